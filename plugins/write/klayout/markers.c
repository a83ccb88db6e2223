/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the marker database of KLayout: violations by rule, transistors
   that do not print, and the transistors with the largest deviations. Places
   are in um. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "klayout.h"

static const double around = 50; /* half size of the box around a violation,
                                    nm */

/* ---- texts ---- */

static void put_escaped(GString *out, const char *text) {
  g_autofree char *valid = g_utf8_make_valid(text, -1);
  for (char *c = valid; *c; c++)
    if ((unsigned char)*c < ' ')
      *c = '?'; /* XML does not allow control
                   characters */
  g_autofree char *escaped = g_markup_escape_text(valid, -1);
  g_string_append(out, escaped);
}

/* Append a text in KLayout's quotes. */
static void put_quoted(GString *out, const char *text) {
  g_autoptr(GString) plain = g_string_new("'");
  for (; *text; text++) {
    if (*text == '\'' || *text == '\\') g_string_append_c(plain, '\\');
    g_string_append_c(plain, *text);
  }
  g_string_append_c(plain, '\'');
  put_escaped(out, plain->str);
}

static void put_value(GString *out, const char *format, ...) OPC_PRINTF(2, 3);
static void put_value(GString *out, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *text = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  g_string_append(out, "<value>text: ");
  put_quoted(out, text);
  g_string_append(out, "</value>\n");
}

/* ---- items ---- */

/* Begin an item whose first value is a box, nm. */
static void begin_item(GString *out, const klayout *k, const char *category,
                       const char *part, const double box[4]) {
  g_string_append(out, "<item>\n<category>");
  put_quoted(out, category);
  if (part) {
    g_string_append_c(out, '.');
    put_quoted(out, part);
  }
  g_string_append(out, "</category>\n<cell>");
  put_escaped(out, k->mask->gates->name);
  g_string_append_printf(out,
                         "</cell>\n<values>\n<value>box: (%.10g,%.10g;%.10g,"
                         "%.10g)</value>\n",
                         box[0] / 1e3, box[1] / 1e3, box[2] / 1e3,
                         box[3] / 1e3);
}

static void end_item(GString *out) {
  g_string_append(out, "</values>\n</item>\n");
}

static void gate_box(const eda_gates *g, size_t i, double box[4]) {
  eda_box b = g->box[i];
  const double all[4] = {b.x0 * g->grid, b.y0 * g->grid, b.x1 * g->grid,
                         b.y1 * g->grid};
  memcpy(box, all, sizeof all);
}

static void put_gate_name(GString *out, const eda_gates *g, size_t i) {
  put_value(out, "%s:%u, %s, L %g nm, W %g nm",
            *g->instance[i] ? g->instance[i] : g->cell[i],
            (unsigned)g->number[i], g->type[i] == EDA_PMOS ? "p" : "n",
            g->length[i], g->width[i]);
}

/* ---- transistors ---- */

static int gate_fails(const eda_mask *m, size_t i) {
  return eda_print_failed(m->flags[i]);
}

/* Figures whose largest deviations are listed. */
static const struct {
  const char *name, *category;
} figures[] = {
    {"Ion", "worst Ion"}, {"Ioff", "worst Ioff"}, {"area", "worst area"}};
enum { ION, IOFF, AREA, FIGURES };

static double gate_deviation(const eda_performance *p,
                             const eda_performance *design, int figure,
                             size_t i) {
  const double *const of[] = {p->ion, p->ioff, p->area};
  const double *const want[] = {design->ion, design->ioff, design->area};
  return eda_deviation(of[figure][i], want[figure][i]);
}

static void put_figures(GString *out, const eda_mask *m, size_t i) {
  if (m->count)
    put_value(out, "class of %.0f transistors", eda_mask_count(m, i));
  for (int k = 0; k < FIGURES; k++)
    put_value(out, "%s %+.3f %% (as drawn %+.3f %%)", figures[k].name,
              gate_deviation(&m->after, &m->design, k, i),
              gate_deviation(&m->before, &m->design, k, i));
}

typedef struct ranked {
  double off; /* |deviation|, % */
  size_t gate;
} ranked;

/* Sort by descending deviation, then by index. */
EDA_COMPARE_FALLING(by_rank, ranked, off, gate);

static void put_worst(GString *out, const klayout *k, int figure) {
  const eda_mask *m = k->mask;
  size_t n = 0;
  ranked *all = eda_alloc(m->gates->count, sizeof *all);
  for (size_t i = 0; i < m->gates->count; i++)
    if (!gate_fails(m, i))
      all[n++] =
          (ranked){fabs(gate_deviation(&m->after, &m->design, figure, i)), i};
  qsort(all, n, sizeof *all, by_rank);
  for (size_t r = 0; r < n && (int64_t)r < k->worst; r++) {
    double box[4];
    size_t i = all[r].gate;
    gate_box(m->gates, i, box);
    begin_item(out, k, figures[figure].category, NULL, box);
    put_value(out, "%s %+.3f %%", figures[figure].name,
              gate_deviation(&m->after, &m->design, figure, i));
    put_gate_name(out, m->gates, i);
    put_figures(out, m, i);
    end_item(out);
  }
  free(all);
}

static void put_failing(GString *out, const klayout *k) {
  const eda_mask *m = k->mask;
  for (size_t i = 0; i < m->gates->count; i++) {
    double box[4];
    if (!gate_fails(m, i)) continue;
    gate_box(m->gates, i, box);
    begin_item(out, k, "does not print", NULL, box);
    put_gate_name(out, m->gates, i);
    end_item(out);
  }
}

/* ---- violations ---- */

/* Return the rule of a violation, without the details of place or reason. */
static char *rule_of(const eda_violation *v) {
  return g_strndup(v->rule, strcspn(v->rule, ":;"));
}

static void put_violation(GString *out, const klayout *k,
                          const eda_violation *v) {
  const double box[4] = {v->x - around, v->y - around, v->x + around,
                         v->y + around};
  g_autofree char *rule = rule_of(v);
  begin_item(out, k, "violations", rule, box);
  put_value(out, "%g, limit %g", v->value, v->limit);
  put_value(out, "%s", v->rule);
  if (v->gate >= 0) put_gate_name(out, k->mask->gates, (size_t)v->gate);
  end_item(out);
}

/* ---- categories ---- */

static void put_category(GString *out, const char *name, const char *about) {
  g_string_append(out, "<category>\n<name>");
  put_escaped(out, name);
  g_string_append(out, "</name>\n<description>");
  put_escaped(out, about);
  g_string_append(out, "</description>\n");
}

static void put_rules(GString *out, const eda_mask *m) {
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  g_string_append(out, "<categories>\n");
  for (size_t i = 0; i < m->n_violations; i++) {
    char *rule = rule_of(&m->violations[i]);
    g_autofree char *name = g_strdup(rule);
    if (!g_hash_table_add(seen, rule)) continue;
    put_category(out, name, "");
    g_string_append(out, "</category>\n");
  }
  g_string_append(out, "</categories>\n");
}

static void put_categories(GString *out, const eda_mask *m) {
  g_string_append(out, "<categories>\n");
  put_category(out, "violations", "rules violated by the simulated contours");
  put_rules(out, m);
  g_string_append(out, "</category>\n");
  put_category(out, "does not print",
               "transistors that do not print as one separate transistor");
  g_string_append(out, "</category>\n");
  for (int k = 0; k < FIGURES; k++) {
    put_category(out, figures[k].category,
                 "deviation from the design, the largest first");
    g_string_append(out, "</category>\n");
  }
  g_string_append(out, "</categories>\n");
}

int klayout_put_markers(const klayout *k, opc_error *error) {
  const eda_mask *m = k->mask;
  GString *out = g_string_new(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
      "<report-database>\n"
      "<description>opcflow</description>\n"
      "<generator>opcflow write.klayout</generator>\n"
      "<top-cell>");
  put_escaped(out, m->gates->name);
  g_string_append(out, "</top-cell>\n<tags/>\n");
  put_categories(out, m);
  g_string_append(out, "<cells>\n<cell>\n<name>");
  put_escaped(out, m->gates->name);
  g_string_append(out, "</name>\n</cell>\n</cells>\n<items>\n");
  for (size_t i = 0; i < m->n_violations; i++)
    put_violation(out, k, &m->violations[i]);
  put_failing(out, k);
  for (int figure = 0; figure < FIGURES; figure++) put_worst(out, k, figure);
  g_string_append(out, "</items>\n</report-database>\n");
  int code = klayout_put_text(k, k->markers_name, out, error);
  g_string_free(out, TRUE);
  return code;
}
