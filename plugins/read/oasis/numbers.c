/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements numbers, vectors and strings (SEMI P39, section 7). */
#include <math.h>
#include <string.h>

#include "oasis.h"

/* Largest coordinate, length or sum of lengths. Sums with further coordinates
   fit into 64 bits. */
#define MAX_LENGTH ((int64_t)1 << 33)

/* Seven bits per byte, lowest bits first; any number of zeros may follow. */
uint64_t oasis_long_uint(oasis *o, uint32_t first) {
  uint64_t v = first & 0x7f;
  uint32_t b = first;
  for (unsigned shift = 7; b & 0x80 && !o->b.failed; shift += 7) {
    b = oasis_byte(o);
    uint64_t bits = b & 0x7f;
    if (!bits) continue;
    if (shift > 63 || (shift == 63 && bits > 1)) {
      oasis_refuse(o, "an integer beyond 64 bits");
      return 0;
    }
    v |= bits << shift;
  }
  return v;
}

uint32_t oasis_uint32(oasis *o, const char *what) {
  uint64_t v = oasis_uint(o);
  if (v <= UINT32_MAX) return (uint32_t)v;
  oasis_refuse(o, what);
  return 0;
}

static double little_endian_real(oasis *o, int bytes) {
  uint64_t bits = 0;
  for (int i = 0; i < bytes; i++) bits |= (uint64_t)oasis_byte(o) << 8 * i;
  double v;
  if (bytes == 4) {
    uint32_t half = (uint32_t)bits;
    float f;
    memcpy(&f, &half, sizeof f);
    v = (double)f;
  } else {
    memcpy(&v, &bits, sizeof v);
  }
  if (isfinite(v)) return v;
  oasis_refuse(o, "a real that is not a number");
  return 0;
}

double oasis_real_of(oasis *o, uint64_t type) {
  if (type > 7) {
    oasis_refuse(o, "an unknown kind of real");
    return 0;
  }
  if (type >= 6) return little_endian_real(o, type == 6 ? 4 : 8);
  int whole = type <= 1, inverse = type == 2 || type == 3;
  double above = inverse ? 1 : (double)oasis_uint(o);
  double below = whole ? 1 : (double)oasis_uint(o);
  if (below == 0) {
    oasis_refuse(o, "a fraction over 0");
    return 0;
  }
  return type & 1 ? -above / below : above / below;
}

double oasis_real(oasis *o) { return oasis_real_of(o, oasis_uint(o)); }

/* ---- vectors ---- */

int64_t oasis_length(oasis *o, int64_t v) {
  if (v >= -MAX_LENGTH && v <= MAX_LENGTH) return v;
  oasis_refuse(o, "a coordinate beyond 32 bits");
  return 0;
}

int64_t oasis_size(oasis *o, uint64_t v) {
  return oasis_length(o, v > INT64_MAX ? INT64_MAX : (int64_t)v);
}

/* Directions: east, north, west, south, then north-east, north-west,
   south-west, south-east. */
static oasis_vector vector_along(uint64_t direction, int64_t size) {
  static const int8_t x[] = {1, 0, -1, 0, 1, -1, -1, 1};
  static const int8_t y[] = {0, 1, 0, -1, 1, 1, -1, -1};
  return (oasis_vector){x[direction] * size, y[direction] * size};
}

oasis_vector oasis_delta1(oasis *o, int horizontal) {
  int64_t v = oasis_length(o, oasis_sint(o));
  return horizontal ? (oasis_vector){v, 0} : (oasis_vector){0, v};
}

oasis_vector oasis_delta2(oasis *o) {
  uint64_t v = oasis_uint(o);
  return vector_along(v & 3, oasis_size(o, v >> 2));
}

oasis_vector oasis_delta3(oasis *o) {
  uint64_t v = oasis_uint(o);
  return vector_along(v & 7, oasis_size(o, v >> 3));
}

oasis_vector oasis_deltag(oasis *o) {
  uint64_t v = oasis_uint(o);
  if (!(v & 1)) return vector_along(v >> 1 & 7, oasis_size(o, v >> 4));
  int64_t x = oasis_size(o, v >> 2);
  int64_t y = oasis_length(o, oasis_sint(o));
  return (oasis_vector){v & 2 ? -x : x, y};
}

/* ---- strings ---- */

/* Append the bytes of a string, which the end of a buffer may split. */
static void take_bytes(oasis *o, GString *out) {
  uint64_t left = oasis_uint(o);
  do {
    size_t n = MIN((size_t)(o->end - o->p), left);
    if (out) g_string_append_len(out, (const char *)o->p, (gssize)n);
    o->p += n;
    left -= n;
  } while (left && oasis_refill(o));
}

char *oasis_string(oasis *o) {
  g_autoptr(GString) bytes = g_string_new(NULL);
  take_bytes(o, bytes);
  return reader_string(bytes->str, o->b.failed ? 0 : bytes->len);
}

void oasis_skip_string(oasis *o) { take_bytes(o, NULL); }
