/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps what the instances of a run find, while it passes on all that they
   say. */
#include <string.h>

#include "core/run/run.h"

/* ---- state ---- */

static void finding_free(gpointer item) {
  opc_finding *finding = item;
  g_free(finding->path);
  g_free(finding->text);
  g_free(finding);
}

/* ---- keeping ---- */

static gboolean is_known(const opc_run *run, const char *path,
                         const char *text) {
  for (guint i = 0; i < run->findings->len; i++) {
    const opc_finding *f = run->findings->pdata[i];
    if (f->point == run->point && !strcmp(f->path, path) &&
        !strcmp(f->text, text))
      return TRUE;
  }
  return FALSE;
}

static void add(opc_run *run, const char *path, const char *text) {
  opc_finding *f = g_new(opc_finding, 1);
  *f = (opc_finding){run->point, g_strdup(path), g_strdup(text)};
  g_ptr_array_add(run->findings, f);
}

/* A step may find the same again and again; once is enough. */
static void keep(opc_run *run, const char *path, const char *text) {
  g_mutex_lock(&run->lock);
  gboolean known = is_known(run, path, text);
  if (!known && run->findings->len < OPC_MOST_FINDINGS)
    add(run, path, text);
  else
    run->more_findings += !known;
  g_mutex_unlock(&run->lock);
}

void opc_run_take_findings(opc_run *run, const opc_run *from) {
  for (guint i = 0; i < from->findings->len; i++) {
    const opc_finding *f = from->findings->pdata[i];
    keep(run, f->path, f->text);
  }
  run->more_findings += from->more_findings;
}

GPtrArray *opc_run_findings(const opc_run *run) {
  GPtrArray *lines = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < run->findings->len; i++) {
    const opc_finding *f = run->findings->pdata[i];
    g_autofree char *point =
        f->point ? g_strdup_printf("point %zu: ", f->point) : g_strdup("");
    g_ptr_array_add(lines,
                    g_strdup_printf("%s%s: %s", point, f->path, f->text));
  }
  if (run->more_findings)
    g_ptr_array_add(
        lines, g_strdup_printf("and %zu more findings", run->more_findings));
  return lines;
}

/* ---- for the next time ---- */

static void said_free(gpointer item) {
  opc_said *said = item;
  g_free(said->path);
  g_free(said->text);
  g_free(said);
}

void opc_result_begin(opc_run *run) {
  g_mutex_lock(&run->lock);
  if (run->said) g_ptr_array_free(run->said, TRUE);
  run->said = g_ptr_array_new_with_free_func(said_free);
  g_mutex_unlock(&run->lock);
}

/* A result with more than so many warnings is not kept. */
enum { MOST_SAID = 1000 };

static void add_said(GPtrArray *list, const char *path, int level,
                     const char *text) {
  opc_said *said = g_new(opc_said, 1);
  *said = (opc_said){level, g_strdup(path), g_utf8_make_valid(text, -1)};
  g_ptr_array_add(list, said);
}

static void note(opc_run *run, const char *path, int level, const char *text) {
  g_mutex_lock(&run->lock);
  if (run->said && run->said->len == MOST_SAID)
    g_clear_pointer(&run->said, g_ptr_array_unref);
  if (run->said) add_said(run->said, path, level, text);
  g_mutex_unlock(&run->lock);
}

void opc_piece_begin(opc_run *run) {
  g_mutex_lock(&run->lock);
  run->piece = g_ptr_array_new_with_free_func(said_free);
  g_mutex_unlock(&run->lock);
}

GPtrArray *opc_piece_end(opc_run *run) {
  g_mutex_lock(&run->lock);
  GPtrArray *said = g_steal_pointer(&run->piece);
  g_mutex_unlock(&run->lock);
  return said;
}

/* FALSE: no piece is at work. */
static gboolean note_in_piece(opc_run *run, const char *path, int level,
                              const char *text) {
  g_mutex_lock(&run->lock);
  gboolean in = run->piece != NULL;
  if (in) add_said(run->piece, path, level, text);
  g_mutex_unlock(&run->lock);
  return in;
}

/* ---- passing on ---- */

/* A step that runs again for its outputs has said it all. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  opc_run *run = data;
  if (level >= OPC_LOG_WARNING && note_in_piece(run, path, level, message))
    return;
  if (run->silent) return;
  if (level >= OPC_LOG_WARNING) note(run, path, level, message);
  if (level >= OPC_LOG_FINDING) keep(run, path, message);
  if (run->told->log) run->told->log(run->told->data, path, level, message);
}

static void pass_step(void *data, const char *name, size_t number,
                      size_t count) {
  const opc_watch *to = ((const opc_run *)data)->told;
  if (to->step) to->step(to->data, name, number, count);
}

static void pass_progress(void *data, const char *path,
                          const opc_progress *progress) {
  const opc_watch *to = ((const opc_run *)data)->told;
  if (to->progress) to->progress(to->data, path, progress);
}

static int pass_cancelled(void *data) {
  const opc_watch *to = ((const opc_run *)data)->told;
  return to->cancelled && to->cancelled(to->data);
}

static void pass_point(void *data, size_t number, size_t count) {
  const opc_watch *to = ((const opc_run *)data)->told;
  if (to->point) to->point(to->data, number, count);
}

void opc_run_listen(opc_run *run, const opc_watch *told) {
  static const opc_watch nobody = {.data = NULL};
  run->told = told ? told : &nobody;
  run->watch = (opc_watch){.data = run,
                           .log = take_log,
                           .step = pass_step,
                           .progress = pass_progress,
                           .cancelled = pass_cancelled,
                           .point = pass_point};
  run->findings = g_ptr_array_new_with_free_func(finding_free);
  g_mutex_init(&run->lock);
}

void opc_run_listen_end(opc_run *run) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(run->flow);
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (b->host) opc_host_ignore(b->host);
  }
  g_ptr_array_free(run->findings, TRUE);
  if (run->said) g_ptr_array_free(run->said, TRUE);
  g_mutex_clear(&run->lock);
}
