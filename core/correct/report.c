/* SPDX-License-Identifier: BSD-3-Clause */
/* What a correction tells: a table of its transistors, one of their
   statistics (thesis eq. 3.3 to 3.7), and metrics. */
#include "core/correct/loop.h"
#include "core/plugin/guard.h"

#include <glib.h>
#include <math.h>

enum { SHORT_TABLE = 24 };   /* as many rows are shown rather than only filed */

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

static double mean_of(const statistics *s) { return s->n ? s->absolute / s->n : 0; }

static double stdv(const statistics *s) {
  if (!s->n) return 0;
  double mean = s->sum / s->n;
  return sqrt(fmax(0, s->square / s->n - mean * mean));
}

/* What was found wrong with a print. */
static const char *trouble(uint32_t flags) {
  if (flags & OPC_PRINT_NO_ACTIVE) return "no active";
  if (flags & OPC_PRINT_OPEN) return "open";
  if (flags & OPC_PRINT_MERGED) return "merged";
  if (flags & OPC_PRINT_SHORT) return "short line end";
  return "";
}

/* "XU1:3", or "NAND2:3" at the top. */
static char *gate_name(const opc_gates *g, size_t i) {
  const char *where = *g->instance[i] ? g->instance[i] : g->cell[i];
  return g_strdup_printf("%s:%u", where, g->number[i]);
}

enum { NAME, CELL, TYPE, L, W, X, Y, ION_DRAWN, ION, IOFF, AREA, LEQ, WEQ,
       MASK_L, MASK_W, END_LOW, END_HIGH, PAST_LOW, PAST_HIGH, PRINT, VERDICT,
       COLUMNS };

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
    [MASK_L] = {"mask_l", "nm", OPC_REAL, 1, NULL},
    [MASK_W] = {"mask_w", "nm", OPC_REAL, 1, NULL},
    [END_LOW] = {"end_low", "nm", OPC_REAL, 1, NULL},
    [END_HIGH] = {"end_high", "nm", OPC_REAL, 1, NULL},
    [PAST_LOW] = {"extension_low", "nm", OPC_REAL, 2, NULL},
    [PAST_HIGH] = {"extension_high", "nm", OPC_REAL, 2, NULL},
    [PRINT] = {"print", NULL, OPC_TEXT, 0, NULL},
    [VERDICT] = {"verdict", NULL, OPC_TEXT, 0, NULL},
};

static const int shown[] = {NAME, TYPE, L, W, ION_DRAWN, ION, IOFF, AREA,
                            MASK_L, MASK_W, VERDICT};

static int gate_table(const opc_host *host, const opc_mask *m,
                      const opc_biases *b, const double *extension,
                      const opc_module *synthesizer, opc_error *error) {
  const opc_synthesizer *s = synthesizer->plugin->operations;
  const opc_gates *g = m->gates;
  size_t n = g->count;
  opc_column columns[COLUMNS];
  double *real[COLUMNS] = {0};
  const char **text[COLUMNS] = {0};
  for (int c = 0; c < COLUMNS; c++) {
    columns[c] = headers[c];
    if (headers[c].type == OPC_REAL) columns[c].data = real[c] = g_new0(double, n + 1);
    else columns[c].data = text[c] = g_new0(const char *, n + 1);
  }
  for (size_t i = 0; i < n; i++) {
    text[NAME][i] = gate_name(g, i);
    text[CELL][i] = g->cell[i];
    text[TYPE][i] = g->type[i] == OPC_PMOS ? "p" : "n";
    text[PRINT][i] = trouble(m->flags[i]);
    const char *before = opc_enter(synthesizer->plugin->id);
    const char *why = s->verdict(synthesizer->self, i);
    opc_leave(before);
    text[VERDICT][i] = why ? why : "";
    real[L][i] = g->length[i];
    real[W][i] = g->width[i];
    real[X][i] = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
    real[Y][i] = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
    real[ION_DRAWN][i] = opc_deviation(m->before.ion[i], m->design.ion[i]);
    real[ION][i] = opc_deviation(m->after.ion[i], m->design.ion[i]);
    real[IOFF][i] = opc_deviation(m->after.ioff[i], m->design.ioff[i]);
    real[AREA][i] = opc_deviation(m->after.area[i], m->design.area[i]);
    real[LEQ][i] = m->after.leq_ion[i];
    real[WEQ][i] = m->after.weq[i];
    real[MASK_L][i] = b->l[i] * g->grid;
    real[MASK_W][i] = b->w[i] * g->grid;
    for (int side = 0; side < 2; side++) {
      real[END_LOW + side][i] = b->end[2 * i + side] * g->grid;
      real[PAST_LOW + side][i] = extension[2 * i + side];
    }
  }
  int code = host->table(host, "gates", 0, n, columns, COLUMNS, error);
  if (!code && n <= SHORT_TABLE) {
    opc_column some[G_N_ELEMENTS(shown)];
    for (size_t k = 0; k < G_N_ELEMENTS(shown); k++) some[k] = columns[shown[k]];
    code = host->table(host, "transistors", OPC_TABLE_PRINT, n, some,
                       G_N_ELEMENTS(shown), error);
  }
  for (size_t i = 0; i < n; i++) g_free((char *)text[NAME][i]);
  for (int c = 0; c < COLUMNS; c++) {
    g_free(real[c]);
    g_free(text[c]);
  }
  return code;
}

/* n, p and both, before and after. */
typedef struct groups {
  statistics ion[3][2], area[3][2];
  double failed;
} groups;

static void gather(const opc_mask *m, groups *out) {
  *out = (groups){0};
  for (size_t i = 0; i < m->gates->count; i++) {
    int type = m->gates->type[i] == OPC_PMOS;
    for (int k = 0; k < 2; k++) {
      const opc_performance *p = k ? &m->after : &m->before;
      double ion = opc_deviation(p->ion[i], m->design.ion[i]);
      double area = opc_deviation(p->area[i], m->design.area[i]);
      count(&out->ion[type][k], ion);
      count(&out->ion[2][k], ion);
      count(&out->area[type][k], area);
      count(&out->area[2][k], area);
    }
    out->failed += m->flags[i] != 0;
  }
}

static int summary_table(const opc_host *host, const groups *g,
                         opc_error *error) {
  static const char *const names[3] = {"n", "p", "all"};
  enum { ROWS = 3, FIGURES = 9 };
  const char *name[ROWS];
  int64_t number[ROWS];
  double figure[FIGURES][ROWS];
  size_t rows = 0;
  for (int t = 0; t < 3; t++) {
    if (!g->ion[t][0].n) continue;
    name[rows] = names[t];
    number[rows] = (int64_t)g->ion[t][0].n;
    for (int k = 0; k < 2; k++) {
      figure[3 * k][rows] = mean_of(&g->ion[t][k]);
      figure[3 * k + 1][rows] = g->ion[t][k].max;
      figure[3 * k + 2][rows] = stdv(&g->ion[t][k]);
      figure[6 + k][rows] = mean_of(&g->area[t][k]);
    }
    figure[8][rows] = g->area[t][1].max;
    rows++;
  }
  opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, name},
      {"transistors", NULL, OPC_INT, 0, number},
      {"ion_mean_before", "%", OPC_REAL, 3, figure[0]},
      {"ion_max_before", "%", OPC_REAL, 3, figure[1]},
      {"ion_mean_after", "%", OPC_REAL, 3, figure[3]},
      {"ion_max_after", "%", OPC_REAL, 3, figure[4]},
      {"ion_stdv_after", "%", OPC_REAL, 3, figure[5]},
      {"area_mean_before", "%", OPC_REAL, 2, figure[6]},
      {"area_mean_after", "%", OPC_REAL, 2, figure[7]},
  };
  return host->table(host, "summary", OPC_TABLE_PRINT, rows, columns,
                     G_N_ELEMENTS(columns), error);
}

static int effort_table(const opc_host *host, const opc_mask *mask,
                        double failed, opc_error *error) {
  int64_t iterations = mask->iterations, simulations = mask->simulations;
  int64_t unsound = (int64_t)failed;
  opc_column columns[] = {
      {"iterations", NULL, OPC_INT, 0, &iterations},
      {"litho_simulations", NULL, OPC_INT, 0, &simulations},
      {"failed_transistors", NULL, OPC_INT, 0, &unsound},
  };
  return host->table(host, "effort", OPC_TABLE_PRINT, 1, columns,
                     G_N_ELEMENTS(columns), error);
}

int opc_correct_report(const opc_host *host, const opc_mask *mask,
                       const opc_biases *biases, const double *extension,
                       const opc_module *synthesizer, opc_error *error) {
  groups g;
  gather(mask, &g);
  int code = gate_table(host, mask, biases, extension, synthesizer, error);
  if (!code) code = summary_table(host, &g, error);
  if (!code) code = effort_table(host, mask, g.failed, error);
  const struct {
    const char *name;
    double value;
  } metrics[] = {
      {"transistors", (double)mask->gates->count},
      {"ion_mean", mean_of(&g.ion[2][1])},
      {"ion_max", g.ion[2][1].max},
      {"ion_stdv", stdv(&g.ion[2][1])},
      {"ion_mean_drawn", mean_of(&g.ion[2][0])},
      {"ion_max_drawn", g.ion[2][0].max},
      {"area_mean", mean_of(&g.area[2][1])},
      {"iterations", mask->iterations},
      {"simulations", mask->simulations},
      {"failed", g.failed},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(metrics) && !code; i++)
    code = host->metric(host, metrics[i].name, metrics[i].value, error);
  return code;
}

int opc_correct_report_violations(const opc_host *host,
                                  const opc_gates *gates,
                                  const opc_violation *v, size_t n,
                                  size_t total, opc_error *error) {
  int code = host->metric(host, "violations", (double)total, error);
  if (code || !n) return code;
  host->log(host, OPC_LOG_WARNING, "%zu rule%s not kept: see violations.csv",
            total, total == 1 ? " is" : "s are");
  const char **rule = g_new(const char *, n), **name = g_new(const char *, n);
  double *figure[4];
  for (int k = 0; k < 4; k++) figure[k] = g_new(double, n);
  for (size_t i = 0; i < n; i++) {
    rule[i] = v[i].rule;
    name[i] = v[i].gate >= 0 ? gate_name(gates, (size_t)v[i].gate) : g_strdup("");
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
