/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements resist.vtr: variable threshold resist (thesis 2.2.3; N. B. Cobb,
   "Fast optical and process proximity correction algorithms for integrated
   circuit manufacturing", Berkeley 1998). A feature prints where the intensity
   is below

   constant + maximum * M + slope * S + product * M * S,

   where M is the maximum intensity and S the image slope near the position
   (local.h). */
#include <eda/resist.h>
#include <math.h>

#include "../calibrate.h"
#include "local.h"

/* ---- state ---- */

enum { CONSTANT, MAXIMUM, SLOPE, PRODUCT };
_Static_assert(PRODUCT + 1 == RESIST_TERMS, "all terms");

typedef struct resist {
  resist_base base;
  local_settings local;
  double given[RESIST_SETS][RESIST_TERMS]; /* parameters; NAN if not given */
  int last[RESIST_SETS];  /* index of the last coefficient to fit; -1: not
                             given */
  int fixed[RESIST_SETS]; /* 1: nothing to calibrate */
  int fit[RESIST_SETS][RESIST_TERMS];
  double coefficient[RESIST_SETS][RESIST_TERMS];
} resist;

/* ---- work ---- */

/* Compute the fields of terms 1 .. n - 1 of an image. */
static int make_terms(const resist_base *base, const eda_field *image, size_t n,
                      eda_field *out, opc_error *error) {
  const resist *r = (const resist *)base;
  for (size_t k = 1; k < n; k++) {
    double one[RESIST_TERMS] = {0};
    one[k] = 1;
    eda_field copy = eda_field_scaled(image, 1);
    int code = local_field(base->host->context, &r->local, one, &copy,
                           &out[k - 1], error);
    eda_field_clear(&copy);
    if (code) return code;
  }
  return OPC_OK;
}

static int vtr_calibrate(resist *r, int set, const opc_module *litho,
                         opc_error *error) {
  double *a = r->coefficient[set];
  size_t n = 1; /* number of terms up to the last one in use */
  for (size_t k = 0; k < RESIST_TERMS; k++) {
    a[k] = isnan(r->given[set][k]) ? 0 : r->given[set][k];
    if (k && (r->fit[set][k] || a[k] != 0)) n = k + 1;
  }
  if (r->fixed[set]) return OPC_OK;
  return resist_fit(&r->base, set, litho, "resist.vtr", make_terms, n,
                    r->fit[set], a, error);
}

static void vtr_log(resist *r, eda_scanner scanner);

static int vtr_prepare(void *self, const opc_module *litho, opc_error *error) {
  static const char *const names[RESIST_SETS] = {"poly", "active"};
  resist *r = self;
  resist_set_diffusion(&r->base, "resist.vtr");
  vtr_log(r, eda_scanner_of(litho));
  for (int set = 0; set < RESIST_SETS; set++) {
    int code = vtr_calibrate(r, set, litho, error);
    if (code) return code;
    const double *a = r->coefficient[set];
    r->base.host->log(r->base.host, OPC_LOG_INFO,
                      "resist.vtr: %s threshold %.4f %+.4f M %+.3f nm S "
                      "%+.3f nm M S",
                      names[set], a[CONSTANT], a[MAXIMUM], a[SLOPE],
                      a[PRODUCT]);
  }
  return OPC_OK;
}

static int vtr_print(const void *self, int layer, eda_field *field,
                     opc_error *error) {
  const resist *r = self;
  const opc_context *context = r->base.host->context;
  const double *a = r->coefficient[resist_set(layer)];
  int code = eda_field_diffuse(context, field, r->base.diffusion, error);
  if (code) return code;
  int varies = a[MAXIMUM] != 0 || a[SLOPE] != 0 || a[PRODUCT] != 0;
  eda_field variable = {0};
  if (varies)
    code = local_field(context, &r->local, a, field, &variable, error);
  if (code) return code;
  resist_print(&r->base, layer, a[CONSTANT], varies ? &variable : NULL, field);
  eda_field_clear(&variable);
  return OPC_OK;
}

/* ---- parameters ---- */

/* clang-format off */ /* clang-format would nest the elements */
/* Parameters of the coefficients of a set of layers. */
#define COEFFICIENTS(prefix, set)                                             \
  {.name = prefix "constant", .type = OPC_REAL,                               \
   .summary = "constant part of the threshold; calibrated if not given",      \
   OPC_FIELD(resist, given[set][CONSTANT])},                                  \
  {.name = prefix "maximum", .type = OPC_REAL,                                \
   .summary = "coefficient of the maximum intensity in the threshold; "       \
              "default: 0, or fitted",                                        \
   OPC_FIELD(resist, given[set][MAXIMUM])},                                   \
  {.name = prefix "slope", .type = OPC_REAL, .unit = "nm",                    \
   .summary = "coefficient of the image slope in 1/nm in the threshold; "     \
              "default: 0, or fitted",                                        \
   OPC_FIELD(resist, given[set][SLOPE])},                                     \
  {.name = prefix "product", .type = OPC_REAL, .unit = "nm",                  \
   .summary = "coefficient of the product of maximum and slope in the "       \
              "threshold; default: 0, or fitted",                             \
   OPC_FIELD(resist, given[set][PRODUCT])},                                   \
  {.name = prefix "fit", .type = OPC_CHOICE,                                  \
   .choices = "constant|maximum|slope|product",                               \
   .summary = "last coefficient that a table determines, with all "           \
              "preceding coefficients that are not given; default: slope",    \
   OPC_FIELD(resist, last[set])}
/* clang-format on */

static const opc_parameter parameters[] = {
    RESIST_LAYER(0, "", RESIST_POLY, RESIST_LINE, RESIST_PITCH),
    COEFFICIENTS("", 0),
    RESIST_LAYER(1, "active_", "active", RESIST_WIDE, RESIST_ALONE),
    COEFFICIENTS("active_", 1),
    RESIST_GATES,
    RESIST_DIFFUSION,
    OPC_PARAMETER_NAMED(
        "radius", resist, local.radius, .type = OPC_REAL,
        .flags = OPC_ABOVE | OPC_AT_MOST, .unit = "nm",
        .follows = "0.777 lambda/NA", .min = 0, .max = 2000,
        .summary = "radius of the neighbourhood for the maximum"),
    OPC_PARAMETER_NAMED("slope_radius", resist, local.slope_radius,
                        .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_AT_MOST,
                        .unit = "nm", .follows = "0.233 lambda/NA", .min = 0,
                        .max = 2000,
                        .summary = "radius of the neighbourhood for the slope"),
    OPC_PARAMETER_NAMED("step", resist, local.step, .type = OPC_REAL,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                        .follows = "0.062 lambda/NA", .min = 1, .max = 64,
                        .summary = "largest grid spacing of the threshold"),
};

/* Log the values in use that the flow does not set, except anchors. */
static void vtr_log(resist *r, eda_scanner scanner) {
  EDA_FOLLOW(r->base.host, "resist.vtr", r, parameters, scanner);
}

/* Choose the coefficients to fit: for a table, all up to `last` that are not
   given; for an anchor, the constant. */
static int check_set(resist *r, int set, opc_error *error) {
  static const char *const names[RESIST_SETS] = {"fit", "active_fit"};
  resist_layer *layer = &r->base.layer[set];
  int code = resist_layer_check(layer, set, error);
  if (code) return code;
  int table = resist_layer_has_table(layer), last = CONSTANT, wanted = 0;
  if (table) last = r->last[set] < 0 ? SLOPE : r->last[set];
  for (int k = 0; k < RESIST_TERMS; k++) {
    r->fit[set][k] = k <= last && isnan(r->given[set][k]);
    wanted += r->fit[set][k];
  }
  r->fixed[set] = !wanted;
  if (table && !wanted)
    return opc_fail(error, OPC_INVALID, layer->source,
                    "'%s' has nothing to fit: all coefficients are given",
                    layer->source);
  if (r->last[set] >= 0 && !table)
    return opc_fail(error, OPC_INVALID, names[set], "'%s' requires a table",
                    names[set]);
  return OPC_OK;
}

static const opc_metric metrics[] = {RESIST_METRICS};

static int vtr_check(void *self, opc_error *error) {
  int code = check_set(self, 0, error);
  return code ? code : check_set(self, 1, error);
}

/* ---- entry ---- */

static const eda_resist functions = {
    .prepare = vtr_prepare, .print = vtr_print, .drawn = resist_take_gates};
OPC_PLUGIN(resist, .id = "resist.vtr", .kind = "resist", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "variable threshold by maximum intensity and image slope",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = vtr_check,
           .clear = resist_clear, OPC_FUNCTIONS(functions));
