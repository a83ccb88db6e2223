/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the service for pieces (work units of a step). Computes the pieces
   in this process or distributes them over the ranks. Stores each result at
   once, so that a run restarted after a kill reuses the result. */
#include "core/plugin/pieces.h"

#include <guard/guard.h>
#include <string.h>

#include "core/run/listen.h"
#include "core/run/pieces.h"
#include "core/run/result.h"

/* Result of a piece, and the messages that the piece logged. */
#define PIECE_TYPE G_VARIANT_TYPE("(aya(uss))")

/* Pieces of a step with their results in the store. The functions of `kept`
   call the functions of the plugin's `pieces`, look results up in the store,
   and add the logged messages to each result. */
typedef struct keeper {
  opc_pieces kept; /* `name` is NULL, because errors of `pieces` already contain
                      the name */
  const opc_pieces *pieces;
  opc_run *run;
  const opc_flow_step *step;
  const char *path; /* path of the instance relative to the step */
  char **names;     /* [count], names of the pieces in the store; NULL if not
                       stored */
  size_t found,
      worked; /* number of results found in the store; number computed here */
  guint64 bytes;      /* size of all results */
  gint64 begun, last; /* start of the work; end of the last piece, us */
} keeper;

/* ---- in the store ---- */

/* Set the names of the pieces in the store. */
static void pieces_name(keeper *k) {
  const opc_pieces *p = k->pieces;
  const opc_key *key = &k->run->kept.keys[k->step->number];
  k->names = g_new0(char *, p->count);
  if (!k->run->options->store || !key->sum || !p->key) return;
  for (size_t i = 0; i < p->count; i++) {
    const char *own = p->key(p->data, i);
    if (!own) continue;
    g_autofree char *all =
        g_strdup_printf("%s\n%s\n%s\n%s", key->sum, k->path, p->name, own);
    g_autofree char *sum =
        g_compute_checksum_for_string(G_CHECKSUM_SHA256, all, -1);
    k->names[i] = g_strconcat(sum, ".piece", NULL);
    g_ptr_array_add(k->run->kept.pieces, k->names[i]);
  }
}

static GVariant *piece_find(const keeper *k, const char *name) {
  if (!name) return NULL;
  const char *before = guard_enter(NULL);
  GVariant *piece = opc_store_get(k->run->options->store, name, PIECE_TYPE);
  guard_leave(before);
  return piece;
}

static void piece_keep(const keeper *k, const char *name, GVariant *piece) {
  if (!name) return;
  const char *before = guard_enter(NULL);
  if (opc_key_is_unchanged(&k->run->kept.keys[k->step->number],
                           k->run->options->store))
    (void)opc_store_put(k->run->options->store, name, piece);
  guard_leave(before);
}

void opc_pieces_drop(opc_run *run) {
  for (guint i = 0; i < run->kept.pieces->len; i++)
    opc_store_drop(run->options->store, run->kept.pieces->pdata[i]);
}

/* ---- one piece ---- */

/* Compute a piece. Messages are packed and replayed when the result is taken,
   or at once if the piece fails. */
static GVariant *piece_do(const keeper *k, size_t i, opc_error *error) {
  GVariantBuilder warned;
  opc_listen_piece(k->run);
  GBytes *bytes = opc_piece_work(k->pieces, i, error);
  g_autoptr(GPtrArray) messages = opc_listen_piece_end(k->run);
  (void)opc_messages_pack(&warned, messages, k->step);
  g_autoptr(GVariant) list = g_variant_ref_sink(g_variant_builder_end(&warned));
  if (!bytes) opc_messages_replay(k->run, k->step, list);
  if (!bytes) return NULL;
  GVariant *piece = g_variant_new(
      "(@ay@a(uss))",
      g_variant_new_from_bytes(G_VARIANT_TYPE_BYTESTRING, bytes, TRUE), list);
  g_bytes_unref(bytes);
  return g_variant_ref_sink(piece);
}

static int kept_work(void *data, size_t i, opc_bytes *out, opc_error *error) {
  keeper *k = data;
  const char *name = k->names[i];
  g_autoptr(GVariant) piece = piece_find(k, name);
  if (piece) {
    k->found++;
  } else {
    k->worked++;
    piece = piece_do(k, i, error);
    if (!piece) return error->code;
    piece_keep(k, name, piece);
  }
  out->add(out, g_variant_get_data(piece), g_variant_get_size(piece));
  k->last = g_get_monotonic_time();
  return OPC_OK;
}

static int kept_take(void *data, size_t i, const void *bytes, size_t size,
                     opc_error *error) {
  keeper *k = data;
  g_autoptr(GVariant) piece = g_variant_ref_sink(
      g_variant_new_from_data(PIECE_TYPE, bytes, size, FALSE, NULL, NULL));
  g_autoptr(GVariant) result = g_variant_get_child_value(piece, 0);
  g_autoptr(GVariant) messages = g_variant_get_child_value(piece, 1);
  gsize n;
  const void *own = g_variant_get_fixed_array(result, &n, 1);
  k->bytes += n;
  opc_messages_replay(k->run, k->step, messages);
  return opc_piece_take(k->pieces, i, own, n, error);
}

static void kept_done(void *data, size_t n) {
  const opc_pieces *p = ((const keeper *)data)->pieces;
  if (p->done) p->done(p->data, n);
}

/* Log time and memory of the pieces, so that the user can estimate the cost of
   a larger layout. */
static void cost_report(const opc_host *host, const keeper *k) {
  const opc_pieces *p = k->pieces;
  double end = (double)(g_get_monotonic_time() - k->last) * 1e-6;
  host->log(
      host, OPC_LOG_DEBUG,
      "%zu work units '%s': %zu read from the store and %zu computed here "
      "in %.2f s, results received in %.2f s, %.0f bytes per result",
      p->count, p->name, k->found, k->worked,
      (double)(k->last - k->begun) * 1e-6, end,
      p->count ? (double)k->bytes / (double)p->count : 0);
}

/* ---- distribution ---- */

static double unit_cost(void *data, size_t i) {
  const opc_pieces *p = ((const keeper *)data)->pieces;
  return p->cost ? p->cost(p->data, i) : 0;
}

static int unit_has(void *data, size_t i) {
  const keeper *k = data;
  return k->names[i] && opc_store_has(k->run->options->store, k->names[i]);
}

static int unit_claim(void *data, size_t i) {
  const keeper *k = data;
  return !k->names[i] || opc_store_claim(k->run->options->store, k->names[i]);
}

static void unit_release(void *data, size_t i) {
  const keeper *k = data;
  if (k->names[i]) opc_store_leave(k->run->options->store, k->names[i]);
}

static GBytes *unit_get(void *data, size_t i, opc_error *error) {
  return opc_piece_work(&((keeper *)data)->kept, i, error);
}

gboolean opc_ranks_agree(const ranks_group *ranks, const char *what,
                         opc_problems *problems) {
  if (!ranks) return !problems->list->len;
  opc_error error = {0};
  int code =
      problems->list->len ? opc_problems_error(problems, &error) : OPC_OK;
  code = ranks->meet(what, code, &error);
  if (code && !problems->list->len)
    opc_problem_add(problems, code, NULL, "%s", error.message);
  return !problems->list->len;
}

/* ---- entry ---- */

static int run_pieces(const opc_host *host, const opc_pieces *theirs,
                      size_t own_size, opc_error *error) {
  const opc_pieces own = opc_pieces_copy(theirs, own_size), *pieces = &own;
  const opc_binding *b = host->data;
  opc_run *run = b->run;
  if (!run->at || run->listener.piece)
    return opc_pieces_alone.run(host, theirs, own_size, error);
  keeper k = {.kept = {.count = pieces->count,
                       .work = kept_work,
                       .take = kept_take,
                       .done = kept_done},
              .pieces = pieces,
              .run = run,
              .step = run->at,
              .path = b->path + strlen(run->at->name)};
  k.kept.data = &k;
  k.begun = k.last = g_get_monotonic_time();
  const opc_step *functions = run->at->binding->plugin->functions;
  const ranks_group *ranks = opc_run_ranks(run);
  const ranks_units units = {&k,         pieces->name, pieces->count, unit_cost,
                             unit_has,   unit_get,     kept_take,     kept_done,
                             unit_claim, unit_release};
  pieces_name(&k);
  int code = ranks && functions->flags & OPC_STEP_PIECES
                 ? ranks->share(&units, error)
                 : ranks_share_claimed(&units, host->context, error);
  cost_report(host, &k);
  g_free(k.names);
  return code;
}

const opc_pieces_service opc_pieces_of_run = {.size = sizeof opc_pieces_of_run,
                                              .run = run_pieces};
