/* SPDX-License-Identifier: BSD-3-Clause */
/* A step that runs a flow at each value of its axes. */
#include "compat.h"

typedef struct step {
  const opc_host *host;
  const char *flow;
  opc_map sweep;
} step;

/* Add the metrics of the last run, each with its place in the list. */
static double add_metrics(const step *s, const opc_inner_service *inner) {
  size_t n, i;
  double sum = 0;
  const opc_inner_metric *const *all = inner->metrics(s->host, 0, &n);
  for (i = 0; i < n; i++)
    if (strlen(all[i]->path) && strlen(all[i]->metric->name))
      sum += (double)(i + 1) * all[i]->value;
  return sum;
}

static int run(void *self, void **outputs, opc_error *error) {
  const step *s = (const step *)self;
  const opc_inner_service *inner = opc_get_inner(s->host);
  opc_metric_value values[2];
  size_t n_axes, points = 1, i;
  const opc_inner_axis *const *axes = inner->axes(s->host, &n_axes);
  double sum = 0;
  int code = inner->begin(s->host, error);
  (void)outputs;
  for (i = 0; i < n_axes; i++) points *= axes[i]->count;
  for (i = 0; i < points && !code; i++) {
    code = inner->run(s->host, i, 0, 1, error);
    if (!code) sum += add_metrics(s, inner) + axes[n_axes - 1]->values[0];
  }
  values[0] = (opc_metric_value){"points", (double)points};
  values[1] = (opc_metric_value){"total", sum};
  return code ? code : opc_put_metrics(s->host, OPC_ARRAY(values), error);
}

static const opc_parameter parameters[] = {
    OPC_PARAMETER(step, flow, .type = OPC_FILE,
                  .flags = OPC_REQUIRED | OPC_INNER_FLOW,
                  .summary = "the flow"),
    OPC_PARAMETER(step, sweep, .type = OPC_MAP, .flags = OPC_MAP_OF_ANY,
                  .summary = "over that flow"),
};

static const opc_metric metrics[] = {
    {"points", NULL, OPC_NEUTRAL, 0, "of all axes"},
    {"total", NULL, OPC_NEUTRAL, 0, "of their metrics"},
};

static const opc_step functions = {.run = run};

OPC_PLUGIN(step, .id = "compat.inner", .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "Kept as a binary",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
