/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the report of a mask with random figures against plain sums: tables,
   metrics and messages. */
#include "report.c"

#include "tools/devel/testing.h"

#define failed                                                   \
  failed_by_findings /* both included files define a function of \
                        this name */
#include "findings.c"
#undef failed

enum { GATES = 14, SITES = 9 };

static double in(double low, double high) {
  static uint32_t state = 9;
  state = state * 1664525u + 1013904223u;
  return low + (high - low) * (state >> 8) / (1 << 24);
}

/* ---- a random mask ---- */

typedef struct made {
  eda_box box[GATES];
  uint8_t type[GATES], axis[GATES], outside[GATES];
  uint32_t number[GATES], flags[2][GATES], flags_before[GATES];
  double length[GATES], width[GATES], extension[2 * GATES];
  char *cell[GATES], *instance[GATES], *held[GATES];
  double of[4][6][GATES]; /* design, before, after, after in the loop */
  eda_gates gates;
  eda_mask mask[2];          /* the reported mask, and the mask with the figures
                                of the loop */
  int32_t moved[12 * GATES]; /* storage of the biases and of their base */
  eda_moved base;
  biases biases;
  double epe[SITES];
  sites sites[2];
} made;

static eda_performance performance_of(made *d, int which) {
  double(*o)[GATES] = d->of[which];
  return (eda_performance){GATES, o[0], o[1], o[2],
                           o[3],  o[4], o[5], d->outside};
}

static void make_sample(made *d) {
  static const uint32_t flags[] = {0,
                                   EDA_PRINT_NECK,
                                   0,
                                   EDA_PRINT_OPEN,
                                   0,
                                   EDA_PRINT_SHORT | EDA_PRINT_WIDE,
                                   EDA_PRINT_OUTSIDE,
                                   EDA_PRINT_MERGED | EDA_PRINT_OPEN,
                                   EDA_PRINT_NOTCH,
                                   0,
                                   EDA_PRINT_ISLAND | EDA_PRINT_OUTSIDE,
                                   EDA_PRINT_WIDE | EDA_PRINT_NECK,
                                   EDA_PRINT_NO_ACTIVE,
                                   0};
  memset(d, 0, sizeof *d);
  for (int i = 0; i < GATES; i++) {
    int32_t x = (int32_t)in(-900, 900), y = (int32_t)in(-900, 900);
    d->box[i] = (eda_box){x, y, x + 65, y + (int32_t)in(90, 300)};
    d->type[i] = i % 3 ? EDA_NMOS : EDA_PMOS;
    d->number[i] = (uint32_t)i + 1;
    d->length[i] = in(50, 70);
    d->width[i] = in(100, 400);
    d->cell[i] = "NAND";
    d->instance[i] = i & 1 ? "X7" : "";
    d->flags[0][i] = flags[i];
    d->flags[1][i] = i == 9 ? EDA_PRINT_OPEN : 0;
    d->flags_before[i] = i == 4 || i == 12 ? EDA_PRINT_MERGED : 0;
    for (int p = 0; p < 4; p++)
      for (int k = 0; k < 6; k++)
        d->of[p][k][i] = 1e-3 * (k + 1) * (p ? in(0.8, 1.3) : 1);
    for (int k = 0; k < 2; k++) d->extension[2 * i + k] = in(0, 99);
  }
  for (int k = 0; k < 12 * GATES; k++) d->moved[k] = (int32_t)in(-20, 20);
  for (int i = 0; i < GATES; i++)
    if (i & 2) d->moved[3 * GATES + i] = 0; /* some gates have no jog */
  int32_t *m = d->moved, *b = m + 6 * GATES;
  d->base = (eda_moved){
      .w = b, .l = b + 2 * GATES, .jog = b + 3 * GATES, .end = b + 4 * GATES};
  d->biases = (biases){.w = m,
                       .l = m + 2 * GATES,
                       .jog = m + 3 * GATES,
                       .end = m + 4 * GATES,
                       .base = &d->base};
  d->gates = (eda_gates){.grid = 0.5,
                         .layers = 2,
                         .count = GATES,
                         .box = d->box,
                         .type = d->type,
                         .axis = d->axis,
                         .number = d->number,
                         .length = d->length,
                         .width = d->width,
                         .cell = d->cell,
                         .instance = d->instance};
  for (int k = 0; k < 2; k++)
    d->mask[k] = (eda_mask){.gates = &d->gates,
                            .layers = 2,
                            .design = performance_of(d, 0),
                            .before = performance_of(d, 1),
                            .after = performance_of(d, 2 + k),
                            .flags = d->flags[k],
                            .iterations = 3,
                            .simulations = 8,
                            .fine_simulations = 2};
  for (int i = 0; i < SITES; i++) d->epe[i] = i % 4 == 1 ? NAN : in(-9, 9);
  d->sites[0] = (sites){.count = 4, .epe = d->epe};
  d->sites[1] = (sites){.count = SITES - 4, .epe = d->epe + 4};
}

static int gate_prints(const uint32_t *flags, int i) {
  return !(flags[i] & (EDA_PRINT_OPEN | EDA_PRINT_NO_ACTIVE | EDA_PRINT_MERGED |
                       EDA_PRINT_SHORT | EDA_PRINT_ISLAND));
}

static double deviation_of(const made *d, int which, int figure, int i) {
  return 100 * (d->of[which][figure][i] / d->of[0][figure][i] - 1);
}

/* Mean and maximum of absolute values, standard deviation and rms. */
typedef struct plain {
  double mean, max, stdv, rms, n;
} plain;

static plain plain_of(const double *x, int n) {
  plain p = {.n = n};
  double sum = 0;
  for (int i = 0; i < n; i++) {
    p.mean += fabs(x[i]) / n;
    p.max = fmax(p.max, fabs(x[i]));
    p.rms += x[i] * x[i] / n;
    sum += x[i] / n;
  }
  for (int i = 0; i < n; i++) p.stdv += (x[i] - sum) * (x[i] - sum) / n;
  p.stdv = sqrt(p.stdv);
  p.rms = sqrt(p.rms);
  return p;
}

/* Compute the statistics of a figure over printing transistors; type 2: both
   types. */
static plain group(const made *d, int which, int figure, const uint32_t *flags,
                   int type) {
  double x[GATES];
  int n = 0;
  for (int i = 0; i < GATES; i++)
    if (gate_prints(flags, i) &&
        (type == 2 || (d->type[i] == EDA_PMOS) == type))
      x[n++] = deviation_of(d, which, figure, i);
  return plain_of(x, n);
}

static double leakage(const made *d, int type) {
  double sum[2] = {0};
  for (int i = 0; i < GATES; i++)
    for (int k = 0; k < 2; k++)
      if (gate_prints(d->flags[0], i) &&
          (type == 2 || (d->type[i] == EDA_PMOS) == type))
        sum[k] += d->of[2 * k][1][i];
  return 100 * (sum[1] / sum[0] - 1);
}

/* ---- cells ---- */

static const void *data_of(const char *table, const char *column) {
  const opc_column *c = opc_table_column(opc_test_table(table), column);
  if (!c) g_error("no column '%s' in '%s'", column, table);
  return c->data;
}

static void assert_same(double got, double want, const char *what) {
  if (!(isnan(want) ? isnan(got) : fabs(got - want) <= 1e-9 * (1 + fabs(want))))
    g_error("%s: %.12g, not %.12g", what, got, want);
}

static void assert_cell(const char *table, const char *column, int row,
                        double want) {
  assert_same(((const double *)data_of(table, column))[row], want, column);
}

static void assert_whole(const char *table, const char *column, int row,
                         int want) {
  assert_same((double)((const int64_t *)data_of(table, column))[row], want,
              column);
}

static const char *text(const char *table, const char *column, int row) {
  return ((char *const *)data_of(table, column))[row];
}

static void assert_metric(const char *name, double want) {
  assert_same(opc_test_metric(name), want, name);
}

/* ---- the tables ---- */

static const char *model_says(const void *self, size_t gate) {
  (void)self;
  return gate == 13 ? NULL : gate % 2 ? "odd" : "even";
}

static void assert_gate(const made *d, const report *r, int i) {
  const char *const figures[] = {"ion_after", "ioff_after", NULL,
                                 NULL,        NULL,         "area_after"};
  int good = gate_prints(d->flags[0], i),
      drawn = gate_prints(d->flags_before, i);
  g_autofree char *name =
      g_strdup_printf("%s:%d", i & 1 ? "X7" : "NAND", i + 1);
  g_assert_cmpstr(text("gates", "transistor", i), ==, name);
  g_assert_cmpstr(text("gates", "cell", i), ==, "NAND");
  g_assert_cmpstr(text("gates", "type", i), ==, i % 3 ? "n" : "p");
  assert_cell("gates", "l", i, d->length[i]);
  assert_cell("gates", "w", i, d->width[i]);
  assert_cell("gates", "x", i, (d->box[i].x0 + d->box[i].x1) / 4.0);
  assert_cell("gates", "y", i, (d->box[i].y0 + d->box[i].y1) / 4.0);
  for (int k = 0; k < 6; k++)
    if (figures[k])
      assert_cell("gates", figures[k], i,
                  good ? deviation_of(d, 2, k, i) : NAN);
  assert_cell("gates", "leq_ion", i, good ? d->of[2][2][i] : NAN);
  assert_cell("gates", "weq", i, good ? d->of[2][4][i] : NAN);
  assert_cell("gates", "extension_low", i, d->extension[2 * i]);
  assert_cell("gates", "extension_high", i, d->extension[2 * i + 1]);
  if (r->corrected) {
    double by = deviation_of(d, 2, 0, i) - deviation_of(d, 3, 0, i);
    assert_cell("gates", "ion_change", i,
                good && gate_prints(d->flags[1], i) ? by : NAN);
    return;
  }
  assert_cell("gates", "ion_before", i, drawn ? deviation_of(d, 1, 0, i) : NAN);
  static const int32_t zeros[6 * GATES];
  const int32_t *m = d->moved, *b = r->biases->base ? m + 6 * GATES : zeros;
  int jog = m[3 * GATES + i] ? m[3 * GATES + i] : b[3 * GATES + i];
  assert_cell("gates", "mask_w", i, 0.5 * (m[i] + b[i]));
  assert_cell("gates", "mask_l", i,
              0.5 * (m[2 * GATES + i] + b[2 * GATES + i]));
  assert_cell("gates", "mask_jog", i, 0.5 * jog);
  for (int s = 0; s < 2; s++)
    assert_cell("gates", s ? "end_high" : "end_low", i,
                0.5 * (m[4 * GATES + 2 * i + s] + b[4 * GATES + 2 * i + s]));
  const char *want = !good                                ? "does not print"
                     : r->held[i]                         ? r->held[i]
                     : d->flags[0][i] & EDA_PRINT_OUTSIDE ? "outside the table"
                     : i == 13                            ? ""
                     : i % 2                              ? "odd"
                                                          : "even";
  g_assert_cmpstr(text("gates", "verdict", i), ==, want);
}

static void assert_summary(const made *d, int corrects) {
  static const char *const names[] = {"n", "p", "all"};
  for (int t = 0; t < 3; t++) {
    plain ion = group(d, 2, 0, d->flags[0], t);
    plain area = group(d, 2, 5, d->flags[0], t);
    plain first = group(d, 1, 0, d->flags_before, t);
    g_assert_cmpstr(text("summary", "type", t), ==, names[t]);
    assert_whole("summary", "transistors", t, (int)ion.n);
    assert_cell("summary", "ion_mean_after", t, ion.mean);
    assert_cell("summary", "ion_max_after", t, ion.max);
    assert_cell("summary", "ion_stdv_after", t, ion.stdv);
    assert_cell("summary", "area_mean_after", t, area.mean);
    assert_cell("summary", "area_max_after", t, area.max);
    assert_cell("summary", "ioff_total_after", t, leakage(d, t));
    if (!corrects) continue;
    assert_cell("summary", "ion_mean_before", t, first.mean);
    assert_cell("summary", "ion_max_before", t, first.max);
    assert_cell("summary", "area_mean_before", t,
                group(d, 1, 5, d->flags_before, t).mean);
  }
  int has =
      opc_table_column(opc_test_table("summary"), "ion_mean_before") != NULL;
  g_assert_cmpint(has, ==, corrects);
}

static void assert_metrics(const made *d, int corrects) {
  plain ion = group(d, 2, 0, d->flags[0], 2);
  plain ioff = group(d, 2, 1, d->flags[0], 2);
  plain area = group(d, 2, 5, d->flags[0], 2);
  int failures = 0, beyond = 0;
  for (int i = 0; i < GATES; i++) {
    failures += !gate_prints(d->flags[0], i);
    beyond += (d->flags[0][i] & EDA_PRINT_OUTSIDE) != 0;
  }
  assert_metric("ion_mean", ion.mean);
  assert_metric("ion_max", ion.max);
  assert_metric("ion_stdv", ion.stdv);
  assert_metric("ion_rms", ion.rms);
  assert_metric("ioff_rms", ioff.rms);
  assert_metric("ioff_mean", ioff.mean);
  assert_metric("ioff_max", ioff.max);
  assert_metric("area_mean", area.mean);
  assert_metric("area_max", area.max);
  assert_metric("ioff_total", leakage(d, 2));
  assert_metric("ioff_total_n", leakage(d, 0));
  assert_metric("ioff_total_p", leakage(d, 1));
  assert_metric("failed", failures);
  assert_metric("outside", beyond);
  if (corrects) {
    plain first = group(d, 1, 0, d->flags_before, 2);
    double near[SITES];
    int n = 0;
    for (int i = 0; i < SITES; i++)
      if (!isnan(d->epe[i])) near[n++] = d->epe[i];
    assert_metric("epe_mean", plain_of(near, n).mean);
    assert_metric("epe_max", plain_of(near, n).max);
    assert_metric("epe_lost", SITES - n);
    assert_metric("transistors", GATES);
    assert_metric("ion_mean_drawn", first.mean);
    assert_metric("ion_max_drawn", first.max);
    assert_metric("iterations", 3);
    assert_metric("simulations", 8);
    assert_metric("fine_simulations", 2);
    assert_whole("effort", "iterations", 0, 3);
    assert_whole("effort", "litho_simulations", 0, 8);
    assert_whole("effort", "fine_simulations", 0, 2);
    assert_whole("effort", "failed_transistors", 0, failures);
    assert_whole("effort", "fragments", 0, SITES);
    assert_cell("effort", "epe_mean", 0, plain_of(near, n).mean);
  } else {
    double x[GATES];
    int n = 0;
    for (int i = 0; i < GATES; i++)
      if (gate_prints(d->flags[0], i) && gate_prints(d->flags[1], i))
        x[n++] = deviation_of(d, 2, 0, i) - deviation_of(d, 3, 0, i);
    assert_metric("ion_change_mean", plain_of(x, n).mean);
    assert_metric("ion_change_max", plain_of(x, n).max);
  }
}

/* The most severe finding is named; all findings are counted. */
static void assert_prints(void) {
  static const struct {
    uint32_t flag;
    const char *name;
    int count;
  } all[] = {{EDA_PRINT_NO_ACTIVE, "no active", 1},
             {EDA_PRINT_OPEN, "open", 2},
             {EDA_PRINT_MERGED, "merged", 1},
             {EDA_PRINT_ISLAND, "island", 1},
             {EDA_PRINT_SHORT, "short line end", 1},
             {EDA_PRINT_NECK, "neck", 2},
             {EDA_PRINT_WIDE, "wide", 2},
             {EDA_PRINT_NOTCH, "notch", 1},
             {EDA_PRINT_OUTSIDE, "outside the table", 2}};
  for (size_t k = 0; k < G_N_ELEMENTS(all); k++) {
    uint32_t graver = 0;
    g_assert_cmpstr(text("prints", "print", (int)k), ==, all[k].name);
    assert_whole("prints", "transistors", (int)k, all[k].count);
    for (size_t m = k; m < G_N_ELEMENTS(all); m++) graver |= all[m].flag;
    g_assert_cmpstr(correct_report_trouble(graver), ==, all[k].name);
  }
  g_assert_cmpuint(opc_test_table("prints")->rows, ==, G_N_ELEMENTS(all));
  g_assert_cmpstr(correct_report_trouble(0), ==, "");
}

static void test_mask(void) {
  static made d;
  opc_error error = {0};
  const eda_synthesizer functions = {.verdict = model_says};
  const opc_module synthesizer = {&functions, NULL, "synthesizer.test"};
  make_sample(&d);
  d.held[2] = "guard: as drawn";
  d.held[3] = "guard: half";
  for (int corrects = 0; corrects < 2; corrects++)
    for (int base = 0; base <= corrects; base++) {
      report r = {.mask = &d.mask[0], .extension = d.extension};
      d.biases.base = base ? &d.base : NULL;
      if (corrects) {
        r.sites = d.sites;
        r.biases = &d.biases;
        r.synthesizer = &synthesizer;
        r.held = d.held;
        r.flags_before = d.flags_before;
      } else {
        r.corrected = &d.mask[1];
      }
      opc_test_forget();
      if (correct_report_mask(opc_test_host(), &r, &error))
        g_error("%s", error.message);
      g_assert_cmpuint(opc_test_table("gates")->rows, ==, GATES);
      g_assert_cmpuint(opc_test_table("transistors")->rows, ==, GATES);
      for (int i = 0; i < GATES; i++) assert_gate(&d, &r, i);
      assert_summary(&d, corrects);
      assert_metrics(&d, corrects);
      assert_prints();
    }
}

/* An accurate simulation replaces the fast one of the same mask. */
static void test_history(void) {
  static made d;
  opc_error error = {0};
  make_sample(&d);
  history h = {0};
  eda_printer p = {.simulations = 2};
  summary s = correct_summarize(&d.gates, &d.mask[0].design, &d.mask[0].after,
                                d.flags[0], d.sites);
  correct_history_add(&h, &s, 0, &p, 0);
  p.simulations = 4;
  correct_history_add(&h, &s, 1, &p, 0);
  p.fine_simulations = 2;
  s.ion_mean = 77;
  correct_history_add(&h, &s, 9, &p, 1);
  p.simulations = 6;
  correct_history_add(&h, &s, 2, &p, 1);
  g_assert_cmpint(correct_history_report(&h, opc_test_host(), &error), ==,
                  OPC_OK);
  g_assert_cmpuint(opc_test_table("history")->rows, ==, 3);
  for (int i = 0; i < 3; i++) {
    assert_whole("history", "iteration", i, i);
    assert_whole("history", "simulations", i, 2 * i + 2);
    assert_whole("history", "fine_simulations", i, i ? 2 : 0);
    g_assert_cmpstr(text("history", "model", i), ==, i ? "fine" : "cheap");
    assert_cell("history", "ion_mean", i,
                i ? 77 : group(&d, 2, 0, d.flags[0], 2).mean);
    assert_cell("history", "epe_max", i, s.epe_max);
  }
  correct_history_clear(&h);
}

/* ---- words ---- */

static void assert_said(const char *words, int whether) {
  if ((strstr(opc_test_log(), words) != NULL) != whether)
    g_error("'%s'%s in:\n%s", words, whether ? " is not" : "", opc_test_log());
}

static void test_violations(void) {
  static made d;
  opc_error error = {0};
  make_sample(&d);
  const eda_violation v[] = {{"space; no space", 3, 10, 20, 30, 40},
                             {"width", -1, 1, 2, 3, 4},
                             {"space; no space", 5, 11, 21, 31, 41},
                             {"space; drawn so", 2, 12, 22, 32, 42}};
  opc_test_forget();
  g_assert_cmpint(
      correct_report_violations(opc_test_host(), &d.gates, v, 4, &error), ==,
      OPC_OK);
  assert_metric("violations", 4);
  assert_metric("violations_unexplained", 1);
  assert_said(
      "2 locations cannot meet a rule: space; no space; the first is at (10, "
      "20) nm",
      1);
  assert_said(
      "1 location cannot meet a rule: space; drawn so; the first is at (12, "
      "22) nm",
      1);
  assert_said("first at (11, 21)", 0);
  assert_said("4 rule violations, 1 without a known", 1);
  static const char *const names[] = {"X7:4", "", "X7:6", "NAND:3"};
  for (int i = 0; i < 4; i++) {
    g_assert_cmpstr(text("violations", "rule", i), ==, v[i].rule);
    g_assert_cmpstr(text("violations", "transistor", i), ==, names[i]);
    assert_cell("violations", "x", i, v[i].x);
    assert_cell("violations", "y", i, v[i].y);
    assert_cell("violations", "value", i, v[i].value);
    assert_cell("violations", "limit", i, v[i].limit);
  }
  opc_test_forget();
  g_assert_cmpint(
      correct_report_violations(opc_test_host(), &d.gates, v, 0, &error), ==,
      OPC_OK);
  assert_metric("violations", 0);
  g_assert_null(opc_test_table("violations"));
}

static double shortest = 0, longest = 0;

static int range(const void *self, int type, double *low, double *high) {
  (void)self;
  *low = shortest;
  *high = longest;
  return type == EDA_NMOS;
}

/* The device table covers n-transistors of 50 to 70 nm; p-transistors have no
   table. */
static void test_drawing(void) {
  static made d;
  const eda_extractor functions = {.range = range};
  const opc_module extractor = {&functions, NULL, "extractor.test"};
  make_sample(&d);
  double least = INFINITY, most = 0;
  for (int i = 0; i < GATES; i++)
    if (i % 3) least = fmin(least, d.length[i]), most = fmax(most, d.length[i]);
  static const struct {
    double low, high; /* smallest and largest */
    int beyond, near;
  } cases[] = {{0.8, 1.2, 0, 0},   {0.91, 1.2, 0, 1},  {0.8, 1.09, 0, 1},
               {0.89, 1.11, 0, 0}, {1.001, 1.2, 1, 0}, {0.8, 0.999, 1, 0}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    opc_test_forget();
    shortest = cases[k].low * least;
    longest = cases[k].high * most;
    correct_findings_of_drawing(opc_test_host(), &d.gates, &extractor);
    assert_said("1 of 9 n-transistors are drawn with lengths", cases[k].beyond);
    assert_said("n-transistors are drawn with lengths",
                cases[k].beyond | cases[k].near);
    assert_said("near an end of the device table", cases[k].near);
    assert_said("p-transistors", 0);
    assert_said("longer than wide", 0);
  }
  for (int i = 0; i < 7; i++) d.width[i] = 1;
  opc_test_forget();
  correct_findings_of_drawing(opc_test_host(), &d.gates, &extractor);
  assert_said("longer than wide", 0); /* seven of fourteen gates are longer than
                                         wide */
  d.width[7] = 1;
  correct_findings_of_drawing(opc_test_host(), &d.gates, &extractor);
  assert_said("8 of 14 transistors are drawn longer than wide", 1);
  /* Gates with one length and many widths cause no warning. */
  for (int i = 0; i < GATES; i++) d.length[i] = 600, d.width[i] = 300 + i;
  opc_test_forget();
  correct_findings_of_drawing(opc_test_host(), &d.gates, &extractor);
  assert_said("longer than wide", 0);
}

static void test_print(void) {
  static made d;
  make_sample(&d);
  g_autofree char *first = g_strdup_printf(
      "5 of 14 transistors do not print as one transistor, and have no "
      "results: "
      "first X7:4 at (%g, %g) nm",
      (d.box[3].x0 + d.box[3].x1) / 4.0, (d.box[3].y0 + d.box[3].y1) / 4.0);
  opc_test_forget();
  correct_findings_of_print(opc_test_host(), &d.gates, NULL, d.flags[0],
                            d.flags_before);
  assert_said(first, 1);
  assert_said(
      "4 transistors that printed with the drawn mask do not print any more: "
      "first X7:4 at",
      1);
  assert_said(
      "results of 1 of 14 transistors are extrapolated beyond the device table",
      1);
  assert_said("no transistor of the drawn mask prints", 0);
  for (int i = 0; i < GATES; i++) d.flags_before[i] = EDA_PRINT_OPEN;
  opc_test_forget();
  correct_findings_of_print(opc_test_host(), &d.gates, NULL, d.flags[1],
                            d.flags_before);
  assert_said(
      "1 of 14 transistors does not print as one transistor, and has no "
      "results: first X7:10 at",
      1);
  assert_said("so no more", 0);
  assert_said("no transistor of the drawn mask prints", 1);
  assert_said("beyond the device table", 0);
  opc_test_forget();
  correct_findings_of_print(opc_test_host(), &d.gates, NULL, d.flags[1], NULL);
  assert_said("printed as drawn", 0);
  assert_said("drawn mask prints", 0);
}

static void test_guard(void) {
  const guard one = {.back = 1, .worse = 1, .lost = 2};
  const guard more = {.back = 3, .worse = 2}, none = {0};
  const opc_host *host = opc_test_host();
  opc_test_forget();
  correct_findings_of_guard(host, &one, 1);
  assert_said("1 transistor is worse than drawn because of neighbours", 1);
  assert_said("1 transistor reverted", 1);
  assert_said("guard: off", 0);
  opc_test_forget();
  correct_findings_of_guard(host, &more, 0);
  assert_said(
      "guard: off: 2 transistors are worse than drawn and worse than the "
      "limit, 0 that printed with the drawn mask do not print any more",
      1);
  assert_said("3 transistors reverted", 1);
  assert_said("because of neighbours", 0);
  opc_test_forget();
  correct_findings_of_guard(host, &none, 1);
  correct_findings_of_guard(host, &none, 0);
  g_assert_cmpstr(opc_test_log(), ==, "");
  guarded state[2] = {[1] = {.rule = "neck", .at = {30, 42.5}}};
  const guard rule = {.state = state, .ruled = 2, .first = 1};
  correct_findings_of_guard(host, &rule, 1);
  assert_said("2 transistors are beyond the limit of Ion", 1);
  assert_said("violates a rule: the first is neck at (30, 42.5) nm", 1);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/report/mask", test_mask);
  g_test_add_func("/report/history", test_history);
  g_test_add_func("/report/violations", test_violations);
  g_test_add_func("/report/drawing", test_drawing);
  g_test_add_func("/report/print", test_print);
  g_test_add_func("/report/guard", test_guard);
  return g_test_run();
}
