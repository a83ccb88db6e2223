/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the disturbance: the |Ion deviation| of a transistor in the
   circuit minus that in the cell alone. */
#include "disturb.h"

#include <eda/drawing.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/report.h>
#include <correct/start.h>

/* Smallest disturbance that counts, %; resolution of thesis figure 4.5. */
static const double least = 0.05;

/* ---- figures ---- */

/* Return the disturbance of each transistor, %; NAN for unknown transistors.
   The caller frees the array with free(). */
static double *disturbances(const eda_mask *m, const uint8_t *known) {
  double *d = eda_alloc(m->gates->count, sizeof *d);
  for (size_t i = 0; i < m->gates->count; i++)
    d[i] =
        known[i] ? correct_start_disturbance(m, &m->after, m->flags, i) : NAN;
  return d;
}

typedef struct row {
  char *name;
  const char *cell;
  double x, y, alone, placed, disturbance;
} row;

static row row_of(const eda_mask *m, size_t i, double disturbance) {
  const eda_gates *g = m->gates;
  eda_box b = g->box[i];
  double drawn = m->design.ion[i];
  int prints = !isnan(correct_start_disturbance(m, &m->after, m->flags, i));
  return (row){.name = correct_report_gate_name(g, i),
               .cell = g->cell[i],
               .x = ((double)b.x0 + b.x1) / 2 * g->grid,
               .y = ((double)b.y0 + b.y1) / 2 * g->grid,
               .alone = eda_deviation(m->before.ion[i], drawn),
               .placed = prints ? eda_deviation(m->after.ion[i], drawn) : NAN,
               .disturbance = disturbance};
}

static int put_metrics(const opc_host *host, const double *d, size_t n,
                       opc_error *error) {
  double sum = 0, most = -INFINITY, worse = 0, count = 0;
  for (size_t i = 0; i < n; i++) {
    if (isnan(d[i])) continue;
    sum += d[i];
    most = fmax(most, d[i]);
    worse += d[i] >= least;
    count++;
  }
  if (count == 0) return OPC_OK;
  const opc_metric_value values[] = {{"disturbance_mean", sum / count},
                                     {"disturbance_max", most},
                                     {"disturbed", 100 * worse / count}};
  return opc_put_metrics(host, OPC_ARRAY(values), error);
}

int disturb_report(const opc_host *host, const eda_mask *m,
                   const uint8_t *known, opc_error *error) {
  size_t n = m->gates->count;
  double *d = disturbances(m, known);
  row *rows = eda_alloc(n, sizeof *rows);
  for (size_t i = 0; i < n; i++) {
    rows[i] = row_of(m, i, d[i]);
    if (!known[i]) rows[i].alone = NAN;
  }
  const opc_column columns[] = {
      {"transistor", NULL, OPC_TEXT, 0, &rows->name},
      {"cell", NULL, OPC_TEXT, 0, &rows->cell},
      {"x", "nm", OPC_REAL, 1, &rows->x},
      {"y", "nm", OPC_REAL, 1, &rows->y},
      {"ion_cell", "%", OPC_REAL, 3, &rows->alone},
      {"ion_placed", "%", OPC_REAL, 3, &rows->placed},
      {"disturbance", "%", OPC_REAL, 3, &rows->disturbance}};
  int code = opc_put_rows(host, "disturbance", 0, n, sizeof *rows, columns,
                          G_N_ELEMENTS(columns), error);
  if (!code) code = put_metrics(host, d, n, error);
  for (size_t i = 0; i < n; i++) g_free(rows[i].name);
  free(rows);
  free(d);
  return code;
}

/* ---- the picture ---- */

static int by_size(const void *a, const void *b) {
  double x = fabs(*(const double *)a), y = fabs(*(const double *)b);
  return (x > y) - (x < y);
}

/* Return the value at the ends of the colour scale, %: the 98th percentile of
   |disturbance|, so that a few outliers do not dominate. */
static double range_of(const double *d, size_t n) {
  double *all = eda_alloc(n, sizeof *all);
  size_t count = 0;
  for (size_t i = 0; i < n; i++)
    if (!isnan(d[i])) all[count++] = d[i];
  qsort(all, count, sizeof *all, by_size);
  double at = count ? fabs(all[(count - 1) * 98 / 100]) : 0;
  free(all);
  return fmax(at, least);
}

/* Smallest drawn size of a transistor, pixels. */
static const double smallest = 3;

static void draw_gate(const eda_chart *c, const eda_gates *g, size_t i,
                      double d, double range) {
  cairo_t *cairo = c->paper->cairo;
  double um = g->grid / 1000;
  double x0 = eda_chart_x(c, g->box[i].x0 * um),
         x1 = eda_chart_x(c, g->box[i].x1 * um),
         y0 = eda_chart_y(c, g->box[i].y1 * um),
         y1 = eda_chart_y(c, g->box[i].y0 * um);
  double more_x = fmax(0, smallest - (x1 - x0)) / 2,
         more_y = fmax(0, smallest - (y1 - y0)) / 2;
  eda_use(cairo, isnan(d) ? eda_unknown : eda_diverging(0.5 + d / range / 2));
  cairo_rectangle(cairo, x0 - more_x, y0 - more_y, x1 - x0 + 2 * more_x,
                  y1 - y0 + 2 * more_y);
  cairo_fill(cairo);
}

/* Draw the chip over the full width of the paper; coordinates in um. */
static void draw_chip(const eda_paper *paper, const eda_mask *m,
                      const double *d, double top, double height,
                      double range) {
  const eda_gates *g = m->gates;
  double um = g->grid / 1000;
  eda_chart c = {.paper = paper,
                 .top = top,
                 .x = {.low = g->extent.x0 * um,
                       .high = g->extent.x1 * um,
                       .title = "x (um)"},
                 .y = {.low = g->extent.y0 * um,
                       .high = g->extent.y1 * um,
                       .title = "y (um)"}};
  c.left = floor(eda_axis_width(paper, &c.y));
  c.width = floor(paper->width - c.left - 1.5 * paper->font);
  c.height = height;
  eda_chart_axes(&c);
  eda_use(paper->cairo, (eda_colour)EDA_COLOUR(0xd8d8d8));
  cairo_rectangle(paper->cairo, c.left, c.top, c.width, c.height);
  cairo_fill(paper->cairo);
  for (size_t i = 0; i < g->count; i++) draw_gate(&c, g, i, d[i], range);
  eda_use(paper->cairo, eda_ink);
}

int disturb_draw(const opc_host *host, const eda_mask *m, const uint8_t *known,
                 const char *file, double width, opc_error *error) {
  const eda_gates *g = m->gates;
  const char *path = host->output_path(host, file, error);
  if (!path) return error->code;
  double *d = disturbances(m, known), range = range_of(d, g->count);
  double font = fmax(9, width / 70);
  double chip = width * ((double)g->extent.y1 - g->extent.y0) /
                fmax(1, (double)g->extent.x1 - g->extent.x0);
  chip = floor(fmin(fmax(chip, width / 5), 1.5 * width));
  eda_paper *paper = eda_paper_open(path, width, chip + 12 * font, font, error);
  if (paper) {
    g_autofree char *low =
        g_strdup_printf("-%.3g %%, better in the circuit", range);
    g_autofree char *high =
        g_strdup_printf("+%.3g %%, worse in the circuit", range);
    const eda_sign ramp = {
        .kind = EDA_SIGN_RAMP, .ramp = eda_diverging, .low = low, .high = high};
    eda_legend l;
    double top = paper->margin +
                 eda_heading(paper, paper->margin,
                             "|Ion deviation| in the circuit minus that in the "
                             "cell alone");
    eda_legend_init(&l, paper, top);
    eda_legend_add(&l, &ramp, " ");
    draw_chip(paper, m, d, top + l.height + font, chip, range);
    (void)eda_paper_close(paper, OPC_OK, error);
  }
  free(d);
  return error->code;
}
