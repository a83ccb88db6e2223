/* SPDX-License-Identifier: BSD-3-Clause */
/* Records findings and warnings of a run, and passes on all messages. */
#include "core/run/listen.h"
#include "core/binding/lookup.h"

/* ---- findings ---- */

/* Keep a finding once; a step may report the same finding many times. */
static void finding_keep(opc_run *run, const char *path, const char *text) {
  g_mutex_lock(&run->listener.lock);
  opc_findings_add(&run->out.findings, run->listener.point, path, text);
  g_mutex_unlock(&run->listener.lock);
}

void opc_listen_take(opc_run *run, const opc_run *from) {
  const opc_findings *findings = &from->out.findings;
  for (guint i = 0; i < findings->list->len; i++) {
    const opc_finding *f = findings->list->pdata[i];
    finding_keep(run, f->path, f->text);
  }
  run->out.findings.more += findings->more;
}

/* ---- messages for reuse ---- */

static void message_free(gpointer item) {
  opc_message *m = item;
  g_free(m->path);
  g_free(m->text);
  g_free(m);
}

void opc_listen_step(opc_run *run) {
  g_mutex_lock(&run->listener.lock);
  if (run->listener.messages) g_ptr_array_free(run->listener.messages, TRUE);
  run->listener.messages = g_ptr_array_new_with_free_func(message_free);
  g_mutex_unlock(&run->listener.lock);
}

/* Largest number of warnings of a step whose result is stored. */
enum { MOST_MESSAGES = 1000 };

static void messages_add(GPtrArray *list, const char *path, int level,
                         const char *text) {
  opc_message *m = g_new(opc_message, 1);
  *m = (opc_message){level, g_strdup(path), g_utf8_make_valid(text, -1)};
  g_ptr_array_add(list, m);
}

static void message_note(opc_run *run, const char *path, int level,
                         const char *text) {
  g_mutex_lock(&run->listener.lock);
  if (run->listener.messages && run->listener.messages->len == MOST_MESSAGES)
    g_clear_pointer(&run->listener.messages, g_ptr_array_unref);
  if (run->listener.messages)
    messages_add(run->listener.messages, path, level, text);
  g_mutex_unlock(&run->listener.lock);
}

void opc_listen_piece(opc_run *run) {
  g_mutex_lock(&run->listener.lock);
  run->listener.piece = g_ptr_array_new_with_free_func(message_free);
  g_mutex_unlock(&run->listener.lock);
}

GPtrArray *opc_listen_piece_end(opc_run *run) {
  g_mutex_lock(&run->listener.lock);
  GPtrArray *messages = g_steal_pointer(&run->listener.piece);
  g_mutex_unlock(&run->listener.lock);
  return messages;
}

/* Keep a message for the running piece; returns FALSE if no piece runs. */
static gboolean note_in_piece(opc_run *run, const char *path, int level,
                              const char *text) {
  g_mutex_lock(&run->listener.lock);
  gboolean in = run->listener.piece != NULL;
  if (in) messages_add(run->listener.piece, path, level, text);
  g_mutex_unlock(&run->listener.lock);
  return in;
}

/* ---- passing on ---- */

/* Pass on a message. A step that runs again only to make its outputs logs
   nothing, because its messages were reported before. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  opc_run *run = data;
  if (level >= OPC_LOG_WARNING && note_in_piece(run, path, level, message))
    return;
  if (run->listener.silent) return;
  if (level >= OPC_LOG_WARNING) message_note(run, path, level, message);
  if (level >= OPC_LOG_FINDING) finding_keep(run, path, message);
  if (run->listener.to->log)
    run->listener.to->log(run->listener.to->data, path, level, message);
}

static void pass_step(void *data, const char *name, size_t number,
                      size_t count) {
  const opc_watch *to = ((const opc_run *)data)->listener.to;
  if (to->step) to->step(to->data, name, number, count);
}

static void pass_progress(void *data, const char *path,
                          const opc_progress *progress) {
  const opc_watch *to = ((const opc_run *)data)->listener.to;
  if (to->progress) to->progress(to->data, path, progress);
}

static int pass_cancelled(void *data) {
  const opc_run *run = data;
  const opc_watch *to = run->listener.to;
  if (run->deadline && g_get_monotonic_time() >= run->deadline) return TRUE;
  return to->cancelled && to->cancelled(to->data);
}

static void pass_point(void *data, size_t number, size_t count) {
  const opc_watch *to = ((const opc_run *)data)->listener.to;
  if (to->point) to->point(to->data, number, count);
}

void opc_listen(opc_run *run, const opc_watch *to) {
  static const opc_watch nobody = {.data = NULL};
  run->listener.to = to ? to : &nobody;
  run->listener.watch = (opc_watch){.data = run,
                                    .log = take_log,
                                    .step = pass_step,
                                    .progress = pass_progress,
                                    .cancelled = pass_cancelled,
                                    .point = pass_point};
  g_mutex_init(&run->listener.lock);
}

void opc_listen_end(opc_run *run) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(run->flow);
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (b->host) opc_host_ignore(b->host);
  }
  if (run->listener.messages) g_ptr_array_free(run->listener.messages, TRUE);
  g_mutex_clear(&run->listener.lock);
}
