/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes files for other programs: delays in SDF (IEEE 1497, version 3.0), the
   circuit in Verilog with module paths, a test bench, and the expected
   events. */
#include <eda/file.h>
#include <eda/sdf.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

const char *sdf_instance(const graph *g, const node *n) {
  const char *name = g->instance[n->instance];
  return name[0] && name[1] ? name + 1 : name;
}

/* ---- SDF ---- */

int write_sdf(const paths *p, const state *s, const char *path,
              opc_error *error) {
  const graph *g = &p->graph;
  g_autofree char *program =
      g_strdup_printf("opcflow timing.paths, sizes: %s", s->name);
  size_t most = 0, arcs = 0;
  for (size_t i = 0; i < g->nodes; i++) most += g->node[i].cell->inputs;
  eda_sdf_arc *all = eda_alloc(most, sizeof *all);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    const eda_timing_cell *c = n->cell;
    for (size_t k = 0; k < c->inputs; k++) {
      eda_sdf_arc a = {c->name,
                       sdf_instance(g, n),
                       c->pin[k],
                       c->pin[c->inputs + n->output],
                       {{0}}};
      for (int rises = 0; rises < 2; rises++)
        for (int kind = 0; kind < KINDS; kind++)
          a.delay[rises][kind] = one_delay(n, s, k, rises)[kind] / 1000;
      if (!isnan(a.delay[0][MEAN]) || !isnan(a.delay[1][MEAN])) all[arcs++] = a;
    }
  }
  int code = eda_sdf_write(path, g->name, program, p->timing->supply,
                           p->timing->temperature, arcs, all, error);
  free(all);
  return code;
}

/* ---- Verilog ---- */

static void put_list(FILE *out, const eda_timing_cell *c) {
  for (size_t i = 0; i < c->inputs + c->outputs; i++) {
    fputs(i ? ", " : "", out);
    eda_verilog_name(out, c->pin[i]);
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
    eda_verilog_name(out, c->pin[i]);
    fputs(";\n", out);
  }
  for (size_t o = 0; o < c->outputs; o++) {
    fprintf(out, "  %s_f%zu f%zu (", c->name, o, o);
    eda_verilog_name(out, c->pin[c->inputs + o]);
    for (size_t i = 0; i < c->inputs; i++) {
      fputs(", ", out);
      eda_verilog_name(out, c->pin[i]);
    }
    fputs(");\n", out);
  }
  fputs("  specify\n", out);
  for (size_t o = 0; o < c->outputs; o++)
    for (size_t i = 0; i < c->inputs; i++) {
      fputs("    (", out);
      eda_verilog_name(out, c->pin[i]);
      fputs(" => ", out);
      eda_verilog_name(out, c->pin[c->inputs + o]);
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
  eda_verilog_name(out, g->name);
  fputs(" (", out);
  for (size_t i = 0; i < g->inputs + g->outputs; i++) {
    fputs(i ? ", " : "", out);
    eda_verilog_name(
        out, g->net[i < g->inputs ? g->input[i] : g->output[i - g->inputs]]);
  }
  fputs(");\n", out);
  for (size_t i = 0; i < g->inputs + g->outputs; i++) {
    fprintf(out, "  %s ", i < g->inputs ? "input" : "output");
    eda_verilog_name(
        out, g->net[i < g->inputs ? g->input[i] : g->output[i - g->inputs]]);
    fputs(";\n", out);
  }
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    const eda_timing_cell *c = n->cell;
    if (n->output) continue;
    eda_verilog_name(out, c->name);
    fputc(' ', out);
    eda_verilog_name(out, sdf_instance(g, n));
    fputs(" (", out);
    for (size_t k = 0; k < c->inputs + c->outputs; k++) {
      fputs(k ? ", ." : ".", out);
      eda_verilog_name(out, c->pin[k]);
      fputc('(', out);
      eda_verilog_name(out, g->net[n->in[k]]);
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
  eda_verilog_name(out, g->name);
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
  if (out) {
    fputs("`timescale 1 ps / 1 fs\n", out);
    put_cells(out, p);
    put_circuit(out, &p->graph);
    if (p->events) put_bench(out, p);
  }
  return eda_file_close(out, path, NULL, error);
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
