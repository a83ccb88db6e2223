/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the pieces service in one process, one piece after another. */
#include "core/plugin/pieces.h"

#include <string.h>

typedef struct buffer {
  opc_bytes bytes; /* must be first: cast from opc_bytes */
  GByteArray *all;
  gboolean full; /* data beyond the limit was dropped */
} buffer;

static void bytes_add(opc_bytes *bytes, const void *from, size_t size) {
  buffer *own = (buffer *)bytes;
  own->full |= size > OPC_PIECE_MOST - (size_t)own->all->len;
  if (!own->full && size) g_byte_array_append(own->all, from, (guint)size);
}

/* Prefix the error message with the name of the piece and return the code. */
static int piece_fail(const opc_pieces *p, size_t i, int code,
                      opc_error *error) {
  const opc_error own = *error;
  if (!*own.message || !p->name) return code;
  return opc_fail(error, code, own.parameter, "%s %zu: %s", p->name, i,
                  own.message);
}

GBytes *opc_piece_work(const opc_pieces *p, size_t i, opc_error *error) {
  buffer b = {{bytes_add}, g_byte_array_new(), FALSE};
  *error = (opc_error){0};
  int code = p->work(p->data, i, &b.bytes, error);
  if (!code && b.full)
    code =
        opc_fail(error, OPC_FAILED, NULL,
                 "the result of a work unit exceeds %d bytes", OPC_PIECE_MOST);
  if (!code) return g_byte_array_free_to_bytes(b.all);
  error->code = piece_fail(p, i, code, error);
  g_byte_array_unref(b.all);
  return NULL;
}

int opc_piece_take(const opc_pieces *p, size_t i, const void *bytes,
                   size_t size, opc_error *error) {
  *error = (opc_error){0};
  int code = p->take(p->data, i, bytes, size, error);
  return code ? piece_fail(p, i, code, error) : OPC_OK;
}

opc_pieces opc_pieces_copy(const opc_pieces *theirs, size_t size) {
  opc_pieces own = {.data = NULL};
  memcpy(&own, theirs, MIN(size, sizeof own));
  return own;
}

static int do_alone(const opc_host *host, const opc_pieces *theirs,
                    size_t own_size, opc_error *error) {
  const opc_pieces own = opc_pieces_copy(theirs, own_size), *p = &own;
  int code = OPC_OK;
  for (size_t i = 0; i < p->count && !code; i++) {
    if (opc_cancelled(host->context))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    g_autoptr(GBytes) all = opc_piece_work(p, i, error);
    if (!all) return error->code;
    if (p->done) p->done(p->data, i + 1);
    gsize size;
    const void *bytes = g_bytes_get_data(all, &size);
    code = opc_piece_take(p, i, bytes, size, error);
  }
  return code;
}

const opc_pieces_service opc_pieces_alone = {.size = sizeof opc_pieces_alone,
                                             .run = do_alone};
