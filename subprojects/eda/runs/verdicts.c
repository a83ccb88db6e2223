/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparison of two methods. */
#include <eda/verdicts.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runs/changes.h"

/* ---- figures ---- */

static const struct {
  const char *name, *title, *unit;
} figures[EDA_CHANGES] = {
    {"lost", "transistors that do not print", ""},
    {"ion", "Ion", "points"},
    {"ioff", "Ioff", "points"},
    {"area", "area", "points"},
    {"shots", "shots", "%"},
    {"violations", "violations", ""},
    {"seconds", "seconds", "%"},
};

static const char *const words[] = {"same", "better", "worse", "too few"};

/* Smallest |change| of the total time that decides without a confidence
   interval, %. */
static const double SECONDS = 10;

/* Return the metric `name` of the last step that has the metric; NAN if no step
   has it. Later steps verify earlier steps. */
static double metric_of(const eda_run *run, const char *name) {
  const eda_run_facts *f = eda_run_info(run);
  for (size_t i = f->n_metrics; i-- > 0;) {
    const char *last = strrchr(f->metrics[i].name, '.');
    if (last && !strcmp(last + 1, name)) return f->metrics[i].value;
  }
  return NAN;
}

static double figure_of(const eda_run *run, int figure) {
  return figure == EDA_CHANGE_SECONDS ? eda_run_time(run)
                                      : metric_of(run, figures[figure].name);
}

static int is_relative(int figure) { return *figures[figure].unit == '%'; }

/* Return the change of a figure. For relative figures, return the logarithm of
   the ratio, so that exchanging the methods changes only the sign. */
static double change_of(int figure, double base, double value) {
  if (!is_relative(figure)) return value - base;
  return base == value ? 0 : log(value / base);
}

static double percent(double logarithm) { return 100 * expm1(logarithm); }

/* ---- verdicts ---- */

/* Set the verdict of a figure that has a confidence interval. */
static void judge_interval(eda_change *c) {
  const eda_median *m = &c->median;
  if (c->same == c->n)
    c->verdict = EDA_VERDICT_SAME;
  else if (m->n < EDA_MEDIAN_FEWEST)
    c->verdict = EDA_VERDICT_FEW;
  else if (m->high < 0 && c->change < 0)
    c->verdict = EDA_VERDICT_BETTER;
  else if (m->low > 0 && c->change > 0)
    c->verdict = EDA_VERDICT_WORSE;
}

/* Set the verdict of a figure from the change of the sum over all cases, if
   |change| exceeds `least`. */
static void judge_sum(eda_change *c, double least) {
  if (c->change < -least) c->verdict = EDA_VERDICT_BETTER;
  if (c->change > least) c->verdict = EDA_VERDICT_WORSE;
}

static void take_transistors(eda_change *out, const changes *from) {
  double n = (double)from->n;
  out->base = from->base / n;
  out->value = from->value / n;
  out->change = out->value - out->base;
  out->median = changes_median(from);
  out->n = from->n;
  out->better = from->better;
  out->worse = from->worse;
  out->same = from->n - from->better - from->worse;
  judge_interval(out);
}

static void take_lost(eda_change *out, const changes *from) {
  out->base = (double)from->lost_base;
  out->value = (double)from->lost;
  out->change = out->value - out->base;
  out->n = from->lost_base || from->lost;
  judge_sum(out, 0);
}

/* Set the change of a figure that has one value for each case. */
static void take_cases(eda_change *out, int figure, size_t n,
                       const eda_run_pair *pairs) {
  g_autofree double *all = g_new(double, n);
  for (size_t i = 0; i < n; i++) {
    double base = figure_of(pairs[i].base, figure);
    double value = figure_of(pairs[i].other, figure);
    double change = change_of(figure, base, value);
    if (!isfinite(change)) continue;
    out->base += base;
    out->value += value;
    out->better += change < 0;
    out->worse += change > 0;
    out->same += change == 0;
    all[out->n++] = change;
  }
  int relative = is_relative(figure);
  out->median = eda_median_of(all, (size_t)out->n);
  out->change = change_of(figure, out->base, out->value);
  if (relative) {
    out->change = percent(out->change);
    out->median.value = percent(out->median.value);
    out->median.low = percent(out->median.low);
    out->median.high = percent(out->median.high);
  }
  if (relative && out->n >= EDA_MEDIAN_FEWEST)
    judge_interval(out);
  else
    judge_sum(out, figure == EDA_CHANGE_SECONDS ? SECONDS : 0);
}

/* ---- the sentence ---- */

static void append_number(GString *out, double x) {
  g_string_append_printf(out, fabs(x) < 10 ? "%.2g" : "%.0f", x);
}

/* Return the absolute value of a change x. If `swapped` is 1, convert a change
   in % relative to one method to the change relative to the other method. */
static double size_of(const eda_change *c, double x, int swapped) {
  return fabs(swapped && *c->unit == '%' ? 100 / (1 + x / 100) - 100 : x);
}

/* Append a change, such as "in Ion by 0.23 points (95 %: 0.2 to 0.26)". */
static void append_change(GString *out, const eda_change *c, int swapped) {
  int has_interval = *c->unit && isfinite(c->median.low);
  double change = has_interval ? c->median.value : c->change;
  g_string_append_printf(out, "in %s by ", c->title);
  append_number(out, size_of(c, change, swapped));
  g_string_append_printf(out, "%s%s", *c->unit ? " " : "", c->unit);
  if (!has_interval && c->median.n)
    g_string_append_printf(out, " (%" G_GINT64_FORMAT " case%s)", c->median.n,
                           c->median.n > 1 ? "s" : "");
  if (!has_interval) return;
  double a = size_of(c, c->median.low, swapped);
  double b = size_of(c, c->median.high, swapped);
  g_string_append(out, " (95 %: ");
  append_number(out, fmin(a, b));
  g_string_append(out, " to ");
  append_number(out, fmax(a, b));
  g_string_append_c(out, ')');
}

/* Append `before` and the titles or changes of all figures with the given
   verdict. `equal` selects figures that are equal in all values, or the other
   figures. */
static void append_all(GString *out, const eda_verdict *v, int verdict,
                       int equal, int swapped, const char *before) {
  int found = 0;
  for (int i = 0; i < EDA_CHANGES; i++) {
    const eda_change *c = &v->changes[i];
    if (!c->n || c->verdict != verdict || (c->same == c->n) != equal) continue;
    g_string_append(out, found++ ? ", " : before);
    if (verdict == EDA_VERDICT_BETTER || verdict == EDA_VERDICT_WORSE)
      append_change(out, c, swapped);
    else
      g_string_append(out, c->title);
  }
  if (found && verdict == EDA_VERDICT_FEW)
    g_string_append_printf(out, " (%" G_GINT64_FORMAT " of %d)",
                           v->changes[EDA_CHANGE_ION].median.n,
                           EDA_MEDIAN_FEWEST);
}

static int first_decided(const eda_verdict *v) {
  for (int i = 0; i < EDA_CHANGES; i++)
    if (v->changes[i].verdict == EDA_VERDICT_BETTER ||
        v->changes[i].verdict == EDA_VERDICT_WORSE)
      return v->changes[i].verdict;
  return EDA_VERDICT_SAME;
}

static char *sentence_of(const eda_verdict *v) {
  int first = first_decided(v), swapped = first == EDA_VERDICT_WORSE;
  const struct {
    int verdict, equal;
    const char *before;
  } clauses[] = {
      {first, 0, " "},
      {swapped ? EDA_VERDICT_BETTER : EDA_VERDICT_WORSE, 0, ", worse "},
      {EDA_VERDICT_SAME, 0, "; no clear difference in "},
      {EDA_VERDICT_SAME, 1, "; equal in "},
      {EDA_VERDICT_FEW, 0, "; too few cells for "}};
  GString *out = g_string_new(NULL);
  g_string_printf(
      out, first ? "%s is better than %s" : "no verdict on %s against %s",
      swapped ? v->against : v->method, swapped ? v->method : v->against);
  for (size_t i = first ? 0 : 2; i < G_N_ELEMENTS(clauses); i++)
    append_all(out, v, clauses[i].verdict, clauses[i].equal, swapped,
               clauses[i].before);
  return g_string_free(out, FALSE);
}

/* ---- public functions ---- */

int eda_verdict_init(eda_verdict *out, const char *method, const char *against,
                     size_t n, const eda_run_pair *pairs, opc_error *error) {
  changes of[FIGURES];
  int code = OPC_OK;
  *out =
      (eda_verdict){.method = g_strdup(method), .against = g_strdup(against)};
  for (int i = 0; i < EDA_CHANGES; i++) {
    eda_change *c = &out->changes[i];
    c->name = figures[i].name;
    c->title = figures[i].title;
    c->unit = figures[i].unit;
    c->median = eda_median_of(NULL, 0);
  }
  g_autofree eda_run_pair *used = g_new(eda_run_pair, n);
  size_t n_used = 0;
  for (int k = 0; k < FIGURES; k++) of[k] = changes_new();
  for (size_t i = 0; i < n && !code; i++) {
    transistors t;
    code = transistors_join(pairs[i].base, pairs[i].other, &t, error);
    if (!code && !t.fault) used[n_used++] = pairs[i];
    for (int k = 0; k < FIGURES && !code; k++) changes_add(&of[k], &t, k);
    transistors_clear(&t);
  }
  eda_change *c = out->changes;
  take_lost(&c[EDA_CHANGE_LOST], &of[FIGURE_ION]);
  for (int k = 0; k < FIGURES; k++) {
    if (of[k].n) take_transistors(&c[EDA_CHANGE_ION + k], &of[k]);
    changes_clear(&of[k]);
  }
  for (int i = EDA_CHANGE_SHOTS; i < EDA_CHANGES; i++)
    take_cases(&c[i], i, n_used, used);
  for (int i = 0; i < EDA_CHANGES; i++) c[i].word = words[c[i].verdict];
  out->text = sentence_of(out);
  return code;
}

void eda_verdict_clear(eda_verdict *v) {
  g_free(v->method);
  g_free(v->against);
  g_free(v->text);
}

/* Compare method m with method `against` on the cases that have a run of both
   methods. */
static int compare_methods(eda_verdict *out, size_t m, size_t against,
                           size_t n_cases, size_t n_methods,
                           const char *const *methods, eda_run *const *runs,
                           opc_error *error) {
  g_autofree eda_run_pair *pairs = g_new(eda_run_pair, n_cases);
  size_t n = 0;
  for (size_t c = 0; c < n_cases; c++) {
    eda_run *const *of_case = runs + c * n_methods;
    if (of_case[m] && of_case[against])
      pairs[n++] = (eda_run_pair){of_case[against], of_case[m]};
  }
  return eda_verdict_init(out, methods[m], methods[against], n, pairs, error);
}

eda_verdict *eda_verdicts_new(size_t n_cases, size_t n_methods,
                              const char *const *methods,
                              const char *const *folders, size_t *n,
                              opc_error *error) {
  size_t count = n_cases * n_methods;
  g_autoptr(GPtrArray) runs =
      g_ptr_array_new_with_free_func((GDestroyNotify)eda_run_free);
  eda_verdict *out = g_new0(eda_verdict, n_methods * n_methods);
  int code = OPC_OK;
  *n = 0;
  for (size_t i = 0; i < count && !code; i++) {
    eda_run *run = folders[i] ? eda_run_open(folders[i], error) : NULL;
    g_ptr_array_add(runs, run);
    if (folders[i] && !run) code = error->code;
  }
  for (size_t b = 0; b < n_methods; b++)
    for (size_t a = b + 1; a < n_methods && !code; a++)
      code = compare_methods(&out[(*n)++], a, b, n_cases, n_methods, methods,
                             (eda_run *const *)runs->pdata, error);
  if (!code) return out;
  eda_verdicts_free(out, *n);
  return NULL;
}

void eda_verdicts_free(eda_verdict *verdicts, size_t n) {
  for (size_t i = 0; i < n; i++) eda_verdict_clear(&verdicts[i]);
  g_free(verdicts);
}

int eda_run_unlike(eda_run *base, eda_run *other, char **why,
                   opc_error *error) {
  transistors t;
  int code = transistors_join(base, other, &t, error);
  *why = code || !t.fault ? NULL : strdup(t.fault);
  transistors_clear(&t);
  return code;
}
