/* SPDX-License-Identifier: BSD-3-Clause */
/* A GDSII file, record by record, through one buffer. */
#ifndef OPCFLOW_GDS_STREAM_H
#define OPCFLOW_GDS_STREAM_H

#include <eda/gds.h>
#include <opcflow/plugin.h>

typedef struct gds_stream {
  const opc_host *host;
  const char *path;
  FILE *file;
  double total; /* bytes of the file, NAN if unknown */
  uint8_t *buffer;
  size_t room;       /* of it, at least one record */
  size_t begin, end; /* what is still to be read of it */
  uint64_t base;     /* place in the file of the buffer's start */

  /* The current record; valid until the next one. */
  uint32_t type;
  const uint8_t *data;
  size_t n;    /* bytes of data, even */
  uint64_t at; /* where it begins */
} gds_stream;

int gds_open(gds_stream *s, const opc_host *host, const char *path,
             opc_error *error);
void gds_close(gds_stream *s);

/* The next record. Errors carry the byte where it begins. */
int gds_next(gds_stream *s, opc_error *error);

/* Refuse the current record: "'path': WHAT at byte N". */
int gds_refuse(const gds_stream *s, opc_error *error, const char *what);

/* Refuse it if it has less than `bytes` of data. */
int gds_need(const gds_stream *s, size_t bytes, opc_error *error);

#endif
