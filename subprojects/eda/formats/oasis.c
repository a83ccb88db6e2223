/* SPDX-License-Identifier: BSD-3-Clause */
/* Encoding of OASIS files: numbers, strings and compressed blocks. */
#include "formats/oasis.h"

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Size of a block before compression, bytes: large enough for good compression.
   Blocks shorter than SMALL bytes are not compressed. */
enum { BLOCK = 1 << 20, SMALL = 32 };

eda_oasis *eda_oasis_new(FILE *file) {
  eda_oasis *out = eda_alloc(1, sizeof *out);
  out->file = file;
  if (deflateInit2(&out->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    g_error("zlib: out of memory");
  return out;
}

void eda_oasis_free(eda_oasis *out) {
  if (!out) return;
  deflateEnd(&out->z);
  free(out->bytes);
  free(out->packed);
  free(out->shapes);
  free(out->steps);
  free(out);
}

uint64_t eda_oasis_place(const eda_oasis *out) { return out->place; }
uint32_t eda_oasis_crc(const eda_oasis *out) { return out->crc; }
size_t eda_oasis_collected(const eda_oasis *out) { return out->n; }

static void oasis_put(eda_oasis *out, const void *bytes, size_t n) {
  eda_grow(&out->bytes, &out->capacity, out->n + n, 1);
  memcpy(out->bytes + out->n, bytes, n);
  out->n += n;
}

/* ---- numbers ---- */

void eda_oasis_byte(eda_oasis *out, uint32_t b) {
  uint8_t byte = (uint8_t)b;
  oasis_put(out, &byte, 1);
}

void eda_oasis_uint(eda_oasis *out, uint64_t v) {
  uint8_t bytes[10];
  size_t n = 0;
  for (; v >= 0x80; v >>= 7) bytes[n++] = (uint8_t)(v | 0x80);
  bytes[n++] = (uint8_t)v;
  oasis_put(out, bytes, n);
}

void eda_oasis_sint(eda_oasis *out, int64_t v) {
  eda_oasis_uint(out, v < 0 ? (uint64_t)-v << 1 | 1 : (uint64_t)v << 1);
}

/* A whole number is written as such, other numbers as 8 bytes (IEEE,
   little-endian). */
void eda_oasis_real(eda_oasis *out, double v) {
  if (v == floor(v) && fabs(v) < 1e15) {
    eda_oasis_uint(out, v < 0);
    eda_oasis_uint(out, (uint64_t)fabs(v));
    return;
  }
  uint64_t bits;
  memcpy(&bits, &v, sizeof bits);
  eda_oasis_uint(out, 7);
  for (int i = 0; i < 8; i++)
    eda_oasis_byte(out, (uint32_t)(bits >> 8 * i) & 0xff);
}

void eda_oasis_delta(eda_oasis *out, int64_t x, int64_t y) {
  uint64_t ax = (uint64_t)(x < 0 ? -x : x), ay = (uint64_t)(y < 0 ? -y : y);
  if (y == 0) {
    eda_oasis_uint(out, ax << 4 | (x < 0 ? 2 << 1 : 0));
  } else if (x == 0) {
    eda_oasis_uint(out, ay << 4 | (y < 0 ? 3 << 1 : 1 << 1));
  } else if (ax == ay) { /* directions: north-east 4, north-west 5, south-west
                            6, south-east 7 */
    uint64_t direction = y > 0 ? (x > 0 ? 4 : 5) : (x > 0 ? 7 : 6);
    eda_oasis_uint(out, ax << 4 | direction << 1);
  } else {
    eda_oasis_uint(out, ax << 2 | (x < 0 ? 3 : 1));
    eda_oasis_sint(out, y);
  }
}

void eda_oasis_string(eda_oasis *out, const char *text) {
  size_t n = strlen(text);
  eda_oasis_uint(out, n);
  oasis_put(out, text, n);
}

/* ---- blocks ---- */

static void to_file(eda_oasis *out, const uint8_t *bytes, size_t n) {
  if (out->file) fwrite(bytes, 1, n, out->file);
  out->crc = (uint32_t)crc32(out->crc, bytes, (uInt)n);
  out->place += n;
}

void eda_oasis_end_plain(eda_oasis *out) {
  to_file(out, out->bytes, out->n);
  out->n = 0;
}

void eda_oasis_end_block(eda_oasis *out) {
  size_t n = out->n;
  if (n < SMALL) {
    eda_oasis_end_plain(out);
    return;
  }
  size_t bound = deflateBound(&out->z, (uLong)n);
  eda_grow(&out->packed, &out->packed_capacity, bound, 1);
  deflateReset(&out->z);
  out->z.next_in = out->bytes;
  out->z.avail_in = (uInt)n;
  out->z.next_out = out->packed;
  out->z.avail_out = (uInt)bound;
  int code = deflate(&out->z, Z_FINISH);
  size_t m = bound - out->z.avail_out;
  if (code != Z_STREAM_END || m + 12 > n) {
    eda_oasis_end_plain(out);
    return;
  }
  out->n = 0;
  eda_oasis_uint(out, EDA_OASIS_CBLOCK);
  eda_oasis_uint(out, 0);
  eda_oasis_uint(out, n);
  eda_oasis_uint(out, m);
  eda_oasis_end_plain(out);
  to_file(out, out->packed, m);
}

void eda_oasis_end_record(eda_oasis *out) {
  if (out->n >= BLOCK) eda_oasis_end_block(out);
}
