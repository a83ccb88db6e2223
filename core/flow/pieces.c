/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces of a step's work: done here, and kept in the store as they come, so
   that a run that was killed finds them again. */
#include "core/plugin/pieces.h"

#include <string.h>

#include "core/flow/run.h"
#include "core/plugin/guard.h"

/* What a piece gave, and what was said meanwhile. */
#define PIECE_TYPE G_VARIANT_TYPE("(aya(uss))")

typedef struct sharer {
  const opc_host *host;
  const opc_pieces *pieces;
  opc_run *run;
  const opc_flow_step *step;
  size_t done;
} sharer;

/* ---- in the store ---- */

/* Its name in the store (g_free); NULL if it is not kept. */
static char *name_of(const sharer *s, size_t i) {
  const opc_pieces *p = s->pieces;
  const opc_binding *b = s->host->data;
  const opc_key *key = &s->run->keys[s->step->number];
  const char *own =
      s->run->options->store && key->sum && p->key ? p->key(p->data, i) : NULL;
  if (!own) return NULL;
  g_autofree char *all =
      g_strdup_printf("%s\n%s\n%s\n%s", key->sum,
                      b->path + strlen(s->step->name), p->name, own);
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, all, -1);
  return g_strconcat(sum, ".piece", NULL);
}

/* NULL: it is not there. */
static GVariant *find(const sharer *s, const char *name) {
  if (!name) return NULL;
  const char *before = opc_guard_enter(NULL);
  GVariant *piece = opc_store_get(s->run->options->store, name, PIECE_TYPE);
  opc_guard_leave(before);
  return piece;
}

static void keep(const sharer *s, const char *name, GVariant *piece) {
  if (!name) return;
  const char *before = opc_guard_enter(NULL);
  if (opc_reuse_is_unchanged(s->run, &s->run->keys[s->step->number]))
    (void)opc_store_put(s->run->options->store, name, piece);
  opc_guard_leave(before);
}

void opc_pieces_drop(opc_run *run) {
  for (guint i = 0; i < run->pieces->len; i++)
    opc_store_drop(run->options->store, run->pieces->pdata[i]);
}

/* ---- one ---- */

static GVariant *work(const sharer *s, size_t i, opc_error *error) {
  GVariantBuilder warned;
  opc_piece_begin(s->run);
  GByteArray *all = opc_piece_work(s->pieces, i, error);
  g_autoptr(GPtrArray) said = opc_piece_end(s->run);
  (void)opc_said_pack(&warned, said, s->step);
  GVariant *list = g_variant_ref_sink(g_variant_builder_end(&warned));
  if (!all) opc_said_again(s->run, s->step, list);
  GBytes *bytes = all ? g_byte_array_free_to_bytes(all) : NULL;
  GVariant *piece =
      bytes ? g_variant_new("(@ay@a(uss))",
                            g_variant_new_from_bytes(G_VARIANT_TYPE_BYTESTRING,
                                                     bytes, TRUE),
                            list)
            : NULL;
  g_bytes_unref(bytes);
  g_variant_unref(list);
  return piece ? g_variant_ref_sink(piece) : NULL;
}

static int take(const sharer *s, size_t i, GVariant *piece, opc_error *error) {
  g_autoptr(GVariant) bytes = g_variant_get_child_value(piece, 0);
  g_autoptr(GVariant) said = g_variant_get_child_value(piece, 1);
  gsize n;
  const void *data = g_variant_get_fixed_array(bytes, &n, 1);
  opc_said_again(s->run, s->step, said);
  return opc_piece_take(s->pieces, i, data, n, error);
}

static void tell_done(sharer *s) {
  s->done++;
  if (s->pieces->done) s->pieces->done(s->pieces->data, s->done);
}

/* ---- all ---- */

static int do_here(sharer *s, size_t i, opc_error *error) {
  char *name = name_of(s, i);
  g_autoptr(GVariant) piece = find(s, name);
  if (name) g_ptr_array_add(s->run->pieces, name);
  if (!piece) {
    piece = work(s, i, error);
    if (!piece) return error->code;
    keep(s, name, piece);
  }
  tell_done(s);
  return take(s, i, piece, error);
}

int opc_pieces_run(const opc_host *host, const opc_pieces *pieces,
                   opc_error *error) {
  opc_run *run = ((const opc_binding *)host->data)->run;
  sharer s = {host, pieces, run, run->at, 0};
  if (!run->at || run->piece) return opc_pieces_alone(host, pieces, error);
  int code = OPC_OK;
  for (size_t i = 0; i < pieces->count && !code; i++)
    code = opc_cancelled(host->context)
               ? opc_fail(error, OPC_CANCELLED, NULL, "stopped")
               : do_here(&s, i, error);
  return code;
}
