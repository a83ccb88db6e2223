/* SPDX-License-Identifier: BSD-3-Clause */
/* resist.threshold: a feature prints where the intensity, blurred by the
   resist, stays below a constant (or above it). The constant of each layer is
   the one that prints an anchor, a line of a grating or an isolated one, to its
   size, or a table of lines as well as it can. */
#include "../calibrate.h"

#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct resist {
  const opc_host *host;
  double diffusion; /* nm */
  resist_layer layer[OPC_MASKS];
  double given[OPC_MASKS]; /* a threshold; NAN: calibrate */
  double threshold[OPC_MASKS];
} resist;

/* ---- work ---- */

static int prepare(void *self, const opc_module *litho, opc_error *error) {
  resist *r = self;
  const resist_model model = {.diffusion = r->diffusion};
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    const int fit = 1;
    r->threshold[layer] = isnan(r->given[layer]) ? 0 : r->given[layer];
    if (!isnan(r->given[layer])) continue;
    int code = resist_fit(&r->layer[layer], litho, &model, 1, &fit,
                          &r->threshold[layer], error);
    if (code) return code;
  }
  static const char *const side[] = {"below", "above"};
  r->host->log(r->host, OPC_LOG_INFO,
               "resist.threshold: poly prints %s %.4f, active %s %.4f",
               side[r->layer[OPC_POLY].bright], r->threshold[OPC_POLY],
               side[r->layer[OPC_ACTIVE].bright], r->threshold[OPC_ACTIVE]);
  return OPC_OK;
}

static int print(const void *self, int layer, opc_field *field,
                 opc_error *error) {
  const resist *r = self;
  int code = r->host->imaging->diffuse(r->host, field, r->diffusion, error);
  if (code) return code;
  float threshold = (float)r->threshold[layer];
  float sign = r->layer[layer].bright ? -1 : 1;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  for (size_t i = 0; i < n; i++)
    field->coefficients[i] = sign * (threshold - field->coefficients[i]);
  return OPC_OK;
}

/* ---- parameters ---- */

enum {
  POLY,
  THRESHOLD = POLY + RESIST_LAYER_PARAMETERS,
  ACTIVE,
  ACTIVE_THRESHOLD = ACTIVE + RESIST_LAYER_PARAMETERS,
  DIFFUSION,
  PARAMETERS
};

static const opc_parameter parameters[PARAMETERS] = {
    RESIST_LAYER("", "poly", "65 nm", "250 nm"),
    {.name = "threshold",
     .type = OPC_REAL,
     .flags = OPC_ABOVE | OPC_BELOW,
     .min = 0,
     .max = 1,
     .summary = "of poly, clear field 1; instead of anchor or table"},
    RESIST_LAYER("active_", "active", "1000 nm", "0 nm"),
    {.name = "active_threshold",
     .type = OPC_REAL,
     .flags = OPC_ABOVE | OPC_BELOW,
     .min = 0,
     .max = 1,
     .summary = "of active, clear field 1; instead of anchor or table"},
    RESIST_DIFFUSION,
};

static void destroy(void *self) {
  resist *r = self;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    resist_layer_clear(&r->layer[layer]);
  free(r);
}

static int take(resist *r, int layer, const opc_value *values,
                const opc_value *threshold, opc_error *error) {
  const opc_host *host = r->host;
  int code = resist_layer_create(&r->layer[layer], host, "resist.threshold",
                                 layer, values, error);
  if (code) return code;
  int given = threshold->type != OPC_ABSENT;
  r->given[layer] = given ? threshold->real : (double)NAN;
  const char *source = r->layer[layer].source;
  if (given && resist_layer_has_table(&r->layer[layer]))
    return host->fail(host, error, OPC_INVALID, source,
                      "'%s' has no use where the threshold is given", source);
  return OPC_OK;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  resist *r = calloc(1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  r->diffusion = values[DIFFUSION].real;
  if (take(r, OPC_POLY, values + POLY, values + THRESHOLD, error) ||
      take(r, OPC_ACTIVE, values + ACTIVE, values + ACTIVE_THRESHOLD, error)) {
    destroy(r);
    return NULL;
  }
  return r;
}

/* ---- entry ---- */

static const opc_resist operations = {
    .size = sizeof operations, .prepare = prepare, .print = print};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "resist.threshold",
      .version = "0.2.0",
      .licence = "BSD-3-Clause",
      .summary = "constant threshold, calibrated to an anchor or a table",
      .kind = OPC_KIND_RESIST,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
