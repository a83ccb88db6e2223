/* SPDX-License-Identifier: BSD-3-Clause */
/* Bytes on their way into an OASIS file: numbers and strings, collected into
   compressed blocks. */
#ifndef OPCFLOW_OASIS_PACK_H
#define OPCFLOW_OASIS_PACK_H

#include <opcflow/opcflow.h>
#include <stdio.h>
#include <zlib.h>

typedef struct pack {
  const opc_host *host;
  FILE *file;
  uint64_t place; /* in the file */
  uint32_t crc;   /* of all that is there */
  uint8_t *bytes; /* of the block that is being collected */
  size_t n, room;
  uint8_t *packed;
  size_t packed_room;
  z_stream z;
  int zlib;   /* z is there */
  int failed; /* for want of memory */
} pack;

int pack_begin(pack *p, const opc_host *host, FILE *file);
void pack_clear(pack *p);

void pack_byte(pack *p, uint32_t b);
void pack_uint(pack *p, uint64_t v);
void pack_sint(pack *p, int64_t v);
void pack_real(pack *p, double v);
/* Any direction and length. */
void pack_delta(pack *p, int64_t x, int64_t y);
void pack_string(pack *p, const char *text);

/* A record has ended: begin a new block if this one is long enough. */
void pack_record(pack *p);
/* What was collected goes to the file, compressed if that makes it shorter. */
void pack_block(pack *p);
/* The same, as it is. */
void pack_plain(pack *p);

#endif
