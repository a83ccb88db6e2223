/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the choice of the simulation accuracy from the tolerance of
   Ion. */
#include <correct/fine.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

/* Tuned constants. */
static const struct {
  double limit, error, least, most, part, peak, light, larger;
  const char *near, *nearest; /* nm, for a wavelength and NA that `natural`
                                 states */
} tuned = {
    /* An image error of `error` (relative to the clear field) is permitted for
       an Ion limit of `limit` %. The permitted error is proportional to the
       limit. Test: c432 corrected by litho.hopkins, Ion compared with all 1402
       kernels. An error of 1e-4 (105 kernels) changes Ion by 0.05 % in the mean
       and 0.27 % at most, 5e-5 (221 kernels) by 0.03 % and 0.15 %. The mean for
       5e-5 is within a tenth of 0.5 %. */
    .limit = 0.5,
    .error = 5e-5,

    /* Bounds of the image error. A few kernels suffice for `most`, so a larger
       error would save no time. */
    .least = 5e-5,
    .most = 5e-4,

    /* Largest standard deviation of Ion caused by the image error of one layer,
       as a fraction of `limit`: 0.02 % of Ion at 0.5 %, the effect of 5e-5 for
       poly at 65 nm. `peak`: ratio of the largest image error, which models
       report, to the standard deviation over a layout (litho.hopkins, README: 4
       to 5). */
    .part = 0.04,
    .peak = 4,

    /* Intensity step of the sensitivity, relative to the clear field; it
       displaces edges by 0.2 nm. Rounding errors are 1e-4 of the displacement;
       a step of 1e-2 is not linear. */
    .light = 1e-3,

    /* Relative step of a length or width for the sensitivity; the step is at
       least half a nanometre. Half and twice the step change the slope of a
       device table by less than 1 %. */
    .larger = 0.01,

    /* Default margin of fast simulations, and smallest allowed margin: 1000 and
       300 nm at 193 nm, NA 0.75. The error caused by the repetition of the
       layout decreases with the square of the margin, as measured in
       plugins/correct/README.md. */
    .near = "3.886 lambda/NA",
    .nearest = "1.166 lambda/NA",
};

int correct_fine_error(const char *text, double limit, double *fine,
                       opc_error *error) {
  char *end = NULL;
  *fine =
      fmin(fmax(tuned.error * limit / tuned.limit, tuned.least), tuned.most);
  if (!text) return OPC_OK;
  *fine = 0;
  if (!g_strcmp0(text, "off")) return OPC_OK;
  *fine = g_ascii_strtod(text, &end);
  if (end != text && !*end && *fine > 0 && *fine < 0.1) return OPC_OK;
  return opc_fail(
      error, OPC_INVALID, "fine",
      "'fine' is '%s', expected a number above 0 and below 0.1, or off", text);
}

double correct_fine_change(const char *text, double limit) {
  return text ? 0 : tuned.part * limit;
}

/* ---- sensitivity to errors ---- */

/* Ion of the drawn transistors, and of the drawn transistors with a slightly
   larger length or width. */
typedef struct drawn {
  const eda_gates *gates;
  const opc_module *extractor;
  eda_performance as_is, larger;
} drawn;

static int make_larger(drawn *d, int layer, const opc_context *context,
                       opc_error *error) {
  eda_gates g = *d->gates;
  double **size = layer == EDA_POLY ? &g.length : &g.width;
  double *grown = eda_alloc(g.count, sizeof *grown);
  for (size_t i = 0; i < g.count; i++)
    grown[i] = (*size)[i] * (1 + tuned.larger);
  *size = grown;
  int code = eda_measure_drawn(context, &g, d->extractor, &d->larger, error);
  free(grown);
  return code;
}

/* Compute the level set of a layer at a slightly higher intensity. The caller
   clears *out. */
static int print_lit(const eda_printer *p, int layer, eda_field *out,
                     opc_error *error) {
  *out = eda_field_scaled(&p->image[layer], 1);
  size_t n = (size_t)out->nx * (size_t)out->ny;
  for (size_t i = 0; i < n; i++) out->coefficients[i] += (float)tuned.light;
  return eda_printer_develop(p, layer, out, error);
}

/* Sensitivities of Ion to intensity, % per clear field: displacement of the
   edges in the middle of a gate times the sensitivity of the drawn gate. The
   sensitivity of the drawn gate is used, because the simulated Ion includes
   line ends that nearly open the channel with the drawn mask only. */
typedef struct sensitivities {
  const eda_printer *printer;
  const drawn *drawn;
  int layer;
  const eda_field *lit;
  double *by; /* [gates] */
} sensitivities;

static void find_sensitivity(void *data, size_t i) {
  const sensitivities *w = data;
  const eda_gates *g = w->drawn->gates;
  const eda_field *print = &w->printer->print[w->layer];
  const eda_field *image = &w->printer->image[w->layer];
  double size = w->layer == EDA_POLY ? g->length[i] : g->width[i];
  double more = eda_deviation(w->drawn->larger.ion[i], w->drawn->as_is.ion[i]);
  double from = eda_gate_section(g, i, w->layer, print, image).length;
  double to = eda_gate_section(g, i, w->layer, w->lit, image).length;
  w->by[i] = fabs(more / (tuned.larger * size) * (to - from) / tuned.light);
}

/* Return the third quartile of the sensitivities; NAN if no transistor
   prints. */
static double sensitivity(const eda_printer *p, const drawn *d, int layer,
                          const eda_field *lit) {
  size_t n = d->gates->count, count = 0;
  sensitivities w = {p, d, layer, lit, eda_alloc(n, sizeof *w.by)};
  opc_parallel(p->context, n, find_sensitivity, &w);
  for (size_t i = 0; i < n; i++)
    if (isfinite(w.by[i])) w.by[count++] = w.by[i];
  qsort(w.by, count, sizeof *w.by, eda_doubles_rise);
  double found = count ? w.by[3 * count / 4] : NAN;
  free(w.by);
  return found;
}

/* Round an error down to one of four values, to limit the number of kernel
   sets. */
static double error_rounded(double error) {
  static const double steps[] = {5e-4, 2e-4, 1e-4, 5e-5};
  size_t i = 0;
  while (i + 1 < G_N_ELEMENTS(steps) && steps[i] > error) i++;
  return fmin(fmax(steps[i], tuned.least), tuned.most);
}

static int set_layer(eda_printer *p, const opc_host *host, drawn *d, int layer,
                     double change, opc_error *error) {
  eda_field lit = {0};
  if (!p->image[layer].coefficients) return OPC_OK;
  int code = make_larger(d, layer, p->context, error);
  if (!code) code = print_lit(p, layer, &lit, error);
  double by = code ? NAN : sensitivity(p, d, layer, &lit);
  eda_field_clear(&lit);
  if (!(by > 0)) return code;
  p->fine_of[layer] = error_rounded(tuned.peak * change / by);
  host->log(host, OPC_LOG_DEBUG,
            "accurate simulations of '%s' within %.0e: 1e-4 of the clear field "
            "changes Ion by %.3f %%",
            d->gates->layer[layer], p->fine_of[layer], by * 1e-4);
  return OPC_OK;
}

int correct_fine_by_layer(eda_printer *p, const opc_host *host,
                          const eda_gates *g, const opc_module *extractor,
                          double change, opc_error *error) {
  drawn d = {.gates = g, .extractor = extractor};
  if (!(change > 0) || !(p->fine > 0) || !g->count) return OPC_OK;
  eda_performance_init(&d.as_is, g->count);
  eda_performance_init(&d.larger, g->count);
  int code = eda_measure_drawn(p->context, g, extractor, &d.as_is, error);
  for (int k = 0; k <= EDA_ACTIVE && !code; k++)
    code = set_layer(p, host, &d, k, change, error);
  eda_performance_clear(&d.as_is);
  eda_performance_clear(&d.larger);
  return code;
}

int correct_fine_by_drawn(eda_printer *p, const opc_host *host,
                          const eda_gates *g, const opc_module *extractor,
                          double change, opc_error *error) {
  if (!(change > 0) || !(p->fine > 0) || !g->count) return OPC_OK;
  int code = eda_printer_print(p, g->corrected, g->drawn, error);
  if (!code) code = correct_fine_by_layer(p, host, g, extractor, change, error);
  for (size_t k = 0; k < g->layers; k++) {
    eda_field_clear(&p->print[k]);
    eda_field_clear(&p->image[k]);
  }
  p->simulations = 0;
  return code;
}

/* Log a finding if a given margin causes a larger error than `needed`. */
static int margin_check(const opc_host *host, eda_scanner scanner,
                        double margin, double needed, opc_error *error) {
  double least = eda_natural(&scanner, tuned.nearest);
  double ratio = eda_natural(&scanner, FINE_MARGIN) / margin;
  double by = fmin(tuned.least * ratio * ratio, 1);
  if (margin < least)
    return opc_fail(error, OPC_INVALID, "margin",
                    "%g nm changes the intensity by up to %.1g of the clear "
                    "field; expected at least %g nm, and %g nm for the error "
                    "of these simulations",
                    margin, by, least, needed);
  if (margin < needed && scanner.wavelength > 0)
    host->log(host, OPC_LOG_FINDING,
              "margin %g nm changes the intensity by up to %.1g of the clear "
              "field; the error of these simulations requires %g nm",
              margin, by, needed);
  return OPC_OK;
}

int correct_fine_margin(const opc_host *host, const opc_module *litho,
                        double fine, double *margin, opc_error *error) {
  char whence[128];
  eda_scanner scanner = eda_scanner_of(litho);
  double needed = eda_natural(&scanner, tuned.near);
  if (fine > 0)
    needed = fmax(needed, round(eda_natural(&scanner, FINE_MARGIN) *
                                sqrt(tuned.least / fmax(fine, tuned.least))));
  if (!isnan(*margin))
    return margin_check(host, scanner, *margin, needed, error);
  *margin = needed;
  eda_natural_text(scanner, whence, sizeof whence);
  host->log(host, OPC_LOG_INFO, "margin %g nm, %s", needed, whence);
  return OPC_OK;
}
