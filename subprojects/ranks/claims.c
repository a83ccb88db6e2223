/* SPDX-License-Identifier: BSD-3-Clause */
/* Distribution of work units over processes that only share a folder of
   results. Each process computes the units that it can claim, in ascending
   order, and waits for the units that other processes have claimed. */
#include <ranks/ranks.h>

enum {
  SHORTEST = 1000, /* first pause between checks for results, us */
  LONGEST = 100000 /* longest pause, us; work units take seconds */
};

typedef struct claimed {
  const ranks_units *units;
  GBytes **own; /* [count], results of this process, not yet taken */
  size_t next;  /* lowest unit that is not yet taken */
  size_t done;  /* number of results in `own` */
} claimed;

static int unit_is_done(const claimed *c, size_t i) {
  const ranks_units *u = c->units;
  return c->own[i] || u->has(u->data, i);
}

/* Claim the lowest unit without a result. Return the index of the unit, or the
   number of units if no unit can be claimed. */
static size_t unit_claim(const claimed *c) {
  const ranks_units *u = c->units;
  for (size_t i = c->next; i < u->count; i++) {
    if (unit_is_done(c, i) || !u->claim(u->data, i)) continue;
    if (!u->has(u->data, i)) return i;
    u->release(u->data, i); /* another process has just computed the unit */
  }
  return u->count;
}

static int unit_compute(claimed *c, size_t i, opc_error *error) {
  const ranks_units *u = c->units;
  c->own[i] = u->get(u->data, i, error);
  u->release(u->data, i);
  if (!c->own[i]) return error->code;
  u->done(u->data, c->next + ++c->done);
  return OPC_OK;
}

static int take_next(claimed *c, opc_error *error) {
  const ranks_units *u = c->units;
  size_t i = c->next++, size;
  c->done -= c->own[i] != NULL;
  g_autoptr(GBytes) bytes = g_steal_pointer(&c->own[i]);
  if (!bytes) bytes = u->get(u->data, i, error);
  if (!bytes) return error->code;
  const void *data = g_bytes_get_data(bytes, &size);
  int code = u->take(u->data, i, data, size, error);
  if (!code) u->done(u->data, c->next + c->done);
  return code;
}

int ranks_share_claimed(const ranks_units *units, const opc_context *context,
                        opc_error *error) {
  claimed c = {.units = units, .own = g_new0(GBytes *, units->count)};
  gulong pause = SHORTEST;
  int code = OPC_OK;
  while (!code && c.next < units->count) {
    if (opc_cancelled(context)) {
      code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
      break;
    }
    gboolean done = unit_is_done(&c, c.next);
    size_t i = done ? units->count : unit_claim(&c);
    if (done) {
      code = take_next(&c, error);
    } else if (i < units->count) {
      code = unit_compute(&c, i, error);
    } else {
      g_usleep(pause);
      pause = MIN(2 * pause, LONGEST);
      continue;
    }
    pause = SHORTEST;
  }
  for (size_t i = c.next; i < units->count; i++)
    if (c.own[i]) g_bytes_unref(c.own[i]);
  g_free(c.own);
  return code;
}
