/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers, vectors and strings (SEMI P39, section 7). */
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "../reader.h"
#include "stream.h"

/* Of a coordinate, a length or a sum of them: whatever is added to another
   coordinate and still fits 64 bits easily. */
#define MAX_LENGTH ((int64_t)1 << 33)

/* Seven bits a byte, the lowest first; zeros may follow without end. */
uint64_t oasis_long_uint(oasis_stream *s, uint32_t first) {
  uint64_t v = first & 0x7f;
  uint32_t b = first;
  for (unsigned shift = 7; b & 0x80 && !s->failed; shift += 7) {
    b = oasis_byte(s);
    uint64_t bits = b & 0x7f;
    if (!bits) continue;
    if (shift > 63 || (shift == 63 && bits > 1)) {
      oasis_refuse(s, "an integer beyond 64 bits");
      return 0;
    }
    v |= bits << shift;
  }
  return v;
}

uint32_t oasis_uint32(oasis_stream *s, const char *what) {
  uint64_t v = oasis_uint(s);
  if (v <= UINT32_MAX) return (uint32_t)v;
  oasis_refuse(s, what);
  return 0;
}

static double little_endian_real(oasis_stream *s, int bytes) {
  uint64_t bits = 0;
  for (int i = 0; i < bytes; i++) bits |= (uint64_t)oasis_byte(s) << 8 * i;
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
  oasis_refuse(s, "a real that is no number");
  return 0;
}

double oasis_real_of(oasis_stream *s, uint64_t type) {
  double above = 1, below = 1;
  switch (type) {
    case 0:
    case 1:
      above = (double)oasis_uint(s);
      break;
    case 2:
    case 3:
      below = (double)oasis_uint(s);
      break;
    case 4:
    case 5:
      above = (double)oasis_uint(s);
      below = (double)oasis_uint(s);
      break;
    case 6:
      return little_endian_real(s, 4);
    case 7:
      return little_endian_real(s, 8);
    default:
      oasis_refuse(s, "an unknown kind of real");
      return 0;
  }
  if (below == 0) {
    oasis_refuse(s, "a fraction over 0");
    return 0;
  }
  return type & 1 ? -above / below : above / below;
}

double oasis_real(oasis_stream *s) { return oasis_real_of(s, oasis_uint(s)); }

/* ---- vectors ---- */

int64_t oasis_length(oasis_stream *s, int64_t v) {
  if (v >= -MAX_LENGTH && v <= MAX_LENGTH) return v;
  oasis_refuse(s, "a coordinate beyond 32 bits");
  return 0;
}

static int64_t magnitude(oasis_stream *s, uint64_t v) {
  return oasis_length(s, v > INT64_MAX ? INT64_MAX : (int64_t)v);
}

/* East, north, west, south; then north-east and on. */
static oasis_vector along(uint64_t direction, int64_t size) {
  static const int8_t x[] = {1, 0, -1, 0, 1, -1, -1, 1};
  static const int8_t y[] = {0, 1, 0, -1, 1, 1, -1, -1};
  return (oasis_vector){x[direction] * size, y[direction] * size};
}

oasis_vector oasis_delta1(oasis_stream *s, int horizontal) {
  int64_t v = oasis_length(s, oasis_sint(s));
  return horizontal ? (oasis_vector){v, 0} : (oasis_vector){0, v};
}

oasis_vector oasis_delta2(oasis_stream *s) {
  uint64_t v = oasis_uint(s);
  return along(v & 3, magnitude(s, v >> 2));
}

oasis_vector oasis_delta3(oasis_stream *s) {
  uint64_t v = oasis_uint(s);
  return along(v & 7, magnitude(s, v >> 3));
}

oasis_vector oasis_deltag(oasis_stream *s) {
  uint64_t v = oasis_uint(s);
  if (!(v & 1)) return along(v >> 1 & 7, magnitude(s, v >> 4));
  int64_t x = magnitude(s, v >> 2);
  int64_t y = oasis_length(s, oasis_sint(s));
  return (oasis_vector){v & 2 ? -x : x, y};
}

/* ---- strings ---- */

void oasis_string(oasis_stream *s, oasis_text *out) {
  uint64_t left = oasis_uint(s);
  size_t used = 0;
  do {
    size_t n = (size_t)(s->end - s->p);
    if (n > left) n = (size_t)left;
    eda_grow(&out->s, &out->room, used + 4 * n + 1, 1);
    reader_string(s->p, n, out->s + used);
    used += strlen(out->s + used);
    s->p += n;
    left -= n;
  } while (left && oasis_refill(s));
  if (s->failed) out->s[0] = '\0';
}

void oasis_skip_string(oasis_stream *s) {
  uint64_t left = oasis_uint(s);
  do {
    size_t n = (size_t)(s->end - s->p);
    if (n > left) n = (size_t)left;
    s->p += n;
    left -= n;
  } while (left && oasis_refill(s));
}
