/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes cells as a Liberty file (Liberty User Guide, version 2007.03) for
   static timing analyzers: times in ns, capacitances in fF. */
#include <eda/file.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

static void put_list(FILE *out, const char *key, const double *value, size_t n,
                     double unit) {
  fprintf(out, "        %s (\"", key);
  for (size_t i = 0; i < n; i++)
    fprintf(out, "%s%.6g", i ? ", " : "", value[i] * unit);
  fputs("\");\n", out);
}

/* `more`: a further attribute, or "". */
static void put_table(FILE *out, const eda_timing_cell *c, const char *name,
                      const char *more, const double *value) {
  fprintf(out, "      %s (grid) {\n%s", name, more);
  put_list(out, "index_1", c->at_slew, c->slews, 1e9);
  put_list(out, "index_2", c->at_load, c->loads, 1e15);
  fputs("        values (", out);
  for (size_t i = 0; i < c->slews; i++) {
    fprintf(out, "%s\"", i ? ", \\\n          " : "");
    for (size_t j = 0; j < c->loads; j++)
      fprintf(out, "%s%.6g", j ? ", " : "", value[i * c->loads + j] * 1e9);
    fputc('"', out);
  }
  fputs(");\n      }\n", out);
}

/* Write the levels of all inputs except input `but`, such as "A1 & !A2". If
   `but` equals c->inputs, write all inputs. */
static void put_pattern(FILE *out, const eda_timing_cell *c, uint32_t pattern,
                        size_t but) {
  int some = 0;
  for (size_t i = 0; i < c->inputs; i++)
    if (i != but)
      fprintf(out, "%s%s%s", some++ ? " & " : "", pattern >> i & 1 ? "" : "!",
              c->pin[i]);
}

/* Write the function of an output as a sum of all patterns with value 1. */
static void put_function(FILE *out, const eda_timing_cell *c, size_t o) {
  int some = 0;
  fputs("    function : \"", out);
  for (uint32_t p = 0; p >> c->inputs == 0; p++) {
    if (!c->level[(o << c->inputs) + p]) continue;
    fputs(some++ ? " | (" : "(", out);
    put_pattern(out, c, p, c->inputs);
    fputc(')', out);
  }
  fputs(some ? "\";\n" : "0\";\n", out);
}

static const eda_timing_arc *arc_at(const eda_timing_cell *c, size_t o,
                                    size_t i, uint32_t from) {
  int32_t k = c->arc_of[((o * c->inputs + i) << c->inputs) + from];
  return k < 0 ? NULL : &c->arc[k];
}

/* Write the standard deviations of delay and slew of an arc (Liberty Variation
   Format), equal for early and late delays. */
static void put_sigma(FILE *out, const study *s, const eda_timing_cell *c,
                      const eda_timing_arc *a) {
  static const char *const names[2][2] = {
      {"ocv_sigma_cell_fall", "ocv_sigma_fall_transition"},
      {"ocv_sigma_cell_rise", "ocv_sigma_rise_transition"}};
  static const char type[] = "        sigma_type : early_and_late;\n";
  double *delay = eda_alloc(2 * c->slews * c->loads, sizeof *delay);
  double *slew = delay + c->slews * c->loads;
  arc_sigma(&s->rough, c, a, delay, slew);
  put_table(out, c, names[a->rises][0], type, delay);
  put_table(out, c, names[a->rises][1], type, slew);
  free(delay);
}

/* Write the arcs from both directions of input i to output o, for one pattern
   of the other inputs. */
static void put_timing(FILE *out, const study *s, const eda_timing_cell *c,
                       size_t o, size_t i, uint32_t low) {
  const eda_timing_arc *a = arc_at(c, o, i, low);
  if (!a) return;
  const eda_timing_arc *b = arc_at(c, o, i, low | (uint32_t)1 << i);
  const eda_timing_arc *rise = a->rises ? a : b, *fall = a->rises ? b : a;
  fprintf(out,
          "    timing () {\n      related_pin : \"%s\";\n"
          "      timing_sense : %s_unate;\n",
          c->pin[i], a->rises ? "positive" : "negative");
  if (c->inputs > 1) {
    fputs("      when : \"", out);
    put_pattern(out, c, low, i);
    fputs("\";\n", out);
  }
  put_table(out, c, "cell_rise", "", rise->delay);
  put_table(out, c, "cell_fall", "", fall->delay);
  put_table(out, c, "rise_transition", "", rise->slew);
  put_table(out, c, "fall_transition", "", fall->slew);
  if (s->rough.sigma > 0) {
    put_sigma(out, s, c, rise);
    put_sigma(out, s, c, fall);
  }
  fputs("    }\n", out);
}

static void put_cell(FILE *out, const study *s, const eda_timing_cell *c) {
  fprintf(out, "  cell (%s) {\n", c->name);
  for (size_t i = 0; i < c->inputs; i++) {
    const double *cap = c->capacitance + i * 2 * EDA_CAPS;
    double fall = cap[EDA_CAP_DELAY], rise = cap[EDA_CAPS + EDA_CAP_DELAY];
    fprintf(out,
            "  pin (%s) {\n    direction : input;\n    capacitance : %.6g;\n"
            "    rise_capacitance : %.6g;\n    fall_capacitance : %.6g;\n  }\n",
            c->pin[i], (rise + fall) / 2 * 1e15, rise * 1e15, fall * 1e15);
  }
  for (size_t o = 0; o < c->outputs; o++) {
    fprintf(out,
            "  pin (%s) {\n    direction : output;\n"
            "    max_capacitance : %.6g;\n",
            c->pin[c->inputs + o], c->at_load[c->loads - 1] * 1e15);
    put_function(out, c, o);
    for (size_t i = 0; i < c->inputs; i++)
      for (uint32_t from = 0; from >> c->inputs == 0; from++)
        if (!(from >> i & 1)) put_timing(out, s, c, o, i, from);
    fputs("  }\n", out);
  }
  fputs("  }\n", out);
}

static void put_library(FILE *out, const study *s) {
  const eda_timing *t = s->timing;
  fputs(
      "library (opcflow) {\n  delay_model : table_lookup;\n"
      "  time_unit : \"1ns\";\n  voltage_unit : \"1V\";\n"
      "  current_unit : \"1mA\";\n  pulling_resistance_unit : \"1kohm\";\n"
      "  leakage_power_unit : \"1nW\";\n  capacitive_load_unit (1, ff);\n",
      out);
  fprintf(out,
          "  nom_process : 1;\n  nom_voltage : %g;\n  nom_temperature : %g;\n",
          t->supply, t->temperature);
  for (int rises = 0; rises < 2; rises++) {
    const char *edge = rises ? "rise" : "fall";
    fprintf(out,
            "  slew_lower_threshold_pct_%s : %g;\n"
            "  slew_upper_threshold_pct_%s : %g;\n"
            "  input_threshold_pct_%s : 50;\n  output_threshold_pct_%s : 50;\n",
            edge, 100 * t->low, edge, 100 * t->high, edge, edge);
  }
  fputs(
      "  slew_derate_from_library : 1;\n  lu_table_template (grid) {\n"
      "    variable_1 : input_net_transition;\n"
      "    variable_2 : total_output_net_capacitance;\n",
      out);
  put_list(out, "index_1", s->slews.values, s->slews.count, 1e9);
  put_list(out, "index_2", s->loads.values, s->loads.count, 1e15);
  fputs("  }\n", out);
  for (size_t i = 0; i < t->count; i++)
    if (!t->cell[i].trouble) put_cell(out, s, &t->cell[i]);
  fputs("}\n", out);
}

int liberty_write(const study *s, const char *path, opc_error *error) {
  FILE *out = fopen(path, "wb");
  if (out) put_library(out, s);
  return eda_file_close(out, path, NULL, error);
}
