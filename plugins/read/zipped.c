/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements gzip files (RFC 1952), which begin with the bytes 1f 8b; no layout
   begins with these bytes. Compiled into each reader. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "reader.h"

/* Limit of the decompressed size: per byte of the file, plus a constant.
   Layouts compress to a tenth, decompression bombs to a thousandth. Half of the
   limit would suffice. With twice the limit, 16 KB of rectangles of two bytes
   each take 4 s under a sanitizer. */
#define MOST_RATIO 64
#define MOST_MORE ((size_t)1 << 18)

/* Bytes passed to zlib at once, which counts in 32 bits, and between two checks
   for cancellation. */
enum { PIECE = 1 << 22 };

static int gzip_is_packed(const char *bytes) {
  return !memcmp(bytes, "\x1f\x8b", 2);
}

static void gzip_refuse(reading *b, const char *what) {
  if (!b->failed)
    b->failed =
        opc_fail(b->error, OPC_IO, NULL, "'%s': gzip: %s", b->r->file, what);
}

/* Decompress the next bytes of the file to *out, across the members of the
   file. Return 0 at the end. */
static int gzip_unpack(reading *b, z_stream *z, size_t *at) {
  if (!z->avail_in) {
    size_t n = MIN(b->n - *at, (size_t)PIECE);
    z->next_in = (Bytef *)b->bytes + *at;
    z->avail_in = (uInt)n;
    *at += n;
  }
  int dry = !z->avail_in;
  int code = inflate(z, Z_NO_FLUSH);
  if (code == Z_STREAM_END) {
    int more = z->avail_in || *at < b->n;
    if (more) inflateReset(z);
    return more;
  }
  if (code == Z_BUF_ERROR && dry)
    gzip_refuse(b, "the data end too early");
  else if (code != Z_OK && code != Z_BUF_ERROR)
    gzip_refuse(b, z->msg ? z->msg : "the data are damaged");
  return !b->failed;
}

void reading_unzip(reading *b) {
  const size_t most = b->n * MOST_RATIO + MOST_MORE;
  char *out = NULL;
  size_t n = 0, capacity = 0, at = 0;
  z_stream z = {0};
  int more = 1;
  if (b->failed || b->n < 2 || !gzip_is_packed(b->bytes)) return;
  if (inflateInit2(&z, MAX_WBITS + 16) != Z_OK)
    gzip_refuse(b, "zlib has no memory");
  while (more && !b->failed) {
    if (opc_cancelled(b->r->host->context))
      b->failed = opc_fail(b->error, OPC_CANCELLED, NULL, "cancelled");
    if (n >= most) gzip_refuse(b, "the content is larger than any layout");
    eda_grow(&out, &capacity, n + PIECE, 1);
    z.next_out = (Bytef *)out + n;
    z.avail_out = PIECE;
    more = !b->failed && gzip_unpack(b, &z, &at);
    n += PIECE - z.avail_out;
  }
  inflateEnd(&z);
  if (n >= 2 && gzip_is_packed(out))
    gzip_refuse(b, "the content is compressed again");
  free(b->bytes);
  b->bytes = out;
  b->n = n;
  b->text = n ? out : "";
}
