/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `verify`: simulates and measures a corrected mask by
   models other than the models of the correction loop. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/step.h>
#include <stdlib.h>

#include <correct/classes.h>
#include <correct/findings.h>
#include <correct/report.h>
#include <correct/settings.h>

/* ---- state ---- */

typedef struct verify {
  const opc_host *host;
  const eda_mask *mask;
  correct_settings with;
  const char *transistors;
  classes_source source; /* models of later simulations of the output */
} verify;

/* ---- work ---- */

/* Simulation of all parts of the mask. */
typedef struct simulation {
  const verify *verify;
  opc_host quiet; /* for all parts but the first */
  eda_mask *out;
  double *extension; /* [2 * gates], nm */
  eda_short_slices slices;
} simulation;

/* Add the slices of a part's transistors. */
static int part_add_slices(simulation *s, const eda_mask_part *p,
                           const eda_mask *m, opc_error *error) {
  const verify *v = s->verify;
  size_t n = m->gates->count;
  if (!n) return OPC_OK;
  uint32_t *count = eda_alloc(n, sizeof *count);
  for (size_t i = 0; i < n; i++) {
    size_t k = eda_mask_part_gate(p, i);
    count[i] = k == UINT32_MAX ? 0 : (uint32_t)eda_mask_count(v->mask, k);
  }
  int code = correct_slices_add(v->host, m, count, v->with.extractor,
                                &s->slices, error);
  free(count);
  return code;
}

/* Copy the figures of a part's transistors to the mask. */
static void part_take(simulation *s, const eda_mask_part *p, const eda_mask *m,
                      const double *extension) {
  for (size_t i = 0; i < m->gates->count; i++) {
    uint32_t k = p->gate[i];
    if (k == UINT32_MAX) continue;
    eda_performance_take(&s->out->design, k, &m->design, i);
    eda_performance_take(&s->out->after, k, &m->after, i);
    s->out->flags[k] = m->flags[i];
    s->extension[(size_t)2 * k] = extension[2 * i];
    s->extension[(size_t)2 * k + 1] = extension[2 * i + 1];
  }
  s->out->simulations += m->simulations;
  s->out->fine_simulations += m->fine_simulations;
}

static int part_simulate(void *data, const eda_mask_part *p, opc_error *error) {
  simulation *s = data;
  const verify *v = s->verify;
  const opc_host *host = p->index ? &s->quiet : v->host;
  const opc_progress at = {
      .done = (double)p->index, .total = (double)p->count, .worst = NAN};
  correct_settings with = v->with;
  double *extension = NULL;
  eda_mask *m = p->gate ? eda_mask_new(p->mask->gates) : s->out;
  int code = OPC_OK;
  if (p->gate) v->host->progress(v->host, &at);
  if (!isnan(p->clear)) with.margin = p->clear;
  for (size_t k = 0; k < m->layers && !code; k++)
    code = eda_boolean(EDA_OR, &p->mask->shapes[k], NULL, &m->shapes[k], error);
  if (!code)
    code = correct_print(&with, host, !p->gate, m, NULL, &extension, error);
  if (!code) code = part_add_slices(s, p, m, error);
  if (!p->gate) {
    s->extension = extension;
    return code;
  }
  if (!code) part_take(s, p, m, extension);
  free(extension);
  eda_mask_free(m);
  return code;
}

/* Make the output; its arrays are allocated here for a mask by classes, and by
   the simulation for a flat mask. */
static eda_mask *verify_begin(simulation *s) {
  const eda_mask *from = s->verify->mask;
  size_t n = from->gates->count;
  eda_mask *out = eda_mask_new(from->gates);
  out->iterations = from->iterations;
  eda_performance_init(&out->before, n);
  eda_performance_copy(&out->before, &from->after);
  if (!from->chip) return out;
  eda_performance_init(&out->design, n);
  eda_performance_init(&out->after, n);
  out->flags = eda_alloc(n, sizeof *out->flags);
  s->extension = eda_alloc(2 * n, sizeof *s->extension);
  return out;
}

/* Give the output the transistors of the input, and the models of this step. */
static void verify_share(verify *v, eda_mask *out) {
  eda_mask_share(out, v->mask);
  v->source = (classes_source){v->host, &v->with, v->with.margin};
  if (out->chip) correct_classes_access(out, &v->source);
}

static int verify_run(void *self, void **outputs, opc_error *error) {
  verify *v = self;
  simulation s = {.verify = v, .quiet = correct_findings_discarded(v->host)};
  eda_mask *out = outputs[0] = s.out = verify_begin(&s); /* released by the host
                                                            on failure */
  int code =
      eda_mask_each_class(v->mask, v->with.margin, part_simulate, &s, error);
  verify_share(v, out);
  const report content = {
      .mask = out, .extension = s.extension, .corrected = v->mask};
  if (!code)
    correct_findings_of_print(v->host, out->gates, out->count, out->flags,
                              NULL);
  if (!code && out->gates->count)
    code = correct_slices_report(v->host, &s.slices, error);
  if (!code) code = correct_report_mask(v->host, &content, error);
  if (!code)
    code = correct_report_transistors(v->host, out, v->transistors, error);
  free(s.extension);
  return code;
}

static int verify_forecast(void *self, opc_forecast *out, opc_error *error) {
  const verify *v = self;
  eda_gates part = eda_mask_part_outline(v->mask, v->with.margin);
  (void)error;
  correct_forecast(&v->with, v->host, &part, "one simulation",
                   "one accurate simulation", out);
  return OPC_OK;
}

static int verify_sketch(void *self, void **outputs, opc_error *error) {
  verify *v = self;
  int code = correct_sketch_mask(v->mask->gates, outputs);
  (void)error;
  if (!code) verify_share(v, outputs[0]);
  return code;
}

/* ---- restoring ---- */

static int verify_restore(void *self, const char *folder, void **outputs,
                          opc_error *error) {
  verify *v = self;
  int code = eda_mask_restore(v->mask->gates, folder, &outputs[0], error);
  if (!code) verify_share(v, outputs[0]);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(verify, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Corrected mask"),
    CORRECT_PRINT_SLOTS(verify),
    CORRECT_MARGIN(verify),
    CORRECT_FINE(verify),
    REPORT_TRANSISTORS(verify),
    CORRECT_OVERLAY(verify),
};

static const opc_metric metrics[] = {
    REPORT_METRICS,
    {"ion_change_mean", "%", OPC_LOWER, 0.01,
     "mean |difference| between the Ion deviations of verification and loop"},
    {"ion_change_max", "%", OPC_LOWER, 0.01,
     "largest |difference| between the Ion deviations of verification and "
     "loop"},
    REPORT_PRINT_METRICS,
};

static int verify_check(void *self, opc_error *error) {
  verify *v = self;
  v->with.ion_limit = CORRECT_USUAL_LIMIT;
  return correct_settings_check(&v->with, v->host, error);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {
    OPC_OUTPUTS(outputs),        .run = verify_run,
    .forecast = verify_forecast, .sketch = verify_sketch,
    .save = correct_save_mask,   .restore = verify_restore};

OPC_PLUGIN(verify, .id = "verify", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "simulate and measure a corrected mask with other models",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = verify_check, OPC_FUNCTIONS(functions));
