/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces of a step's work: done here or shared out among ranks, and kept in the
   store as they come, so that a run that was killed finds them again. */
#include "core/plugin/pieces.h"

#include <guard/guard.h>
#include <string.h>

#include "core/run/run.h"

/* What a piece gave, and what was said meanwhile. */
#define PIECE_TYPE G_VARIANT_TYPE("(aya(uss))")

typedef struct sharer {
  const opc_host *host;
  const opc_pieces *pieces;
  opc_run *run;
  const opc_flow_step *step;
  size_t found, worked; /* in the store, and here */
  guint64 bytes;        /* of all results */
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
  const char *before = guard_enter(NULL);
  GVariant *piece = opc_store_get(s->run->options->store, name, PIECE_TYPE);
  guard_leave(before);
  return piece;
}

static void keep(const sharer *s, const char *name, GVariant *piece) {
  if (!name) return;
  const char *before = guard_enter(NULL);
  if (opc_reuse_is_unchanged(s->run, &s->run->keys[s->step->number]))
    (void)opc_store_put(s->run->options->store, name, piece);
  guard_leave(before);
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

static int take(sharer *s, size_t i, GVariant *piece, opc_error *error) {
  g_autoptr(GVariant) bytes = g_variant_get_child_value(piece, 0);
  g_autoptr(GVariant) said = g_variant_get_child_value(piece, 1);
  gsize n;
  const void *data = g_variant_get_fixed_array(bytes, &n, 1);
  s->bytes += n;
  opc_said_again(s->run, s->step, said);
  return opc_piece_take(s->pieces, i, data, n, error);
}

static void tell_done(const sharer *s, size_t n) {
  if (s->pieces->done) s->pieces->done(s->pieces->data, n);
}

/* From the store, or by work. */
static GVariant *get(sharer *s, size_t i, opc_error *error) {
  g_autofree char *name = name_of(s, i);
  GVariant *piece = find(s, name);
  s->found += piece != NULL;
  if (piece) return piece;
  s->worked++;
  piece = work(s, i, error);
  if (piece) keep(s, name, piece);
  return piece;
}

/* For whoever plans what machines a larger layout wants. */
static void tell_cost(const sharer *s, gint64 start, gint64 worked) {
  const opc_pieces *p = s->pieces;
  double end = (double)(g_get_monotonic_time() - worked) * 1e-6;
  s->host->log(s->host, OPC_LOG_DEBUG,
               "%zu of '%s': %zu found and %zu done here in %.2f s, taken in "
               "%.2f s, %.0f bytes each",
               p->count, p->name, s->found, s->worked,
               (double)(worked - start) * 1e-6, end,
               p->count ? (double)s->bytes / (double)p->count : 0);
}

static int stop(const sharer *s, opc_error *error) {
  return opc_cancelled(s->host->context)
             ? opc_fail(error, OPC_CANCELLED, NULL, "stopped")
             : OPC_OK;
}

/* ---- all, here ---- */

static int do_alone(sharer *s, opc_error *error) {
  int code = OPC_OK;
  gint64 start = g_get_monotonic_time();
  for (size_t i = 0; i < s->pieces->count && !code; i++) {
    code = stop(s, error);
    g_autoptr(GVariant) piece = code ? NULL : get(s, i, error);
    if (!piece) return error->code;
    tell_done(s, i + 1);
    code = take(s, i, piece, error);
  }
  tell_cost(s, start, g_get_monotonic_time());
  return code;
}

/* ---- all, among ranks ---- */

/* Which rank has piece i, as all know it, or will have it; the last element is
   the lowest piece with a fault. */
enum { NOBODY = G_MAXINT32 };

typedef struct share {
  opc_ranks *ranks;
  int rank;
  gint64 *holders;
  GVariant **own; /* done here, not yet given to the others */
  opc_error fault;
} share;

typedef struct turn {
  size_t i;
  double cost;
} turn;

static gint by_cost(gconstpointer a, gconstpointer b) {
  const turn *s = a, *t = b;
  if (s->cost != t->cost) return s->cost < t->cost ? 1 : -1;
  return (s->i > t->i) - (s->i < t->i);
}

/* What nobody has, the dearest first. */
static GArray *list_turns(const sharer *s, const share *all) {
  const opc_pieces *p = s->pieces;
  GArray *list = g_array_new(FALSE, FALSE, sizeof(turn));
  for (size_t i = 0; i < p->count; i++) {
    const turn t = {i, p->cost ? p->cost(p->data, i) : 0};
    if (all->holders[i] == NOBODY) g_array_append_val(list, t);
  }
  g_array_sort(list, by_cost);
  return list;
}

/* Who has pieces from an earlier run. */
static int find_holders(const sharer *s, share *all, opc_error *error) {
  size_t n = s->pieces->count;
  for (size_t i = 0; i < n; i++) {
    g_autofree char *name = name_of(s, i);
    gboolean here = name && opc_store_has(s->run->options->store, name);
    all->holders[i] = here ? all->rank : NOBODY;
  }
  opc_ranks_restart(all->ranks);
  return opc_ranks_least(all->ranks, all->holders, n, error);
}

/* Whoever is free does the next one; after a fault there is none. */
static int do_turns(sharer *s, share *all, opc_error *error) {
  g_autoptr(GArray) list = list_turns(s, all);
  size_t found = s->pieces->count - list->len, faulty = NOBODY;
  for (;;) {
    gint64 t = opc_ranks_turn(all->ranks, 1);
    if (t < 0 || stop(s, error))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if (t >= list->len) break;
    size_t i = g_array_index(list, turn, t).i;
    all->own[i] = get(s, i, &all->fault);
    all->holders[i] = all->rank;
    if (all->own[i]) {
      tell_done(s, found + (size_t)t + 1);
    } else {
      faulty = i;
      opc_ranks_turn(all->ranks, list->len);
    }
  }
  all->holders[s->pieces->count] = (gint64)faulty;
  return opc_ranks_least(all->ranks, all->holders, s->pieces->count + 1, error);
}

/* How many bytes this rank gives of a piece; -1: it has a fault. */
static gint64 size_of(share *all, GVariant *own) {
  gint64 size = own ? (gint64)g_variant_get_size(own) : -1;
  if (size <= G_MAXINT32) return size;
  opc_fail(&all->fault, OPC_FAILED, NULL, "a piece says too much");
  return -1;
}

/* Give piece i to all, or what is wrong with it. NULL and *error. */
static GVariant *exchange(sharer *s, share *all, size_t i, opc_error *error) {
  int from = (int)all->holders[i];
  gboolean here = from == all->rank;
  GVariant *own = g_steal_pointer(&all->own[i]);
  if (here && !own && !all->fault.code) own = get(s, i, &all->fault);
  gint64 size = size_of(all, own);
  int code = opc_ranks_spread(all->ranks, &size, sizeof size, from, error);
  if (!code && size < 0)
    code = opc_ranks_spread(all->ranks, &all->fault, sizeof all->fault, from,
                            error);
  if (!code && size < 0) *error = all->fault;
  if (!code && size >= 0) {
    void *bytes =
        here ? (void *)g_variant_get_data(own) : g_malloc((gsize)size);
    code = opc_ranks_spread(all->ranks, bytes, (gsize)size, from, error);
    if (!here)
      own = g_variant_ref_sink(g_variant_new_from_data(
          PIECE_TYPE, bytes, (gsize)size, FALSE, g_free, bytes));
  }
  if (!code && size >= 0) return own;
  if (own) g_variant_unref(own);
  return NULL;
}

/* One that cannot take a piece still gives the others theirs. */
static int take_all(sharer *s, share *all, opc_error *error) {
  size_t n = s->pieces->count;
  int code = OPC_OK;
  gint64 faulty = all->holders[n];
  for (size_t i = faulty < NOBODY ? (size_t)faulty : 0; i < n; i++) {
    opc_error fault;
    g_autoptr(GVariant) piece = exchange(s, all, i, &fault);
    if (!piece) *error = fault;
    if (!piece) return fault.code;
    if (!code) code = take(s, i, piece, error);
  }
  tell_done(s, n);
  return code;
}

static int do_together(sharer *s, opc_ranks *ranks, opc_error *error) {
  size_t n = s->pieces->count;
  share all = {.ranks = ranks, .rank = opc_ranks_own(ranks)};
  gint64 start = g_get_monotonic_time();
  all.holders = g_new0(gint64, n + 1);
  all.own = g_new0(GVariant *, n + 1);
  g_autofree char *what = g_strdup_printf("%zu of %s", n, s->pieces->name);
  int code = opc_ranks_meet(ranks, what, OPC_OK, error);
  if (!code) code = find_holders(s, &all, error);
  if (!code) code = do_turns(s, &all, error);
  gint64 worked = g_get_monotonic_time();
  if (!code) code = take_all(s, &all, error);
  tell_cost(s, start, worked);
  for (size_t i = 0; i < n; i++)
    if (all.own[i]) g_variant_unref(all.own[i]);
  g_free(all.own);
  g_free(all.holders);
  return code;
}

/* ---- entry ---- */

static int run_pieces(const opc_host *host, const opc_pieces *theirs,
                      size_t size, opc_error *error) {
  const opc_pieces pieces = opc_pieces_copy(theirs, size);
  opc_run *run = ((const opc_binding *)host->data)->run;
  sharer s = {.host = host, .pieces = &pieces, .run = run, .step = run->at};
  if (!run->at || run->piece)
    return opc_pieces_alone.run(host, theirs, size, error);
  const opc_step *functions = run->at->binding->plugin->functions;
  opc_ranks *ranks = opc_run_ranks(run);
  for (size_t i = 0; i < pieces.count; i++) {
    char *name = name_of(&s, i);
    if (name) g_ptr_array_add(run->pieces, name);
  }
  return ranks && functions->flags & OPC_STEP_PIECES
             ? do_together(&s, ranks, error)
             : do_alone(&s, error);
}

const opc_pieces_service opc_pieces_of_run = {.size = sizeof opc_pieces_of_run,
                                              .run = run_pieces};
