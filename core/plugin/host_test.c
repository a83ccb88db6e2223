/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of hosts without a run: messages, progress, requests to stop, and work
   units in one process. */
#include "core/plugin/host.h"

#include <glib.h>
#include <opcflow/pieces.h>
#include <string.h>

typedef struct seen {
  GString *text;
  int stop;
} seen;

static void take_log(void *data, const char *path, int level,
                     const char *message) {
  g_string_append_printf(((seen *)data)->text, "%s %d %s\n", path, level,
                         message);
}

static void take_progress(void *data, const char *path, const opc_progress *p) {
  g_string_append_printf(((seen *)data)->text, "%s %g/%g %g %s\n", path,
                         p->done, p->total, p->worst,
                         p->worst_unit ? p->worst_unit : "-");
}

static int is_stopped(void *data) { return ((const seen *)data)->stop; }

/* Messages have the path of the instance and no control characters. */
static void test_messages(void) {
  seen s = {g_string_new(NULL), 0};
  const opc_watch watch = {.data = &s,
                           .log = take_log,
                           .progress = take_progress,
                           .cancelled = is_stopped};
  const opc_progress some = {1, 4, 0.5, "nm"}, none = {2, 4, 1, NULL};
  opc_host *host = opc_host_new("mask.model", &watch, NULL);
  host->log(host, OPC_LOG_INFO, "%d\tgates", 3);
  host->progress(host, &some);
  host->progress(host, &none);
  g_autofree char *expected = g_strdup_printf(
      "mask.model %d 3\\tgates\nmask.model 1/4 0.5 nm\nmask.model 2/4 1 -\n",
      OPC_LOG_INFO);
  g_assert_cmpstr(s.text->str, ==, expected);
  g_assert_false(opc_cancelled(host->context));
  s.stop = 1;
  g_assert_true(opc_cancelled(host->context));
  opc_host_ignore(host);
  host->log(host, OPC_LOG_WARNING, "not received");
  host->progress(host, &some);
  g_assert_false(opc_cancelled(host->context));
  g_assert_cmpstr(s.text->str, ==, expected);
  opc_host_free(host);
  g_string_free(s.text, TRUE);
}

static void test_nowhere(void) {
  opc_host *host = opc_host_new("a", NULL, NULL);
  opc_error error = {0};
  host->log(host, OPC_LOG_WARNING, "to nobody");
  g_assert_cmpint(host->metric(host, "sum", 1, &error), ==, OPC_OK);
  g_assert_cmpint(host->table(host, "t", 0, 0, NULL, 0, 0, &error), ==, OPC_OK);
  g_assert_null(host->output_path(host, "x.txt", &error));
  g_assert_cmpstr(error.message, ==, "'x.txt': no run folder exists");
  g_assert_null(host->service(host, "unknown/1"));
  opc_host_free(host);
}

static void add_square(void *data, size_t i) {
  __atomic_fetch_add((gint64 *)data, (gint64)(i * i), __ATOMIC_RELAXED);
}

/* The sum of the squares below n is (n - 1) n (2 n - 1) / 6 for any number of
   threads. */
static void test_parallel(void) {
  opc_host *host = opc_host_new("a", NULL, NULL);
  opc_set_threads(3);
  g_assert_cmpuint(opc_threads(), ==, 3);
  for (size_t n = 0; n < 200; n = 3 * n + 1) {
    gint64 sum = 0;
    opc_parallel(host->context, n, add_square, &sum);
    g_assert_cmpint(sum, ==, n ? (gint64)((n - 1) * n * (2 * n - 1) / 6) : 0);
  }
  opc_set_threads(0);
  g_assert_cmpuint(opc_threads(), ==, g_get_num_processors());
  opc_host_free(host);
}

/* ---- work units ---- */

typedef struct units {
  size_t bad_work, bad_take; /* indices of faulty units */
  size_t worked, taken, done;
  double sum;
  seen *stop;
} units;

static int unit_work(void *data, size_t i, opc_bytes *out, opc_error *error) {
  units *u = data;
  double half[2] = {(double)i, (double)i / 2};
  u->worked++;
  if (i == u->bad_work)
    return opc_fail(error, OPC_LIMIT, "size", "is too much");
  for (int k = 0; k < 2; k++) out->add(out, &half[k], sizeof *half);
  return OPC_OK;
}

static int unit_take(void *data, size_t i, const void *bytes, size_t size,
                     opc_error *error) {
  units *u = data;
  const double *half = bytes;
  g_assert_cmpuint(i, ==, u->taken++);
  g_assert_cmpuint(size, ==, 2 * sizeof *half);
  u->sum += half[0] + half[1];
  if (u->stop && i == 1) u->stop->stop = 1;
  if (i == u->bad_take) return opc_fail(error, OPC_IO, NULL, "no space");
  return OPC_OK;
}

static void unit_done(void *data, size_t n) {
  units *u = data;
  g_assert_cmpuint(n, ==, ++u->done);
}

static int do_units(units *u, const opc_watch *watch, opc_error *error) {
  opc_host *host = opc_host_new("a", watch, NULL);
  const opc_pieces list = {.data = u,
                           .name = "window",
                           .count = 5,
                           .work = unit_work,
                           .take = unit_take,
                           .done = unit_done};
  int code = opc_do_pieces(host, &list, error);
  opc_host_free(host);
  return code;
}

static void test_units(void) {
  opc_error error = {0};
  units good = {.bad_work = 9, .bad_take = 9};
  g_assert_cmpint(do_units(&good, NULL, &error), ==, OPC_OK);
  g_assert_cmpfloat(good.sum, ==, 15); /* 1.5 (0 + 1 + 2 + 3 + 4) */
  g_assert_cmpuint(good.worked, ==, 5);
  g_assert_cmpuint(good.done, ==, 5);
  units work = {.bad_work = 2, .bad_take = 9};
  g_assert_cmpint(do_units(&work, NULL, &error), ==, OPC_LIMIT);
  g_assert_cmpstr(error.message, ==, "window 2: is too much");
  g_assert_cmpstr(error.parameter, ==, "size");
  g_assert_cmpuint(work.worked, ==, 3);
  units take = {.bad_work = 9, .bad_take = 3};
  g_assert_cmpint(do_units(&take, NULL, &error), ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "window 3: no space");
  g_assert_cmpuint(take.worked, ==, 4);
  seen s = {NULL, 0};
  const opc_watch watch = {.data = &s, .cancelled = is_stopped};
  units stopped = {.bad_work = 9, .bad_take = 9, .stop = &s};
  g_assert_cmpint(do_units(&stopped, &watch, &error), ==, OPC_CANCELLED);
  g_assert_cmpuint(stopped.worked, ==, 2);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/host/messages", test_messages);
  g_test_add_func("/host/nowhere", test_nowhere);
  g_test_add_func("/host/parallel", test_parallel);
  g_test_add_func("/host/units", test_units);
  return g_test_run();
}
