/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind synthesizer in Python. */
#include <math.h>
#include <string.h>

#include <opcflow/follow.h>

#include "py.h"

/* Forget the verdicts and targets of the last iteration. */
static void answers_clear(py_instance *in) {
  if (in->verdicts) g_ptr_array_free(in->verdicts, TRUE);
  in->verdicts = NULL;
  g_clear_pointer(&in->target, g_free);
}

static void add_feedback(py_worker *w, const eda_feedback *f) {
  JsonObject *values = py_values(w);
  size_t n = f->gates->count;
  json_object_set_int_member(values, "iteration", f->iteration);
  py_set_number(values, "ion_limit", f->ion_limit ? *f->ion_limit : NAN);
  py_add_scanner(w, f->scanner);
  if (f->design) py_add_performance(w, "design", f->design);
  if (f->printed) py_add_performance(w, "printed", f->printed);
  if (f->flags) py_add_array(w, "flags", "u4", n, f->flags);
  if (f->vetoes) py_add_array(w, "vetoes", "u4", n, f->vetoes);
  if (f->end) py_add_array(w, "end", "i4", 2 * n, f->end);
  if (f->next_end) py_add_array(w, "next_end", "i4", 2 * n, f->next_end);
}

static int synthesizer_begin(void *self, const eda_feedback *f,
                             opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "begin", error);
  if (!w) return error->code;
  const opc_plugin *d = &in->plugin->descriptor;
  char whence[128];
  eda_natural_text(f->scanner, whence, sizeof whence);
  opc_follow(in->host, d->id, in, d->parameters, d->n_parameters, eda_natural,
             &f->scanner, whence);
  answers_clear(in);
  in->gates = f->gates->count;
  py_add_parameters(in);
  py_add_gates(w, "gates", f->gates);
  add_feedback(w, f);
  return py_send(in, NULL, error);
}

/* The moves of each gate: name, elements of a gate, data. */
typedef struct move_array {
  const char *name;
  size_t width;
  int32_t *data;
} move_array;

enum { MOVE_ARRAYS = 5 };

static void list_moves(const eda_moves *m, move_array *all) {
  const move_array list[MOVE_ARRAYS] = {
      {"moves.l", 1, m->l},
      {"moves.w", 1, m->w},
      {"moves.jog", 1, m->jog},
      {"moves.aside", 1, m->aside},
      {"moves.part", 3 * EDA_PARTS, m->part ? &m->part->from : NULL}};
  memcpy(all, list, sizeof list);
}

static int synthesizer_update(void *self, const eda_feedback *f,
                              eda_moves *moves, int *done, opc_error *error) {
  py_instance *in = self;
  move_array all[MOVE_ARRAYS];
  py_worker *w = py_open(in, "update", error);
  if (!w) return error->code;
  answers_clear(in);
  add_feedback(w, f);
  list_moves(moves, all);
  for (size_t i = 0; i < MOVE_ARRAYS; i++)
    if (all[i].data)
      py_add_array(w, all[i].name, "i4", all[i].width * in->gates, all[i].data);
  int code = py_send(in, NULL, error);
  if (code) return code;
  for (size_t i = 0; i < MOVE_ARRAYS; i++)
    if (all[i].data) py_get_array(w, all[i].name, all[i].data);
  *done = json_object_get_boolean_member(py_reply(w), "done");
  return OPC_OK;
}

/* Request the verdicts of all gates at once. A failure is logged, because the
   function of the kind cannot fail. */
static void ask_verdicts(py_instance *in) {
  opc_error error;
  in->verdicts = g_ptr_array_new_with_free_func(g_free);
  if (!py_open(in, "verdicts", &error) || py_send(in, NULL, &error)) {
    in->host->log(in->host, OPC_LOG_WARNING, "%s", error.message);
    return;
  }
  JsonArray *list =
      json_object_get_array_member(py_reply(in->worker), "verdicts");
  for (guint i = 0; i < json_array_get_length(list); i++) {
    JsonNode *one = json_array_get_element(list, i);
    g_ptr_array_add(in->verdicts, JSON_NODE_HOLDS_VALUE(one)
                                      ? json_node_dup_string(one)
                                      : NULL);
  }
}

static const char *synthesizer_verdict(const void *self, size_t gate) {
  py_instance *in = (py_instance *)self;
  if (!in->verdicts) ask_verdicts(in);
  return gate < in->verdicts->len ? in->verdicts->pdata[gate] : NULL;
}

static void ask_targets(py_instance *in) {
  opc_error error;
  in->target = g_new(double, in->gates + 1);
  for (size_t i = 0; i < in->gates; i++) in->target[i] = 1;
  if (!py_open(in, "targets", &error) || py_send(in, NULL, &error)) {
    in->host->log(in->host, OPC_LOG_WARNING, "%s", error.message);
    return;
  }
  size_t n = 0;
  const void *all = py_new_array(in->worker, "targets", "f8", &n);
  if (all && n == in->gates) memcpy(in->target, all, n * sizeof *in->target);
}

static double synthesizer_target(const void *self, size_t gate) {
  py_instance *in = (py_instance *)self;
  if (!in->target) ask_targets(in);
  return gate < in->gates ? in->target[gate] : 1;
}

void py_synthesizer_set(py_plugin *p) {
  eda_synthesizer *f = &p->functions.synthesizer;
  *f = (eda_synthesizer){.begin = synthesizer_begin,
                         .update = synthesizer_update};
  if (py_defines(p, "verdict")) f->verdict = synthesizer_verdict;
  if (py_defines(p, "targets")) f->target = synthesizer_target;
  p->descriptor.functions = f;
  p->descriptor.functions_size = sizeof *f;
}
