#include "pieces.h"
#include <glib.h>
typedef struct local { opc_bytes bytes; GByteArray *all; } local;
static void add(opc_bytes *b, const void *from, size_t size) { if (size) g_byte_array_append(((local *)b)->all, from, (guint)size); }
int pieces_run(const opc_host *host, const opc_pieces *p, opc_error *error) {
  int code = OPC_OK;
  for (size_t i = 0; i < p->count && !code; i++) {
    local l = {{add}, g_byte_array_new()};
    if (opc_cancelled(host->context)) code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if (!code) code = p->work(p->data, i, &l.bytes, error);
    if (!code) code = p->take(p->data, i, l.all->data, l.all->len, error);
    if (p->done) p->done(p->data, i + 1);
    g_byte_array_unref(l.all);
  }
  return code;
}
