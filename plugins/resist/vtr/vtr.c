/* SPDX-License-Identifier: BSD-3-Clause */
/* resist.vtr: variable threshold resist (thesis 2.2.3; N. B. Cobb, "Fast
   optical and process proximity correction algorithms for integrated circuit
   manufacturing", Berkeley 1998). A feature prints where the intensity stays
   below

     constant + maximum * M + slope * S + product * M * S,

   M the maximum of the intensity and S its slope in the neighbourhood. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../calibrate.h"
#include "local.h"

/* ---- state ---- */

enum { CONSTANT, MAXIMUM, SLOPE, PRODUCT };
_Static_assert(PRODUCT + 1 == RESIST_TERMS, "all terms");

typedef struct resist {
  const opc_host *host;
  double diffusion; /* nm */
  local_settings local;
  resist_layer layer[OPC_MASKS];
  int fixed[OPC_MASKS]; /* nothing to calibrate */
  int fit[OPC_MASKS][RESIST_TERMS];
  double given[OPC_MASKS][RESIST_TERMS];
  double coefficient[OPC_MASKS][RESIST_TERMS];
} resist;

/* ---- work ---- */

/* Terms 1 .. n - 1 of an image, each a field of its own. */
static int make_terms(const void *self, const opc_field *image, size_t n,
                      opc_field *out, opc_error *error) {
  const resist *r = self;
  for (size_t k = 1; k < n; k++) {
    double one[RESIST_TERMS] = {0};
    one[k] = 1;
    size_t size = (size_t)image->nx * (size_t)image->ny;
    opc_field copy = *image;
    copy.coefficients = r->host->alloc(r->host, size, sizeof(float));
    if (!copy.coefficients)
      return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
    memcpy(copy.coefficients, image->coefficients, size * sizeof(float));
    int code = local_field(r->host, &r->local, one, &copy, &out[k - 1], error);
    r->host->imaging->release_field(r->host, &copy);
    if (code) return code;
  }
  return OPC_OK;
}

static int calibrate(resist *r, int layer, const opc_module *litho,
                     opc_error *error) {
  const resist_model model = {
      .self = r, .diffusion = r->diffusion, .terms = make_terms};
  double *a = r->coefficient[layer];
  memcpy(a, r->given[layer], sizeof r->given[layer]);
  if (r->fixed[layer]) return OPC_OK;
  size_t n = 1; /* terms that are not 0 */
  for (size_t k = 1; k < RESIST_TERMS; k++)
    if (r->fit[layer][k] || a[k] != 0) n = k + 1;
  return resist_fit(&r->layer[layer], litho, &model, n, r->fit[layer], a,
                    error);
}

static int prepare(void *self, const opc_module *litho, opc_error *error) {
  static const char *const names[OPC_MASKS] = {"poly", "active"};
  resist *r = self;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    int code = calibrate(r, layer, litho, error);
    if (code) return code;
    const double *a = r->coefficient[layer];
    r->host->log(r->host, OPC_LOG_INFO,
                 "resist.vtr: %s threshold %.4f %+.4f M %+.3f nm S "
                 "%+.3f nm M S",
                 names[layer], a[CONSTANT], a[MAXIMUM], a[SLOPE], a[PRODUCT]);
  }
  return OPC_OK;
}

static int print(const void *self, int layer, opc_field *field,
                 opc_error *error) {
  const resist *r = self;
  const opc_host *host = r->host;
  const double *a = r->coefficient[layer];
  int code = host->imaging->diffuse(host, field, r->diffusion, error);
  if (code) return code;
  int varies = a[MAXIMUM] != 0 || a[SLOPE] != 0 || a[PRODUCT] != 0;
  opc_field variable = {0};
  if (varies) code = local_field(host, &r->local, a, field, &variable, error);
  if (code) return code;
  float constant = (float)a[CONSTANT], sign = r->layer[layer].bright ? -1 : 1;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  for (size_t i = 0; i < n; i++) {
    float threshold = varies ? constant + variable.coefficients[i] : constant;
    field->coefficients[i] = sign * (threshold - field->coefficients[i]);
  }
  host->imaging->release_field(host, &variable);
  return OPC_OK;
}

/* ---- parameters ---- */

/* Of a layer, after those of calibrate.h. */
enum {
  GIVEN_CONSTANT = RESIST_LAYER_PARAMETERS,
  GIVEN_MAXIMUM,
  GIVEN_SLOPE,
  GIVEN_PRODUCT,
  FIT,
  LAYER_PARAMETERS
};

enum {
  DIFFUSION = OPC_MASKS * LAYER_PARAMETERS,
  RADIUS,
  SLOPE_RADIUS,
  STEP,
  PARAMETERS
};

#define COEFFICIENTS(prefix)                                                   \
  {.name = prefix "constant",                                                  \
   .type = OPC_REAL,                                                           \
   .summary = "constant part of the threshold; calibrated if not given"},      \
      {.name = prefix "maximum",                                               \
       .type = OPC_REAL,                                                       \
       .summary =                                                              \
           "change of the threshold by the maximum intensity; 0, or "          \
           "fitted, if not given"},                                            \
      {.name = prefix "slope",                                                 \
       .type = OPC_REAL,                                                       \
       .unit = "nm",                                                           \
       .summary =                                                              \
           "change of the threshold by the image slope in 1/nm; the same"},    \
      {.name = prefix "product",                                               \
       .type = OPC_REAL,                                                       \
       .unit = "nm",                                                           \
       .summary = "change of the threshold by the product of both; the same"}, \
  {                                                                            \
    .name = prefix "fit", .type = OPC_CHOICE,                                  \
    .choices = "constant|maximum|slope|product",                               \
    .summary =                                                                 \
        "the last coefficient that a table fits, with all before it "          \
        "that are not given (default: slope)"                                  \
  }

static const opc_parameter parameters[PARAMETERS] = {
    RESIST_LAYER("", "poly", "65 nm", "250 nm"),
    COEFFICIENTS(""),
    RESIST_LAYER("active_", "active", "1000 nm", "0 nm"),
    COEFFICIENTS("active_"),
    RESIST_DIFFUSION,
    {.name = "radius",
     .type = OPC_REAL,
     .flags = OPC_ABOVE | OPC_AT_MOST,
     .unit = "nm",
     .preset = "200 nm",
     .min = 0,
     .max = 2000,
     .summary = "of the neighbourhood whose maximum counts"},
    {.name = "slope_radius",
     .type = OPC_REAL,
     .flags = OPC_AT_LEAST | OPC_AT_MOST,
     .unit = "nm",
     .preset = "60 nm",
     .min = 0,
     .max = 2000,
     .summary = "of the neighbourhood whose slope counts"},
    {.name = "step",
     .type = OPC_REAL,
     .flags = OPC_AT_LEAST | OPC_AT_MOST,
     .unit = "nm",
     .preset = "16 nm",
     .min = 1,
     .max = 32,
     .summary = "grid on which the threshold is worked out, at most"},
};

static void destroy(void *self) {
  resist *r = self;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    resist_layer_clear(&r->layer[layer]);
  free(r);
}

/* A table fits the coefficients up to `fit` that are not given; an anchor fits
   the constant. */
static int take(resist *r, int layer, const opc_value *v, opc_error *error) {
  const opc_host *host = r->host;
  int code = resist_layer_create(&r->layer[layer], host, "resist.vtr", layer, v,
                                 error);
  if (code) return code;
  int table = resist_layer_has_table(&r->layer[layer]);
  int says = v[FIT].type != OPC_ABSENT, last = CONSTANT, wanted = 0;
  if (table) last = says ? (int)v[FIT].integer : SLOPE;
  for (int k = 0; k < RESIST_TERMS; k++) {
    const opc_value *given = &v[GIVEN_CONSTANT + k];
    if (given->type != OPC_ABSENT) r->given[layer][k] = given->real;
    r->fit[layer][k] = k <= last && given->type == OPC_ABSENT;
    wanted += r->fit[layer][k];
  }
  r->fixed[layer] = !wanted;
  const char *source = r->layer[layer].source;
  const char *fit = layer == OPC_POLY ? "fit" : "active_fit";
  if (table && !wanted)
    return host->fail(host, error, OPC_INVALID, source,
                      "'%s' has nothing to fit: all coefficients are given",
                      source);
  if (says && !table)
    return host->fail(host, error, OPC_INVALID, fit, "'%s' needs a table", fit);
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
  r->local = (local_settings){.radius = values[RADIUS].real,
                              .slope_radius = values[SLOPE_RADIUS].real,
                              .step = values[STEP].real};
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (take(r, layer, values + (size_t)layer * LAYER_PARAMETERS, error)) {
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
      .id = "resist.vtr",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "threshold that varies with maximum intensity and image slope",
      .kind = OPC_KIND_RESIST,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
