/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements an OASIS file as a stream of bytes, with its compressed blocks.
   Memory is bounded: the file and a block are read through one buffer each. */
#include <eda/memory.h>
#include <inttypes.h>
#include <stdlib.h>

#include "oasis.h"

enum { BUFFER = 1 << 18 };

/* Limit of the decompressed size of all blocks: MAX_RATIO times the file size
   plus MAX_MORE. Layouts compress to a tenth, padding to a thousandth. 64 MB of
   one-byte records take 30 s under a sanitizer. */
#define MAX_RATIO 64
#define MAX_MORE ((uint64_t)1 << 18)

/* ---- life ---- */

/* Continue at byte `at` of the file. */
static void file_continue(oasis *o, uint64_t at) {
  size_t n;
  o->p = reading_view(&o->b, at, 1, &n);
  o->end = o->p + n;
}

oasis oasis_again(const oasis *from, opc_error *error) {
  oasis o = {.b = reading_again(&from->b, error), .naming = 1};
  for (int i = 0; i < OASIS_NAMES; i++)
    o.names[i] = g_hash_table_ref(from->names[i]);
  return o;
}

static void block_leave(oasis *o) {
  if (o->inside) inflateEnd(&o->z);
  o->inside = 0;
}

void oasis_clear(oasis *o) {
  block_leave(o);
  for (int i = 0; i < OASIS_NAMES; i++) g_hash_table_unref(o->names[i]);
  if (o->b.file >= 0) free(o->b.bytes);
  free(o->inflated);
  free(o->points);
  g_free(o->instance);
  g_free(o->m.text.text);
  g_free(o->m.property.text);
  g_free(o->m.value.text);
  free(o->m.polygon.p);
  free(o->m.path.p);
  free(o->m.repetition.offsets.p);
}

void oasis_seek(oasis *o, uint64_t at) {
  if (o->b.failed) return;
  block_leave(o);
  if (at && at >= o->b.n) {
    oasis_refuse(o, "a name table is outside of the file");
    return;
  }
  file_continue(o, at);
  o->record = at;
}

void oasis_refuse(void *self, const char *what) {
  oasis *o = self;
  if (o->b.failed) return;
  g_autofree char *block =
      o->inside
          ? g_strdup_printf(
                " of the content of the compressed block at byte %" PRIu64 "",
                o->block_at)
          : NULL;
  o->b.failed =
      opc_fail(o->b.error, OPC_IO, NULL, "'%s': %s at byte %" PRIu64 "%s",
               o->b.r->file, what, o->record, block ? block : "");
  o->p = o->end;
}

/* ---- windows ---- */

/* Provide compressed bytes to zlib. */
static void block_feed(oasis *o) {
  enum { MOST = 1 << 30 }; /* zlib counts in 32 bits */
  if (o->z.avail_in || !o->left_in) return;
  size_t n;
  o->z.next_in = (Bytef *)reading_view(&o->b, o->file_at, 1, &n);
  if (!n) oasis_refuse(o, "the file ends in a compressed block, in a record");
  n = MIN(n, MIN(o->left_in, (uint64_t)MOST));
  o->z.avail_in = (uInt)n;
  o->file_at += n;
  o->left_in -= n;
}

/* Inflate at most `capacity` bytes to `out`. Return their number, 0 at the
   end. */
static size_t block_unpack(oasis *o, uint8_t *out, size_t capacity) {
  o->z.next_out = out;
  o->z.avail_out = (uInt)capacity;
  int code = Z_OK;
  while (code == Z_OK && o->z.avail_out == capacity && !o->b.failed) {
    block_feed(o);
    int dry = !o->z.avail_in;
    code = inflate(&o->z, Z_NO_FLUSH);
    if (dry && code == Z_BUF_ERROR) break;
  }
  if (o->b.failed) return 0;
  if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
    oasis_refuse(o, "the compressed data is damaged");
  return capacity - o->z.avail_out;
}

int oasis_refill(oasis *o) {
  if (!o->inside && !o->b.failed && oasis_place(o) < o->b.n) {
    file_continue(o, oasis_place(o));
    return !o->b.failed;
  }
  if (!o->inside || !o->left_out) {
    oasis_refuse(o, o->inside ? "the block ends in a record that begins"
                              : "the file ends in a record that begins");
    return 0;
  }
  if (!reading_goes_on(&o->b, oasis_place(o), !o->naming)) return 0;
  o->done += (uint64_t)(o->end - o->inflated);
  o->p = o->end = o->inflated;
  size_t n = block_unpack(o, o->inflated, MIN(o->left_out, (uint64_t)BUFFER));
  if (!n)
    oasis_refuse(o, "a compressed block is shorter than declared, the record");
  o->left_out -= n;
  if (!o->b.failed) o->end = o->inflated + n;
  return !o->b.failed;
}

uint64_t oasis_place(const oasis *o) {
  if (o->inside) return o->file_at;
  return o->b.start + (uint64_t)(o->p - (const uint8_t *)o->b.bytes);
}

uint64_t oasis_consumed(const oasis *o) {
  uint64_t unpacked = o->unpacked, place = oasis_place(o);
  if (o->inside) unpacked -= o->left_out + (uint64_t)(o->end - o->p);
  return place + MIN(unpacked, 64 * place);
}

/* ---- blocks ---- */

void oasis_enter_block(oasis *o) {
  uint64_t type = oasis_uint(o), out = oasis_uint(o), in = oasis_uint(o);
  uint64_t most = o->b.n * MAX_RATIO + MAX_MORE;
  if (o->b.failed) return;
  if (o->inside)
    oasis_refuse(o, "a compressed block inside of another");
  else if (type != 0)
    oasis_refuse(o, "a compressed block of an unknown kind");
  else if (in > o->b.n)
    oasis_refuse(o, "a compressed block longer than the file");
  else if (out > most || o->unpacked + out > most)
    oasis_refuse(o, "compressed blocks are too large, the one");
  if (o->b.failed) return;
  o->z = (z_stream){0};
  if (inflateInit2(&o->z, -MAX_WBITS) != Z_OK) {
    oasis_refuse(o, "zlib has no memory for the block");
    return;
  }
  if (!o->inflated) o->inflated = eda_alloc(BUFFER, 1);
  o->file_at = oasis_place(o);
  o->inside = 1;
  o->block_at = o->record;
  o->unpacked += out;
  o->left_in = in;
  o->left_out = out;
  o->done = 0;
  o->p = o->end = o->inflated;
}

/* Leave a block at the end of the block. */
static void block_end(oasis *o) {
  uint8_t more;
  o->record = o->done + (uint64_t)(o->p - o->inflated);
  if (block_unpack(o, &more, 1))
    oasis_refuse(o,
                 "a compressed block is longer than declared, the remainder");
  else if (o->left_in || o->z.avail_in)
    oasis_refuse(o, "a compressed block ends too early,");
  if (o->b.failed) return;
  block_leave(o);
  file_continue(o, o->file_at);
}

int oasis_begin_record(oasis *o) {
  while (!o->b.failed && o->inside && o->p == o->end && !o->left_out)
    block_end(o);
  o->record =
      o->inside ? o->done + (uint64_t)(o->p - o->inflated) : oasis_place(o);
  return reading_goes_on(&o->b, oasis_place(o), !o->naming);
}
