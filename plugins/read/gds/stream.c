/* SPDX-License-Identifier: BSD-3-Clause */
/* A GDSII file, record by record, through one buffer. */
#include "stream.h"

#include <eda/memory.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Some records; a record has less than 2^16 bytes. Small files take less. */
enum { BUFFER = 1 << 20, LEAST = 1 << 16 };

int gds_open(gds_stream *s, const opc_host *host, const char *path,
             opc_error *error) {
  *s = (gds_stream){.host = host, .path = path, .total = NAN};
  s->file = fopen(path, "rb");
  if (!s->file)
    return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, strerror(errno));
  setvbuf(s->file, NULL, _IONBF, 0);
  if (!fseek(s->file, 0, SEEK_END)) {
    long end = ftell(s->file);
    if (end >= 0) s->total = (double)end;
    rewind(s->file);
  }
  s->room = s->total < BUFFER ? (size_t)s->total + LEAST : BUFFER;
  s->buffer = eda_alloc(s->room, 1);
  return OPC_OK;
}

void gds_close(gds_stream *s) {
  if (s->file) fclose(s->file);
  free(s->buffer);
}

int gds_refuse(const gds_stream *s, opc_error *error, const char *what) {
  return opc_fail(error, OPC_IO, NULL, "'%s': %s at byte %" PRIu64, s->path,
                  what, s->at);
}

int gds_need(const gds_stream *s, size_t bytes, opc_error *error) {
  if (s->n >= bytes) return OPC_OK;
  return gds_refuse(s, error, "record too short for its kind");
}

/* Read on until `wanted` bytes are there, or the file ends. */
static int fill(gds_stream *s, size_t wanted, opc_error *error) {
  const opc_host *host = s->host;
  if (opc_cancelled(host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
  memmove(s->buffer, s->buffer + s->begin, s->end - s->begin);
  s->base += s->begin;
  s->end -= s->begin;
  s->begin = 0;
  while (s->end < wanted) {
    size_t got = fread(s->buffer + s->end, 1, s->room - s->end, s->file);
    s->end += got;
    if (got) continue;
    if (ferror(s->file))
      return opc_fail(error, OPC_IO, NULL, "'%s': %s", s->path,
                      strerror(errno));
    break;
  }
  opc_progress progress = {(double)(s->base + s->end), s->total, NAN, NULL};
  host->progress(host, &progress);
  return OPC_OK;
}

int gds_next(gds_stream *s, opc_error *error) {
  s->at = s->base + s->begin;
  if (s->end - s->begin < 4) {
    if (fill(s, 4, error)) return error->code;
    if (s->end == 0) return gds_refuse(s, error, "ends before ENDLIB,");
    if (s->end < 4) return gds_refuse(s, error, "truncated record");
  }
  const uint8_t *p = s->buffer + s->begin;
  size_t length = eda_gds_u16(p);
  if (length < 4 || length % 2)
    return gds_refuse(s, error, "impossible record length");
  if (s->end - s->begin < length) {
    if (fill(s, length, error)) return error->code;
    if (s->end < length) return gds_refuse(s, error, "truncated record");
    p = s->buffer;
  }
  s->type = p[2];
  s->data = p + 4;
  s->n = length - 4;
  s->begin += length;
  return OPC_OK;
}
