/* SPDX-License-Identifier: BSD-3-Clause */
#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../read/oasis/records.h"

/* Bytes of a block: enough for zlib, little enough for memory. Blocks of fewer
   than SMALL are left as they are. */
enum { BLOCK = 1 << 20, SMALL = 32 };

int pack_begin(pack *p, const opc_host *host, FILE *file) {
  *p = (pack){.host = host, .file = file};
  p->zlib = deflateInit2(&p->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS,
                         8, Z_DEFAULT_STRATEGY) == Z_OK;
  return p->zlib;
}

void pack_clear(pack *p) {
  if (p->zlib) deflateEnd(&p->z);
  free(p->bytes);
  free(p->packed);
  *p = (pack){0};
}

static int room_for(uint8_t **bytes, size_t *room, size_t need) {
  if (need <= *room) return 1;
  size_t wanted = need + need / 2 + 4096;
  uint8_t *memory = realloc(*bytes, wanted);
  if (!memory) return 0;
  *bytes = memory;
  *room = wanted;
  return 1;
}

static void put(pack *p, const void *bytes, size_t n) {
  if (!room_for(&p->bytes, &p->room, p->n + n)) {
    p->failed = 1;
    return;
  }
  memcpy(p->bytes + p->n, bytes, n);
  p->n += n;
}

/* ---- numbers ---- */

void pack_byte(pack *p, uint32_t b) {
  uint8_t byte = (uint8_t)b;
  put(p, &byte, 1);
}

void pack_uint(pack *p, uint64_t v) {
  uint8_t bytes[10];
  size_t n = 0;
  for (; v >= 0x80; v >>= 7) bytes[n++] = (uint8_t)(v | 0x80);
  bytes[n++] = (uint8_t)v;
  put(p, bytes, n);
}

void pack_sint(pack *p, int64_t v) {
  pack_uint(p, v < 0 ? (uint64_t)-v << 1 | 1 : (uint64_t)v << 1);
}

/* A whole number if it is one, or else 8 bytes, little-endian. */
void pack_real(pack *p, double v) {
  if (v == floor(v) && fabs(v) < 1e15) {
    pack_uint(p, v < 0);
    pack_uint(p, (uint64_t)fabs(v));
    return;
  }
  uint64_t bits;
  memcpy(&bits, &v, sizeof bits);
  pack_uint(p, 7);
  for (int i = 0; i < 8; i++) pack_byte(p, (uint32_t)(bits >> 8 * i) & 0xff);
}

void pack_delta(pack *p, int64_t x, int64_t y) {
  uint64_t ax = (uint64_t)(x < 0 ? -x : x), ay = (uint64_t)(y < 0 ? -y : y);
  if (y == 0) {
    pack_uint(p, ax << 4 | (x < 0 ? 2 << 1 : 0));
  } else if (x == 0) {
    pack_uint(p, ay << 4 | (y < 0 ? 3 << 1 : 1 << 1));
  } else if (ax == ay) { /* north-east, north-west, south-west, south-east */
    uint64_t direction = y > 0 ? (x > 0 ? 4 : 5) : (x > 0 ? 7 : 6);
    pack_uint(p, ax << 4 | direction << 1);
  } else {
    pack_uint(p, ax << 2 | (x < 0 ? 3 : 1));
    pack_sint(p, y);
  }
}

void pack_string(pack *p, const char *text) {
  size_t n = strlen(text);
  pack_uint(p, n);
  put(p, text, n);
}

/* ---- blocks ---- */

static void to_file(pack *p, const uint8_t *bytes, size_t n) {
  fwrite(bytes, 1, n, p->file);
  p->crc = (uint32_t)crc32(p->crc, bytes, (uInt)n);
  p->place += n;
}

void pack_plain(pack *p) {
  to_file(p, p->bytes, p->n);
  p->n = 0;
}

void pack_block(pack *p) {
  size_t n = p->n;
  if (n < SMALL || p->failed) {
    pack_plain(p);
    return;
  }
  size_t bound = deflateBound(&p->z, (uLong)n);
  if (!room_for(&p->packed, &p->packed_room, bound)) {
    p->failed = 1;
    return;
  }
  deflateReset(&p->z);
  p->z.next_in = p->bytes;
  p->z.avail_in = (uInt)n;
  p->z.next_out = p->packed;
  p->z.avail_out = (uInt)bound;
  int code = deflate(&p->z, Z_FINISH);
  size_t m = bound - p->z.avail_out;
  if (code != Z_STREAM_END || m + 12 > n) {
    pack_plain(p);
    return;
  }
  p->n = 0;
  pack_uint(p, OASIS_CBLOCK);
  pack_uint(p, 0);
  pack_uint(p, n);
  pack_uint(p, m);
  pack_plain(p);
  to_file(p, p->packed, m);
}

void pack_record(pack *p) {
  if (p->n >= BLOCK) pack_block(p);
}
