/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds synthesizer and regulator in Python. */
#include <math.h>
#include <string.h>

#include <opcflow/follow.h>

#include "py.h"

/* ---- both kinds ---- */

/* Begin a request that starts with the gates; the worker keeps gates with a
   serial number. Defaults of parameters follow from the scanner. */
static py_worker *open_with(py_instance *in, const char *call,
                            const eda_gates *gates, eda_scanner scanner,
                            opc_error *error) {
  int fresh = !gates->serial || gates->serial != in->serial;
  const opc_plugin *d = &in->plugin->descriptor;
  char whence[128];
  eda_natural_text(scanner, whence, sizeof whence);
  if (fresh)
    opc_follow(in->host, d->id, in, d->parameters, d->n_parameters, eda_natural,
               &scanner, whence);
  py_worker *w = py_open(in, call, fresh, error);
  if (!w) return NULL;
  py_put_scanner(w, scanner);
  in->serial = gates->serial;
  in->gates = gates->count;
  if (fresh) py_put_gates(w, "gates", gates);
  return w;
}

/* Log a failure of a function that cannot report an error. */
static int ask_all(py_instance *in, const char *call) {
  opc_error error;
  if (py_open(in, call, 0, &error) && !py_send(in, NULL, &error)) return 1;
  in->host->log(in->host, OPC_LOG_WARNING, "%s", error.message);
  return 0;
}

/* ---- synthesizer ---- */

/* Forget the verdicts and targets of the last iteration. */
static void answers_clear(py_instance *in) {
  if (in->verdicts) g_ptr_array_free(in->verdicts, TRUE);
  in->verdicts = NULL;
  g_clear_pointer(&in->target, g_free);
}

static void put_feedback(py_worker *w, const eda_feedback *f) {
  py_begin(w, "feedback", '{');
  py_put_table(w, &py_feedback, f->gates->count, f, 0);
  py_put_int(w, "iteration", f->iteration);
  py_put_number(w, "ion_limit", f->ion_limit ? *f->ion_limit : NAN);
  py_put_performance(w, "design", f->design);
  py_put_performance(w, "printed", f->printed);
  py_end(w, '}');
}

static int synthesizer_begin(void *self, const eda_feedback *f,
                             opc_error *error) {
  py_instance *in = self;
  in->serial = 0;
  answers_clear(in);
  py_worker *w = open_with(in, "begin", f->gates, f->scanner, error);
  if (!w) return error->code;
  put_feedback(w, f);
  return py_send(in, NULL, error);
}

static int synthesizer_update(void *self, const eda_feedback *f,
                              eda_moves *moves, int *done, opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "update", 0, error);
  if (!w) return error->code;
  answers_clear(in);
  put_feedback(w, f);
  py_begin(w, "moves", '{');
  py_put_table(w, &py_moves, in->gates, moves, 1);
  py_end(w, '}');
  int code = py_send(in, NULL, error);
  if (!code) *done = py_number(py_result(w), "done") != 0;
  return code;
}

/* Request the verdicts of all gates at once. */
static void ask_verdicts(py_instance *in) {
  in->verdicts = g_ptr_array_new_with_free_func(g_free);
  if (!ask_all(in, "verdicts")) return;
  JsonArray *list = py_list(py_result(in->worker), "verdicts");
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
  in->target = g_new(double, in->gates + 1);
  for (size_t i = 0; i < in->gates; i++) in->target[i] = 1;
  if (!ask_all(in, "targets")) return;
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
  *PY_FUNCTIONS(p, synthesizer) = (eda_synthesizer){
      .begin = synthesizer_begin,
      .update = synthesizer_update,
      .verdict = py_defines(p, "verdict") ? synthesizer_verdict : NULL,
      .target = py_defines(p, "targets") ? synthesizer_target : NULL};
}

/* ---- regulator ---- */

/* Begin a request with a simulation. */
static py_worker *open_printed(py_instance *in, const char *call,
                               const eda_printed *p, opc_error *error) {
  size_t layers = p->gates->layers;
  py_worker *w = open_with(in, call, p->gates, p->scanner, error);
  if (!w) return NULL;
  py_begin(w, "printed", '{');
  py_put_table(w, &py_printed, p->gates->count, p, 0);
  py_put_int(w, "iteration", p->iteration);
  py_put_shapes(w, "shapes", layers, p->shapes);
  py_begin(w, "print", '[');
  for (size_t k = 0; p->print && k < layers; k++) {
    eda_field field = p->print[k];
    size_t n = (size_t)field.nx * (size_t)field.ny;
    field.coefficients = g_memdup2(field.coefficients, n * sizeof(float));
    if (n) eda_field_samples(in->host->context, &field);
    py_begin(w, NULL, '{');
    py_put_frame(w, field.frame);
    py_put_array(w, "values", "f4", (size_t)field.ny, (size_t)field.nx,
                 field.coefficients);
    py_end(w, '}');
    g_free(field.coefficients);
  }
  py_end(w, ']');
  py_end(w, '}');
  return w;
}

/* Return boxes that the reply adds to layers: each with the layer as fifth
   element. Boxes of a layer are consecutive. */
static size_t take_boxes(py_instance *in, const char *name, size_t layers,
                         eda_box *at, eda_boxes *boxes) {
  size_t n = 0, used = 0;
  const int32_t *all = py_new_array(in->worker, name, "i4", &n);
  for (size_t k = 0; boxes && k < layers; k++) {
    boxes[k] = (eda_boxes){at + used, 0};
    for (size_t i = 0; i + 4 < n; i += 5)
      if ((size_t)all[i + 4] == k) {
        at[used++] = (eda_box){all[i], all[i + 1], all[i + 2], all[i + 3]};
        boxes[k].count++;
      }
  }
  return used;
}

static int regulator_rule(void *self, const eda_printed *p, eda_ruling *ruling,
                          opc_error *error) {
  py_instance *in = self;
  size_t layers = p->gates->layers, boxes[2] = {0};
  py_worker *w = open_printed(in, "rule", p, error);
  if (!w) return error->code;
  py_begin(w, "ruling", '{');
  py_put_table(w, &py_ruling, p->gates->count, ruling, 1);
  py_end(w, '}');
  int code = py_send(in, NULL, error);
  if (code) return code;
  ruling->transistors = (size_t)py_number(py_result(w), "transistors");
  (void)py_new_array(w, "added", "i4", &boxes[0]);
  (void)py_new_array(w, "cutouts", "i4", &boxes[1]);
  g_free(in->boxes);
  in->boxes = g_new(eda_box, (boxes[0] + boxes[1]) / 5 + 1);
  size_t used = take_boxes(in, "added", layers, in->boxes, ruling->added);
  (void)take_boxes(in, "cutouts", layers, in->boxes + used, ruling->cutouts);
  return OPC_OK;
}

static int regulator_violations(void *self, const eda_printed *p,
                                eda_violation *list, size_t most, size_t *count,
                                opc_error *error) {
  py_instance *in = self;
  py_worker *w = open_printed(in, "violations", p, error);
  int code = w ? py_send(in, NULL, error) : error->code;
  if (code) return code;
  size_t n = 0;
  JsonArray *rules = py_list(py_result(w), "rules");
  const double *all = py_new_array(w, "figures", "f8", &n);
  *count = json_array_get_length(rules);
  for (size_t i = 0; i < *count && i < most && 5 * i + 4 < n; i++) {
    const double *v = all + 5 * i;
    list[i] = (eda_violation){
        g_intern_string(json_array_get_string_element(rules, (guint)i)),
        (int32_t)v[0],
        v[1],
        v[2],
        v[3],
        v[4]};
  }
  return OPC_OK;
}

void py_regulator_set(py_plugin *p) {
  *PY_FUNCTIONS(p, regulator) = (eda_regulator){
      .rule = regulator_rule, .violations = regulator_violations};
}
