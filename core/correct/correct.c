/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `correct`: the loop of thesis figures 2.1, 3.1 and 5.1. A mask is
   printed, each transistor's performance taken from the print, and the mask's
   edges moved by a synthesizer, within what a regulator allows, until the
   synthesizer is done. All boxes of the figures are plugins; the loop only
   hands arrays from one to the next. */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  GATES, LITHO, RESIST, EXTRACT, SYNTHESIZER, REGULATOR, MAX_ITERATIONS, MARGIN,
  PARAMETERS
};

enum { BLOCK = 64, ROOM_FOR_VIOLATIONS = 10000 };

typedef struct correct {
  const opc_host *host;
  const opc_value *values;
} correct;

/* One run. Arrays are of gates, made once. */
typedef struct loop {
  const opc_host *host;
  const opc_gates *gates;
  const opc_module *extract, *synthesizer, *regulator;
  opc_printer printer;
  opc_shapes mask[OPC_MASKS];       /* of the biases, not merged */
  opc_biases now, next;             /* printed and measured; to try next */
  opc_measurement measured;
  opc_performance design, before;
  uint32_t *vetoes;
  int judged;                       /* whether the regulator spoke */
  uint32_t iterations;
  int max_iterations;
  opc_error *failures;              /* of each block of gates */
} loop;

/* ---- work: one print ---- */

static size_t blocks(const loop *l) { return (l->gates->count + BLOCK - 1) / BLOCK; }

static void measure_block(void *data, size_t block) {
  loop *l = data;
  size_t first = block * BLOCK, last = first + BLOCK;
  if (last > l->gates->count) last = l->gates->count;
  l->failures[block] = (opc_error){0};
  opc_measure(l->host, l->gates, l->printer.print, l->extract, first, last,
              &l->measured, &l->failures[block]);
}

static opc_printed printed(const loop *l) {
  return (opc_printed){.size = sizeof(opc_printed),
                       .iteration = l->iterations,
                       .gates = l->gates,
                       .flags = l->measured.flags,
                       .l = l->now.l,
                       .w = l->now.w,
                       .extension = l->measured.extension};
}

/* Did any bias of that layer change? */
static int changed(const loop *l, int layer) {
  size_t n = l->gates->count * sizeof(int32_t);
  if (layer == OPC_ACTIVE) return memcmp(l->now.w, l->next.w, n) != 0;
  return memcmp(l->now.l, l->next.l, n) != 0 ||
         memcmp(l->now.end, l->next.end, 2 * n) != 0;
}

/* Print and measure the mask of `next`, which becomes `now`. Only layers that
   changed are printed again. */
static int print_next(loop *l, int all, opc_error *error) {
  int layers[OPC_MASKS];
  for (int layer = 0; layer < OPC_MASKS; layer++)
    layers[layer] = all || changed(l, layer);
  size_t n = l->gates->count * sizeof(int32_t);
  memcpy(l->now.l, l->next.l, n);
  memcpy(l->now.w, l->next.w, n);
  memcpy(l->now.end, l->next.end, 2 * n);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    if (!layers[layer]) continue;
    opc_edges_move(l->gates, layer, &l->now, &l->mask[layer]);
    int code = opc_printer_print(&l->printer, layer, &l->mask[layer], error);
    if (code) return code;
  }
  l->host->parallel(l->host, blocks(l), measure_block, l);
  for (size_t b = 0; b < blocks(l); b++)
    if (l->failures[b].code) {
      *error = l->failures[b];
      return error->code;
    }
  return OPC_OK;
}

/* Let the regulator set vetoes, and the line ends of `next`. */
static int judge(loop *l, opc_error *error) {
  memset(l->vetoes, 0, l->gates->count * sizeof *l->vetoes);
  if (!l->regulator) return OPC_OK;
  const opc_regulator *r = l->regulator->plugin->operations;
  opc_printed p = printed(l);
  opc_ruling ruling = {.size = sizeof ruling, .vetoes = l->vetoes,
                       .end = l->next.end};
  const char *before = opc_call(l->regulator, error);
  int code = r->rule(l->regulator->self, &p, &ruling, error);
  opc_leave(before);
  if (!code) code = opc_check_ruling(&ruling, l->gates->count, error);
  return opc_blame(error, code, "regulator");
}

static opc_feedback feedback(const loop *l) {
  return (opc_feedback){.size = sizeof(opc_feedback),
                        .iteration = l->iterations,
                        .gates = l->gates,
                        .design = &l->design,
                        .printed = &l->measured.performance,
                        .flags = l->measured.flags,
                        .vetoes = l->vetoes};
}

static double worst_deviation(const loop *l) {
  double worst = 0;
  for (size_t i = 0; i < l->gates->count; i++)
    worst = fmax(worst, fabs(opc_deviation(l->measured.performance.ion[i],
                                           l->design.ion[i])));
  return worst;
}

/* ---- work: the loop ---- */

static int begin(const loop *l, opc_error *error) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  opc_feedback f = feedback(l);
  f.printed = NULL;
  const char *before = opc_call(l->synthesizer, error);
  int code = s->begin(l->synthesizer->self, &f, error);
  opc_leave(before);
  return opc_blame(error, code, "synthesizer");
}

/* Let the synthesizer write what to try next. */
static int update(loop *l, int *done, opc_error *error) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  opc_feedback f = feedback(l);
  opc_moves moves = {.size = sizeof moves, .l = l->next.l, .w = l->next.w};
  const char *before = opc_call(l->synthesizer, error);
  int code = s->update(l->synthesizer->self, &f, &moves, done, error);
  opc_leave(before);
  if (!code) code = opc_check_moves(&moves, l->gates->count, error);
  return opc_blame(error, code, "synthesizer");
}

static int iterate(loop *l, opc_error *error) {
  int code = begin(l, error), done = 0, prints = 0;
  if (!code) code = print_next(l, 1, error);
  if (!code)
    for (int k = 0; k < 6; k++)
      memcpy((&l->before.ion)[k], (&l->measured.performance.ion)[k],
             l->gates->count * sizeof(double));
  for (; !code; code = print_next(l, 0, error)) {
    opc_progress progress = {.size = sizeof progress, .done = l->iterations,
                             .total = l->max_iterations,
                             .worst = worst_deviation(l), .worst_unit = "%"};
    l->host->progress(l->host, &progress);
    if (l->host->cancelled(l->host))
      return l->host->fail(l->host, error, OPC_CANCELLED, NULL, "stopped");
    if ((code = judge(l, error))) return code;
    int ends_moved = changed(l, OPC_POLY);
    if (done && !ends_moved) return OPC_OK;
    /* Line ends first, so that their effect is not taken for that of the
       first moves. */
    if (l->iterations == 0 && ends_moved && prints++ < l->max_iterations)
      continue;
    if ((int)l->iterations == l->max_iterations) {
      memcpy(l->next.end, l->now.end, 2 * l->gates->count * sizeof(int32_t));
      l->host->log(l->host, OPC_LOG_WARNING,
                   "not done after %d iterations: worst deviation %.3g %%",
                   l->max_iterations, worst_deviation(l));
      return OPC_OK;
    }
    done = 0;
    if ((code = update(l, &done, error))) return code;
    l->iterations++;
    if (done && !changed(l, OPC_POLY) && !changed(l, OPC_ACTIVE)) return OPC_OK;
  }
  return code;
}

/* The mask as a step's result: merged; printed again where edges had come to
   overlap, as what overlaps is not twice as dark. */
static int finish(loop *l, opc_mask *out, opc_error *error) {
  int overlap = 0, code = OPC_OK;
  for (int layer = 0; layer < OPC_MASKS && !code; layer++) {
    const opc_geometry_service *g = l->host->geometry;
    code = g->boolean(l->host, OPC_OR, &l->mask[layer], NULL,
                      &out->shapes[layer], error);
    if (code || g->area2(&out->shapes[layer]) == g->area2(&l->mask[layer]))
      continue;
    overlap = 1;
    code = opc_printer_print(&l->printer, layer, &out->shapes[layer], error);
  }
  if (!code && overlap) {
    l->host->log(l->host, OPC_LOG_WARNING,
                 "mask edges have met: their polygons were merged");
    l->host->parallel(l->host, blocks(l), measure_block, l);
    for (size_t b = 0; b < blocks(l) && !code; b++)
      if ((code = l->failures[b].code)) *error = l->failures[b];
  }
  return code;
}

static int report(const loop *l, const opc_mask *mask, opc_error *error) {
  int code = opc_correct_report(l->host, mask, &l->now, l->measured.extension,
                                l->synthesizer, error);
  if (code || !l->regulator) return code;
  const opc_regulator *r = l->regulator->plugin->operations;
  opc_violation *v =
      l->host->alloc(l->host, ROOM_FOR_VIOLATIONS, sizeof *v);
  if (!v)
    return l->host->fail(l->host, error, OPC_FAILED, NULL, "out of memory");
  opc_printed p = printed(l);
  size_t total = 0;
  const char *before = opc_call(l->regulator, error);
  code = r->violations(l->regulator->self, &p, v, ROOM_FOR_VIOLATIONS, &total,
                       error);
  opc_leave(before);
  size_t n = total < ROOM_FOR_VIOLATIONS ? total : ROOM_FOR_VIOLATIONS;
  if (!code) code = opc_check_violations(v, n, l->gates->count, error);
  code = opc_blame(error, code, "regulator");
  if (!code)
    code = opc_correct_report_violations(l->host, l->gates, v, n, total, error);
  l->host->free(l->host, v);
  return code;
}

/* ---- work: making and clearing a run ---- */

static int make_performance(const opc_host *host, size_t n,
                            opc_performance *p) {
  p->count = n;
  int ok = 1;
  for (int k = 0; k < 6; k++)
    ok &= ((&p->ion)[k] = host->alloc(host, n, sizeof(double))) != NULL;
  return ok;
}

static void clear_performance(const opc_host *host, opc_performance *p) {
  for (int k = 0; k < 6; k++) host->free(host, (&p->ion)[k]);
}

static int make_biases(const opc_host *host, size_t n, opc_biases *b) {
  b->l = host->alloc(host, n, sizeof *b->l);
  b->w = host->alloc(host, n, sizeof *b->w);
  b->end = host->alloc(host, 2 * n, sizeof *b->end);
  return b->l && b->w && b->end;
}

static void clear_biases(const opc_host *host, opc_biases *b) {
  host->free(host, b->l);
  host->free(host, b->w);
  host->free(host, b->end);
}

static int make_loop(loop *l) {
  const opc_host *host = l->host;
  size_t n = l->gates->count;
  int ok = make_biases(host, n, &l->now) & make_biases(host, n, &l->next) &
           make_performance(host, n, &l->measured.performance) &
           make_performance(host, n, &l->design) &
           make_performance(host, n, &l->before);
  for (int layer = 0; layer < OPC_MASKS; layer++)
    ok &= opc_edges_room(host, &l->gates->edges[layer], &l->mask[layer]);
  l->measured.flags = host->alloc(host, n, sizeof(uint32_t));
  l->measured.extension = host->alloc(host, 2 * n, sizeof(double));
  l->vetoes = host->alloc(host, n, sizeof *l->vetoes);
  l->failures = host->alloc(host, blocks(l), sizeof *l->failures);
  return ok && l->measured.flags && l->measured.extension && l->vetoes &&
         l->failures;
}

static void clear_loop(loop *l) {
  clear_biases(l->host, &l->now);
  clear_biases(l->host, &l->next);
  clear_performance(l->host, &l->measured.performance);
  clear_performance(l->host, &l->design);
  clear_performance(l->host, &l->before);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    l->host->free(l->host, l->mask[layer].start);
    l->host->free(l->host, l->mask[layer].points);
  }
  opc_printer_clear(&l->printer);
  l->host->free(l->host, l->measured.flags);
  l->host->free(l->host, l->measured.extension);
  l->host->free(l->host, l->vetoes);
  l->host->free(l->host, l->failures);
}

/* The frame of all shapes with `margin` around them. */
static opc_frame frame_around(const opc_gates *g, double margin) {
  opc_box b = g->extent;
  return (opc_frame){b.x0 * g->grid - margin, b.y0 * g->grid - margin,
                     ((double)b.x1 - b.x0) * g->grid + 2 * margin,
                     ((double)b.y1 - b.y0) * g->grid + 2 * margin};
}

/* Move what outlives the run from the loop to its result. */
static void hand_over(loop *l, opc_mask *out) {
  out->size = sizeof *out;
  out->gates = l->gates;
  out->design = l->design;
  out->before = l->before;
  out->after = l->measured.performance;
  out->flags = l->measured.flags;
  out->iterations = l->iterations;
  out->simulations = l->printer.simulations;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    out->print[layer] = l->printer.print[layer];
}

/* What hand_over gave away is no longer the loop's to free. */
static void forget(loop *l) {
  l->design = l->before = l->measured.performance = (opc_performance){0};
  l->measured.flags = NULL;
  memset(l->printer.print, 0, sizeof l->printer.print);
}

static void release_mask(void *object) {
  opc_mask *m = object;
  opc_host *host = opc_host_new(NULL);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    host->geometry->release(&m->shapes[layer]);
    host->imaging->release_field(host, &m->print[layer]);
  }
  clear_performance(host, &m->design);
  clear_performance(host, &m->before);
  clear_performance(host, &m->after);
  host->free(host, m->flags);
  host->free(host, m);
  opc_host_free(host);
}

static int prepare_extract(const opc_module *extract, opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  const char *before = opc_call(extract, error);
  int code = model->prepare(extract->self, error);
  opc_leave(before);
  return opc_blame(error, code, "extract");
}

static int run(void *self, void **outputs, opc_error *error) {
  const correct *c = self;
  const opc_value *v = c->values;
  const opc_host *host = c->host;
  loop l = {.host = host,
            .gates = v[GATES].object,
            .extract = v[EXTRACT].object,
            .synthesizer = v[SYNTHESIZER].object,
            .regulator = v[REGULATOR].object,
            .max_iterations = (int)v[MAX_ITERATIONS].integer};
  l.printer = (opc_printer){.host = host, .resist = v[RESIST].object,
                            .frame = frame_around(l.gates, v[MARGIN].real),
                            .grid = l.gates->grid};
  opc_model_make(&l.printer.litho, v[LITHO].object);
  opc_mask *mask = host->alloc(host, 1, sizeof *mask);
  int code = OPC_OK;
  if (!mask || !make_loop(&l)) {
    code = OPC_FAILED;
    host->fail(host, error, code, NULL, "out of memory");
  }
  if (!code) code = opc_printer_prepare(&l.printer, error);
  if (!code) code = prepare_extract(l.extract, error);
  if (!code) code = opc_measure_drawn(l.gates, l.extract, &l.design, error);
  if (!code) code = iterate(&l, error);
  if (!code) code = finish(&l, mask, error);
  if (!code) {
    hand_over(&l, mask);
    code = report(&l, mask, error);
    forget(&l);
    outputs[0] = mask;   /* released by the host if the report failed */
  } else if (mask) {
    for (int layer = 0; layer < OPC_MASKS; layer++)
      host->geometry->release(&mask->shapes[layer]);
    host->free(host, mask);
  }
  clear_loop(&l);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [GATES] = {.name = "gates", .type = OPC_INPUT, .flags = OPC_REQUIRED,
               .choices = "gates", .summary = "the transistors to correct"},
    [LITHO] = {.name = "litho", .type = OPC_SLOT, .flags = OPC_REQUIRED,
               .choices = "litho", .summary = "model of the optics"},
    [RESIST] = {.name = "resist", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                .choices = "resist", .summary = "model of the resist"},
    [EXTRACT] = {.name = "extract", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                 .choices = "extract",
                 .summary = "performance of a printed transistor"},
    [SYNTHESIZER] = {.name = "synthesizer", .type = OPC_SLOT,
                     .flags = OPC_REQUIRED, .choices = "mask",
                     .summary = "what moves the mask's edges"},
    [REGULATOR] = {.name = "regulator", .type = OPC_SLOT, .choices = "drc",
                   .summary = "what keeps the print free of failures"},
    [MAX_ITERATIONS] = {.name = "max_iterations", .type = OPC_INT,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "100",
                        .min = 0, .max = 100000,
                        .summary = "stop after so many moves"},
    [MARGIN] = {.name = "margin", .type = OPC_REAL, .flags = OPC_AT_LEAST,
                .unit = "nm", .preset = "1000 nm", .min = 0,
                .summary = "clear field around the layout, which repeats beyond"},
};

static const opc_metric metrics[] = {
    {.name = "transistors", .summary = "how many were corrected"},
    {.name = "ion_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |Ion deviation| after correction"},
    {.name = "ion_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |Ion deviation| after correction"},
    {.name = "ion_stdv", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "standard deviation of the Ion deviation, thesis eq. 3.5"},
    {.name = "ion_mean_drawn", .unit = "%",
     .summary = "mean of |Ion deviation| of the mask as drawn"},
    {.name = "ion_max_drawn", .unit = "%",
     .summary = "largest |Ion deviation| of the mask as drawn"},
    {.name = "area_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |gate area deviation| after correction"},
    {.name = "iterations", .better = OPC_LOWER,
     .summary = "times that the synthesizer moved edges"},
    {.name = "simulations", .better = OPC_LOWER,
     .summary = "litho simulations, of one layer each"},
    {.name = "failed", .better = OPC_LOWER,
     .summary = "transistors that do not print as one of their own"},
    {.name = "violations", .better = OPC_LOWER,
     .summary = "rules of the regulator that the print does not keep"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  correct *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static void destroy(void *self) {
  correct *c = self;
  c->host->free(c->host, c);
}

/* ---- entry ---- */

static const opc_port ports[] = {{"mask", "mask", release_mask}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = 1,
                                    .port_size = sizeof(opc_port),
                                    .outputs = ports,
                                    .run = run};

extern const opc_plugin opc_correct_plugin;
const opc_plugin opc_correct_plugin = {
    .size = sizeof(opc_plugin),
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "correct",
    .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "move mask edges until every transistor performs as drawn",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};
