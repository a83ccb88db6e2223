/* SPDX-License-Identifier: BSD-3-Clause */
/* An OASIS file as a stream of numbers and strings, compressed blocks opened
   on the way. Memory is bounded: the file goes through one buffer, a block
   through another.

   The first failure is kept: *error is filled, `failed` set, and everything
   that is read from then on is 0. Whoever loops over something that the file
   counts looks at `failed`. */
#ifndef OPCFLOW_OASIS_STREAM_H
#define OPCFLOW_OASIS_STREAM_H

#include <eda/oasis.h>
#include <opcflow/plugin.h>
#include <zlib.h>

typedef struct oasis_stream {
  const opc_host *host;
  const char *path;
  FILE *file;
  uint64_t size; /* of the file, bytes */
  opc_error *error;
  int failed;
  int told; /* of the progress: the user */

  const uint8_t *p, *end; /* what can be read at once */
  uint8_t *buffer;        /* of the file */
  uint64_t base;          /* place in the file of its start */
  size_t filled;

  int inside; /* of a compressed block */
  const uint8_t *file_p;
  uint64_t block_at; /* where it begins in the file */
  uint64_t done;     /* of its bytes, before `inflated` */
  uint64_t left_in, left_out;
  uint8_t *inflated;
  z_stream z;
  uint64_t unpacked; /* from all blocks so far */

  int scheme; /* of the sum to keep */
  uint32_t sum;
  uint64_t summed; /* place in the file up to which it goes */

  uint64_t record; /* where the current record begins, in file or block */
} oasis_stream;

/* Open the file and step past the magic bytes. */
void oasis_open(oasis_stream *s, const opc_host *host, const char *path,
                opc_error *error);
void oasis_close(oasis_stream *s);
/* Go on at another place of the file; not while a sum is kept. */
void oasis_seek(oasis_stream *s, uint64_t at);

/* Fail: "'path': WHAT at byte N", N being where the record begins. */
void oasis_refuse(oasis_stream *s, const char *what);

/* A record begins here: leave blocks that end here. 0 after a failure. */
int oasis_begin_record(oasis_stream *s);
/* The place in the file; and bytes read up to here, also of blocks, these at
   most 64 for each of the file's. */
uint64_t oasis_place(const oasis_stream *s);
uint64_t oasis_consumed(const oasis_stream *s);

/* The contents of a CBLOCK record are what comes next. */
void oasis_enter_block(oasis_stream *s);

/* The sum of the file up to here. */
uint32_t oasis_sum(oasis_stream *s);

/* The next window; 0 if there is none, which is a failure. */
int oasis_refill(oasis_stream *s);

static inline uint32_t oasis_byte(oasis_stream *s) {
  if (s->p == s->end && !oasis_refill(s)) return 0;
  return *s->p++;
}

uint64_t oasis_long_uint(oasis_stream *s, uint32_t first);

static inline uint64_t oasis_uint(oasis_stream *s) {
  uint32_t b = oasis_byte(s);
  return b < 0x80 ? b : oasis_long_uint(s, b);
}

/* Sign in the lowest bit. */
static inline int64_t oasis_sint(oasis_stream *s) {
  uint64_t v = oasis_uint(s);
  return v & 1 ? -(int64_t)(v >> 1) : (int64_t)(v >> 1);
}

/* An unsigned integer of 32 bits: `what` is too large otherwise. */
uint32_t oasis_uint32(oasis_stream *s, const char *what);

double oasis_real(oasis_stream *s);
/* Of a type that has been read already. */
double oasis_real_of(oasis_stream *s, uint64_t type);

/* Lengths that a coordinate can have, or it is a failure; also of a sum. */
int64_t oasis_length(oasis_stream *s, int64_t v);

typedef struct oasis_vector {
  int64_t x, y; /* within +-2^33 */
} oasis_vector;

oasis_vector oasis_delta1(oasis_stream *s, int horizontal);
oasis_vector oasis_delta2(oasis_stream *s);
oasis_vector oasis_delta3(oasis_stream *s);
oasis_vector oasis_deltag(oasis_stream *s);

typedef struct oasis_text {
  char *s; /* zero-terminated, printable */
  size_t room;
} oasis_text;

/* A string, bytes that are not printable ASCII as "\xE4"; into `out`, which is
   freed with free, or past it. */
void oasis_string(oasis_stream *s, oasis_text *out);
void oasis_skip_string(oasis_stream *s);

#endif
