/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `search`: a flow at each setting of some of its parameters (scan.c),
   and the mask of the best one. */
#include "core/search/search.h"

#include "core/flow/value.h"
#include "core/plugin/host.h"

/* ---- work ---- */

static int run(void *self, void **outputs, opc_error *error) {
  opc_search *s = self;
  s->outer = s->binding->listener;
  if (!s->outer)
    return opc_fail(error, OPC_FAILED, NULL, "a search runs in a flow only");
  int code = opc_search_scan(s, error);
  if (code) return code;
  opc_settings *settings = opc_search_settings(s);
  outputs[0] = s->best_run->objects[s->plan.mask_step][s->plan.mask_port];
  outputs[1] = settings;
  return opc_search_report(s, settings, error);
}

/* The mask belongs to the run of the best setting, which lives as long as the
   step. */
static void keep_mask(void *mask) { (void)mask; }

/* ---- parameters ---- */

static const opc_parameter parameters[SEARCH_PARAMETERS] = {
    [SEARCH_FLOW] = {.name = "flow",
                     .type = OPC_FILE,
                     .flags = OPC_REQUIRED,
                     .summary = "the flow whose parameters are searched"},
    [SEARCH_VARIANT] = {.name = "variant",
                        .type = OPC_TEXT,
                        .summary = "a variant of that flow"},
    [SEARCH_SET] = {.name = "set",
                    .type = OPC_MAP,
                    .flags = OPC_MAP_OF_ANY,
                    .summary = "step.parameter: value, over what that flow "
                               "says"},
    [SEARCH_SWEEP] = {.name = "sweep",
                      .type = OPC_MAP,
                      .flags = OPC_MAP_OF_ANY,
                      .summary = "step.parameter: [...] or { from: A, to: B, "
                                 "step: C }; over that flow's own sweep"},
    [SEARCH_ALONG] = {.name = "along",
                      .type = OPC_MAP,
                      .summary = "step.parameter: step.table.column, one run "
                                 "has the figure at all values of a swept "
                                 "parameter, row by row"},
    [SEARCH_MINIMISE] = {.name = "minimise",
                         .type = OPC_TEXT,
                         .summary = "step.metric, the figure whose least value "
                                    "is best"},
    [SEARCH_MAXIMISE] = {.name = "maximise",
                         .type = OPC_TEXT,
                         .summary = "or that whose greatest value is"},
    [SEARCH_MASK] = {.name = "mask",
                     .type = OPC_TEXT,
                     .summary = "the step whose mask is handed on; that of the "
                                "figure"},
};

static const opc_metric metrics[] = {
    {.name = "least",
     .better = OPC_LOWER,
     .summary = "the figure of the best setting, in its unit"},
    {.name = "greatest",
     .better = OPC_HIGHER,
     .summary = "the same where the greatest is best"},
    {.name = "setting", .summary = "the number of the best one"},
    {.name = "settings", .summary = "how many there are"},
    {.name = "failed",
     .better = OPC_LOWER,
     .summary = "settings that could not be run"},
    {.name = "runs",
     .better = OPC_LOWER,
     .summary = "runs of the flow, without that of the best setting again"},
    {.name = "simulations",
     .better = OPC_LOWER,
     .summary = "litho simulations in all, of one layer each"},
};

static const opc_inner_step inner_step = {.flow = SEARCH_FLOW,
                                          .variant = SEARCH_VARIANT,
                                          .set = SEARCH_SET,
                                          .sweep = SEARCH_SWEEP,
                                          .check = opc_search_check};

static const void *get_extension(const char *id) {
  return g_str_equal(id, OPC_INNER_FLOW) ? &inner_step : NULL;
}

/* Instances of the inner flow refuse here what only they can tell. */
static gboolean check_instances(const opc_inner *inner, opc_error *error) {
  static const opc_sink nowhere = {.data = NULL};
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, &nowhere,
                 problems);
  return !opc_problems_error(problems, error);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  /* The core's own step knows who called. */
  const opc_binding *binding = ((const opc_sink *)host->context)->data;
  if (!check_instances(binding->inner, error)) return NULL;
  opc_search *s = g_new0(opc_search, 1);
  s->host = host;
  s->values = values;
  s->binding = binding;
  s->inner = binding->inner;
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_search_plan_make(&s->plan, binding, problems);
  return s;
}

static void destroy(void *self) {
  opc_search_clear(self);
  g_free(self);
}

/* ---- entry ---- */

static const opc_port ports[] = {
    {"mask", "mask", keep_mask},
    {"settings", "settings", opc_search_settings_release}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = G_N_ELEMENTS(ports),
                                    .port_size = sizeof(opc_port),
                                    .outputs = ports,
                                    .run = run};

extern const opc_plugin opc_search_plugin;
const opc_plugin opc_search_plugin = {
    .size = sizeof(opc_plugin),
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "search",
    .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "run a flow at many settings of its parameters, keep the best",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
    .get_extension = get_extension,
};
