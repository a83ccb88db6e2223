/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `search`: runs a flow at each setting of some parameters
   and returns the mask of the best setting. */
#include "search.h"

#include <eda/gates.h>
#include <glib.h>
#include <math.h>
#include <opcflow/step.h>
#include <string.h>

/* ---- the figure to minimise ---- */

/* Set the parameter of an error, or a key of that parameter, and return the
   code. */
static int error_set_parameter(opc_error *error, const char *parameter,
                               const char *key) {
  g_snprintf(error->parameter, sizeof error->parameter, "%s%s%s", parameter,
             key ? "." : "", key ? key : "");
  return error->code;
}

/* Add a metric to the objective. Return OPC_INVALID unless it belongs to the
   step or plugin of the first metric. */
static int plan_term(search *s, const char *path, double weight,
                     opc_error *error) {
  plan *p = &s->plan;
  const opc_metric *metric =
      opc_get_inner(s->host)->metric(s->host, path, error);
  if (!metric) return error->code;
  g_autofree char *of = g_strndup(path, (gsize)(strrchr(path, '.') - path));
  if (!p->of) p->of = g_steal_pointer(&of);
  if (of && strcmp(of, p->of))
    return opc_fail(error, OPC_INVALID, NULL,
                    "expected a metric of '%s', like the first one", p->of);
  p->terms = g_renew(term, p->terms, p->n_terms + 1);
  p->terms[p->n_terms++] = (term){metric, weight};
  return OPC_OK;
}

/* Set up the weighted sum of squares. */
static int plan_weights(search *s, opc_error *error) {
  s->plan.figure = "cost";
  s->plan.weighted = 1;
  for (size_t i = 0; i < s->weights.count; i++) {
    const opc_pair *pair = &s->weights.pairs[i];
    char *end;
    double weight = g_ascii_strtod(pair->value, &end);
    int code = end == pair->value || *end || !(weight >= 0) || isinf(weight)
                   ? opc_fail(error, OPC_INVALID, NULL,
                              "expected a number of at least 0, found '%s'",
                              pair->value)
                   : plan_term(s, pair->key, weight, error);
    if (code) return error_set_parameter(error, "weights", pair->key);
  }
  return OPC_OK;
}

static int plan_figure(search *s, opc_error *error) {
  plan *p = &s->plan;
  if (!s->minimise + !s->maximise + !s->weights.count != 2)
    return opc_fail(
        error, OPC_INVALID, NULL,
        "a search requires one of 'minimise', 'maximise' and 'weights'");
  if (s->weights.count) return plan_weights(s, error);
  p->greatest = s->maximise != NULL;
  p->figure = p->greatest ? s->maximise : s->minimise;
  if (plan_term(s, p->figure, 1, error))
    return error_set_parameter(error, p->greatest ? "maximise" : "minimise",
                               NULL);
  p->unit = p->terms[0].metric->unit;
  return OPC_OK;
}

/* Set up the shared axis: settings that differ only in the value of this axis
   share a run. */
static int plan_axis(search *s, const char *key, opc_error *error) {
  plan *p = &s->plan;
  p->along = opc_get_inner(s->host)->axis(s->host, key, error);
  if (p->along < 0) return error_set_parameter(error, "along", key);
  for (size_t i = (size_t)p->along + 1; i < s->n_axes; i++)
    p->stride *= s->axes[i]->count;
  const opc_inner_axis *axis = s->axes[p->along];
  int good = axis->values && !axis->unit;
  for (size_t i = 1; i < axis->count && good; i++)
    good = axis->values[i] > axis->values[i - 1];
  p->count = axis->count;
  if (good) return OPC_OK;
  opc_fail(error, OPC_INVALID, NULL,
           "'%s' requires increasing numbers without units to share a run",
           key);
  return error_set_parameter(error, "along", key);
}

static int plan_along(search *s, opc_error *error) {
  plan *p = &s->plan;
  p->along = -1;
  p->count = p->stride = 1;
  if (!s->along.count) return OPC_OK;
  const char *key = s->along.pairs[0].key, *text = s->along.pairs[0].value;
  if (plan_axis(s, key, error)) return error->code;
  p->column = g_strsplit(text, ".", -1);
  if (s->along.count > 1)
    opc_fail(error, OPC_INVALID, NULL, "only one parameter can share runs");
  else if (g_strv_length(p->column) != 3)
    opc_fail(error, OPC_INVALID, NULL,
             "'%s' does not name a column, expected 'step.table.column'", text);
  else if (strcmp(p->column[0], p->of))
    opc_fail(error, OPC_INVALID, NULL,
             "the table must belong to the step of the metric, found step '%s'",
             p->column[0]);
  else
    return OPC_OK;
  return error_set_parameter(error, "along",
                             s->along.pairs[s->along.count - 1].key);
}

/* Select the step that provides the mask. It is the step with the figure,
   unless `mask` names another step. */
static int plan_mask(search *s, opc_error *error) {
  const opc_inner_service *inner = opc_get_inner(s->host);
  opc_error none = {0};
  g_autofree char *step = g_strdup(s->mask ? s->mask : s->plan.of);
  if (!s->mask) step[strcspn(step, ".")] = 0;
  s->plan.mask = inner->output(s->host, step, "mask", error);
  if (s->plan.mask) return OPC_OK;
  const char *other = inner->output(s->host, NULL, "mask", &none);
  const opc_error why = *error;
  if (other)
    opc_fail(error, OPC_INVALID, NULL,
             "%.800s: 'mask' must name the step whose mask is the output, such "
             "as '%.80s'",
             why.message, other);
  return s->mask ? error_set_parameter(error, "mask", NULL) : error->code;
}

/* Refuse an axis that affects neither figure nor mask. */
static int check_axes(search *s, opc_error *error) {
  s->axes = opc_get_inner(s->host)->axes(s->host, &s->n_axes);
  for (size_t i = 0; i < s->n_axes; i++) {
    const char *path = s->axes[i]->path;
    if (s->axes[i]->used || !path) continue;
    opc_fail(
        error, OPC_INVALID, NULL,
        "'%s' has no effect: step '%.*s' runs after the step of the metric",
        path, (int)strcspn(path, "."), path);
    return error_set_parameter(error, "sweep", path);
  }
  return OPC_OK;
}

static int search_check(void *self, opc_error *error) {
  search *s = self;
  int code = plan_figure(s, error);
  if (code) return code;
  s->axes = opc_get_inner(s->host)->axes(s->host, &s->n_axes);
  if (!s->n_axes)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a search requires a 'sweep', here or in '%s'", s->flow);
  code = plan_along(s, error);
  if (!code) code = plan_mask(s, error);
  return code ? code : check_axes(s, error);
}

/* ---- the figures of a run ---- */

/* Return the objective as a function of its metrics. */
static double plan_value(const plan *p, const double *metrics) {
  if (!p->weighted) return metrics[0];
  double sum = 0;
  for (size_t i = 0; i < p->n_terms; i++)
    if (p->terms[i].weight > 0)
      sum += p->terms[i].weight * metrics[i] * metrics[i];
  return sum;
}

static double find_metric(const search *s, const opc_metric *metric,
                          int shared) {
  size_t n;
  const opc_inner_metric *const *m =
      opc_get_inner(s->host)->metrics(s->host, shared, &n);
  for (size_t i = 0; i < n; i++)
    if (m[i]->metric == metric && !strcmp(m[i]->path, s->plan.of))
      return m[i]->value;
  return NAN;
}

/* Return the figure of the last run. Metrics that the run itself does not have
   are those of the steps shared by all runs. */
static double get_figure(const search *s) {
  const plan *p = &s->plan;
  g_autofree double *values = g_new(double, p->n_terms);
  for (size_t i = 0; i < p->n_terms; i++) {
    values[i] = find_metric(s, p->terms[i].metric, 0);
    if (isnan(values[i])) values[i] = find_metric(s, p->terms[i].metric, 1);
  }
  return plan_value(p, values);
}

/* Return the sum of the metrics `simulations` of all steps. */
static double count_simulations(const search *s, int shared) {
  size_t n;
  const opc_inner_metric *const *m =
      opc_get_inner(s->host)->metrics(s->host, shared, &n);
  double sum = 0;
  for (size_t i = 0; i < n; i++)
    if (!strcmp(m[i]->metric->name, "simulations")) sum += m[i]->value;
  return sum;
}

static double real_at(const opc_column *c, size_t row) {
  return c->type == OPC_REAL ? ((const double *)c->data)[row]
                             : (double)((const int64_t *)c->data)[row];
}

/* Take the figures of a shared run from the rows of a table. The row for a
   value of the axis is the last one whose axis value does not exceed that
   value. A run that ends early has converged, so its last row applies to all
   later values. */
static int take_column(search *s, size_t setting, opc_error *error) {
  const opc_inner_service *inner = opc_get_inner(s->host);
  const plan *p = &s->plan;
  size_t rows;
  const opc_column *value =
      inner->column(s->host, p->of, p->column[1], p->column[2], &rows, error);
  g_autofree const opc_column **figure = g_new0(const opc_column *, p->n_terms);
  g_autofree double *values = g_new(double, p->n_terms);
  int good = value != NULL;
  for (size_t i = 0; i < p->n_terms && good; i++) {
    figure[i] = inner->column(s->host, p->of, p->column[1],
                              p->terms[i].metric->name, &rows, error);
    good = figure[i] != NULL;
  }
  if (!good) return error_set_parameter(error, "along", NULL);
  const double *at = s->axes[p->along]->values;
  for (size_t k = 0, row = 0; k < p->count; k++) {
    while (row < rows && real_at(value, row) <= at[k]) row++;
    for (size_t i = 0; i < p->n_terms && row; i++)
      values[i] = real_at(figure[i], row - 1);
    if (row) s->figure[setting + k * p->stride] = plan_value(p, values);
  }
  return OPC_OK;
}

/* ---- all runs ---- */

/* Update the best setting. Among settings with equal figures, the first is the
   best. */
static void search_compare(search *s, size_t setting) {
  double figure = s->figure[setting];
  if (isnan(figure)) return;
  double best = s->best < s->count ? s->figure[s->best] : NAN;
  int better = s->plan.greatest ? figure > best : figure < best;
  if (isnan(best) || better || (figure == best && setting < s->best))
    s->best = setting;
}

/* Run the settings that share a run with `first`, the setting with the first
   value of the shared axis. The table of settings records a failed run. Returns
   an error only for cancellation or an invalid column. */
static int run_settings(search *s, size_t first, opc_error *error) {
  const plan *p = &s->plan;
  opc_error failure = {0};
  size_t last = first + (p->count - 1) * p->stride;
  int code = opc_get_inner(s->host)->run(s->host, last, 0, p->count, &failure);
  if (code == OPC_CANCELLED) {
    *error = failure;
    return code;
  }
  s->simulations += count_simulations(s, 0);
  if (!code && p->along >= 0) {
    if (take_column(s, first, error)) return error->code;
  } else if (!code) {
    s->figure[first] = get_figure(s);
    if (isnan(s->figure[first]))
      code = opc_fail(&failure, OPC_FAILED, NULL,
                      "step '%s' published no metric '%s'", p->of,
                      p->terms[0].metric->name);
  }
  if (code) s->failed += p->count;
  s->results[s->runs++] = g_strdup(code ? failure.message : "good");
  for (size_t k = 0; k < p->count; k++) {
    size_t setting = first + k * p->stride;
    s->run[setting] = (int64_t)s->runs;
    if (!code) search_compare(s, setting);
  }
  return OPC_OK;
}

static int run_all(search *s, opc_error *error) {
  const size_t block = s->plan.count * s->plan.stride;
  int code = opc_get_inner(s->host)->begin(s->host, error);
  if (code) return code;
  s->simulations = count_simulations(s, 1);
  for (size_t i = 0; i < s->count && !code; i++)
    if (i % block < s->plan.stride) code = run_settings(s, i, error);
  if (code || s->best < s->count) return code;
  return opc_fail(error, OPC_FAILED, NULL, "no setting has a value: %s",
                  s->results[0]);
}

/* Run the best setting again, to obtain its objects and files. */
static int run_best(search *s, opc_error *error) {
  int code = opc_get_inner(s->host)->run(s->host, s->best, 1, 0, error);
  if (code) return code;
  s->simulations += count_simulations(s, 0);
  double figure = get_figure(s);
  if (figure != s->figure[s->best])
    s->host->log(s->host, OPC_LOG_WARNING,
                 "the best setting run alone has %.9g, expected %.9g: the run "
                 "does not begin like the shared run",
                 figure, s->figure[s->best]);
  return OPC_OK;
}

static int search_run(void *self, void **outputs, opc_error *error) {
  search *s = self;
  s->count = 1;
  for (size_t i = 0; i < s->n_axes; i++) s->count *= s->axes[i]->count;
  s->best = s->count;
  s->figure = g_new(double, s->count);
  for (size_t i = 0; i < s->count; i++) s->figure[i] = NAN;
  s->run = g_new0(int64_t, s->count);
  s->results = g_new0(char *, s->count + 1);
  int code = run_all(s, error);
  if (!code) code = run_best(s, error);
  if (code) return code;
  eda_settings *settings = search_settings(s);
  outputs[0] = opc_get_inner(s->host)->object(s->host, s->plan.mask, "mask");
  outputs[1] = settings;
  return search_report(s, settings, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(search, flow, .type = OPC_FILE,
                  .flags = OPC_REQUIRED | OPC_INNER_FLOW,
                  .summary = "flow whose parameters are searched"),
    OPC_PARAMETER(search, gates, .type = OPC_INPUT, .flags = OPC_INNER_STEP,
                  .choices = "gates",
                  .summary = "gates that the flow corrects (default: those of "
                             "the step 'gates' of the flow)"),
    OPC_PARAMETER(search, variant, .type = OPC_TEXT,
                  .summary = "variant of the flow"),
    OPC_PARAMETER(search, set, .type = OPC_MAP, .flags = OPC_MAP_OF_ANY,
                  .summary = "values that override those of the flow, { "
                             "step.parameter: value }"),
    OPC_PARAMETER(
        search, sweep, .type = OPC_MAP, .flags = OPC_MAP_OF_ANY,
        .summary =
            "swept parameters, { step.parameter: [...] } or { step.parameter: "
            "{ from: A, to: B, step: C } }; added to the sweep of the flow"),
    OPC_PARAMETER(
        search, along, .type = OPC_MAP,
        .summary = "parameter whose values share a run, { step.parameter: "
                   "step.table.column }; the table has a row for each value"),
    OPC_PARAMETER(search, minimise, .type = OPC_TEXT,
                  .summary = "metric to minimise, as in step.metric"),
    OPC_PARAMETER(search, maximise, .type = OPC_TEXT,
                  .summary = "metric to maximise, as in step.metric"),
    OPC_PARAMETER(
        search, weights, .type = OPC_MAP,
        .summary = "minimise the sum of the squares of metrics of a step times "
                   "their weights, { step.metric: weight } (thesis eq. 2.5)"),
    OPC_PARAMETER(
        search, mask, .type = OPC_TEXT,
        .summary =
            "step that provides the mask; default: the step of the metric"),
};

static const opc_metric metrics[] = {
    {"least", NULL, OPC_LOWER, 0, "metric of the best setting, if minimised"},
    {"greatest", NULL, OPC_HIGHER, 0,
     "metric of the best setting, if maximised"},
    {"setting", NULL, OPC_NEUTRAL, 0, "number of the best setting"},
    {"settings", NULL, OPC_NEUTRAL, 0, "number of settings"},
    {"failed", NULL, OPC_LOWER, 0, "settings whose runs failed"},
    {"runs", NULL, OPC_LOWER, 0,
     "runs of the flow, without the repeated run of the best setting"},
    {"simulations", NULL, OPC_LOWER, 0,
     "litho simulations of all runs, one layer each"},
};

static void search_clear(void *self) {
  search *s = self;
  g_free(s->plan.of);
  g_free(s->plan.terms);
  g_strfreev(s->plan.column);
  g_free(s->figure);
  g_free(s->run);
  g_strfreev(s->results);
}

/* ---- entry ---- */

/* Do not release the mask: the mask belongs to the run of the best setting,
   which exists as long as the step. */
static void keep_mask(void *mask) { (void)mask; }

static const opc_port outputs[] = {{.name = "mask",
                                    .kind = "mask",
                                    .check = eda_mask_check,
                                    .release = keep_mask},
                                   EDA_PORT_SETTINGS("settings")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = search_run};

OPC_PLUGIN(
    search, .id = "search", .kind = "step", .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary =
        "run a flow at many settings of parameters and keep the best setting",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = search_check, .clear = search_clear,
    OPC_FUNCTIONS(functions));
