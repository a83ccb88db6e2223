/* SPDX-License-Identifier: BSD-3-Clause */
/* What a correction tells: a table of its transistors, one of their
   statistics (thesis eq. 3.3 to 3.7), and metrics. */
#include "report.h"

#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

enum { SHORT_TABLE = 24 }; /* as many rows are shown rather than only filed */

/* ---- statistics ---- */

typedef struct statistics {
  double n, sum, absolute, square, max;
} statistics;

static void count(statistics *s, double x) {
  s->n++;
  s->sum += x;
  s->absolute += fabs(x);
  s->square += x * x;
  s->max = fmax(s->max, fabs(x));
}

static double mean_of(const statistics *s) {
  return s->n ? s->absolute / s->n : 0;
}

static double stdv(const statistics *s) {
  if (!s->n) return 0;
  double mean = s->sum / s->n;
  return sqrt(fmax(0, s->square / s->n - mean * mean));
}

/* Of gates: n, p and all. */
typedef struct groups {
  statistics ion[3], area[3], ioff[3];
} groups;

static groups gather(const eda_gates *g, const eda_performance *design,
                     const eda_performance *printed) {
  groups out = {0};
  for (size_t i = 0; i < g->count; i++) {
    double ion = eda_deviation(printed->ion[i], design->ion[i]);
    double area = eda_deviation(printed->area[i], design->area[i]);
    double ioff = eda_deviation(printed->ioff[i], design->ioff[i]);
    for (int k = 0; k < 2; k++) {
      int group = k ? 2 : g->type[i] == EDA_PMOS;
      count(&out.ion[group], ion);
      count(&out.area[group], area);
      count(&out.ioff[group], ioff);
    }
  }
  return out;
}

summary summarize(const eda_gates *gates, const eda_performance *design,
                  const eda_performance *printed, const uint32_t *flags,
                  const sites *places) {
  groups g = gather(gates, design, printed);
  statistics epe = {0};
  summary out = {.ion_mean = mean_of(&g.ion[2]),
                 .ion_max = g.ion[2].max,
                 .ion_stdv = stdv(&g.ion[2]),
                 .area_mean = mean_of(&g.area[2]),
                 .area_max = g.area[2].max,
                 .ioff_mean = mean_of(&g.ioff[2]),
                 .gates = gates->count};
  for (size_t i = 0; i < gates->count; i++)
    out.failed += (flags[i] & ~(uint32_t)EDA_PRINT_NOTES) != 0;
  for (size_t k = 0; places && k < gates->layers; k++) {
    out.sites += places[k].count;
    for (size_t i = 0; i < places[k].count; i++)
      if (isnan(places[k].epe[i]))
        out.lost++;
      else
        count(&epe, places[k].epe[i]);
  }
  out.epe_mean = mean_of(&epe);
  out.epe_max = epe.max;
  return out;
}

/* ---- history ---- */

void history_add(history *h, const summary *print, uint32_t iteration,
                 uint32_t simulations) {
  eda_grow(&h->line, &h->room, h->count + 1, sizeof *h->line);
  h->line[h->count++] = (history_line){*print, iteration, simulations};
}

void history_clear(history *h) { free(h->line); }

int history_report(const history *h, const opc_host *host, opc_error *error) {
  enum { FIGURES = 7, COLUMNS = FIGURES + 2 };
  static const struct {
    const char *name, *unit;
    size_t offset;
  } figures[FIGURES] = {
      {"ion_mean", "%", offsetof(summary, ion_mean)},
      {"ion_max", "%", offsetof(summary, ion_max)},
      {"ion_stdv", "%", offsetof(summary, ion_stdv)},
      {"area_mean", "%", offsetof(summary, area_mean)},
      {"area_max", "%", offsetof(summary, area_max)},
      {"epe_mean", "nm", offsetof(summary, epe_mean)},
      {"epe_max", "nm", offsetof(summary, epe_max)},
  };
  size_t rows = h->count, n = 0;
  const history_line *lines = h->line;
  g_autofree int64_t *iteration = g_new(int64_t, rows + 1);
  g_autofree int64_t *simulations = g_new(int64_t, rows + 1);
  g_autofree double *figure = g_new(double, FIGURES *(rows + 1));
  opc_column columns[COLUMNS];
  columns[n++] = (opc_column){"iteration", NULL, OPC_INT, 0, iteration};
  for (int k = 0; k < FIGURES; k++) {
    int of_sites = *figures[k].unit == 'n';
    if (!rows || !(of_sites ? lines[0].print.sites : lines[0].print.gates))
      continue;
    double *column = figure + (size_t)k * rows;
    for (size_t i = 0; i < rows; i++)
      column[i] =
          *(const double *)(const void *)((const char *)&lines[i].print +
                                          figures[k].offset);
    columns[n++] =
        (opc_column){figures[k].name, figures[k].unit, OPC_REAL, 4, column};
  }
  columns[n++] = (opc_column){"simulations", NULL, OPC_INT, 0, simulations};
  for (size_t i = 0; i < rows; i++) {
    iteration[i] = lines[i].iteration;
    simulations[i] = lines[i].simulations;
  }
  return host->table(host, "history", 0, rows, columns, n, error);
}

/* ---- tables ---- */

/* What may be found of a print: the failures, the gravest first, then notes. */
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
                {EDA_PRINT_BITE, "bite"}};

/* The first of the findings. */
static const char *trouble(uint32_t flags) {
  for (size_t k = 0; k < G_N_ELEMENTS(findings); k++)
    if (flags & findings[k].flag) return findings[k].name;
  return "";
}

/* How many transistors have each of them; one may have several. */
static int finding_table(const opc_host *host, const eda_mask *m,
                         opc_error *error) {
  const char *name[G_N_ELEMENTS(findings)];
  int64_t number[G_N_ELEMENTS(findings)];
  size_t rows = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(findings); k++) {
    name[rows] = findings[k].name;
    number[rows] = 0;
    for (size_t i = 0; i < m->gates->count; i++)
      number[rows] += (m->flags[i] & findings[k].flag) != 0;
    rows += number[rows] > 0;
  }
  const opc_column columns[] = {{"print", NULL, OPC_TEXT, 0, name},
                                {"transistors", NULL, OPC_INT, 0, number}};
  return rows ? host->table(host, "prints", 0, rows, columns,
                            G_N_ELEMENTS(columns), error)
              : OPC_OK;
}

/* "XU1:3", or "NAND2:3" at the top. */
static char *gate_name(const eda_gates *g, size_t i) {
  const char *where = *g->instance[i] ? g->instance[i] : g->cell[i];
  return g_strdup_printf("%s:%u", where, g->number[i]);
}

enum {
  NAME,
  CELL,
  TYPE,
  L,
  W,
  X,
  Y,
  ION_DRAWN,
  ION,
  IOFF,
  AREA,
  LEQ,
  WEQ,
  CHANGE,
  MASK_L,
  MASK_W,
  MASK_JOG,
  END_LOW,
  END_HIGH,
  PAST_LOW,
  PAST_HIGH,
  PRINT,
  VERDICT,
  COLUMNS
};

static const opc_column headers[COLUMNS] = {
    [NAME] = {"transistor", NULL, OPC_TEXT, 0, NULL},
    [CELL] = {"cell", NULL, OPC_TEXT, 0, NULL},
    [TYPE] = {"type", NULL, OPC_TEXT, 0, NULL},
    [L] = {"l", "nm", OPC_REAL, 1, NULL},
    [W] = {"w", "nm", OPC_REAL, 1, NULL},
    [X] = {"x", "nm", OPC_REAL, 1, NULL},
    [Y] = {"y", "nm", OPC_REAL, 1, NULL},
    [ION_DRAWN] = {"ion_before", "%", OPC_REAL, 3, NULL},
    [ION] = {"ion_after", "%", OPC_REAL, 3, NULL},
    [IOFF] = {"ioff_after", "%", OPC_REAL, 2, NULL},
    [AREA] = {"area_after", "%", OPC_REAL, 2, NULL},
    [LEQ] = {"leq_ion", "nm", OPC_REAL, 3, NULL},
    [WEQ] = {"weq", "nm", OPC_REAL, 2, NULL},
    [CHANGE] = {"ion_change", "%", OPC_REAL, 3, NULL},
    [MASK_L] = {"mask_l", "nm", OPC_REAL, 1, NULL},
    [MASK_W] = {"mask_w", "nm", OPC_REAL, 1, NULL},
    [MASK_JOG] = {"mask_jog", "nm", OPC_REAL, 1, NULL},
    [END_LOW] = {"end_low", "nm", OPC_REAL, 1, NULL},
    [END_HIGH] = {"end_high", "nm", OPC_REAL, 1, NULL},
    [PAST_LOW] = {"extension_low", "nm", OPC_REAL, 2, NULL},
    [PAST_HIGH] = {"extension_high", "nm", OPC_REAL, 2, NULL},
    [PRINT] = {"print", NULL, OPC_TEXT, 0, NULL},
    [VERDICT] = {"verdict", NULL, OPC_TEXT, 0, NULL},
};

/* What is printed of few transistors. */
static int is_shown(int column) {
  return column == NAME || column == TYPE || column == L || column == W ||
         (column >= ION_DRAWN && column <= AREA) || column == CHANGE ||
         column == MASK_L || column == MASK_W || column == VERDICT;
}

static int is_there(const report *r, int column) {
  if (column == ION_DRAWN) return !r->corrected;
  if (column == CHANGE) return r->corrected != NULL;
  if (column >= MASK_L && column <= END_HIGH) return r->biases != NULL;
  if (column == VERDICT) return r->synthesizer != NULL;
  return 1;
}

/* How far the deviation of a gate's Ion is from that in the loop. */
static double change(const report *r, size_t i) {
  const eda_mask *m = r->mask, *c = r->corrected;
  return eda_deviation(m->after.ion[i], m->design.ion[i]) -
         eda_deviation(c->after.ion[i], c->design.ion[i]);
}

static const char *verdict_of(const opc_context *context,
                              const opc_module *synthesizer, size_t gate) {
  const eda_synthesizer *s = synthesizer->functions;
  const char *before = opc_enter(context, synthesizer->id);
  const char *why = s->verdict ? s->verdict(synthesizer->self, gate) : NULL;
  opc_leave(context, before);
  return why ? why : "";
}

static void fill_texts(const opc_context *context, const report *r, size_t i,
                       const char **text[COLUMNS]) {
  const eda_gates *g = r->mask->gates;
  text[NAME][i] = gate_name(g, i);
  text[CELL][i] = g->cell[i];
  text[TYPE][i] = g->type[i] == EDA_PMOS ? "p" : "n";
  text[PRINT][i] = trouble(r->mask->flags[i]);
  if (r->synthesizer) text[VERDICT][i] = verdict_of(context, r->synthesizer, i);
}

static void fill_figures(const report *r, size_t i, double *real[COLUMNS]) {
  const eda_mask *m = r->mask;
  const eda_gates *g = m->gates;
  real[L][i] = g->length[i];
  real[W][i] = g->width[i];
  real[X][i] = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
  real[Y][i] = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
  real[ION_DRAWN][i] = eda_deviation(m->before.ion[i], m->design.ion[i]);
  real[ION][i] = eda_deviation(m->after.ion[i], m->design.ion[i]);
  real[IOFF][i] = eda_deviation(m->after.ioff[i], m->design.ioff[i]);
  real[AREA][i] = eda_deviation(m->after.area[i], m->design.area[i]);
  real[LEQ][i] = m->after.leq_ion[i];
  real[WEQ][i] = m->after.weq[i];
  if (r->corrected) real[CHANGE][i] = change(r, i);
  for (size_t side = 0; side < 2; side++)
    real[PAST_LOW + side][i] = r->extension[2 * i + side];
  const biases *b = r->biases;
  if (!b) return;
  real[MASK_L][i] = b->l[i] * g->grid;
  real[MASK_W][i] = b->w[i] * g->grid;
  real[MASK_JOG][i] = b->jog[i] * g->grid;
  for (size_t side = 0; side < 2; side++)
    real[END_LOW + side][i] = b->end[2 * i + side] * g->grid;
}

static int gate_table(const opc_host *host, const report *r, opc_error *error) {
  size_t n = r->mask->gates->count, filed = 0, shown = 0;
  opc_column file[COLUMNS], show[COLUMNS];
  double *real[COLUMNS] = {0};
  const char **text[COLUMNS] = {0};
  for (int c = 0; c < COLUMNS; c++) {
    opc_column column = headers[c];
    if (headers[c].type == OPC_REAL)
      column.data = real[c] = g_new0(double, n + 1);
    else
      column.data = text[c] = g_new0(const char *, n + 1);
    if (is_there(r, c)) file[filed++] = column;
    if (is_there(r, c) && is_shown(c)) show[shown++] = column;
  }
  for (size_t i = 0; i < n; i++) {
    fill_texts(host->context, r, i, text);
    fill_figures(r, i, real);
  }
  int code = host->table(host, "gates", 0, n, file, filed, error);
  if (!code && n && n <= SHORT_TABLE)
    code = host->table(host, "transistors", OPC_TABLE_PRINT, n, show, shown,
                       error);
  for (size_t i = 0; i < n; i++) g_free((char *)text[NAME][i]);
  for (int c = 0; c < COLUMNS; c++) {
    g_free(real[c]);
    g_free(text[c]);
  }
  return code;
}

static int summary_table(const opc_host *host, const report *r,
                         opc_error *error) {
  static const char *const names[3] = {"n", "p", "all"};
  enum { ROWS = 3, BEFORE = 3, FIGURES = 8 };
  const eda_mask *m = r->mask;
  const groups before = gather(m->gates, &m->design, &m->before);
  const groups after = gather(m->gates, &m->design, &m->after);
  const char *name[ROWS];
  int64_t number[ROWS];
  double figure[FIGURES][ROWS];
  size_t rows = 0;
  for (int t = 0; t < ROWS; t++) {
    if (!after.ion[t].n) continue;
    const double figures[FIGURES] = {
        mean_of(&before.ion[t]), before.ion[t].max, mean_of(&before.area[t]),
        mean_of(&after.ion[t]),  after.ion[t].max,  stdv(&after.ion[t]),
        mean_of(&after.area[t]), after.area[t].max};
    for (int k = 0; k < FIGURES; k++) figure[k][rows] = figures[k];
    name[rows] = names[t];
    number[rows++] = (int64_t)after.ion[t].n;
  }
  const opc_column all[] = {
      {"type", NULL, OPC_TEXT, 0, name},
      {"transistors", NULL, OPC_INT, 0, number},
      {"ion_mean_before", "%", OPC_REAL, 3, figure[0]},
      {"ion_max_before", "%", OPC_REAL, 3, figure[1]},
      {"ion_mean_after", "%", OPC_REAL, 3, figure[3]},
      {"ion_max_after", "%", OPC_REAL, 3, figure[4]},
      {"ion_stdv_after", "%", OPC_REAL, 3, figure[5]},
      {"area_mean_before", "%", OPC_REAL, 2, figure[2]},
      {"area_mean_after", "%", OPC_REAL, 2, figure[6]},
      {"area_max_after", "%", OPC_REAL, 2, figure[7]},
  };
  opc_column columns[G_N_ELEMENTS(all)];
  size_t n = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(all); k++)
    if (!r->corrected || !g_str_has_suffix(all[k].name, "_before"))
      columns[n++] = all[k];
  return host->table(host, "summary", OPC_TABLE_PRINT, rows, columns, n, error);
}

static int effort_table(const opc_host *host, const eda_mask *mask,
                        const summary *s, opc_error *error) {
  int64_t iterations = mask->iterations, simulations = mask->simulations;
  int64_t unsound = (int64_t)s->failed, fragments = (int64_t)s->sites;
  opc_column columns[] = {
      {"iterations", NULL, OPC_INT, 0, &iterations},
      {"litho_simulations", NULL, OPC_INT, 0, &simulations},
      {"failed_transistors", NULL, OPC_INT, 0, &unsound},
      {"fragments", NULL, OPC_INT, 0, &fragments},
      {"epe_mean", "nm", OPC_REAL, 3, &s->epe_mean},
      {"epe_max", "nm", OPC_REAL, 3, &s->epe_max},
  };
  return host->table(host, "effort", OPC_TABLE_PRINT, 1, columns,
                     s->sites ? 6 : 3, error);
}

/* ---- metrics ---- */

static int metrics(const opc_host *host, const report *r, const summary *s,
                   opc_error *error) {
  const eda_mask *m = r->mask;
  const summary drawn =
      summarize(m->gates, &m->design, &m->before, m->flags, NULL);
  statistics changes = {0};
  for (size_t i = 0; r->corrected && i < m->gates->count; i++)
    count(&changes, change(r, i));
  int gates = m->gates->count > 0, corrects = !r->corrected;
  int edges = s->sites > s->lost;
  const struct {
    const char *name;
    double value;
    int is_there;
  } all[] = {
      {"transistors", (double)m->gates->count, corrects},
      {"ion_mean", s->ion_mean, gates},
      {"ion_max", s->ion_max, gates},
      {"ion_stdv", s->ion_stdv, gates},
      {"ion_mean_drawn", drawn.ion_mean, gates && corrects},
      {"ion_max_drawn", drawn.ion_max, gates && corrects},
      {"area_mean", s->area_mean, gates},
      {"area_max", s->area_max, gates},
      {"ioff_mean", s->ioff_mean, gates},
      {"ion_change_mean", mean_of(&changes), gates && !corrects},
      {"ion_change_max", changes.max, gates && !corrects},
      {"epe_mean", s->epe_mean, edges},
      {"epe_max", s->epe_max, edges},
      {"epe_lost", (double)s->lost, s->sites > 0},
      {"iterations", m->iterations, corrects},
      {"simulations", m->simulations, corrects},
      {"failed", (double)s->failed, 1},
  };
  int code = OPC_OK;
  for (size_t i = 0; i < G_N_ELEMENTS(all) && !code; i++)
    if (all[i].is_there)
      code = host->metric(host, all[i].name, all[i].value, error);
  return code;
}

/* ---- all of it ---- */

int report_mask(const opc_host *host, const report *r, opc_error *error) {
  const eda_mask *m = r->mask;
  const summary s =
      summarize(m->gates, &m->design, &m->after, m->flags, r->sites);
  int code = gate_table(host, r, error);
  if (!code) code = finding_table(host, m, error);
  if (!code && m->gates->count) code = summary_table(host, r, error);
  if (!code && !r->corrected) code = effort_table(host, m, &s, error);
  if (!code) code = metrics(host, r, &s, error);
  return code;
}

int report_violations(const opc_host *host, const eda_gates *gates,
                      const eda_violation *v, size_t n, size_t total,
                      opc_error *error) {
  int code = host->metric(host, "violations", (double)total, error);
  if (code || !n) return code;
  host->log(host, OPC_LOG_WARNING, "%zu rule%s not kept: see violations.csv",
            total, total == 1 ? " is" : "s are");
  const char **rule = g_new(const char *, n), **name = g_new(const char *, n);
  double *figure[4];
  for (int k = 0; k < 4; k++) figure[k] = g_new(double, n);
  for (size_t i = 0; i < n; i++) {
    rule[i] = v[i].rule;
    name[i] =
        v[i].gate >= 0 ? gate_name(gates, (size_t)v[i].gate) : g_strdup("");
    figure[0][i] = v[i].x;
    figure[1][i] = v[i].y;
    figure[2][i] = v[i].value;
    figure[3][i] = v[i].limit;
  }
  opc_column columns[] = {
      {"rule", NULL, OPC_TEXT, 0, rule},
      {"transistor", NULL, OPC_TEXT, 0, name},
      {"x", "nm", OPC_REAL, 1, figure[0]},
      {"y", "nm", OPC_REAL, 1, figure[1]},
      {"value", "nm", OPC_REAL, 2, figure[2]},
      {"limit", "nm", OPC_REAL, 2, figure[3]},
  };
  code = host->table(host, "violations", n <= SHORT_TABLE ? OPC_TABLE_PRINT : 0,
                     n, columns, G_N_ELEMENTS(columns), error);
  for (size_t i = 0; i < n; i++) g_free((char *)name[i]);
  g_free(rule);
  g_free(name);
  for (int k = 0; k < 4; k++) g_free(figure[k]);
  return code;
}
