/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes files for other programs: delays in SDF (IEEE 1497, version 3.0), the
   circuit in Verilog with module paths, a test bench, and the expected
   events. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

static int close_file(FILE *out, const char *path, opc_error *error) {
  int bad = !out || ferror(out), why = errno;
  if (out && fclose(out)) {
    bad = 1;
    why = errno;
  }
  if (!bad) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%.300s': %s", path, strerror(why));
}

/* Write a Verilog name, escaped if needed. */
static void put_name(FILE *out, const char *name) {
  const char *at = name;
  int good = isalpha((unsigned char)*at) || *at == '_';
  while (good && *++at) good = isalnum((unsigned char)*at) || *at == '_';
  fprintf(out, good ? "%s" : "\\%s ", name);
}

/* Return the instance name without the leading letter of SPICE. */
static const char *instance_of(const graph *g, const node *n) {
  const char *name = g->instance[n->instance];
  return name[0] && name[1] ? name + 1 : name;
}

/* ---- SDF ---- */

static void put_delay(FILE *out, const double *one) {
  if (isnan(one[MEAN]))
    fputs(" ()", out);
  else
    fprintf(out, " (%.3f:%.3f:%.3f)", one[LEAST] / 1000, one[MEAN] / 1000,
            one[LARGEST] / 1000);
}

static void put_paths(FILE *out, const node *n, const state *s) {
  const eda_timing_cell *c = n->cell;
  for (size_t i = 0; i < c->inputs; i++) {
    const double *fall = one_delay(n, s, i, 0), *rise = one_delay(n, s, i, 1);
    if (isnan(rise[MEAN]) && isnan(fall[MEAN])) continue;
    fputs("      (IOPATH ", out);
    put_name(out, c->pin[i]);
    fputc(' ', out);
    put_name(out, c->pin[c->inputs + n->output]);
    put_delay(out, rise);
    put_delay(out, fall);
    fputs(")\n", out);
  }
}

int write_sdf(const paths *p, const state *s, const char *path,
              opc_error *error) {
  const graph *g = &p->graph;
  FILE *out = fopen(path, "wb");
  if (!out) return close_file(out, path, error);
  fprintf(out,
          "(DELAYFILE\n  (SDFVERSION \"3.0\")\n  (DESIGN \"%s\")\n"
          "  (PROGRAM \"opcflow timing.paths, sizes: %s\")\n"
          "  (VOLTAGE %g)\n  (TEMPERATURE %g)\n"
          "  (DIVIDER /)\n  (TIMESCALE 1 ps)\n",
          g->name, s->name, p->timing->supply, p->timing->temperature);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    fprintf(out, "  (CELL (CELLTYPE \"%s\") (INSTANCE ", n->cell->name);
    put_name(out, instance_of(g, n));
    fputs(")\n    (DELAY (ABSOLUTE\n", out);
    put_paths(out, n, s);
    fputs("    ))\n  )\n", out);
  }
  fputs(")\n", out);
  return close_file(out, path, error);
}

/* ---- Verilog ---- */

static void put_list(FILE *out, const eda_timing_cell *c) {
  for (size_t i = 0; i < c->inputs + c->outputs; i++) {
    fputs(i ? ", " : "", out);
    put_name(out, c->pin[i]);
  }
}

/* Write the function of an output as a table primitive, which evaluates in one
   step without intermediate events. */
static void put_primitive(FILE *out, const eda_timing_cell *c, size_t o) {
  fprintf(out, "primitive %s_f%zu (o", c->name, o);
  for (size_t i = 0; i < c->inputs; i++) fprintf(out, ", i%zu", i);
  fputs(");\n  output o;\n  input i0", out);
  for (size_t i = 1; i < c->inputs; i++) fprintf(out, ", i%zu", i);
  fputs(";\n  table\n", out);
  for (uint32_t k = 0; k >> c->inputs == 0; k++) {
    fputs("   ", out);
    for (size_t i = 0; i < c->inputs; i++) fprintf(out, " %u", k >> i & 1);
    fprintf(out, " : %u;\n", c->level[(o << c->inputs) + k]);
  }
  fputs("  endtable\nendprimitive\n", out);
}

static void put_cell(FILE *out, const eda_timing_cell *c) {
  for (size_t o = 0; o < c->outputs; o++) put_primitive(out, c, o);
  fprintf(out, "module %s (", c->name);
  put_list(out, c);
  fputs(");\n", out);
  for (size_t i = 0; i < c->inputs + c->outputs; i++) {
    fprintf(out, "  %s ", i < c->inputs ? "input" : "output");
    put_name(out, c->pin[i]);
    fputs(";\n", out);
  }
  for (size_t o = 0; o < c->outputs; o++) {
    fprintf(out, "  %s_f%zu f%zu (", c->name, o, o);
    put_name(out, c->pin[c->inputs + o]);
    for (size_t i = 0; i < c->inputs; i++) {
      fputs(", ", out);
      put_name(out, c->pin[i]);
    }
    fputs(");\n", out);
  }
  fputs("  specify\n", out);
  for (size_t o = 0; o < c->outputs; o++)
    for (size_t i = 0; i < c->inputs; i++) {
      fputs("    (", out);
      put_name(out, c->pin[i]);
      fputs(" => ", out);
      put_name(out, c->pin[c->inputs + o]);
      fputs(") = (0, 0);\n", out);
    }
  fputs("  endspecify\nendmodule\n\n", out);
}

static void put_cells(FILE *out, const paths *p) {
  const graph *g = &p->graph;
  for (size_t k = 0; k < p->timing->count; k++) {
    const eda_timing_cell *c = &p->timing->cell[k];
    size_t i = 0;
    while (i < g->nodes && g->node[i].cell != c) i++;
    if (i < g->nodes) put_cell(out, c);
  }
}

static void put_circuit(FILE *out, const graph *g) {
  fputs("module ", out);
  put_name(out, g->name);
  fputs(" (", out);
  for (size_t i = 0; i < g->inputs + g->outputs; i++) {
    fputs(i ? ", " : "", out);
    put_name(out,
             g->net[i < g->inputs ? g->input[i] : g->output[i - g->inputs]]);
  }
  fputs(");\n", out);
  for (size_t i = 0; i < g->inputs + g->outputs; i++) {
    fprintf(out, "  %s ", i < g->inputs ? "input" : "output");
    put_name(out,
             g->net[i < g->inputs ? g->input[i] : g->output[i - g->inputs]]);
    fputs(";\n", out);
  }
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    const eda_timing_cell *c = n->cell;
    if (n->output) continue;
    put_name(out, c->name);
    fputc(' ', out);
    put_name(out, instance_of(g, n));
    fputs(" (", out);
    for (size_t k = 0; k < c->inputs + c->outputs; k++) {
      fputs(k ? ", ." : ".", out);
      put_name(out, c->pin[k]);
      fputc('(', out);
      put_name(out, g->net[n->in[k]]);
      fputc(')', out);
    }
    fputs(");\n", out);
  }
  fputs("endmodule\n\n", out);
}

static void put_bits(FILE *out, const uint8_t *bit, size_t n) {
  fprintf(out, "    in = %zu'b", n);
  for (size_t i = n; i-- > 0;) fputc('0' + bit[i], out);
  fputs(";\n", out);
}

/* Time between transitions of the test bench: `waits` times the latest static
   arrival, at least least_wait (ps). Glitches may end after the latest static
   arrival, but end within this time. */
static const double least_wait = 1000, waits = 4;

/* Write the bench, which prints "PATTERN,OUTPUT,LEVEL,TIME" for each event of
   an output. */
static void put_bench(FILE *out, const paths *p) {
  const graph *g = &p->graph;
  eda_pool pool = {0};
  arrivals a = static_arrivals(g, &p->state[0], p->at.slew, &pool);
  double wait = least_wait;
  for (size_t i = 0; i < 2 * g->nets; i++) wait = fmax(wait, waits * a.time[i]);
  eda_pool_clear(&pool);
  uint8_t *before = eda_alloc(2 * g->inputs, 1), *after = before + g->inputs;
  fprintf(out,
          "module bench;\n  reg [%zu:0] in;\n  wire [%zu:0] out;\n"
          "  integer pattern;\n  real start;\n  ",
          g->inputs - 1, g->outputs - 1);
  put_name(out, g->name);
  fputs(" dut (", out);
  for (size_t i = 0; i < g->inputs; i++) fprintf(out, "in[%zu], ", i);
  for (size_t i = 0; i < g->outputs; i++)
    fprintf(out, "%sout[%zu]", i ? ", " : "", i);
  fputs(");\n", out);
  for (size_t i = 0; i < g->outputs; i++)
    fprintf(out,
            "  always @(out[%zu]) if (pattern >= 0)\n    $display("
            "\"%%0d,%s,%%b,%%0.3f\", pattern, out[%zu], $realtime - start);\n",
            i, g->net[g->output[i]], i);
  fputs("  initial begin\n    $sdf_annotate(`SDF, dut);\n", out);
  for (size_t i = 0; i < (size_t)p->events && i < p->patterns; i++) {
    pattern_at(p, i, before, after);
    fputs("    pattern = -1;\n", out);
    put_bits(out, before, g->inputs);
    fprintf(out, "    #%.0f pattern = %zu; start = $realtime;\n", wait, i);
    put_bits(out, after, g->inputs);
    fprintf(out, "    #%.0f;\n", wait);
  }
  fputs("    $finish;\n  end\nendmodule\n", out);
  free(before);
}

int write_verilog(const paths *p, const char *path, opc_error *error) {
  FILE *out = fopen(path, "wb");
  if (!out) return close_file(out, path, error);
  fputs("`timescale 1 ps / 1 fs\n", out);
  put_cells(out, p);
  put_circuit(out, &p->graph);
  if (p->events) put_bench(out, p);
  return close_file(out, path, error);
}

/* ---- events of the internal simulation ---- */

typedef struct line {
  int64_t pattern, level;
  const char *output;
  double time;
} line;

int events_report(const paths *p, opc_error *error) {
  const graph *g = &p->graph;
  size_t count = 0, capacity = 0;
  line *all = NULL;
  waves w;
  waves_init(&w, p);
  for (size_t i = 0; i < (size_t)p->events && i < p->patterns; i++) {
    pattern_at(p, i, w.before, w.after);
    waves_run(&w, &p->state[0]);
    for (size_t o = 0; o < g->outputs; o++) {
      uint32_t net = g->output[o];
      int level = w.level[net];
      for (uint32_t k = w.first[net]; k < w.last[net]; k++) {
        level = !level;
        double time = w.event[k].time;
        EDA_PUSH(all, count, capacity,
                 (line){(int64_t)i, level, g->net[net],
                        p->delays == ONE_AN_ARC ? time / 1000 : time});
      }
    }
  }
  waves_clear(&w);
  const line none = {0};
  const line *first = all ? all : &none;
  const opc_column columns[] = {
      {"transition", NULL, OPC_INT, 0, &first->pattern},
      {"output", NULL, OPC_TEXT, 0, &first->output},
      {"level", NULL, OPC_INT, 0, &first->level},
      {"time", "ps", OPC_REAL, 3, &first->time}};
  int code = opc_put_rows(p->host, "events", 0, count, sizeof *all,
                          OPC_ARRAY(columns), error);
  free(all);
  return code;
}
