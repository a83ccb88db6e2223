/* SPDX-License-Identifier: BSD-3-Clause */
/* Agreement of ranks, and distribution of work units. */
#include <ranks/ranks.h>
#include <string.h>

#include "calls.h"

static ranks_group group;

/* ---- agreement ---- */

/* Return OPC_OK if `what` is equal to that of rank 0; otherwise fill *error. */
static int compare_place(const char *what, opc_error *error) {
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, what, -1);
  g_autofree char *first = g_strdup(sum);
  if (mpi_spread(first, strlen(first), 0, error)) return OPC_CANCELLED;
  return strcmp(first, sum) ? opc_fail(error, OPC_FAILED, NULL,
                                       "does not run the same as rank 0: flow, "
                                       "files, builds or processor differ")
                            : OPC_OK;
}

/* Add rank and machine to the message, except for rank 0. */
static void fault_sign(opc_error *error) {
  const opc_error own = *error;
  if (group.rank)
    opc_fail(error, own.code, own.parameter, "rank %d on %s: %s", group.rank,
             g_get_host_name(), own.message);
}

static int ranks_agree(const char *what, int code, opc_error *error) {
  opc_error own = {0};
  if (code == OPC_CANCELLED) mpi_stop(&own);
  int differs = compare_place(what, &own);
  if (code) own = *error;
  own.code = code ? code : differs;
  int64_t lowest = own.code ? group.rank : G_MAXINT64;
  int stopped = mpi_least(&lowest, 1, error);
  if (stopped || lowest == G_MAXINT64) return stopped;
  if (lowest == group.rank) fault_sign(&own);
  if (mpi_spread(&own, sizeof own, (int)lowest, error)) return OPC_CANCELLED;
  *error = own;
  return own.code;
}

/* ---- distribution ---- */

/* holders[i] is the rank that has the result of unit i, equal in all ranks;
   NOBODY if no rank has the result. holders[count] is the lowest unit with a
   fault, or NOBODY. */
enum { NOBODY = G_MAXINT32 };

typedef struct sharing {
  const ranks_units *units;
  int64_t *holders;
  GBytes **own; /* results of this rank, not yet sent */
  opc_error fault;
} sharing;

typedef struct turn {
  size_t i;
  double cost;
} turn;

static gint by_cost(gconstpointer a, gconstpointer b) {
  const turn *s = a, *t = b;
  if (s->cost != t->cost) return s->cost < t->cost ? 1 : -1;
  return (s->i > t->i) - (s->i < t->i);
}

/* List the units that no rank has, by decreasing cost. */
static GArray *list_turns(const sharing *s) {
  const ranks_units *u = s->units;
  GArray *list = g_array_new(FALSE, FALSE, sizeof(turn));
  for (size_t i = 0; i < u->count; i++) {
    const turn t = {i, u->cost(u->data, i)};
    if (s->holders[i] == NOBODY) g_array_append_val(list, t);
  }
  g_array_sort(list, by_cost);
  return list;
}

static int find_holders(sharing *s, opc_error *error) {
  const ranks_units *u = s->units;
  for (size_t i = 0; i < u->count; i++)
    s->holders[i] = u->has(u->data, i) ? group.rank : NOBODY;
  mpi_restart();
  return mpi_least(s->holders, u->count, error);
}

/* Compute units by decreasing cost until none remains. After a fault, advance
   the counter beyond the last unit, so that all ranks stop. */
static int do_turns(sharing *s, opc_error *error) {
  const ranks_units *u = s->units;
  g_autoptr(GArray) list = list_turns(s);
  size_t found = u->count - list->len, faulty = NOBODY;
  for (;;) {
    int64_t t = mpi_turn(1);
    if (t < 0) return mpi_stop(error);
    if (t >= list->len) break;
    size_t i = g_array_index(list, turn, t).i;
    s->own[i] = u->get(u->data, i, &s->fault);
    s->holders[i] = group.rank;
    if (s->own[i]) {
      u->done(u->data, found + (size_t)t + 1);
    } else {
      faulty = i;
      mpi_turn(list->len);
    }
  }
  s->holders[u->count] = (int64_t)faulty;
  return mpi_least(s->holders, u->count + 1, error);
}

/* Send the result of unit i from its holder to all ranks. Return the result, or
   NULL and the fault of the unit in *error. */
static GBytes *result_exchange(sharing *s, size_t i, opc_error *error) {
  const ranks_units *u = s->units;
  int from = (int)s->holders[i];
  gboolean here = from == group.rank;
  g_autoptr(GBytes) own = g_steal_pointer(&s->own[i]);
  if (here && !own && !s->fault.code) own = u->get(u->data, i, &s->fault);
  int64_t size = own ? (int64_t)g_bytes_get_size(own) : -1;
  int code = mpi_spread(&size, sizeof size, from, error);
  if (!code && size < 0) {
    code = mpi_spread(&s->fault, sizeof s->fault, from, error);
    if (!code) *error = s->fault;
    return NULL;
  }
  if (code) return NULL;
  void *bytes =
      here ? (void *)g_bytes_get_data(own, NULL) : g_malloc((gsize)size);
  code = mpi_spread(bytes, (size_t)size, from, error);
  if (!here) own = g_bytes_new_take(bytes, (gsize)size);
  return code ? NULL : g_steal_pointer(&own);
}

/* Call take() for all results. If take() fails, continue to send the results of
   this rank to the other ranks. */
static int take_all(sharing *s, opc_error *error) {
  const ranks_units *u = s->units;
  int code = OPC_OK;
  int64_t faulty = s->holders[u->count];
  for (size_t i = faulty < NOBODY ? (size_t)faulty : 0; i < u->count; i++) {
    opc_error fault;
    g_autoptr(GBytes) bytes = result_exchange(s, i, &fault);
    if (!bytes) *error = fault;
    if (!bytes) return fault.code;
    gsize size;
    const void *data = g_bytes_get_data(bytes, &size);
    if (!code) code = u->take(u->data, i, data, size, error);
  }
  u->done(u->data, u->count);
  return code;
}

static int ranks_share_units(const ranks_units *units, opc_error *error) {
  size_t n = units->count;
  sharing s = {.units = units};
  s.holders = g_new0(int64_t, n + 1);
  s.own = g_new0(GBytes *, n + 1);
  g_autofree char *what = g_strdup_printf("%zu of %s", n, units->name);
  int code = ranks_agree(what, OPC_OK, error);
  if (!code) code = find_holders(&s, error);
  if (!code) code = do_turns(&s, error);
  if (!code) code = take_all(&s, error);
  for (size_t i = 0; i < n; i++)
    if (s.own[i]) g_bytes_unref(s.own[i]);
  g_free(s.own);
  g_free(s.holders);
  return code;
}

/* ---- entry ---- */

OPC_EXPORT const ranks_group *ranks_join(int (*stopped)(void));
const ranks_group *ranks_join(int (*stopped)(void)) {
  group = (ranks_group){.meet = ranks_agree,
                        .least = mpi_least,
                        .spread = mpi_spread,
                        .share = ranks_share_units,
                        .end = mpi_end};
  return mpi_start(stopped, &group.rank, &group.size) ? NULL : &group;
}
