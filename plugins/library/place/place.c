/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `library.place`: composes a circuit's mask from the masks
   of its cells (thesis 4.2.2, step 1), simulates the mask, and compares the
   figures with those in the cells alone. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <glib.h>
#include <opcflow/table.h>
#include <string.h>

#include <correct/findings.h>
#include <correct/library.h>
#include <correct/report.h>
#include <correct/settings.h>
#include <correct/start.h>
#include <correct/symmetry.h>
#include "disturb.h"
#include "stitch.h"

enum { REFUSE, DRAWN }; /* values of `missing` */

/* ---- state ---- */

typedef struct place {
  const opc_host *host;
  const eda_layout *layout;
  const eda_gates *gates;
  const library *library;
  correct_settings with;
  const char *top, *picture;
  int missing, print;
  int64_t width;
} place;

/* State of a run; arrays have an element for each cell of the circuit. */
typedef struct placer {
  const place *p;
  stitch stitch;
  const entry **entry; /* corrected cell; NULL: not in the library */
  uint8_t *looked;     /* 1: the library was searched for the cell */
  size_t placed, cells, unknown;
  opc_error *error;
} placer;

/* ---- the library ---- */

/* Return OPC_INVALID if the library was made for another process or grid. */
static int check_process(const place *p, opc_error *error) {
  library own = {0};
  int code = correct_library_take_models(p->host, own.model, error);
  for (int k = 0; k < LIBRARY_MODELS && !code; k++)
    if (strcmp(own.model[k], p->library->model[k]) != 0)
      code = opc_fail(error, OPC_INVALID, correct_library_models[k],
                      "the library was built with another %s",
                      correct_library_models[k]);
  for (int k = 0; k < LIBRARY_MODELS; k++) g_free(own.model[k]);
  if (!code && p->library->grid != p->gates->grid)
    code = opc_fail(
        error, OPC_INVALID, "gates",
        "the grid of the library is %g nm, expected that of the circuit, %g nm",
        p->library->grid, p->gates->grid);
  return code;
}

/* Find a cell by its name, or by the checksum of its shapes; NULL: none. */
static const library_cell *find_cell(const library *l, gboolean by_name,
                                     const char *what) {
  for (guint i = 0; i < l->cells->len; i++) {
    const library_cell *c = &g_array_index(l->cells, library_cell, i);
    if (!strcmp(by_name ? c->name : c->geometry, what)) return c;
  }
  return NULL;
}

/* Find a cell in the library, by the checksum of its shapes. */
static int look_up(placer *r, int32_t cell) {
  const place *p = r->p;
  g_autofree char *geometry = correct_units_sum(p->layout, cell, r->error);
  if (!geometry) return r->error->code;
  const library_cell *c = find_cell(p->library, FALSE, geometry);
  r->looked[cell] = 1;
  if (!c) return OPC_OK;
  r->entry[cell] = c->entry;
  r->cells++;
  return OPC_OK;
}

/* ---- orientations ---- */

/* Return the number of equivalent orientations (correct_symmetry_find) that a
   placement requires. */
static int orientations_for(const turn *t) {
  return t->xy ? 8 : t->xx < 0 || t->yy < 0 ? 4 : 1;
}

static int find_symmetry(const place *p, int *orientations, opc_error *error) {
  eda_printer printer;
  eda_printer_init(&printer, p->host->context, p->gates, p->with.litho,
                   p->with.resist, p->with.margin);
  int code = printer.litho.functions.prepare(&printer.litho, error);
  if (!code)
    code = correct_symmetry_find(p->host->context, &printer.litho.module,
                                 orientations, error);
  eda_printer_clear(&printer);
  return code;
}

/* Return OPC_INVALID if a cell is placed in an orientation in which the optics
   image the cell differently. */
static int check_orientations(const placer *r, const units *found) {
  const place *p = r->p;
  size_t worst = 0;
  int orientations = 0;
  for (size_t i = 1; i < found->count; i++)
    if (orientations_for(&found->unit[i].at) >
        orientations_for(&found->unit[worst].at))
      worst = i;
  if (!found->count || orientations_for(&found->unit[worst].at) == 1)
    return OPC_OK;
  int code = find_symmetry(p, &orientations, r->error);
  if (code || orientations_for(&found->unit[worst].at) <= orientations)
    return code;
  return opc_fail(r->error, OPC_INVALID, "layout",
                  "\"cell '%s' is %s, and the optics image this orientation "
                  "differently (source, polarisation or aberrations): the mask "
                  "of the library is not valid\"",
                  eda_layout_cell_name(p->layout, found->unit[worst].cell),
                  found->unit[worst].at.xy
                      ? "rotated by 90 degrees"
                      : "mirrored or rotated by 180 degrees");
}

/* ---- the mask ---- */

static int place_all(placer *r, const units *found) {
  int code = OPC_OK;
  for (size_t i = 0; i < found->count && !code; i++) {
    int32_t cell = found->unit[i].cell;
    if (!r->looked[cell]) code = look_up(r, cell);
    if (code || !r->entry[cell]) continue;
    (void)stitch_place(&r->stitch, r->entry[cell], &found->unit[i].at);
    r->placed++;
  }
  return code;
}

/* Report the transistors that no cell of the library matches. */
static int place_report_unknown(placer *r) {
  const place *p = r->p;
  const eda_gates *g = p->gates;
  size_t first = g->count;
  for (size_t i = 0; i < g->count; i++) {
    if (r->stitch.known[i]) continue;
    if (!r->unknown++) first = i;
  }
  if (!r->unknown) return OPC_OK;
  const char *cell = g->cell[first];
  g_autofree char *name = correct_report_gate_name(g, first);
  g_autofree char *text = g_strdup_printf(
      "%zu of %zu transistors are not in the library, the first is %s: cell "
      "'%s' %s",
      r->unknown, g->count, name, cell,
      find_cell(p->library, TRUE, cell)
          ? "differs in the library by its shapes, fragments or flavour"
          : "is missing");
  if (p->missing == REFUSE)
    return opc_fail(r->error, OPC_INVALID, "library", "%s", text);
  p->host->log(p->host, OPC_LOG_FINDING,
               "%s: these transistors keep the drawn mask", text);
  return OPC_OK;
}

static int stitch_all(placer *r) {
  const place *p = r->p;
  size_t cells = eda_layout_cells(p->layout);
  units found = {0};
  int32_t top = p->top ? eda_layout_find_cell(p->layout, p->top)
                       : eda_layout_top(p->layout, r->error);
  if (p->top && top < 0)
    return opc_fail(r->error, OPC_INVALID, "top", "cell '%s' does not exist",
                    p->top);
  if (top < 0) return r->error->code;
  r->entry = eda_alloc(cells, sizeof(entry *));
  r->looked = eda_alloc(cells, 1);
  int code = correct_units_find(p->layout, top, &found, r->error);
  if (!code) code = check_orientations(r, &found);
  if (!code) code = place_all(r, &found);
  g_free(found.unit);
  return code ? code : place_report_unknown(r);
}

/* ---- simulation ---- */

/* Set mask.before to the figures in the cells or, for unknown transistors, to
   the drawn figures. */
static void set_before(const placer *r, eda_mask *m) {
  size_t n = m->gates->count;
  eda_performance_init(&m->before, n);
  for (size_t i = 0; i < n; i++)
    eda_performance_one(&m->before,
                        r->stitch.known[i] ? &r->stitch.cell : &m->design, i);
}

/* Build the mask's shapes and set the figures of the cells. */
static int make_mask(const placer *r, eda_mask *m) {
  const place *p = r->p;
  const eda_gates *g = p->gates;
  const opc_context *context = p->host->context;
  eda_performance_init(&m->design, g->count);
  int code = eda_extractor_prepare(context, p->with.extractor, r->error);
  if (!code)
    code =
        eda_measure_drawn(context, g, p->with.extractor, &m->design, r->error);
  set_before(r, m);
  for (size_t k = 0; k < g->layers && !code; k++)
    if (g->corrected[k])
      code = correct_start_mask(g, m->moved, k, &m->shapes[k], r->error);
  return code;
}

static int place_report_cells(const placer *r) {
  const opc_metric_value values[] = {{"cells", (double)r->cells},
                                     {"placed", (double)r->placed},
                                     {"unknown", (double)r->unknown}};
  return opc_put_metrics(r->p->host, OPC_ARRAY(values), r->error);
}

static int place_report(placer *r, const eda_mask *m, const double *extension) {
  const opc_host *host = r->p->host;
  const uint8_t *known = r->stitch.known;
  uint32_t *good = eda_alloc(m->gates->count, sizeof *good);
  trial none;
  correct_trial_init(&none, m->layers, m->gates->count);
  none.biases.base = m->moved;
  const report content = {.mask = m,
                          .extension = extension,
                          .biases = &none.biases,
                          .flags_before = good};
  correct_findings_of_print(host, m->gates, NULL, m->flags, NULL);
  int code = correct_report_mask(host, &content, r->error);
  if (!code) code = disturb_report(host, m, known, r->error);
  if (!code && r->p->picture)
    code = disturb_draw(host, m, known, r->p->picture, (double)r->p->width,
                        r->error);
  correct_trial_clear(&none);
  free(good);
  return code;
}

static int place_print_report(placer *r, eda_mask *m) {
  const place *p = r->p;
  double *extension = NULL;
  /* Calibrate the resist as in the library, not with the transistors of this
     circuit. */
  int code = correct_print(&p->with, p->host, 0, m, NULL, &extension, r->error);
  if (!code && !m->fine_simulations) /* apply the stored Ion ratios */
    correct_start_correct(m->moved, &m->after);
  if (!code) code = place_report(r, m, extension);
  free(extension);
  return code;
}

/* Use the figures in the cells as the figures of a mask that is not simulated.
 */
static void place_cell_figures(eda_mask *m) {
  size_t n = m->gates->count;
  eda_performance_init(&m->after, n);
  eda_performance_copy(&m->after, &m->before);
  m->flags = eda_alloc(n, sizeof *m->flags);
}

static int place_run(void *self, void **outputs, opc_error *error) {
  const place *p = self;
  placer r = {.p = p, .error = error};
  int code = check_process(p, error);
  if (code) return code;
  stitch_init(&r.stitch, p->gates, eda_layout_unit(p->layout));
  code = stitch_all(&r);
  if (!code) {
    eda_mask *mask = eda_mask_new(p->gates);
    outputs[0] = mask; /* released by the host on failure */
    mask->moved = r.stitch.moved;
    r.stitch.moved = NULL;
    code = make_mask(&r, mask);
    if (!code) code = place_report_cells(&r);
    if (!code && !p->print)
      place_cell_figures(mask);
    else if (!code)
      code = place_print_report(&r, mask);
  }
  free(r.entry);
  free(r.looked);
  stitch_clear(&r.stitch);
  return code;
}

static int place_forecast(void *self, opc_forecast *out, opc_error *error) {
  const place *p = self;
  (void)error;
  if (!p->print) return OPC_OK;
  correct_forecast(&p->with, p->host, p->gates, "one simulation",
                   "one accurate simulation", out);
  return OPC_OK;
}

/* ---- parameters ---- */

#define INPUT(NAME, KIND, SUMMARY)                                     \
  OPC_PARAMETER(place, NAME, .type = OPC_INPUT, .flags = OPC_REQUIRED, \
                .choices = KIND, .summary = (SUMMARY))
static const opc_parameter parameters[] = {
    INPUT(layout, "layout", "Circuit with its cells"),
    INPUT(gates, "gates", "Transistors of the circuit"),
    INPUT(library, "library", "Corrected cells"),
    CORRECT_SLOT(place, litho, OPC_REQUIRED,
                 "model of the optics, the same as in the library"),
    CORRECT_SLOT(place, resist, OPC_REQUIRED,
                 "model of the resist, the same as in the library"),
    CORRECT_SLOT(place, extractor, OPC_REQUIRED,
                 "model of a printed transistor's performance, the same as in "
                 "the library"),
    OPC_PARAMETER(place, top, .type = OPC_TEXT,
                  .summary = "Top cell of the circuit (default: the only cell "
                             "that no other places)"),
    OPC_PARAMETER(place, missing, .type = OPC_CHOICE, .preset = "refuse",
                  .choices = "refuse|drawn",
                  .summary = "Treatment of transistors that are not in the "
                             "library: refuse with an error, or keep as drawn"),
    CORRECT_MARGIN(place),
    CORRECT_FINE(place),
    OPC_PARAMETER(
        place, print, .type = OPC_BOOL, .preset = "true",
        .summary = "Simulate the entire mask and report the disturbance of the "
                   "transistors; false: report the figures of the cells"),
    OPC_PARAMETER(place, picture, .type = OPC_OUTPUT,
                  .summary = "Picture of the disturbance of each transistor, "
                             ".png, .svg or .pdf"),
    OPC_PARAMETER(place, width, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1200",
                  .min = 200, .max = 10000,
                  .summary = "Width of the picture, pixels"),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "number of transistors"},
    {"cells", NULL, OPC_NEUTRAL, 0, "different cells of the library"},
    {"placed", NULL, OPC_NEUTRAL, 0, "placed cells"},
    {"unknown", NULL, OPC_LOWER, 0,
     "transistors without a cell of the library"},
    DISTURB_METRICS,
    REPORT_METRICS,
    {"ion_mean_drawn", "%", OPC_NEUTRAL, 0,
     "mean of |Ion deviation| of the cells alone"},
    {"ion_max_drawn", "%", OPC_NEUTRAL, 0,
     "largest |Ion deviation| of the cells alone"},
    {"iterations", NULL, OPC_LOWER, 0, "0: no edge is displaced"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations of one layer each"},
    {"fine_simulations", NULL, OPC_LOWER, 0,
     "simulations of the accurate model"},
    REPORT_PRINT_METRICS,
};

static int place_check(void *self, opc_error *error) {
  place *p = self;
  p->with.ion_limit = CORRECT_USUAL_LIMIT;
  int code = correct_settings_check(&p->with, p->host, error);
  if (!code && p->picture && !p->print)
    code = opc_fail(error, OPC_INVALID, "picture",
                    "requires 'print: true', which computes the disturbance");
  if (!code && p->picture) code = eda_paper_check(p->picture, "picture", error);
  return code;
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = place_run,
                                   .forecast = place_forecast};

OPC_PLUGIN(place, .id = "library.place", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "compose the mask of a circuit from the masks of cells",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = place_check, OPC_FUNCTIONS(functions));
