/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the report of a correction: table of transistors, statistics
   (thesis eq. 3.3 to 3.7) and metrics. */
#include <correct/report.h>

#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include <correct/settings.h>

enum {
  SHORT_TABLE = 24
}; /* largest number of rows of a table that is
      printed */

/* ---- statistics ---- */

/* Sums over n values: values, absolute values, squares; largest absolute value.
 */
typedef struct statistics {
  double n, sum, absolute, square, max;
} statistics;

/* Deviations, %, of n-, p- and all transistors that print. */
typedef struct groups {
  statistics ion[3], area[3], ioff[3];
  double leakage[3], leakage_drawn[3]; /* sums of Ioff, A */
} groups;

/* Add n equal values. */
static void statistics_add(statistics *s, double x, double n) {
  s->n += n;
  s->sum += n * x;
  s->absolute += n * fabs(x);
  s->square += n * x * x;
  s->max = fmax(s->max, fabs(x));
}

/* Return the mean of absolute values; NAN without values. */
static double mean_of(const statistics *s) {
  return s->n ? s->absolute / s->n : NAN;
}

static double max_of(const statistics *s) { return s->n ? s->max : NAN; }

static double stdv_of(const statistics *s) {
  if (!s->n) return NAN;
  double mean = s->sum / s->n;
  return sqrt(fmax(0, s->square / s->n - mean * mean));
}

static double rms_of(const statistics *s) {
  return s->n ? sqrt(s->square / s->n) : NAN;
}

/* Return 1 if a transistor does not print and has no figures. */
static int gate_failed(const uint32_t *flags, size_t i) {
  return flags && eda_print_failed(flags[i]);
}

/* Add the deviations of n equal printed transistors of a type. */
static void groups_add(groups *to, int type, const eda_figures *drawn,
                       const eda_figures *printed, double n) {
  for (int k = 0; k < 2; k++) {
    int group = k ? 2 : type == EDA_PMOS;
    statistics_add(&to->ion[group], eda_deviation(printed->ion, drawn->ion), n);
    statistics_add(&to->area[group], eda_deviation(printed->area, drawn->area),
                   n);
    statistics_add(&to->ioff[group], eda_deviation(printed->ioff, drawn->ioff),
                   n);
    to->leakage[group] += n * printed->ioff;
    to->leakage_drawn[group] += n * drawn->ioff;
  }
}

/* Return the deviations of gates; `count`: number of transistors that each gate
   represents, NULL: one. */
static groups groups_of(const eda_gates *g, const uint32_t *count,
                        const eda_performance *design,
                        const eda_performance *printed, const uint32_t *flags) {
  groups out = {0};
  for (size_t i = 0; i < g->count; i++) {
    if (gate_failed(flags, i)) continue;
    eda_figures drawn = eda_figures_of(design, i),
                now = eda_figures_of(printed, i);
    groups_add(&out, g->type[i], &drawn, &now, count ? count[i] : 1);
  }
  return out;
}

static summary groups_sum(const groups *g) {
  summary out = {.ion_mean = mean_of(&g->ion[2]),
                 .ion_max = max_of(&g->ion[2]),
                 .ion_stdv = stdv_of(&g->ion[2]),
                 .ion_rms = rms_of(&g->ion[2]),
                 .ioff_rms = rms_of(&g->ioff[2]),
                 .area_mean = mean_of(&g->area[2]),
                 .area_max = max_of(&g->area[2]),
                 .ioff_mean = mean_of(&g->ioff[2]),
                 .ioff_max = max_of(&g->ioff[2])};
  for (int t = 0; t < 3; t++)
    out.ioff_total[t] =
        g->ioff[t].n ? eda_deviation(g->leakage[t], g->leakage_drawn[t]) : NAN;
  return out;
}

static summary summarize(const eda_gates *gates, const uint32_t *count,
                         const eda_performance *design,
                         const eda_performance *printed, const uint32_t *flags,
                         const sites *places) {
  groups g = groups_of(gates, count, design, printed, flags);
  statistics epe = {0};
  summary out = groups_sum(&g);
  for (size_t i = 0; i < gates->count; i++) {
    size_t n = count ? count[i] : 1;
    out.gates += n;
    out.failed += gate_failed(flags, i) ? n : 0;
    out.outside += flags[i] & EDA_PRINT_OUTSIDE ? n : 0;
  }
  for (size_t k = 0; places && k < gates->layers; k++) {
    out.sites += places[k].count;
    for (size_t i = 0; i < places[k].count; i++)
      if (isnan(places[k].epe[i]))
        out.lost++;
      else
        statistics_add(&epe, places[k].epe[i], 1);
  }
  out.epe_mean = mean_of(&epe);
  out.epe_max = max_of(&epe);
  return out;
}

summary correct_summarize(const eda_gates *gates, const eda_performance *design,
                          const eda_performance *printed, const uint32_t *flags,
                          const sites *places) {
  return summarize(gates, NULL, design, printed, flags, places);
}

/* ---- history ---- */

void correct_history_add(history *h, const summary *print, uint32_t iteration,
                         const eda_printer *printer, int fine) {
  const history_line *last = h->count ? &h->line[h->count - 1] : NULL;
  if (fine && last && last->simulations == printer->simulations) {
    iteration = (uint32_t)last->iteration;
    h->count--;
  }
  eda_grow(&h->line, &h->capacity, h->count + 1, sizeof *h->line);
  h->line[h->count++] =
      (history_line){*print, iteration, printer->simulations,
                     printer->fine_simulations, fine ? "fine" : "cheap"};
}

void correct_history_clear(history *h) { free(h->line); }

int correct_history_report(const history *h, const opc_host *host,
                           opc_error *error) {
  const history_line *line = h->line;
  const summary *s = &line->print;
  opc_column columns[13] = {{"iteration", NULL, OPC_INT, 0, &line->iteration}};
  size_t n = 1;
  const opc_column of_gates[] = {{"ion_mean", "%", OPC_REAL, 4, &s->ion_mean},
                                 {"ion_max", "%", OPC_REAL, 4, &s->ion_max},
                                 {"ion_stdv", "%", OPC_REAL, 4, &s->ion_stdv},
                                 {"ion_rms", "%", OPC_REAL, 4, &s->ion_rms},
                                 {"ioff_rms", "%", OPC_REAL, 4, &s->ioff_rms},
                                 {"area_mean", "%", OPC_REAL, 4, &s->area_mean},
                                 {"area_max", "%", OPC_REAL, 4, &s->area_max}};
  const opc_column of_sites[] = {{"epe_mean", "nm", OPC_REAL, 4, &s->epe_mean},
                                 {"epe_max", "nm", OPC_REAL, 4, &s->epe_max}};
  for (size_t k = 0; h->count && s->gates && k < G_N_ELEMENTS(of_gates); k++)
    columns[n++] = of_gates[k];
  for (size_t k = 0; h->count && s->sites && k < G_N_ELEMENTS(of_sites); k++)
    columns[n++] = of_sites[k];
  columns[n++] =
      (opc_column){"simulations", NULL, OPC_INT, 0, &line->simulations};
  columns[n++] = (opc_column){"fine_simulations", NULL, OPC_INT, 0,
                              &line->fine_simulations};
  columns[n++] = (opc_column){"model", NULL, OPC_TEXT, 0, &line->model};
  return opc_put_rows(host, "history", 0, h->count, sizeof *line, columns, n,
                      error);
}

/* ---- tables ---- */

/* Findings on a printed transistor: failures in the order of severity, then
   remarks. */
static const struct {
  uint32_t flag;
  const char *name;
} findings[] = {{EDA_PRINT_NO_ACTIVE, "no active"},
                {EDA_PRINT_OPEN, "open"},
                {EDA_PRINT_MERGED, "merged"},
                {EDA_PRINT_ISLAND, "island"},
                {EDA_PRINT_SHORT, "short line end"},
                {EDA_PRINT_NECK, "neck"},
                {EDA_PRINT_WIDE, "wide"},
                {EDA_PRINT_NOTCH, "notch"},
                {EDA_PRINT_OUTSIDE, "outside the table"}};

const char *correct_report_trouble(uint32_t flags) {
  for (size_t k = 0; k < G_N_ELEMENTS(findings); k++)
    if (flags & findings[k].flag) return findings[k].name;
  return "";
}

/* Write the number of transistors with each finding. A transistor may have
   several findings. */
static int finding_table(const opc_host *host, const eda_mask *m,
                         opc_error *error) {
  struct {
    const char *name;
    int64_t count;
  } row[G_N_ELEMENTS(findings)];
  size_t rows = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(findings); k++) {
    row[rows].name = findings[k].name;
    row[rows].count = 0;
    for (size_t i = 0; i < m->gates->count; i++)
      if (m->flags[i] & findings[k].flag)
        row[rows].count += (int64_t)eda_mask_count(m, i);
    rows += row[rows].count > 0;
  }
  const opc_column columns[] = {{"print", NULL, OPC_TEXT, 0, &row->name},
                                {"transistors", NULL, OPC_INT, 0, &row->count}};
  return rows ? opc_put_rows(host, "prints", 0, rows, sizeof *row,
                             OPC_ARRAY(columns), error)
              : OPC_OK;
}

char *correct_report_gate_name(const eda_gates *g, size_t i) {
  const char *where = *g->instance[i] ? g->instance[i] : g->cell[i];
  return g_strdup_printf("%s:%u", where, g->number[i]);
}

/* Row of the table of transistors. */
typedef struct gate_row {
  char *name;
  const char *cell, *type, *print, *verdict;
  int64_t count;
  double l, w, x, y;
  double ion_before, ion, ioff, area, leq, weq, change;
  double mask_l, mask_w, mask_jog, end[2], extension[2];
} gate_row;

/* Return the Ion deviation of a gate in the reported mask minus that in the
   correction loop, %. */
static double gate_change(const report *r, size_t i) {
  const eda_mask *m = r->mask, *c = r->corrected;
  if (gate_failed(m->flags, i) || gate_failed(c->flags, i)) return NAN;
  return eda_deviation(m->after.ion[i], m->design.ion[i]) -
         eda_deviation(c->after.ion[i], c->design.ion[i]);
}

/* Set *verdict to the first that exists: a failure, the guard's verdict, a
   remark on the figures, the synthesizer's verdict. */
static int verdict_of(const opc_context *context, const report *r, size_t gate,
                      const char **verdict, opc_error *error) {
  *verdict = gate_failed(r->mask->flags, gate)          ? "does not print"
             : r->held[gate]                            ? r->held[gate]
             : r->mask->flags[gate] & EDA_PRINT_OUTSIDE ? "outside the table"
                                                        : NULL;
  if (*verdict) return OPC_OK;
  int code = eda_call_verdict(context, r->synthesizer, gate, verdict, error);
  return eda_blame(error, code, "synthesizer");
}

/* Return the deviation of a figure, %; NAN if the transistor does not print. */
static double gate_deviation(const uint32_t *flags, size_t i,
                             const double *printed, const double *design) {
  return gate_failed(flags, i) ? NAN : eda_deviation(printed[i], design[i]);
}

static gate_row row_of(const report *r, size_t i) {
  const eda_mask *m = r->mask;
  const eda_gates *g = m->gates;
  const biases *b = r->biases;
  const eda_performance *now = &m->after, *drawn = &m->design;
  int none = gate_failed(m->flags, i);
  gate_row row = {.name = correct_report_gate_name(g, i),
                  .cell = g->cell[i],
                  .count = (int64_t)eda_mask_count(m, i),
                  .type = g->type[i] == EDA_PMOS ? "p" : "n",
                  .print = correct_report_trouble(m->flags[i]),
                  .l = g->length[i],
                  .w = g->width[i],
                  .x = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
                  .y = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid,
                  .ion_before = gate_deviation(r->flags_before, i,
                                               m->before.ion, drawn->ion),
                  .ion = gate_deviation(m->flags, i, now->ion, drawn->ion),
                  .ioff = gate_deviation(m->flags, i, now->ioff, drawn->ioff),
                  .area = gate_deviation(m->flags, i, now->area, drawn->area),
                  .leq = none ? NAN : now->leq_ion[i],
                  .weq = none ? NAN : now->weq[i]};
  if (r->corrected) row.change = gate_change(r, i);
  if (b) {
    const eda_moved *base = b->base;
    row.mask_l = (b->l[i] + (base ? base->l[i] : 0)) * g->grid;
    row.mask_w = (b->w[i] + (base ? base->w[i] : 0)) * g->grid;
    row.mask_jog = (b->jog[i] ? b->jog[i] : base ? base->jog[i] : 0) * g->grid;
  }
  for (size_t side = 0; side < 2; side++) {
    row.extension[side] = r->extension[2 * i + side];
    if (!b) continue;
    const int32_t *under = b->base ? b->base->end : NULL;
    row.end[side] =
        (b->end[2 * i + side] + (under ? under[2 * i + side] : 0)) * g->grid;
  }
  return row;
}

/* Write all columns of the table of transistors to a file, and print selected
   columns if the table is short. */
static int put_gates(const opc_host *host, const report *r, const gate_row *row,
                     opc_error *error) {
  int corrects = !r->corrected, moved = r->biases != NULL;
  const struct {
    int is_there, is_shown;
    opc_column column;
  } all[] = {
      {1, 1, {"transistor", NULL, OPC_TEXT, 0, &row->name}},
      {1, 0, {"cell", NULL, OPC_TEXT, 0, &row->cell}},
      {r->mask->count != NULL, 1, {"count", NULL, OPC_INT, 0, &row->count}},
      {1, 1, {"type", NULL, OPC_TEXT, 0, &row->type}},
      {1, 1, {"l", "nm", OPC_REAL, 1, &row->l}},
      {1, 1, {"w", "nm", OPC_REAL, 1, &row->w}},
      {1, 0, {"x", "nm", OPC_REAL, 1, &row->x}},
      {1, 0, {"y", "nm", OPC_REAL, 1, &row->y}},
      {corrects, 1, {"ion_before", "%", OPC_REAL, 3, &row->ion_before}},
      {1, 1, {"ion_after", "%", OPC_REAL, 3, &row->ion}},
      {1, 1, {"ioff_after", "%", OPC_REAL, 2, &row->ioff}},
      {1, 1, {"area_after", "%", OPC_REAL, 2, &row->area}},
      {1, 0, {"leq_ion", "nm", OPC_REAL, 3, &row->leq}},
      {1, 0, {"weq", "nm", OPC_REAL, 2, &row->weq}},
      {!corrects, 1, {"ion_change", "%", OPC_REAL, 3, &row->change}},
      {moved, 1, {"mask_l", "nm", OPC_REAL, 1, &row->mask_l}},
      {moved, 1, {"mask_w", "nm", OPC_REAL, 1, &row->mask_w}},
      {moved, 0, {"mask_jog", "nm", OPC_REAL, 1, &row->mask_jog}},
      {moved, 0, {"end_low", "nm", OPC_REAL, 1, &row->end[0]}},
      {moved, 0, {"end_high", "nm", OPC_REAL, 1, &row->end[1]}},
      {1, 0, {"extension_low", "nm", OPC_REAL, 2, &row->extension[0]}},
      {1, 0, {"extension_high", "nm", OPC_REAL, 2, &row->extension[1]}},
      {1, 0, {"print", NULL, OPC_TEXT, 0, &row->print}},
      {r->synthesizer != NULL,
       1,
       {"verdict", NULL, OPC_TEXT, 0, &row->verdict}},
  };
  opc_column file[G_N_ELEMENTS(all)], show[G_N_ELEMENTS(all)];
  size_t n = r->mask->gates->count, filed = 0, shown = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(all); k++) {
    if (all[k].is_there) file[filed++] = all[k].column;
    if (all[k].is_there && all[k].is_shown) show[shown++] = all[k].column;
  }
  int code = opc_put_rows(host, "gates", 0, n, sizeof *row, file, filed, error);
  if (code || !n || n > SHORT_TABLE) return code;
  return opc_put_rows(host, "transistors", OPC_TABLE_PRINT, n, sizeof *row,
                      show, shown, error);
}

static int gate_table(const opc_host *host, const report *r, opc_error *error) {
  size_t n = r->mask->gates->count;
  gate_row *row = eda_alloc(n, sizeof *row);
  int code = OPC_OK;
  for (size_t i = 0; i < n; i++) row[i] = row_of(r, i);
  for (size_t i = 0; i < n && !code && r->synthesizer; i++)
    code = verdict_of(host->context, r, i, &row[i].verdict, error);
  if (!code) code = put_gates(host, r, row, error);
  for (size_t i = 0; i < n; i++) g_free(row[i].name);
  free(row);
  return code;
}

static int groups_table(const opc_host *host, const groups *drawn,
                        const groups *printed, opc_error *error) {
  static const char *const names[3] = {"n", "p", "all"};
  struct {
    const char *name;
    int64_t count;
    double ion_mean_before, ion_max_before, area_mean_before;
    double ion_mean, ion_max, ion_stdv, area_mean, area_max, ioff_total;
  } row[3];
  const groups none = {0}, before = drawn ? *drawn : none, after = *printed;
  size_t rows = 0;
  for (int t = 0; t < 3; t++) {
    if (!after.ion[t].n) continue;
    row[rows].name = names[t];
    row[rows].count = (int64_t)after.ion[t].n;
    row[rows].ion_mean_before = mean_of(&before.ion[t]);
    row[rows].ion_max_before = max_of(&before.ion[t]);
    row[rows].area_mean_before = mean_of(&before.area[t]);
    row[rows].ion_mean = mean_of(&after.ion[t]);
    row[rows].ion_max = after.ion[t].max;
    row[rows].ion_stdv = stdv_of(&after.ion[t]);
    row[rows].area_mean = mean_of(&after.area[t]);
    row[rows].ioff_total =
        eda_deviation(after.leakage[t], after.leakage_drawn[t]);
    row[rows++].area_max = after.area[t].max;
  }
  const opc_column all[] = {
      {"type", NULL, OPC_TEXT, 0, &row->name},
      {"transistors", NULL, OPC_INT, 0, &row->count},
      {"ion_mean_before", "%", OPC_REAL, 3, &row->ion_mean_before},
      {"ion_max_before", "%", OPC_REAL, 3, &row->ion_max_before},
      {"ion_mean_after", "%", OPC_REAL, 3, &row->ion_mean},
      {"ion_max_after", "%", OPC_REAL, 3, &row->ion_max},
      {"ion_stdv_after", "%", OPC_REAL, 3, &row->ion_stdv},
      {"area_mean_before", "%", OPC_REAL, 2, &row->area_mean_before},
      {"area_mean_after", "%", OPC_REAL, 2, &row->area_mean},
      {"area_max_after", "%", OPC_REAL, 2, &row->area_max},
      {"ioff_total_after", "%", OPC_REAL, 1, &row->ioff_total},
  };
  opc_column columns[G_N_ELEMENTS(all)];
  size_t n = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(all); k++)
    if (drawn || !g_str_has_suffix(all[k].name, "_before"))
      columns[n++] = all[k];
  return opc_put_rows(host, "summary", OPC_TABLE_PRINT, rows, sizeof *row,
                      columns, n, error);
}

static int summary_table(const opc_host *host, const report *r,
                         opc_error *error) {
  const eda_mask *m = r->mask;
  const groups before =
      groups_of(m->gates, m->count, &m->design, &m->before, r->flags_before);
  const groups after =
      groups_of(m->gates, m->count, &m->design, &m->after, m->flags);
  return groups_table(host, r->corrected ? NULL : &before, &after, error);
}

static int effort_table(const opc_host *host, const eda_mask *mask,
                        const summary *s, opc_error *error) {
  int64_t iterations = mask->iterations, simulations = mask->simulations;
  int64_t fine = mask->fine_simulations;
  int64_t unsound = (int64_t)s->failed, fragments = (int64_t)s->sites;
  opc_column columns[] = {
      {"iterations", NULL, OPC_INT, 0, &iterations},
      {"litho_simulations", NULL, OPC_INT, 0, &simulations},
      {"fine_simulations", NULL, OPC_INT, 0, &fine},
      {"failed_transistors", NULL, OPC_INT, 0, &unsound},
      {"fragments", NULL, OPC_INT, 0, &fragments},
      {"epe_mean", "nm", OPC_REAL, 3, &s->epe_mean},
      {"epe_max", "nm", OPC_REAL, 3, &s->epe_max},
  };
  return opc_put_table(host, "effort", OPC_TABLE_PRINT, 1, columns,
                       s->sites ? 7 : 4, error);
}

/* ---- metrics ---- */

static int report_metrics(const opc_host *host, const report *r,
                          const summary *s, opc_error *error) {
  const eda_mask *m = r->mask;
  const groups before =
      groups_of(m->gates, m->count, &m->design, &m->before, r->flags_before);
  const statistics *drawn = &before.ion[2];
  statistics changes = {0};
  for (size_t i = 0; r->corrected && i < m->gates->count; i++)
    if (!isnan(gate_change(r, i)))
      statistics_add(&changes, gate_change(r, i), eda_mask_count(m, i));
  const int gates = s->gates > s->failed, corrects = !r->corrected;
  const int edges = s->sites > s->lost;
  const opc_metric_value values[] = {
      {corrects ? "transistors" : NULL, (double)s->gates},
      {gates ? "ion_mean" : NULL, s->ion_mean},
      {gates ? "ion_max" : NULL, s->ion_max},
      {gates ? "ion_stdv" : NULL, s->ion_stdv},
      {gates ? "ion_rms" : NULL, s->ion_rms},
      {gates ? "ioff_rms" : NULL, s->ioff_rms},
      {drawn->n && corrects ? "ion_mean_drawn" : NULL, mean_of(drawn)},
      {drawn->n && corrects ? "ion_max_drawn" : NULL, drawn->max},
      {gates ? "area_mean" : NULL, s->area_mean},
      {gates ? "area_max" : NULL, s->area_max},
      {gates ? "ioff_mean" : NULL, s->ioff_mean},
      {gates ? "ioff_max" : NULL, s->ioff_max},
      {gates ? "ioff_total" : NULL, s->ioff_total[2]},
      {isnan(s->ioff_total[0]) ? NULL : "ioff_total_n", s->ioff_total[0]},
      {isnan(s->ioff_total[1]) ? NULL : "ioff_total_p", s->ioff_total[1]},
      {changes.n ? "ion_change_mean" : NULL, mean_of(&changes)},
      {changes.n ? "ion_change_max" : NULL, changes.max},
      {edges ? "epe_mean" : NULL, s->epe_mean},
      {edges ? "epe_max" : NULL, s->epe_max},
      {s->sites ? "epe_lost" : NULL, (double)s->lost},
      {corrects ? "iterations" : NULL, m->iterations},
      {corrects ? "simulations" : NULL, m->simulations},
      {corrects ? "fine_simulations" : NULL, m->fine_simulations},
      {"failed", (double)s->failed},
      {m->gates->count ? "outside" : NULL, (double)s->outside},
  };
  return opc_put_metrics(host, OPC_ARRAY(values), error);
}

/* ---- run ---- */

int correct_report_mask(const opc_host *host, const report *r,
                        opc_error *error) {
  const eda_mask *m = r->mask;
  const summary s =
      summarize(m->gates, m->count, &m->design, &m->after, m->flags, r->sites);
  int code = gate_table(host, r, error);
  if (!code) code = finding_table(host, m, error);
  if (!code && m->gates->count) code = summary_table(host, r, error);
  if (!code && !r->corrected) code = effort_table(host, m, &s, error);
  if (!code) code = report_metrics(host, r, &s, error);
  return code;
}

/* Log each stated cause of violations once. Returns the number of violations
   without a stated cause. */
static size_t violations_log_reasons(const opc_host *host,
                                     const eda_violation *v, size_t n) {
  size_t without = 0;
  for (size_t i = 0; i < n; i++) {
    size_t before = 0, count = 0;
    without += !strchr(v[i].rule, ';');
    for (size_t k = 0; k < n && strchr(v[i].rule, ';') && !before; k++) {
      before = k < i && !strcmp(v[i].rule, v[k].rule);
      count += !strcmp(v[i].rule, v[k].rule);
    }
    if (count && !before)
      host->log(
          host, OPC_LOG_FINDING,
          "%zu location%s cannot meet a rule: %s; the first is at (%g, %g) nm",
          count, count == 1 ? "" : "s", v[i].rule, v[i].x, v[i].y);
  }
  return without;
}

int correct_report_violations(const opc_host *host, const eda_gates *gates,
                              const eda_violation *v, size_t n,
                              opc_error *error) {
  size_t unexplained = violations_log_reasons(host, v, n);
  const opc_metric_value values[] = {
      {"violations", (double)n},
      {"violations_unexplained", (double)unexplained}};
  int code = opc_put_metrics(host, OPC_ARRAY(values), error);
  if (code || !n) return code;
  host->log(
      host, OPC_LOG_WARNING,
      "%zu rule violation%s, %zu without a known cause: see violations.csv", n,
      n == 1 ? "" : "s", unexplained);
  struct {
    char *gate;
    eda_violation v;
  } *row = eda_alloc(n, sizeof *row);
  for (size_t i = 0; i < n; i++) {
    row[i].v = v[i];
    row[i].gate = v[i].gate >= 0
                      ? correct_report_gate_name(gates, (size_t)v[i].gate)
                      : g_strdup("");
  }
  const opc_column columns[] = {
      {"rule", NULL, OPC_TEXT, 0, &row->v.rule},
      {"transistor", NULL, OPC_TEXT, 0, &row->gate},
      {"x", "nm", OPC_REAL, 1, &row->v.x},
      {"y", "nm", OPC_REAL, 1, &row->v.y},
      {"value", "nm", OPC_REAL, 2, &row->v.value},
      {"limit", "nm", OPC_REAL, 2, &row->v.limit},
  };
  code =
      opc_put_rows(host, "violations", n <= SHORT_TABLE ? OPC_TABLE_PRINT : 0,
                   n, sizeof *row, OPC_ARRAY(columns), error);
  for (size_t i = 0; i < n; i++) g_free(row[i].gate);
  free(row);
  return code;
}

int correct_report_rules(const opc_host *host, const opc_module *regulator,
                         const eda_printed *printed, eda_mask *mask,
                         opc_error *error) {
  eda_violation *v;
  size_t n;
  if (!regulator) return OPC_OK;
  int code =
      correct_violations(host->context, regulator, printed, &v, &n, error);
  if (!code)
    code = correct_report_violations(host, printed->gates, v, n, error);
  if (!code) eda_mask_set_violations(mask, v, n);
  free(v);
  return code;
}
