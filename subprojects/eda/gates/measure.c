/* SPDX-License-Identifier: BSD-3-Clause */
/* From prints to performance: each gate is cut into the slices that the
   extractor asks for. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>

#include "gates/gate.h"

enum { BLOCK = 64 }; /* gates that a thread measures at a time */

static const char slot[] = "extractor";

/* ---- slices of some gates ---- */

typedef struct slices {
  const opc_context *context;
  const opc_module *extractor;
  const double *place, *share; /* of every gate that is not sliced by itself */
  size_t n;
  double *own;                   /* places and shares of one that is; or NULL */
  double *width, *length, *edge; /* [gate * n + slice]; one array */
} slices;

static int slices_init(slices *s, const opc_context *context,
                       const opc_module *extractor, size_t gates,
                       opc_error *error) {
  const eda_extractor *model = extractor->functions;
  *s = (slices){.context = context, .extractor = extractor};
  const char *before = eda_enter(context, extractor, error);
  s->n = model->slicing(extractor->self, &s->place, &s->share);
  opc_leave(context, before);
  int code = eda_check_slicing(s->n, s->place, s->share, error);
  if (code) return eda_blame(error, code, slot);
  size_t all = s->n * gates, own = model->slice ? 2 * s->n : 0;
  s->width = eda_alloc(3 * all + own, sizeof *s->width);
  s->length = s->width + all;
  s->edge = s->length + all;
  s->own = own ? s->edge + all : NULL;
  return OPC_OK;
}

/* Cut a gate, number k of these. */
static int slices_cut(const slices *s, size_t k, eda_gate *gate,
                      opc_error *error) {
  const eda_extractor *model = s->extractor->functions;
  const double *place = s->place, *share = s->share;
  if (s->own) {
    const char *before = eda_enter(s->context, s->extractor, error);
    model->slice(s->extractor->self, &gate->shown, s->own, s->own + s->n);
    opc_leave(s->context, before);
    place = s->own;
    share = s->own + s->n;
    int code = eda_check_slicing(s->n, place, share, error);
    if (code) return eda_blame(error, code, slot);
  }
  for (size_t i = 0; i < s->n; i++) {
    double t = place[i], width = gate->shown.width;
    s->width[k * s->n + i] = share[i] * width;
    s->edge[k * s->n + i] = width * (t < 0.5 ? t : 1 - t);
  }
  gate->shown.lengths(&gate->shown, s->n, place, s->length + k * s->n);
  return OPC_OK;
}

/* The performance of the gates from `first` on; `flags` of each as in
   eda_check_performance. */
static int slices_extract(const slices *s, const eda_gates *gates, size_t first,
                          const uint32_t *flags, eda_performance *out,
                          opc_error *error) {
  const eda_extractor *model = s->extractor->functions;
  eda_slices in = {.count = out->count,
                   .slices = s->n,
                   .type = gates->type + first,
                   .width = s->width,
                   .length = s->length,
                   .edge = s->edge};
  const char *before = eda_enter(s->context, s->extractor, error);
  int code = model->extract(s->extractor->self, &in, out, error);
  opc_leave(s->context, before);
  if (!code) code = eda_check_performance(gates, first, flags, out, error);
  return eda_blame(error, code, slot);
}

/* ---- a print ---- */

typedef struct job {
  const opc_context *context;
  const eda_gates *gates;
  const eda_field *print;
  const opc_module *extractor;
  eda_measurement *out;
} job;

/* The gates from `first` on. */
static eda_performance part(const eda_performance *p, size_t first, size_t n) {
  return (eda_performance){.count = n,
                           .ion = p->ion + first,
                           .ioff = p->ioff + first,
                           .leq_ion = p->leq_ion + first,
                           .leq_ioff = p->leq_ioff + first,
                           .weq = p->weq + first,
                           .area = p->area + first};
}

static int measure_block(void *data, size_t block, opc_error *error) {
  const job *j = data;
  size_t first = block * BLOCK, n = j->gates->count - first;
  if (n > BLOCK) n = BLOCK;
  slices s;
  int code = slices_init(&s, j->context, j->extractor, n, error);
  for (size_t k = 0; k < n && !code; k++) {
    size_t i = first + k;
    eda_gate gate;
    eda_gate_measure(j->gates, i, j->print, &gate);
    code = slices_cut(&s, k, &gate, error);
    for (int side = 0; side < 2; side++)
      j->out->extension[2 * i + side] = gate.extension[side];
    j->out->flags[i] = gate.flags;
  }
  if (!code) {
    eda_performance p = part(&j->out->performance, first, n);
    code =
        slices_extract(&s, j->gates, first, j->out->flags + first, &p, error);
  }
  free(s.width);
  return code;
}

int eda_measure(const opc_context *context, const eda_gates *gates,
                const eda_field *print, const opc_module *extractor,
                eda_measurement *out, opc_error *error) {
  job j = {context, gates, print, extractor, out};
  return eda_try_all(context, (gates->count + BLOCK - 1) / BLOCK, measure_block,
                     &j, error);
}

/* ---- the design ---- */

int eda_measure_drawn(const opc_context *context, const eda_gates *gates,
                      const opc_module *extractor, eda_performance *out,
                      opc_error *error) {
  slices s;
  int code = slices_init(&s, context, extractor, gates->count, error);
  for (size_t i = 0; i < gates->count && !code; i++) {
    eda_gate gate;
    eda_gate_draw(gates, i, &gate);
    code = slices_cut(&s, i, &gate, error);
  }
  if (!code) code = slices_extract(&s, gates, 0, NULL, out, error);
  free(s.width);
  return code;
}

/* ---- what both need ---- */

int eda_extractor_prepare(const opc_context *context,
                          const opc_module *extractor, opc_error *error) {
  const eda_extractor *model = extractor->functions;
  const char *before = eda_enter(context, extractor, error);
  int code = model->prepare(extractor->self, error);
  opc_leave(context, before);
  return eda_blame(error, code, slot);
}

void eda_measurement_init(eda_measurement *m, size_t n) {
  m->flags = eda_alloc(n, sizeof *m->flags);
  m->extension = eda_alloc(2 * n, sizeof *m->extension);
  eda_performance_init(&m->performance, n);
}

void eda_measurement_clear(eda_measurement *m) {
  eda_performance_clear(&m->performance);
  free(m->flags);
  free(m->extension);
  *m = (eda_measurement){0};
}
