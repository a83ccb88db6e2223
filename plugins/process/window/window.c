/* SPDX-License-Identifier: BSD-3-Clause */
/* process.window: the gates of a mask, printed at a list of doses and foci
   (Bossung curves; exposure latitude and depth of focus: C. A. Mack,
   "Fundamental Principles of Optical Lithography", 2007, chapter 8). */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <opcflow/litho.h>

#include "../../draw/mask/paper.h"
#include "window.h"

/* ---- state ---- */

enum {
  MASK,
  GATES,
  LITHO,
  RESIST,
  DOSE,
  DEFOCUS,
  TOLERANCE,
  MARGIN,
  CUT_LINES,
  FILE_NAME,
  PARAMETERS
};

enum { MAX_PLACES = 100 };

typedef struct window {
  const opc_host *host;
  const opc_value *values;
  int format; /* PAPER_PNG and so on */
} window;

/* One run. */
typedef struct run_state {
  const window *w;
  const opc_module *litho, *resist;
  const opc_shapes *shapes;
  window_results results;
} run_state;

/* ---- work: prints ---- */

static int image_at(const run_state *s, const opc_spectrum *mask,
                    double defocus, opc_field *out, opc_error *error) {
  const opc_litho *model = s->litho->plugin->operations;
  const opc_host *host = s->w->host;
  int has = model->size > offsetof(opc_litho, image_at) && model->image_at;
  if (defocus == 0)
    return model->image(s->litho->self, OPC_POLY, mask, out, error);
  if (!has)
    return host->fail(host, error, OPC_INVALID, "defocus",
                      "'%s' has one focus only: say defocus: [0 nm]",
                      s->litho->plugin->id);
  return model->image_at(s->litho->self, OPC_POLY, mask, defocus, out, error);
}

/* The image at a dose, and what it prints. Both are released by the caller. */
static int print_at(const run_state *s, const opc_field *image, double dose,
                    opc_field *scaled, opc_field *print, opc_error *error) {
  const opc_host *host = s->w->host;
  const opc_resist *model = s->resist->plugin->operations;
  size_t n = (size_t)image->nx * (size_t)image->ny;
  float factor = (float)(1 + dose / 100);
  *scaled = *print = *image;
  scaled->coefficients = host->alloc(host, n, sizeof(float));
  print->coefficients = host->alloc(host, n, sizeof(float));
  if (!scaled->coefficients || !print->coefficients)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < n; i++)
    scaled->coefficients[i] = factor * image->coefficients[i];
  memcpy(print->coefficients, scaled->coefficients, n * sizeof(float));
  return model->print(s->resist->self, OPC_POLY, print, error);
}

static int cut_focus(const run_state *s, const opc_spectrum *mask, size_t f,
                     opc_error *error) {
  const opc_host *host = s->w->host;
  const window_results *r = &s->results;
  opc_field image = {0};
  int code = image_at(s, mask, r->focus[f], &image, error);
  for (size_t d = 0; d < r->doses && !code; d++) {
    opc_field scaled = {0}, print = {0};
    code = print_at(s, &image, r->dose[d], &scaled, &print, error);
    if (!code)
      window_cuts(host, r->gates, &print, &scaled,
                  r->cuts + (f * r->doses + d) * r->gates->count);
    host->imaging->release_field(host, &scaled);
    host->imaging->release_field(host, &print);
  }
  host->imaging->release_field(host, &image);
  return code;
}

static int cut_all(const run_state *s, opc_error *error) {
  const opc_host *host = s->w->host;
  const window_results *r = &s->results;
  const opc_gates *g = r->gates;
  const opc_litho *model = s->litho->plugin->operations;
  double margin = s->w->values[MARGIN].real;
  opc_box b = g->extent;
  opc_frame frame = {b.x0 * g->grid - margin, b.y0 * g->grid - margin,
                     ((double)b.x1 - b.x0) * g->grid + 2 * margin,
                     ((double)b.y1 - b.y0) * g->grid + 2 * margin};
  opc_spectrum mask;
  int code =
      host->imaging->mask_spectrum(host, s->shapes, g->grid, frame,
                                   model->band(s->litho->self), &mask, error);
  if (code) return code;
  for (size_t f = 0; f < r->foci && !code; f++) {
    opc_progress progress = {.size = sizeof progress,
                             .done = (double)f,
                             .total = (double)r->foci,
                             .worst = (double)NAN};
    host->progress(host, &progress);
    if (host->cancelled(host))
      code = host->fail(host, error, OPC_CANCELLED, NULL, "stopped");
    else
      code = cut_focus(s, &mask, f, error);
  }
  host->imaging->release_spectrum(host, &mask);
  return code;
}

/* ---- work: tables and metrics ---- */

/* What all gates have at one dose and focus. */
typedef struct summary {
  double mean, min, max; /* deviation, nm */
  double nils;           /* the least: drawn length times log slope */
  int64_t failed;
} summary;

static summary summarise(const window_results *r, size_t f, size_t d) {
  summary s = {0, INFINITY, -INFINITY, INFINITY, 0};
  size_t n = r->gates->count, good = 0;
  for (size_t i = 0; i < n; i++) {
    window_cut c = r->cuts[(f * r->doses + d) * n + i];
    double drawn = r->gates->length[i];
    if (isnan(c.length)) {
      s.failed++;
      continue;
    }
    good++;
    s.mean += c.length - drawn;
    s.min = fmin(s.min, c.length - drawn);
    s.max = fmax(s.max, c.length - drawn);
    s.nils = fmin(s.nils, drawn * fmin(c.low, c.high));
  }
  if (!good) return (summary){NAN, NAN, NAN, NAN, s.failed};
  s.mean /= (double)good;
  return s;
}

/* Room for `columns` columns of `rows` numbers. */
static double *make_columns(const opc_host *host, size_t columns, size_t rows,
                            opc_error *error) {
  double *room = NULL;
  if (rows <= SIZE_MAX / columns / sizeof *room)
    room = host->alloc(host, columns * rows, sizeof *room);
  if (!room) host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  return room;
}

static int window_table(const opc_host *host, const window_results *r,
                        opc_error *error) {
  size_t rows = r->doses * r->foci;
  double *c = make_columns(host, 6, rows, error);
  int64_t *failed = host->alloc(host, rows, sizeof *failed);
  if (!c || !failed) {
    host->free(host, c);
    host->free(host, failed);
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  }
  for (size_t k = 0; k < rows; k++) {
    size_t f = k / r->doses, d = k % r->doses;
    summary s = summarise(r, f, d);
    const double all[] = {r->focus[f], r->dose[d], s.mean,
                          s.min,       s.max,      s.nils};
    for (size_t i = 0; i < 6; i++) c[i * rows + k] = all[i];
    failed[k] = s.failed;
  }
  const opc_column columns[] = {{"defocus", "nm", OPC_REAL, -1, c},
                                {"dose", "%", OPC_REAL, -1, c + rows},
                                {"mean", "nm", OPC_REAL, 2, c + 2 * rows},
                                {"min", "nm", OPC_REAL, 2, c + 3 * rows},
                                {"max", "nm", OPC_REAL, 2, c + 4 * rows},
                                {"nils", NULL, OPC_REAL, 3, c + 5 * rows},
                                {"failed", NULL, OPC_INT, 0, failed}};
  int code = host->table(host, "process_window", OPC_TABLE_PRINT, rows, columns,
                         7, error);
  host->free(host, c);
  host->free(host, failed);
  return code;
}

static int latitude_table(const opc_host *host, const window_results *r,
                          opc_error *error) {
  double *width = make_columns(host, 1, r->foci, error);
  if (!width) return error->code;
  for (size_t f = 0; f < r->foci; f++)
    width[f] = isnan(r->low[f]) ? 0 : r->high[f] - r->low[f];
  const opc_column columns[] = {{"defocus", "nm", OPC_REAL, -1, r->focus},
                                {"lowest_dose", "%", OPC_REAL, 2, r->low},
                                {"highest_dose", "%", OPC_REAL, 2, r->high},
                                {"latitude", "%", OPC_REAL, 2, width}};
  int code = host->table(host, "exposure_latitude", OPC_TABLE_PRINT, r->foci,
                         columns, 4, error);
  host->free(host, width);
  return code;
}

static int cut_table(const opc_host *host, const window_results *r,
                     opc_error *error) {
  enum { COLUMNS = 9 };
  size_t n = r->gates->count, rows = r->doses * r->foci * n;
  double *c = make_columns(host, COLUMNS, rows, error);
  if (!c) return error->code;
  for (size_t k = 0; k < rows; k++) {
    size_t i = k % n, d = k / n % r->doses, f = k / n / r->doses;
    const opc_gates *g = r->gates;
    window_cut cut = r->cuts[k];
    const double all[COLUMNS] = {
        ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
        ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid,
        r->focus[f],
        r->dose[d],
        g->length[i],
        cut.length,
        cut.low,
        cut.high,
        g->length[i] * fmin(cut.low, cut.high)};
    for (size_t q = 0; q < COLUMNS; q++) c[q * rows + k] = all[q];
  }
  static const struct {
    const char *name, *unit;
    int32_t decimals;
  } heads[COLUMNS] = {
      {"x", "nm", -1},        {"y", "nm", -1},         {"defocus", "nm", -1},
      {"dose", "%", -1},      {"drawn", "nm", -1},     {"printed", "nm", 3},
      {"ils_low", "1/nm", 6}, {"ils_high", "1/nm", 6}, {"nils", NULL, 4}};
  opc_column columns[COLUMNS];
  for (size_t q = 0; q < COLUMNS; q++)
    columns[q] = (opc_column){heads[q].name, heads[q].unit, OPC_REAL,
                              heads[q].decimals, c + q * rows};
  int code = host->table(host, "cut_lines", 0, rows, columns, COLUMNS, error);
  host->free(host, c);
  return code;
}

static int report(const run_state *s, opc_error *error) {
  const opc_host *host = s->w->host;
  const window_results *r = &s->results;
  double latitude = 0, nils = INFINITY, failed = 0;
  for (size_t f = 0; f < r->foci; f++)
    if (!isnan(r->low[f])) latitude = fmax(latitude, r->high[f] - r->low[f]);
  for (size_t k = 0; k < r->foci * r->doses; k++) {
    summary one = summarise(r, k / r->doses, k % r->doses);
    if (!isnan(one.nils)) nils = fmin(nils, one.nils);
    failed = fmax(failed, (double)one.failed);
  }
  double depth = isnan(r->depth_low) ? 0 : r->depth_high - r->depth_low;
  int code = window_table(host, r, error);
  if (!code) code = latitude_table(host, r, error);
  if (!code && s->w->values[CUT_LINES].integer)
    code = cut_table(host, r, error);
  if (!code) code = host->metric(host, "exposure_latitude", latitude, error);
  if (!code) code = host->metric(host, "depth_of_focus", depth, error);
  if (!code && isfinite(nils))
    code = host->metric(host, "nils_min", nils, error);
  if (!code) code = host->metric(host, "failed_max", failed, error);
  return code;
}

/* ---- work: a run ---- */

static int draw(const run_state *s, opc_error *error) {
  const opc_value *file = &s->w->values[FILE_NAME];
  const opc_host *host = s->w->host;
  const char *path = host->output_path(host, file->text, error);
  if (!path) return error->code;
  return window_draw(host, &s->results, s->w->format, path, error);
}

/* What is measured: a corrected mask, or the gates as drawn. */
static int choose_shapes(run_state *s, opc_error *error) {
  const opc_host *host = s->w->host;
  const opc_mask *mask = s->w->values[MASK].object;
  const opc_gates *gates = s->w->values[GATES].object;
  if (!mask == !gates) {
    host->fail(host, error, OPC_INVALID, "mask",
               "one of 'mask' and 'gates' is needed, and not both");
    return OPC_INVALID;
  }
  s->results.gates = mask ? mask->gates : gates;
  s->shapes = mask ? &mask->shapes[OPC_POLY] : &gates->drawn[OPC_POLY];
  if (!s->results.gates->count)
    return host->fail(host, error, OPC_INVALID, mask ? "mask" : "gates",
                      "there are no transistors to measure");
  return OPC_OK;
}

static int make_results(const run_state *s, window_results *r,
                        opc_error *error) {
  const opc_host *host = s->w->host;
  const opc_value *v = s->w->values;
  r->dose = v[DOSE].reals;
  r->doses = v[DOSE].count;
  r->focus = v[DEFOCUS].reals;
  r->foci = v[DEFOCUS].count;
  r->tolerance = v[TOLERANCE].real;
  for (size_t d = 0; d < r->doses; d++)
    if (fabs(r->dose[d]) < fabs(r->dose[r->nominal])) r->nominal = d;
  size_t places = r->doses * r->foci;
  if (places && r->gates->count <= SIZE_MAX / places)
    r->cuts = host->alloc(host, places * r->gates->count, sizeof *r->cuts);
  r->low = host->alloc(host, r->foci, sizeof *r->low);
  r->high = host->alloc(host, r->foci, sizeof *r->high);
  if (r->cuts && r->low && r->high) return OPC_OK;
  return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
}

static int run(void *self, void **outputs, opc_error *error) {
  const window *w = self;
  const opc_host *host = w->host;
  (void)outputs;
  run_state s = {.w = w,
                 .litho = w->values[LITHO].object,
                 .resist = w->values[RESIST].object};
  const opc_litho *litho = s.litho->plugin->operations;
  const opc_resist *resist = s.resist->plugin->operations;
  int code = choose_shapes(&s, error);
  if (!code) code = make_results(&s, &s.results, error);
  if (!code) code = litho->prepare(s.litho->self, error);
  if (!code) code = resist->prepare(s.resist->self, s.litho, error);
  if (!code) code = cut_all(&s, error);
  if (!code) {
    window_limits(&s.results);
    code = report(&s, error);
  }
  if (!code) code = draw(&s, error);
  host->free(host, s.results.cuts);
  host->free(host, s.results.low);
  host->free(host, s.results.high);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .choices = "mask",
              .summary = "a corrected mask whose gates are measured"},
    [GATES] = {.name = "gates",
               .type = OPC_INPUT,
               .choices = "gates",
               .summary = "in its place: gates on the mask as drawn"},
    [LITHO] = {.name = "litho",
               .type = OPC_SLOT,
               .flags = OPC_REQUIRED,
               .choices = "litho",
               .summary = "model of the optics"},
    [RESIST] = {.name = "resist",
                .type = OPC_SLOT,
                .flags = OPC_REQUIRED,
                .choices = "resist",
                .summary = "model of the resist, calibrated at 0 % and 0 nm"},
    [DOSE] = {.name = "dose",
              .type = OPC_REALS,
              .unit = "%",
              .preset = "[-8 %, -4 %, 0 %, 4 %, 8 %]",
              .summary = "more or less light, increasing"},
    [DEFOCUS] = {.name = "defocus",
                 .type = OPC_REALS,
                 .unit = "nm",
                 .preset = "[-100 nm, -50 nm, 0 nm, 50 nm, 100 nm]",
                 .summary = "distances from the focus of litho, increasing"},
    [TOLERANCE] = {.name = "tolerance",
                   .type = OPC_REAL,
                   .flags = OPC_ABOVE,
                   .unit = "%",
                   .preset = "10 %",
                   .min = 0,
                   .summary =
                       "of the drawn length, that a print may be off by"},
    [MARGIN] = {.name = "margin",
                .type = OPC_REAL,
                .flags = OPC_AT_LEAST,
                .unit = "nm",
                .preset = "1000 nm",
                .min = 0,
                .summary =
                    "clear field around the layout, which repeats beyond"},
    [CUT_LINES] = {.name = "cut_lines",
                   .type = OPC_BOOL,
                   .preset = "false",
                   .summary = "whether to write a table of every gate's cuts"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "process_window.png",
                   .summary = "the picture, .png, .svg or .pdf"},
};

static const opc_metric metrics[] = {
    {.name = "exposure_latitude",
     .unit = "%",
     .better = OPC_HIGHER,
     .tolerance = 0.05,
     .summary = "range of dose within tolerance, at the focus with most"},
    {.name = "depth_of_focus",
     .unit = "nm",
     .better = OPC_HIGHER,
     .tolerance = 0.5,
     .summary = "range of focus within tolerance, at the dose nearest to 0 %"},
    {.name = "nils_min",
     .better = OPC_HIGHER,
     .tolerance = 0.001,
     .summary = "least normalised image log slope of all gates and prints"},
    {.name = "failed_max",
     .better = OPC_LOWER,
     .summary = "gates that are open or merged, in the worst print"},
};

static int check_list(const opc_host *host, const char *name,
                      const opc_value *v, double above, opc_error *error) {
  if (!v->count || v->count > MAX_PLACES)
    return host->fail(host, error, OPC_INVALID, name,
                      "'%s' needs 1 to %d values, not %zu", name, MAX_PLACES,
                      v->count);
  for (size_t i = 0; i < v->count; i++)
    if (!isfinite(v->reals[i]) || v->reals[i] <= above)
      return host->fail(host, error, OPC_INVALID, name,
                        "'%s' of %g is out of range", name, v->reals[i]);
  for (size_t i = 1; i < v->count; i++)
    if (!(v->reals[i] > v->reals[i - 1]))
      return host->fail(host, error, OPC_INVALID, name,
                        "'%s' must increase, %g comes after %g", name,
                        v->reals[i], v->reals[i - 1]);
  return OPC_OK;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const char *file = values[FILE_NAME].text;
  if (check_list(host, "dose", &values[DOSE], -100, error) ||
      check_list(host, "defocus", &values[DEFOCUS], -1e6, error))
    return NULL;
  if (paper_format(file) < 0) {
    host->fail(host, error, OPC_INVALID, "file",
               "'%s' is not the name of a .png, .svg or .pdf file", file);
    return NULL;
  }
  window *w = calloc(1, sizeof *w);
  if (!w) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  *w = (window){.host = host, .values = values, .format = paper_format(file)};
  return w;
}

static void destroy(void *self) { free(self); }

/* ---- entry ---- */

static const opc_step operations = {
    .size = sizeof operations, .port_size = sizeof(opc_port), .run = run};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "process.window",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "gate lengths and image slopes through dose and focus",
      .kind = OPC_KIND_STEP,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
