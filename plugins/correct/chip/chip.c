/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `correct.chip`, the correction of a layout of any size by
   equivalence classes. Transistors are found window by window. One transistor
   of each class of equal drawn environments is corrected, and all transistors
   of the class receive its mask. Then one transistor of each class of equal
   masked environments is simulated. If its |Ion deviation| exceeds a part of
   the limit, the transistors of that class receive a mask of their own. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/fine.h>
#include <correct/report.h>
#include <correct/rules.h>
#include <correct/settings.h>
#include <correct/symmetry.h>
#include "work.h"

/* Tuned constants. */
static const struct {
  double radius_error, radius, gap;
  const char *margin;
} tuned = {
    /* The default of `radius` is the distance beyond which shapes change an
       image by less than this error (clear field 1; eda_margin): 1.04 um at 193
       nm, NA 0.75, sigma 0.75, The constant `radius`, nm, is the default for
       models of unknown bandwidth. The verification measures the remaining
       error. */
    .radius_error = 1e-3,
    .radius = 1000,

    /* Default of `margin`, nm, without accurate simulations. Shapes beyond the
       margin are omitted and treated as clear field. At 193 nm, NA 0.75, the
       largest error of Ion in an SRAM of 44 transistors is 1.5 % for 1 um, 0.25
       % for 2 um (this value) and 0.11 % for 4 um. */
    .margin = "7.772 lambda/NA",

    /* Distance of two clips on a sheet, nm; larger than any mask rule. */
    .gap = 500,
};

/* ---- state ---- */

typedef struct chip {
  const opc_host *host;
  const eda_layout *layout;
  const char *top;
  opc_map also, flavours;
  double grid, overhang, line_end;
  correct_settings with;
  int64_t rounds;
  double radius, window; /* nm */
} chip;

/* ---- work ---- */

void work_progress(const work *w, double part) {
  const opc_progress at = {.done = 100 * (w->done + part * w->share),
                           .total = 100,
                           .worst = w->worst,
                           .worst_unit = "%"};
  w->host->progress(w->host, &at);
}

/* Return the key of a stored result within a step. The other dependencies of
   the result are in the results of earlier rounds. */
static const char *sheets_key(void *data, size_t i) {
  sheets *s = data;
  g_free(s->key);
  return s->key = g_strdup_printf("%zu %zu", s->work->round, i);
}

static double sheets_cost(void *data, size_t i) {
  return ((const sheets *)data)->pages.area[i];
}

static void sheets_done(void *data, size_t done) {
  sheets *s = data;
  s->done = done;
  work_progress(s->work, (double)done / (double)s->pages.count);
}

int work_sheets(sheets *s, int32_t reach, opc_pieces jobs, opc_error *error) {
  work *w = s->work;
  int32_t most = w->window + 2 * reach;
  double area = 0, um = w->chip->grid / 1000;
  eda_box *box = eda_alloc(s->count, sizeof *box);
  for (size_t i = 0; i < s->count; i++)
    box[i] = w->chip->gate[s->number[i]].box;
  cover_make(box, s->count, reach, most, &s->cover);
  free(box);
  pages_make(&s->cover, most, w->gap, &s->pages);
  w->sheets += s->pages.count;
  for (size_t i = 0; i < s->pages.count; i++) area += s->pages.area[i];
  w->host->log(w->host, OPC_LOG_INFO,
               "%zu transistors in %zu clips of %.0f um^2, on %zu sheets",
               s->count, s->cover.count, area * um * um, s->pages.count);
  jobs.data = s;
  jobs.count = s->pages.count;
  jobs.key = sheets_key;
  jobs.cost = sheets_cost;
  jobs.done = sheets_done;
  int code = opc_do_pieces(w->host, &jobs, error);
  pages_clear(&s->pages);
  cover_clear(&s->cover);
  g_free(s->key);
  return code;
}

/* Start a phase. `share`: estimated part of the run time, 0 to 1. */
static int work_phase(work *w, double share, opc_error *error) {
  w->done += w->share;
  w->share = share;
  if (opc_cancelled(w->host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  return OPC_OK;
}

/* Find the prints that exceed the limit and were not yet corrected
   individually. Returns the number of these prints. */
static size_t find_failing(work *w, uint32_t *prints) {
  const eda_chip *c = w->chip;
  uint8_t *used = eda_alloc(c->prints, 1);
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) used[c->gate[i].print] = 1;
  for (size_t k = 0; k < c->prints; k++) {
    if (!used[k] || w->tried[k] || isnan(print_beyond(w, &c->print[k])))
      continue;
    w->tried[k] = 1;
    prints[n++] = (uint32_t)k;
  }
  free(used);
  return n;
}

static int work_refine(work *w, int *done, opc_error *error) {
  uint32_t *prints = eda_alloc(w->chip->prints, sizeof *prints);
  size_t n = find_failing(w, prints);
  *done = !n;
  if (n)
    w->host->log(w->host, OPC_LOG_INFO,
                 "%zu of %zu verified transistors deviate and are corrected "
                 "individually",
                 n, w->chip->prints);
  int code = n ? correct_prints(w, prints, n, error) : OPC_OK;
  free(prints);
  return code;
}

static int work_all(work *w, opc_error *error) {
  int done = 0;
  int code = work_phase(w, 0.1, error);
  if (!code) code = scan_all(w, error);
  if (code) return code;
  w->host->log(w->host, OPC_LOG_INFO,
               "%zu transistors in %zu windows: %zu different environments "
               "within %.4g nm",
               w->chip->count, w->windows, w->classes,
               w->radius * w->chip->grid);
  representatives_choose(w);
  code = work_phase(w, 0.6, error);
  if (!code) code = correct_classes(w, error);
  if (!code) code = work_phase(w, 0.2, error);
  if (!code) code = verify_all(w, error);
  for (w->round = 1; !code && !done && (int64_t)w->round <= w->rounds;
       w->round++) {
    code = work_phase(w, 0.1 / (double)w->rounds, error);
    if (!code) code = work_refine(w, &done, error);
    if (!code && !done) code = verify_all(w, error);
  }
  return code ? code : report_all(w, error);
}

static int32_t in_steps(double nm, double grid) {
  return (int32_t)fmin(ceil(nm / grid), 1 << 28);
}

static double radius_of(const chip *c) {
  if (!isnan(c->radius)) return c->radius;
  const eda_litho *litho = c->with.litho->functions;
  double band = litho->band(c->with.litho->self);
  return band > 0 ? eda_margin(band, tuned.radius_error) : tuned.radius;
}

static void work_init(const chip *c, eda_chip *out, work *w) {
  double radius = radius_of(c);
  *w = (work){.host = c->host,
              .with = &c->with,
              .faults = faults_new(),
              .margin = in_steps(c->with.margin, c->grid),
              .radius = in_steps(radius, c->grid),
              .window = in_steps(c->window, c->grid),
              .gap = in_steps(tuned.gap, c->grid),
              .rounds = c->rounds,
              .chip = out,
              .prints = work_sums(),
              .sums = g_ptr_array_new_with_free_func(g_free),
              .worst = NAN};
}

static void work_clear(work *w) {
  free(w->found);
  free(w->first);
  free(w->before);
  g_hash_table_destroy(w->prints);
  g_ptr_array_free(w->sums, TRUE);
  free(w->print_first);
  free(w->tried);
  faults_free(w->faults);
}

static void take_layers(const eda_gates *g, eda_chip *out) {
  out->layers = g->layers;
  out->layer = eda_alloc(g->layers, sizeof *out->layer);
  out->corrected = eda_alloc(g->layers, 1);
  for (size_t k = 0; k < g->layers; k++) {
    size_t size = strlen(g->layer[k]) + 1;
    out->layer[k] = memcpy(eda_alloc(size, 1), g->layer[k], size);
    out->corrected[k] = g->corrected[k];
  }
}

/* Prepare the models before any sheet, because their messages belong to no work
   unit. */
static int chip_prepare(const chip *c, const eda_gates *g, opc_error *error) {
  eda_printer printer;
  eda_printer_init(&printer, c->host->context, g, c->with.litho, c->with.resist,
                   c->with.margin);
  printer.fine = c->with.fine;
  printer.drawn = NULL; /* no calibration with these transistors */
  int code = eda_printer_prepare(&printer, error);
  eda_printer_clear(&printer);
  return code ? code
              : eda_extractor_prepare(c->host->context, c->with.extractor,
                                      error);
}

/* Read the layers from an empty window, because the layers of all windows are
   equal. `prepare`: 1: prepare the models. */
static int chip_begin(const chip *c, eda_chip *out, int prepare,
                      opc_error *error) {
  static const eda_box nowhere = {0, 0, 1, 1};
  eda_gates *g;
  out->layout = c->layout;
  out->grid = c->grid;
  out->segment = (eda_segment_settings)EDA_SEGMENT_SETTINGS(c);
  out->top = eda_segment_top(c->layout, c->top, error);
  if (out->top < 0) return error->code;
  int code = eda_segment_window(out->layout, out->top, &out->segment, &nowhere,
                                &g, error);
  if (code) return code;
  take_layers(g, out);
  if (prepare) code = chip_prepare(c, g, error);
  eda_gates_free(g);
  return code;
}

static int find_symmetry(work *w, opc_error *error) {
  int code = correct_symmetry_find(w->host->context, w->with->litho,
                                   &w->orientations, error);
  if (code) return code;
  if (w->orientations < 8)
    w->host->log(
        w->host, OPC_LOG_INFO,
        "the optics image %d of 8 orientations of a transistor equally",
        w->orientations);
  return OPC_OK;
}

static int chip_run(void *self, void **outputs, opc_error *error) {
  const chip *c = self;
  work w;
  eda_chip *out = eda_alloc(1, sizeof *out);
  outputs[0] = out; /* released by the host on failure */
  int code = chip_begin(c, out, 1, error);
  if (code) return code;
  work_init(c, out, &w);
  code = find_symmetry(&w, error);
  if (!code) code = work_all(&w, error);
  work_clear(&w);
  return code;
}

/* Make a chip with its layers but without transistors, for the forecast of
   later steps. */
static int chip_sketch(void *self, void **outputs, opc_error *error) {
  eda_chip *out = eda_alloc(1, sizeof *out);
  outputs[0] = out;
  out->gate = eda_alloc(1, sizeof *out->gate);
  out->mask = eda_alloc(1, sizeof *out->mask);
  out->print = eda_alloc(1, sizeof *out->print);
  return chip_begin(self, out, 0, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(
        chip, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
        .choices = "layout",
        .summary = "Layout with the layers required by segment.transistors"),
    OPC_PARAMETER(
        chip, top, .type = OPC_TEXT,
        .summary = "Top cell (default: the only cell that no other places)"),
    EDA_SEGMENT_PARAMETERS(chip),
    CORRECT_PRINT_SLOTS(chip),
    CORRECT_MOVE_SLOTS(chip),
    CORRECT_MAX_ITERATIONS(chip, "Largest number of iterations for a sheet"),
    OPC_PARAMETER(chip, radius, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .min = 0,
                  .summary =
                      "Distance within which equal shapes result in "
                      "equal masks (default: range of an optical effect of "
                      "1e-3 of the clear field, 7.1 / bandwidth)"),
    OPC_PARAMETER_NAMED(
        "margin", chip, with.margin, .type = OPC_REAL, .flags = OPC_ABOVE,
        .unit = "nm", .min = 0,
        .summary = "Range of optical interaction around a transistor (default: "
                   "as required by 'fine')"),
    OPC_PARAMETER(
        chip, window, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
        .preset = "60 um", .min = 1000,
        .summary =
            "Side of a window; larger windows take more memory and less time"),
    OPC_PARAMETER(
        chip, rounds, .type = OPC_INT, .flags = OPC_AT_LEAST | OPC_AT_MOST,
        .preset = "2", .min = 0, .max = 20,
        .summary = "Largest number of rounds in which groups of transistors "
                   "above half of 'ion_limit' are corrected again"),
    CORRECT_FINE(chip),
    CORRECT_GUARD(chip),
    CORRECT_ION_LIMIT(chip,
                      "Largest allowed |Ion deviation|; groups of transistors "
                      "above half of the limit are corrected individually"),
    RULES_PARAMETERS(chip),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0,
     "number of transistors of the layout"},
    {"windows", NULL, OPC_NEUTRAL, 0, "number of windows"},
    {"classes", NULL, OPC_LOWER, 0,
     "different drawn environments within 'radius'"},
    {"prints", NULL, OPC_LOWER, 0,
     "different masked environments within 'margin', equal to the number of "
     "verified transistors"},
    {"refined", NULL, OPC_LOWER, 0,
     "groups of transistors corrected individually after a verification"},
    {"sheets", NULL, OPC_LOWER, 0,
     "number of sheets that were corrected or simulated"},
    REPORT_METRICS,
    REPORT_DRAWN_METRICS,
    {"simulations", NULL, OPC_LOWER, 0,
     "litho simulations of one layer of a sheet each"},
    {"fine_simulations", NULL, OPC_LOWER, 0,
     "additional simulations of the accurate model"},
    REPORT_PRINT_METRICS,
    REPORT_JUDGED_METRICS,
    RULES_METRICS,
};

static int chip_check(void *self, opc_error *error) {
  chip *c = self;
  eda_scanner scanner = eda_scanner_of(c->with.litho);
  int code = correct_fine_error(c->with.fine_text, c->with.ion_limit,
                                &c->with.fine, error);
  if (isnan(c->with.margin) && !(c->with.fine > 0))
    c->with.margin = eda_natural(&scanner, tuned.margin);
  if (!code)
    code = correct_fine_margin(c->host, c->with.litho, c->with.fine,
                               &c->with.margin, error);
  EDA_FOLLOW(c->host, "correct.chip", c, parameters, scanner);
  if (!code && c->also.count)
    return opc_fail(
        error, OPC_INVALID, "also",
        "correct.chip corrects poly and active only: remove 'also'");
  if (!code && c->radius > c->window)
    return opc_fail(error, OPC_INVALID, "radius",
                    "'radius' is %.4g nm, expected at most 'window', %.4g nm",
                    c->radius, c->window);
  return code;
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_CHIP("chip")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = chip_run,
                                   .sketch = chip_sketch,
                                   .flags = OPC_STEP_PIECES};

OPC_PLUGIN(
    chip, .id = "correct.chip", .kind = "step", .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary =
        "correct a layout of any size by equivalence classes of transistors",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = chip_check, OPC_FUNCTIONS(functions));
