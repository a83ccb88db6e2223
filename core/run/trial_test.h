/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of flows of the test plugins inside of a test program, in a temporary
   folder. */
#pragma once

#include <math.h>
#include <string.h>

#include "core/binding/folder_test.h"
#include "core/run/whole.h"

/* A flow and its run; the members outlive the run in this order. */
typedef struct trial {
  opc_problems *problems;
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_flow *flow;
  opc_run *run;
  GString *log;     /* "path: message" of each message, one a line */
  const char *stop; /* step at whose start the user stops the run, or NULL */
  gboolean stopped; /* the user has stopped the run */
  opc_watch watch;
  opc_run_options options;
} trial;

/* Keep a message; any thread of a step may log. */
static inline void trial_log(void *data, const char *path, int level,
                             const char *message) {
  static GMutex lock;
  (void)level;
  g_mutex_lock(&lock);
  g_string_append_printf(((trial *)data)->log, "%s: %s\n", path, message);
  g_mutex_unlock(&lock);
}

static inline void trial_step(void *data, const char *name, size_t number,
                              size_t count) {
  trial *t = data;
  g_string_append_printf(t->log, "[%zu/%zu] %s\n", number, count, name);
  if (!g_strcmp0(t->stop, name)) t->stopped = TRUE;
}

static inline int trial_is_stopped(void *data) {
  return ((const trial *)data)->stopped;
}

static inline char *get_text(const char *folder, const char *name) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  char *text = NULL;
  if (!g_file_get_contents(path, &text, NULL, NULL))
    g_error("'%s' does not exist", path);
  return text;
}

static inline gboolean has_file(const char *folder, const char *name) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  return g_file_test(path, G_FILE_TEST_EXISTS);
}

/* Run the flow `text`, with the values `sets` (may be NULL), and return the
   code of the problems. The caller first sets `options` and `stop`. */
static inline int trial_run(trial *t, const char *text,
                            const char *const *sets) {
  put_text("flow.yaml", text);
  t->log = g_string_new(NULL);
  t->problems = opc_problems_new();
  t->recipe = opc_recipe_read("flow.yaml", t->problems);
  t->sweep = opc_sweep_new(t->recipe, sets, NULL, NULL, t->problems);
  const opc_choice choice = {.sweep = t->sweep, .sets = sets};
  t->flow = opc_flow_make(t->recipe, &choice, trial_registry(), t->problems);
  g_autofree char *faults = opc_problems_text(t->problems);
  g_assert_cmpstr(faults, ==, "");
  t->watch = (opc_watch){.data = t,
                         .log = trial_log,
                         .step = trial_step,
                         .cancelled = trial_is_stopped};
  t->run = opc_run_flow(t->flow, &choice, trial_registry(), &t->options,
                        &t->watch, t->problems);
  return opc_problems_code(t->problems);
}

static inline void trial_clear(trial *t) {
  opc_run_free(t->run);
  opc_flow_free(t->flow);
  opc_sweep_free(t->sweep);
  opc_recipe_free(t->recipe);
  opc_problems_free(t->problems);
  g_string_free(t->log, TRUE);
  *t = (trial){0};
}

/* Run a flow that must succeed. */
static inline void trial_run_good(trial *t, const char *text,
                                  const char *const *sets) {
  (void)trial_run(t, text, sets);
  g_autofree char *faults = opc_problems_text(t->problems);
  g_assert_cmpstr(faults, ==, "");
}

/* Check all problems of a run. */
static inline void trial_expect(const trial *t, const char *text) {
  g_autofree char *found = opc_problems_text(t->problems);
  g_assert_cmpstr(found, ==, text);
}

/* Return a metric of a run; NAN if the metric was not published. */
static inline double trial_metric(const trial *t, const char *path,
                                  const char *name) {
  const GArray *all = t->run->out.metrics;
  for (guint i = 0; i < all->len; i++) {
    const opc_inner_metric *m = &g_array_index(all, opc_inner_metric, i);
    if (!strcmp(m->path, path) && !strcmp(m->metric->name, name))
      return m->value;
  }
  return NAN;
}
