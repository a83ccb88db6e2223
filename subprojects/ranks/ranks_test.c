/* SPDX-License-Identifier: BSD-3-Clause */
/* Three processes started by mpirun. Every unit is done once, all ranks take
   all results in order, and a fault of one rank is the fault of all. The first
   rank prints. */
#include <ranks/ranks.h>
#include <stdlib.h>
#include <string.h>

enum {
  UNITS = 40,
  KEPT = 7 /* rank 1 already has the results of units 0, 7, 14
              ... */
};

const ranks_group *ranks_join(int (*stopped)(void));
static const ranks_group *group;
static int failed, number;

static void assert_true(int good, const char *text) {
  int64_t all = good;
  opc_error error;
  if (group->least(&all, 1, &error)) all = 0;
  failed |= !all;
  if (!group->rank) printf("%sok %d - %s\n", all ? "" : "not ", ++number, text);
}

/* ---- units whose results are known ---- */

typedef struct table {
  char done[UNITS];     /* 1 if this rank computed the unit */
  size_t next, largest; /* next unit to take; largest argument of done() */
  size_t faulty;        /* index of the faulty unit; UNITS if no unit is
                           faulty */
  int wrong;
} table;

static double unit_cost(void *data, size_t i) {
  (void)data;
  return (double)(i % 5);
}

static int unit_has(void *data, size_t i) {
  (void)data;
  return group->rank == 1 && i % KEPT == 0;
}

static GBytes *unit_get(void *data, size_t i, opc_error *error) {
  table *t = data;
  char text[32];
  t->done[i]++;
  g_usleep(500);
  if (i == t->faulty) {
    opc_fail(error, OPC_LIMIT, "width", "unit %zu is too wide", i);
    return NULL;
  }
  int n = g_snprintf(text, sizeof text, "%zu", i * i);
  return g_bytes_new(text, (gsize)n);
}

static int unit_take(void *data, size_t i, const void *bytes, size_t size,
                     opc_error *error) {
  table *t = data;
  g_autofree char *text = g_strndup(bytes, size);
  (void)error;
  t->wrong |= i != t->next++ || strtoul(text, NULL, 10) != i * i;
  return OPC_OK;
}

static void unit_done(void *data, size_t n) {
  table *t = data;
  t->largest = MAX(t->largest, n);
}

static int table_share(table *t, opc_error *error) {
  const ranks_units units = {t,        "unit",   UNITS,     unit_cost,
                             unit_has, unit_get, unit_take, unit_done,
                             NULL,     NULL};
  return group->share(&units, error);
}

/* ---- the tests ---- */

static void test_share(void) {
  opc_error error = {0};
  table t = {.faulty = UNITS};
  int code = table_share(&t, &error), once = 1, kept = 1;
  assert_true(!code && !t.wrong && t.next == UNITS && t.largest == UNITS,
              "all ranks take all results in order");
  char all[3][UNITS];
  for (int r = 0; r < 3; r++) {
    memcpy(all[r], t.done, UNITS);
    group->spread(all[r], UNITS, r, &error);
  }
  for (int i = 0; i < UNITS; i++) {
    once &= all[0][i] + all[1][i] + all[2][i] == 1;
    kept &= i % KEPT || all[1][i] == 1;
  }
  assert_true(once, "one rank does each unit");
  assert_true(kept, "units that a rank has are not done by others");
}

static void test_fault(void) {
  opc_error error = {0};
  table t = {.faulty = 23};
  int code = table_share(&t, &error);
  assert_true(code == OPC_LIMIT &&
                  !strcmp(error.message, "unit 23 is too wide") &&
                  !strcmp(error.parameter, "width") && t.next <= 23,
              "the fault of a unit is the fault of all ranks");
}

static void test_meet(void) {
  opc_error error = {0};
  assert_true(group->meet("here", OPC_OK, &error) == OPC_OK, "ranks meet");
  int code = group->meet(group->rank == 2 ? "there" : "here", OPC_OK, &error);
  assert_true(code == OPC_FAILED &&
                  g_str_has_prefix(error.message, "rank 2 on ") &&
                  strstr(error.message, "does not run the same as rank 0"),
              "the message names a rank that is at another call");
  error = (opc_error){0};
  if (group->rank) opc_fail(&error, OPC_IO, NULL, "disk %d", group->rank);
  code = group->meet("here", error.code, &error);
  assert_true(code == OPC_IO && g_str_has_prefix(error.message, "rank 1 on ") &&
                  g_str_has_suffix(error.message, ": disk 1"),
              "of several faults, the fault of the lowest rank is returned");
}

static int go_on(void) { return 0; }

int main(void) {
  int rank, size;
  gboolean launched = ranks_launched(&rank, &size);
  group = ranks_join(go_on);
  if (!group) return 1;
  if (!group->rank) printf("1..8\n");
  assert_true(launched && rank == group->rank && size == 3 && group->size == 3,
              "the environment reports three ranks");
  test_share();
  test_fault();
  test_meet();
  group->end();
  return failed;
}
