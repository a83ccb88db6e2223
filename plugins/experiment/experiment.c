/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `experiment`: runs a flow with several methods on several
   cases, keeps each run, and publishes all figures as one table. */
#include "experiment.h"

#include <eda/experiment.h>
#include <math.h>
#include <opcflow/step.h>
#include <string.h>

/* ---- the axes ---- */

static const opc_inner_axis *find_axis(const experiment *e, const char *name,
                                       opc_error *error) {
  size_t n;
  const opc_inner_axis *const *axes = opc_get_inner(e->host)->axes(e->host, &n);
  int i = opc_get_inner(e->host)->axis(e->host, name, error);
  return i < 0 ? NULL : axes[i];
}

/* Refuse a flow with a sweep: each method needs exactly one run per case. */
static int check_sweep(const experiment *e, opc_error *error) {
  size_t n;
  const opc_inner_axis *const *axes = opc_get_inner(e->host)->axes(e->host, &n);
  for (size_t i = 0; i < n; i++)
    if (strcmp(axes[i]->path, "cases") && strcmp(axes[i]->path, "methods"))
      return opc_fail(error, OPC_INVALID, "flow",
                      "'%s' sweeps '%s': fix it by 'set', or make methods of "
                      "its values",
                      e->flow, axes[i]->path);
  return OPC_OK;
}

/* Check the form "step.metric" of the figures requested for the summary. */
static int check_columns(const experiment *e, opc_error *error) {
  for (size_t i = 0; i < e->columns.count; i++)
    if (!strchr(e->columns.pairs[i].key, '.')) {
      g_snprintf(error->parameter, sizeof error->parameter, "columns.%s",
                 e->columns.pairs[i].key);
      g_snprintf(error->message, sizeof error->message,
                 "'%s' does not name a metric, expected 'step.metric'",
                 e->columns.pairs[i].key);
      return error->code = OPC_INVALID;
    }
  return OPC_OK;
}

static int experiment_check(void *self, opc_error *error) {
  experiment *e = self;
  int code = check_sweep(e, error);
  const opc_inner_axis *cases = code ? NULL : find_axis(e, "cases", error);
  const opc_inner_axis *methods = cases ? find_axis(e, "methods", error) : NULL;
  if (!methods) return error->code;
  e->n_cases = cases->count;
  e->n_methods = methods->count;
  e->count = e->n_cases * e->n_methods;
  e->case_names = cases->texts;
  e->method_names = methods->texts;
  return check_columns(e, error);
}

/* ---- the runs ---- */

/* Run a method on a case. Returns OPC_OK, also if the run fails, or
   OPC_CANCELLED. */
static int run_one(experiment *e, size_t i, opc_error *error) {
  opc_error why = {0};
  const opc_inner_run *out;
  g_autofree char *place = g_build_filename(
      e->case_names[i / e->n_methods], e->method_names[i % e->n_methods], NULL);
  int code =
      opc_get_inner(e->host)->run_whole(e->host, i, place, 1, &out, &why);
  if (code == OPC_CANCELLED) {
    *error = why;
    return code;
  }
  e->results[i] = g_strdup(code ? why.message : "good");
  e->seconds[i] = out ? out->seconds : NAN;
  if (!out) {
    e->failed++;
    e->host->log(e->host, OPC_LOG_WARNING, "%s by %s failed: %s",
                 e->case_names[i / e->n_methods],
                 e->method_names[i % e->n_methods], e->results[i]);
    e->places[i] = g_strdup("");
    return OPC_OK;
  }
  e->folders[i] = g_strdup(out->folder);
  e->places[i] = g_steal_pointer(&place);
  e->missed += code == OPC_LIMIT;
  e->with_findings += out->findings > 0;
  take_figures(e, i);
  return OPC_OK;
}

static int experiment_run(void *self, void **outputs, opc_error *error) {
  experiment *e = self;
  e->folders = g_new0(char *, e->count);
  e->places = g_new0(char *, e->count);
  e->results = g_new0(char *, e->count);
  e->seconds = g_new(double, e->count);
  e->figures = g_ptr_array_new_with_free_func(figure_free);
  int code = opc_get_inner(e->host)->begin(e->host, error);
  for (size_t i = 0; i < e->count && !code; i++) code = run_one(e, i, error);
  if (code) return code;
  if (e->failed == e->count)
    return opc_fail(error, OPC_FAILED, NULL, "no run succeeded: %s",
                    e->results[0]);
  outputs[0] =
      eda_experiment_new(e->n_cases, e->case_names, e->n_methods,
                         e->method_names, (const char *const *)e->folders);
  return experiment_report(e, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(experiment, flow, .type = OPC_FILE,
                  .flags = OPC_REQUIRED | OPC_INNER_FLOW,
                  .summary = "flow that runs for each method and case"),
    OPC_PARAMETER(
        experiment, variant, .type = OPC_TEXT,
        .summary = "variant of the flow that applies before each method"),
    OPC_PARAMETER(
        experiment, cases, .type = OPC_MAP,
        .flags = OPC_REQUIRED | OPC_MAP_OF_ANY | OPC_INNER_AXIS,
        .summary = "cases to run, as in [{ layout.file: a.gds }]; values may "
                   "be lists or patterns, and { list: FILE } reads a file"),
    OPC_PARAMETER(experiment, methods, .type = OPC_MAP,
                  .flags = OPC_REQUIRED | OPC_MAP_OF_ANY | OPC_INNER_AXIS,
                  .summary = "methods to compare: [variant], or { name: { "
                             "step.parameter: value } }"),
    OPC_PARAMETER(experiment, set, .type = OPC_MAP, .flags = OPC_MAP_OF_ANY,
                  .summary = "values for all runs, { step.parameter: value }; "
                             "they override all others"),
    OPC_PARAMETER(
        experiment, columns, .type = OPC_MAP,
        .summary =
            "columns of the summary, { step.metric: heading }; default: the "
            "figures of merit, and other metrics that differ between methods"),
};

static const opc_metric metrics[] = {
    {"cases", NULL, OPC_NEUTRAL, 0, "number of cases"},
    {"methods", NULL, OPC_NEUTRAL, 0, "number of methods"},
    {"failed", NULL, OPC_LOWER, 0, "runs that failed"},
    {"missed", NULL, OPC_LOWER, 0,
     "runs that do not meet the requirements of the flow"},
};

static void free_texts(char **texts, size_t n) {
  for (size_t i = 0; texts && i < n; i++) g_free(texts[i]);
  g_free(texts);
}

static void experiment_clear(void *self) {
  experiment *e = self;
  free_texts(e->folders, e->count);
  free_texts(e->places, e->count);
  free_texts(e->results, e->count);
  g_free(e->seconds);
  if (e->figures) g_ptr_array_free(e->figures, TRUE);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_EXPERIMENT("experiment")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = experiment_run};

OPC_PLUGIN(experiment, .id = "experiment", .kind = "step",
           .version = OPC_VERSION, .licence = "BSD-3-Clause",
           .summary = "run a flow by several methods on several cases",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = experiment_check, .clear = experiment_clear,
           OPC_FUNCTIONS(functions));
