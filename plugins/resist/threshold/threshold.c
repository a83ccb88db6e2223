/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements resist.threshold: a feature prints where the intensity, blurred by
   diffusion, is below a constant (bright features: above). By default the
   constant of each layer is calibrated: an anchor line prints to size, or a
   table of lines is fitted. */
#include <eda/resist.h>
#include <math.h>

#include "../calibrate.h"

/* ---- state ---- */

typedef struct resist {
  resist_base base;
  double given[RESIST_SETS]; /* threshold, relative to the clear field; NAN:
                                calibrate */
  double threshold[RESIST_SETS];
} resist;

/* ---- work ---- */

static int threshold_prepare(void *self, const opc_module *litho,
                             opc_error *error) {
  resist *r = self;
  resist_set_diffusion(&r->base, "resist.threshold");
  for (int set = 0; set < RESIST_SETS; set++) {
    const int fit = 1;
    r->threshold[set] = isnan(r->given[set]) ? 0 : r->given[set];
    if (!isnan(r->given[set])) continue;
    int code = resist_fit(&r->base, set, litho, "resist.threshold", NULL, 1,
                          &fit, &r->threshold[set], error);
    if (code) return code;
  }
  static const char *const side[] = {"below", "above"};
  const resist_layer *layer = r->base.layer;
  r->base.host->log(r->base.host, OPC_LOG_INFO,
                    "resist.threshold: poly prints %s %.4f, active %s %.4f, "
                    "diffusion %g nm",
                    side[layer[0].bright], r->threshold[0],
                    side[layer[1].bright], r->threshold[1], r->base.diffusion);
  return OPC_OK;
}

static int threshold_print(const void *self, int layer, eda_field *field,
                           opc_error *error) {
  const resist *r = self;
  int code =
      eda_field_diffuse(r->base.host->context, field, r->base.diffusion, error);
  if (code) return code;
  resist_print(&r->base, layer, r->threshold[resist_set(layer)], NULL, field);
  return OPC_OK;
}

/* ---- parameters ---- */

/* clang-format off */ /* clang-format would nest the elements */
#define GIVEN(name_, what, set)                                               \
  {.name = name_, .type = OPC_REAL, .flags = OPC_ABOVE | OPC_BELOW,           \
   .min = 0, .max = 1,                                                        \
   .summary = "threshold of " what ", relative to the clear field; replaces "             \
              "anchor and table",                                             \
   OPC_FIELD(resist, given[set])}
/* clang-format on */

static const opc_parameter parameters[] = {
    RESIST_LAYER(0, "", RESIST_POLY, RESIST_LINE, RESIST_PITCH),
    GIVEN("threshold", RESIST_POLY, 0),
    RESIST_LAYER(1, "active_", "active", RESIST_WIDE, RESIST_ALONE),
    GIVEN("active_threshold", "active", 1),
    RESIST_GATES,
    RESIST_DIFFUSION,
};

static const opc_metric metrics[] = {RESIST_METRICS};

static int threshold_check(void *self, opc_error *error) {
  resist *r = self;
  int code = OPC_OK;
  for (int set = 0; set < RESIST_SETS && !code; set++) {
    resist_layer *layer = &r->base.layer[set];
    code = resist_layer_check(layer, set, error);
    if (!code && !isnan(r->given[set]) && resist_layer_has_table(layer))
      code = opc_fail(error, OPC_INVALID, layer->source,
                      "'%s' has no effect when the threshold is given",
                      layer->source);
  }
  return code;
}

/* ---- entry ---- */

static const eda_resist functions = {.prepare = threshold_prepare,
                                     .print = threshold_print,
                                     .drawn = resist_take_gates};
OPC_PLUGIN(resist, .id = "resist.threshold", .kind = "resist",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "constant threshold, calibrated to an anchor or a table",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = threshold_check, .clear = resist_clear,
           OPC_FUNCTIONS(functions));
