/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the correction by classes: transistors are found window by window.
   One transistor of each class of equal drawn environments is corrected, and
   all transistors of the class receive its mask. One transistor of each class
   of equal masked environments, called a print, is simulated. If its |Ion
   deviation| exceeds a part of the limit, the transistors of that class receive
   a mask of their own. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/fine.h>
#include <correct/symmetry.h>
#include "window.h"
#include "work.h"

/* Tuned constants. */
static const struct {
  double radius_error, radius;
  const char *margin;
} tuned = {
    /* The default of `radius` is the distance beyond which shapes change an
       image by less than this error (relative to the clear field;
       eda_margin): 1.04 um at 193 nm, NA 0.75, sigma 0.75. The constant
       `radius`, nm, is the default for models of unknown bandwidth. The
       verification measures the remaining error. */
    .radius_error = 1e-3,
    .radius = 1000,

    /* Default of `margin`, nm, without accurate simulations. Shapes beyond the
       margin are omitted and treated as clear field. At 193 nm, NA 0.75, the
       largest error of Ion in an SRAM of 44 transistors is 1.5 % for 1 um, 0.25
       % for 2 um (this value) and 0.11 % for 4 um. */
    .margin = "7.772 lambda/NA",
};

/* ---- work ---- */

void work_progress(const work *w, double part) {
  const opc_progress at = {.done = 100 * (w->done + part * w->share),
                           .total = 100,
                           .worst = w->worst,
                           .worst_unit = "%"};
  w->host->progress(w->host, &at);
}

/* Return the key of a work unit within the step: round and sheet. The other
   data on which the result depends are parameters of the step, or results of
   earlier rounds. */
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
    if (!used[k] || w->tried[k] ||
        isnan(print_beyond(w, &c->gate[w->print_first[k]])))
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

/* Refine the masks of cells where the neighbours disturb them. The loop itself
   finds these transistors in its first simulation. */
static int refine_placed(work *w, opc_error *error) {
  prints_find(w);
  uint32_t *prints = eda_alloc(w->chip->prints, sizeof *prints);
  for (size_t k = 0; k < w->chip->prints; k++) prints[k] = (uint32_t)k;
  int code = correct_prints(w, prints, w->chip->prints, error);
  free(prints);
  prints_clear(w);
  w->round++;
  return code;
}

static int work_all(work *w, opc_error *error) {
  int done = 0;
  w->host->log(w->host, OPC_LOG_INFO,
               "%zu transistors in %zu windows: %zu different environments "
               "within %.4g nm",
               w->chip->count, w->windows, w->classes,
               w->radius * w->chip->grid);
  representatives_choose(w);
  int code = work_phase(w, 0.6, error);
  if (!code) code = correct_classes(w, error);
  if (!code) code = work_phase(w, 0.2, error);
  done = w->cells.used && !w->cells.verify;
  if (!code && !done && w->rounds && work_continues(w))
    code = refine_placed(w, error);
  if (!code) code = verify_all(w, error);
  for (w->round++; !code && !done && (int64_t)w->round <= w->rounds;
       w->round++) {
    code = work_phase(w, 0.1 / (double)w->rounds, error);
    if (!code) code = work_refine(w, &done, error);
    if (!code && !done) code = verify_all(w, error);
  }
  return code;
}

static int32_t in_steps(double nm, double grid) {
  return (int32_t)fmin(ceil(nm / grid), 1 << 28);
}

double correct_classes_margin(const correct_settings *with, double margin) {
  eda_scanner scanner = eda_scanner_of(with->litho);
  if (!isnan(margin)) return margin;
  return with->fine > 0 ? with->margin : eda_natural(&scanner, tuned.margin);
}

static double radius_of(const classes_request *r) {
  if (!isnan(r->radius)) return r->radius;
  const eda_litho *litho = r->with->litho->functions;
  double band = litho->band(r->with->litho->self);
  return band > 0 ? eda_margin(band, tuned.radius_error) : tuned.radius;
}

static void work_init(work *w, const classes_request *r) {
  double grid = r->segment.grid;
  *w = (work){.host = r->host,
              .with = r->with,
              .faults = faults_new(),
              .margin = in_steps(r->margin, grid),
              .radius = in_steps(radius_of(r), grid),
              .window = in_steps(r->window, grid),
              .gap = in_steps(CLASSES_GAP, grid),
              .rounds = r->rounds,
              .sample = r->sample,
              .orientations = 8,
              .cells = r->cells,
              .chip = eda_alloc(1, sizeof *w->chip),
              .prints = work_sums(),
              .sums = g_ptr_array_new_with_free_func(g_free),
              .worst = NAN};
}

void correct_classes_free(division *w) {
  if (!w) return;
  eda_chip_free(w->chip);
  free(w->first);
  free(w->before);
  free(w->alone);
  free(w->kind);
  free(w->print);
  g_hash_table_destroy(w->prints);
  g_ptr_array_free(w->sums, TRUE);
  free(w->print_first);
  free(w->tried);
  faults_free(w->faults);
  free(w);
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
static int prepare_models(const classes_request *r, const eda_gates *g,
                          opc_error *error) {
  eda_printer printer;
  eda_printer_init(&printer, r->host->context, g, r->with->litho,
                   r->with->resist, r->margin);
  printer.fine = r->with->fine;
  printer.drawn = NULL; /* no calibration with these transistors */
  int code = eda_printer_prepare(&printer, error);
  eda_printer_clear(&printer);
  return code ? code
              : eda_extractor_prepare(r->host->context, r->with->extractor,
                                      error);
}

/* Read the layers from an empty window; the layers of all windows are equal. If
   `prepare` is 1, prepare the models. */
static int chip_begin(const classes_request *r, eda_chip *out, int prepare,
                      opc_error *error) {
  static const eda_box nowhere = {0, 0, 1, 1};
  eda_gates *g;
  out->layout = r->layout;
  out->grid = r->segment.grid;
  out->segment = r->segment;
  out->placed = r->cells.used;
  out->top = eda_segment_top(r->layout, r->top, error);
  if (out->top < 0) return error->code;
  int code = eda_segment_window(out->layout, out->top, &out->segment, &nowhere,
                                &g, error);
  if (code) return code;
  take_layers(g, out);
  if (prepare) code = prepare_models(r, g, error);
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

int correct_classes_find(const classes_request *r, division **out,
                         opc_error *error) {
  work *w = *out = eda_alloc(1, sizeof *w);
  work_init(w, r);
  int code = chip_begin(r, w->chip, !r->sample, error);
  if (!code && !r->sample) code = find_symmetry(w, error);
  if (!code) code = work_phase(w, 0.1, error);
  return code ? code : scan_all(w, error);
}

size_t correct_classes_count(const division *w, size_t *transistors) {
  *transistors = w->chip->count;
  return w->classes;
}

int correct_classes_correct(division *w, const classes_source *source,
                            void **mask, opc_error *error) {
  int code = work_all(w, error);
  if (code) return code;
  eda_mask *m = *mask = report_mask(w);
  correct_classes_access(m, source);
  faults_put(w, m);
  code = report_all(w, m, error);
  w->chip = NULL; /* belongs to the mask */
  return code;
}

/* ---- other masks by classes ---- */

int correct_classes_sketch(const classes_request *r,
                           const classes_source *source, void **mask,
                           opc_error *error) {
  eda_chip *c = eda_alloc(1, sizeof *c);
  int code = chip_begin(r, c, 0, error);
  if (code) {
    eda_chip_free(c);
    return code;
  }
  c->gate = eda_alloc(1, sizeof *c->gate);
  c->mask = eda_alloc(1, sizeof *c->mask);
  eda_mask *m = *mask = eda_chip_mask_new(c);
  correct_classes_access(m, source);
  return OPC_OK;
}

int correct_classes_restore(const classes_request *r,
                            const classes_source *source, const char *folder,
                            void **mask, opc_error *error) {
  eda_chip *c = eda_alloc(1, sizeof *c);
  int code = chip_begin(r, c, 0, error);
  if (!code) code = scan_extent(c, error);
  if (code) {
    eda_chip_free(c);
    return code;
  }
  code = eda_chip_mask_restore(c, folder, mask, error);
  if (code) return code;
  correct_classes_access(*mask, source);
  return prepare_models(r, ((const eda_mask *)*mask)->gates, error);
}
