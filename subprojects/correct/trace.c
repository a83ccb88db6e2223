/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the record of each transistor in each simulation. */
#include <correct/trace.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/loop.h>

void correct_trace_add(trace *t, const loop *l) {
  const eda_gates *g = l->gates;
  const eda_performance *now = &l->measured.performance, *drawn = &l->design;
  const biases *b = &l->now.biases;
  eda_grow(&t->row, &t->capacity, t->count + g->count, sizeof *t->row);
  for (size_t i = 0; i < g->count; i++) {
    int good = !eda_print_failed(l->measured.flags[i]);
    t->row[t->count++] = (trace_row){
        .iteration = l->iterations,
        .l = b->l[i] * g->grid,
        .w = b->w[i] * g->grid,
        .jog = b->jog[i] * g->grid,
        .end_low = b->end[2 * i] * g->grid,
        .end_high = b->end[2 * i + 1] * g->grid,
        .ion = good ? eda_deviation(now->ion[i], drawn->ion[i]) : NAN,
        .ioff = good ? eda_deviation(now->ioff[i], drawn->ioff[i]) : NAN,
        .area = good ? eda_deviation(now->area[i], drawn->area[i]) : NAN,
        .print = correct_report_trouble(l->measured.flags[i]),
        .vetoes = l->vetoes[i]};
  }
}

void correct_trace_clear(trace *t) { free(t->row); }

int correct_trace_report(trace *t, const loop *l, opc_error *error) {
  trace_row *row = t->row;
  size_t n = l->gates->count;
  char **name = eda_alloc(n, sizeof *name);
  for (size_t i = 0; i < n; i++)
    name[i] = correct_report_gate_name(l->gates, i);
  for (size_t i = 0; n && i < t->count; i++) row[i].name = name[i % n];
  const opc_column columns[] = {
      {"iteration", NULL, OPC_INT, 0, &row->iteration},
      {"transistor", NULL, OPC_TEXT, 0, &row->name},
      {"mask_l", "nm", OPC_REAL, 1, &row->l},
      {"mask_w", "nm", OPC_REAL, 1, &row->w},
      {"mask_jog", "nm", OPC_REAL, 1, &row->jog},
      {"end_low", "nm", OPC_REAL, 1, &row->end_low},
      {"end_high", "nm", OPC_REAL, 1, &row->end_high},
      {"ion", "%", OPC_REAL, 4, &row->ion},
      {"ioff", "%", OPC_REAL, 3, &row->ioff},
      {"area", "%", OPC_REAL, 3, &row->area},
      {"print", NULL, OPC_TEXT, 0, &row->print},
      {"vetoes", NULL, OPC_INT, 0, &row->vetoes},
  };
  int code = opc_put_rows(l->host, "trace", 0, t->count, sizeof *row,
                          OPC_ARRAY(columns), error);
  for (size_t i = 0; i < n; i++) g_free(name[i]);
  free(name);
  return code;
}
