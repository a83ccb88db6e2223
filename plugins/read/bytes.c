/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a file through a window, a buffer with a part of the file. A gzip file
   (RFC 1952) is decompressed into memory; such a file begins with the bytes 1f
   8b, with which no layout format begins. Compiled into each reader. */
#include <eda/memory.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "reader.h"

/* Size of the window, bytes. The window fits into the cache of a core. */
enum { WINDOW = 1 << 19 };

/* Largest file, 8 GiB: more than any layout that fits into memory. */
#define MOST_BYTES ((size_t)1 << 33)

/* Limit of the decompressed size: MOST_RATIO times the file size plus
   MOST_MORE. Layouts compress to a tenth, decompression bombs to a thousandth.
   Half of the limit would be sufficient for layouts. With twice the limit, a
   file of 16 KB with rectangles of two bytes each takes 4 s under a sanitizer.
 */
#define MOST_RATIO 64
#define MOST_MORE ((size_t)1 << 18)

/* Decompressed bytes between two checks for cancellation. */
enum { PIECE = 1 << 22 };

/* ---- the window ---- */

/* The file is read and not mapped into memory: if another program shortened a
   mapped file, the next access would end this process. */
void reading_load(reading *b, size_t at, size_t want) {
  size_t end = b->start + b->held;
  size_t kept = at >= b->start && at < end ? end - at : 0;
  want = MIN(MAX(want, (size_t)WINDOW), b->n - at);
  eda_grow(&b->bytes, &b->capacity, want, 1);
  if (kept) memmove(b->bytes, b->bytes + (at - b->start), kept);
  while (kept < want && !b->failed) {
    ssize_t got = pread(b->file, b->bytes + kept,
                        MIN(want - kept, (size_t)WINDOW), (off_t)(at + kept));
    if (got < 0 && errno == EINTR) continue;
    if (opc_cancelled(b->r->host->context))
      b->failed = opc_fail(b->error, OPC_CANCELLED, NULL, "cancelled");
    else if (got <= 0)
      b->failed =
          opc_fail(b->error, OPC_IO, NULL, "'%s': %s", b->r->file,
                   got ? strerror(errno) : "became shorter while it was read");
    else
      kept += (size_t)got;
  }
  b->start = at;
  b->held = b->failed ? 0 : kept;
}

reading reading_again(const reading *from, opc_error *error) {
  reading b = {.r = from->r,
               .error = error,
               .refuse = from->refuse,
               .file = from->file,
               .n = from->n};
  if (b.file < 0) {
    b.bytes = from->bytes;
    b.held = from->held;
  }
  return b;
}

int reading_text(reading *b) {
  size_t n;
  b->text = b->n ? (const char *)reading_view(b, 0, b->n, &n) : "";
  return !b->failed;
}

/* ---- gzip ---- */

static int gzip_is_packed(const void *bytes, size_t n) {
  return n >= 2 && !memcmp(bytes, "\x1f\x8b", 2);
}

static void gzip_refuse(reading *b, const char *what) {
  if (!b->failed)
    b->failed =
        opc_fail(b->error, OPC_IO, NULL, "'%s': gzip: %s", b->r->file, what);
}

/* Decompress the next bytes of the file to z->next_out, across the members of
   the file. Return 0 at the end. */
static int gzip_unpack(reading *b, z_stream *z, size_t *at) {
  if (!z->avail_in) {
    size_t n;
    z->next_in = (Bytef *)reading_view(b, *at, 1, &n);
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

/* Replace the window on a gzip file by the whole decompressed content. */
static void reading_unzip(reading *b) {
  const size_t most = b->n * MOST_RATIO + MOST_MORE;
  char *out = NULL;
  size_t n = 0, capacity = 0, at = 0;
  z_stream z = {0};
  int more = 1;
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
  if (gzip_is_packed(out, n)) gzip_refuse(b, "the content is compressed again");
  reading_close(b);
  b->bytes = out;
  b->n = b->held = n;
}

/* ---- opening ---- */

/* Only regular files are accepted, because others may be endless (/dev/zero).
   With O_NONBLOCK, opening a pipe returns at once. */
void reading_open(reading *b) {
  struct stat about = {0};
  size_t n;
  b->file = open(b->r->file, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (b->file < 0 || fstat(b->file, &about))
    b->failed = opc_fail(b->error, OPC_IO, NULL, "'%s': %s", b->r->file,
                         strerror(errno));
  else if (!S_ISREG(about.st_mode) || (size_t)about.st_size >= MOST_BYTES)
    b->failed = opc_fail(b->error, OPC_IO, NULL, "'%s': %s", b->r->file,
                         S_ISREG(about.st_mode) ? "is larger than 8 GiB"
                                                : "is not a regular file");
  if (b->failed) return;
  b->n = (size_t)about.st_size;
  eda_grow(&b->bytes, &b->capacity, 1, 1); /* not NULL for an empty file */
  const uint8_t *first = reading_view(b, 0, 2, &n);
  if (gzip_is_packed(first, n)) reading_unzip(b);
}

void reading_close(reading *b) {
  g_clear_pointer(&b->bytes, free);
  if (b->file >= 0) close(b->file);
  b->file = -1;
  b->start = b->held = b->capacity = b->n = 0;
}
