/* SPDX-License-Identifier: BSD-3-Clause */
/* An OASIS file as a stream of bytes: windows, compressed blocks, check sums.
 */
#include "stream.h"

#include <eda/memory.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { BUFFER = 1 << 18, MAGIC = sizeof EDA_OASIS_MAGIC - 1 };

/* Blocks of a file may hold this many bytes for each of the file's, and so
   many more: far beyond what layouts compress to. */
#define MAX_RATIO 256
#define MAX_MORE ((uint64_t)1 << 26)

/* ---- life ---- */

void oasis_open(oasis_stream *s, const opc_host *host, const char *path,
                opc_error *error) {
  *s = (oasis_stream){.host = host, .path = path, .error = error};
  s->buffer = eda_alloc(BUFFER, 1);
  s->inflated = eda_alloc(BUFFER, 1);
  struct stat about;
  s->file = fopen(path, "rb");
  if (!s->file || fstat(fileno(s->file), &about)) {
    s->failed = 1;
    opc_fail(error, OPC_IO, NULL, "'%s': %s", path, strerror(errno));
    return;
  }
  setvbuf(s->file, NULL, _IONBF, 0);
  s->size = (uint64_t)about.st_size;
  s->p = s->end = s->buffer;
  for (int i = 0; i < MAGIC && !s->failed; i++)
    if (oasis_byte(s) != (uint8_t)EDA_OASIS_MAGIC[i])
      oasis_refuse(s, "not an OASIS file: no magic bytes");
}

static void leave_block(oasis_stream *s) {
  if (s->inside) inflateEnd(&s->z);
  s->inside = 0;
}

void oasis_close(oasis_stream *s) {
  leave_block(s);
  if (s->file) fclose(s->file);
  free(s->buffer);
  free(s->inflated);
}

void oasis_seek(oasis_stream *s, uint64_t at) {
  if (s->failed) return;
  leave_block(s);
  if (at >= s->size || fseeko(s->file, (off_t)at, SEEK_SET)) {
    oasis_refuse(s, "a name table lies outside of the file");
    return;
  }
  s->base = at;
  s->filled = 0;
  s->p = s->end = s->buffer;
  s->record = at;
}

/* ---- failures ---- */

static void stop(oasis_stream *s) {
  s->failed = 1;
  s->p = s->end = s->buffer;
}

void oasis_refuse(oasis_stream *s, const char *what) {
  if (s->failed) return;
  if (s->inside)
    opc_fail(s->error, OPC_IO, NULL,
             "'%s': %s at byte %" PRIu64 " of what the block at byte %" PRIu64
             " holds",
             s->path, what, s->record, s->block_at);
  else
    opc_fail(s->error, OPC_IO, NULL, "'%s': %s at byte %" PRIu64, s->path, what,
             s->record);
  stop(s);
}

/* ---- windows ---- */

static void add_to_sum(oasis_stream *s, const uint8_t *p, size_t n) {
  if (s->scheme == EDA_OASIS_CRC32)
    s->sum = (uint32_t)crc32(s->sum, p, (uInt)n);
  if (s->scheme == EDA_OASIS_SUM32)
    for (size_t i = 0; i < n; i++) s->sum += p[i];
}

/* Up to the place `to`, which lies in the buffer or at its end. */
static void sum_up(oasis_stream *s, uint64_t to) {
  if (s->scheme == EDA_OASIS_NO_CHECK) return;
  add_to_sum(s, s->buffer + (s->summed - s->base), (size_t)(to - s->summed));
  s->summed = to;
}

/* The next bytes of the file at s->buffer; how many. */
static size_t read_file(oasis_stream *s) {
  const opc_host *host = s->host;
  if (opc_cancelled(host->context)) {
    opc_fail(s->error, OPC_CANCELLED, NULL, "cancelled");
    stop(s);
    return 0;
  }
  sum_up(s, s->base + s->filled);
  s->base += s->filled;
  s->filled = fread(s->buffer, 1, BUFFER, s->file);
  if (ferror(s->file)) {
    opc_fail(s->error, OPC_IO, NULL, "'%s': %s", s->path, strerror(errno));
    stop(s);
    return 0;
  }
  opc_progress progress = {(double)(s->base + s->filled), (double)s->size, NAN,
                           NULL};
  if (s->told) host->progress(host, &progress);
  return s->filled;
}

/* Compressed bytes for zlib. */
static void feed(oasis_stream *s) {
  if (s->z.avail_in || !s->left_in) return;
  const uint8_t *end = s->buffer + s->filled;
  if (s->file_p == end) {
    if (!read_file(s)) {
      oasis_refuse(s, "the file ends in a compressed block, in a record");
      return;
    }
    s->file_p = s->buffer;
    end = s->buffer + s->filled;
  }
  size_t n = (size_t)(end - s->file_p);
  if (n > s->left_in) n = (size_t)s->left_in;
  s->z.next_in = (Bytef *)s->file_p;
  s->z.avail_in = (uInt)n;
  s->file_p += n;
  s->left_in -= n;
}

/* At most `room` inflated bytes into `out`; how many, 0 at the end. */
static size_t unpack(oasis_stream *s, uint8_t *out, size_t room) {
  s->z.next_out = out;
  s->z.avail_out = (uInt)room;
  int code = Z_OK;
  while (code == Z_OK && s->z.avail_out == room && !s->failed) {
    feed(s);
    int dry = !s->z.avail_in;
    code = inflate(&s->z, Z_NO_FLUSH);
    if (dry && code == Z_BUF_ERROR) break;
  }
  if (s->failed) return 0;
  if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
    oasis_refuse(s, "the compressed data is damaged");
  return room - s->z.avail_out;
}

static int refill_block(oasis_stream *s) {
  if (!s->left_out) {
    oasis_refuse(s, "the block ends in a record that begins");
    return 0;
  }
  s->done += (uint64_t)(s->end - s->inflated);
  s->p = s->end = s->inflated;
  size_t room = s->left_out < BUFFER ? (size_t)s->left_out : BUFFER;
  size_t n = unpack(s, s->inflated, room);
  if (!n) {
    oasis_refuse(s, "a compressed block holds less than it says, the record");
    return 0;
  }
  s->left_out -= n;
  s->end = s->inflated + n;
  return 1;
}

int oasis_refill(oasis_stream *s) {
  if (s->failed) return 0;
  if (s->inside) return refill_block(s);
  size_t n = read_file(s);
  s->p = s->buffer;
  s->end = s->buffer + n;
  if (!n) oasis_refuse(s, "the file ends in a record that begins");
  return n > 0;
}

uint64_t oasis_place(const oasis_stream *s) {
  const uint8_t *p = s->inside ? s->file_p : s->p;
  return s->base + (uint64_t)(p - s->buffer);
}

uint64_t oasis_consumed(const oasis_stream *s) {
  uint64_t unpacked = s->unpacked, place = oasis_place(s);
  if (s->inside) unpacked -= s->left_out + (uint64_t)(s->end - s->p);
  return place + (unpacked < 64 * place ? unpacked : 64 * place);
}

uint32_t oasis_sum(oasis_stream *s) {
  sum_up(s, oasis_place(s));
  return s->sum;
}

/* ---- blocks ---- */

void oasis_enter_block(oasis_stream *s) {
  uint64_t type = oasis_uint(s), out = oasis_uint(s), in = oasis_uint(s);
  if (s->failed) return;
  if (s->inside) {
    oasis_refuse(s, "a compressed block inside of another");
    return;
  }
  if (type != 0) {
    oasis_refuse(s, "a compressed block of an unknown kind");
    return;
  }
  if (in > s->size) {
    oasis_refuse(s, "a compressed block longer than the file");
    return;
  }
  uint64_t most = s->size * MAX_RATIO + MAX_MORE;
  if (out > most || s->unpacked + out > most) {
    oasis_refuse(s, "compressed blocks hold too much, the one");
    return;
  }
  s->z = (z_stream){0};
  if (inflateInit2(&s->z, -MAX_WBITS) != Z_OK) {
    oasis_refuse(s, "zlib has no memory for the block");
    return;
  }
  s->inside = 1;
  s->block_at = s->record;
  s->unpacked += out;
  s->left_in = in;
  s->left_out = out;
  s->done = 0;
  s->file_p = s->p;
  s->p = s->end = s->inflated;
}

/* All that the block holds has been read. */
static void end_block(oasis_stream *s) {
  uint8_t more;
  s->record = s->done + (uint64_t)(s->p - s->inflated);
  if (unpack(s, &more, 1)) {
    oasis_refuse(s, "a compressed block holds more than it says, the rest");
    return;
  }
  if (s->failed) return;
  if (s->left_in || s->z.avail_in) {
    oasis_refuse(s, "a compressed block ends before it should,");
    return;
  }
  leave_block(s);
  s->p = s->file_p;
  s->end = s->buffer + s->filled;
}

int oasis_begin_record(oasis_stream *s) {
  while (!s->failed && s->inside && s->p == s->end && !s->left_out)
    end_block(s);
  if (s->failed) return 0;
  s->record =
      s->inside ? s->done + (uint64_t)(s->p - s->inflated) : oasis_place(s);
  return 1;
}
