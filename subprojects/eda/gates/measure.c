/* SPDX-License-Identifier: BSD-3-Clause */
/* Performance of printed or drawn transistors: the extractor evaluates slices
   of each gate. */
#include <eda/memory.h>
#include <eda/print.h>
#include <stdlib.h>

#include "gates/gate.h"

enum {
  BLOCK = 64 /* gates that a thread measures together */
};

static const char slot[] = "extractor";

/* ---- slices of some gates ---- */

typedef struct slices {
  const opc_context *context;
  const opc_module *extractor;
  const double *place,
      *share; /* positions and widths of the slices, as fractions of the gate
                 width, the same for all gates */
  size_t n;
  double *own; /* positions and widths of the slices of one gate; NULL if all
                  gates use the common slices */
  double *width, *length, *edge; /* nm, [gate * n + slice]; in one allocation */
} slices;

static int slices_init(slices *s, const opc_context *context,
                       const opc_module *extractor, size_t gates,
                       opc_error *error) {
  const eda_extractor *model = extractor->functions;
  *s = (slices){.context = context, .extractor = extractor};
  const char *before = eda_enter(context, extractor, error);
  s->n = model->slicing(extractor->self, &s->place, &s->share);
  int code = eda_check_slicing(s->n, s->place, s->share, error);
  opc_leave(context, before);
  if (code) return eda_blame(error, code, slot);
  size_t all = s->n * gates;
  s->width = eda_alloc(3 * all, sizeof *s->width);
  s->length = s->width + all;
  s->edge = s->length + all;
  s->own = model->slice ? eda_alloc(2 * s->n, sizeof *s->own) : NULL;
  return OPC_OK;
}

static void slices_clear(slices *s) {
  free(s->width);
  free(s->own);
}

/* Measure the slices of a gate; k is the index of the gate in the block. */
static int slices_cut(const slices *s, size_t k, eda_gate *gate,
                      opc_error *error) {
  const double *place = s->place, *share = s->share;
  if (s->own) {
    int code = eda_call_slice(s->context, s->extractor, &gate->shown, s->n,
                              s->own, error);
    if (code) return eda_blame(error, code, slot);
    place = s->own;
    share = s->own + s->n;
  }
  for (size_t i = 0; i < s->n; i++) {
    double t = place[i], width = gate->shown.width;
    s->width[k * s->n + i] = share[i] * width;
    s->edge[k * s->n + i] = width * (t < 0.5 ? t : 1 - t);
  }
  gate->shown.lengths(&gate->shown, s->n, place, s->length + k * s->n);
  return OPC_OK;
}

/* Return the slices of `count` gates from gate `first` on. */
static eda_slices slices_of(const slices *s, const eda_gates *gates,
                            size_t first, size_t count) {
  eda_slices in = {.count = count,
                   .slices = s->n,
                   .type = gates->type + first,
                   .width = s->width,
                   .length = s->length,
                   .edge = s->edge};
  if (gates->flavour) in.flavour = (const char *const *)gates->flavour + first;
  return in;
}

/* Extract the performance of out->count gates from gate `first` on. `flags`:
   flags of these gates as in eda_check_performance. */
static int slices_extract(const slices *s, const eda_gates *gates, size_t first,
                          const uint32_t *flags, eda_performance *out,
                          opc_error *error) {
  eda_slices in = slices_of(s, gates, first, out->count);
  int code = eda_call_extract(s->context, s->extractor, &in, out, error);
  if (!code) code = eda_check_performance(gates, first, flags, out, error);
  return eda_blame(error, code, slot);
}

/* ---- all gates ---- */

typedef struct measure_task {
  const opc_context *context;
  const eda_gates *gates;
  const eda_field
      *print; /* level sets [layers]; NULL: measure the drawn gates */
  const opc_module *extractor;
  eda_measurement
      *out; /* NULL for drawn gates, which have only a performance */
  eda_performance *performance;
  eda_slices_visit *visit; /* NULL: none */
  void *data;              /* of `visit` */
} measure_task;

/* Return a view of the performance of n gates from gate `first` on. */
static eda_performance performance_part(const eda_performance *p, size_t first,
                                        size_t n) {
  return (eda_performance){.count = n,
                           .ion = p->ion + first,
                           .ioff = p->ioff + first,
                           .leq_ion = p->leq_ion + first,
                           .leq_ioff = p->leq_ioff + first,
                           .weq = p->weq + first,
                           .area = p->area + first,
                           .outside = p->outside + first};
}

/* Set all figures of gate i to zero. A gate whose poly is open or whose active
   is missing is no transistor, so the figures of the slices are meaningless. */
static void performance_strike(eda_performance *p, size_t i) {
  p->ion[i] = p->ioff[i] = p->leq_ion[i] = p->leq_ioff[i] = 0;
  p->weq[i] = p->area[i] = p->outside[i] = 0;
}

/* Zero the figures of gates whose poly is open or whose active is missing. Set
   the flag EDA_PRINT_OUTSIDE of all other gates whose figures are beyond the
   range of the device table. */
static void performance_settle(eda_performance *p, uint32_t *flags) {
  for (size_t i = 0; i < p->count; i++)
    if (flags[i] & (EDA_PRINT_OPEN | EDA_PRINT_NO_ACTIVE))
      performance_strike(p, i);
    else if (p->outside[i])
      flags[i] |= EDA_PRINT_OUTSIDE;
}

/* Measure gate i; k is the index of the gate in the block. */
static int measure_one(const measure_task *j, size_t i, const slices *s,
                       size_t k, opc_error *error) {
  eda_gate gate;
  if (!j->print) {
    eda_gate_draw(j->gates, i, &gate);
    return slices_cut(s, k, &gate, error);
  }
  eda_gate_measure(j->gates, i, j->print, &gate);
  int code = slices_cut(s, k, &gate, error);
  for (int side = 0; side < 2; side++)
    j->out->extension[2 * i + side] = gate.extension[side];
  j->out->flags[i] = gate.flags;
  return code;
}

static int measure_block(void *data, size_t block, opc_error *error) {
  const measure_task *j = data;
  size_t first = block * BLOCK, n = j->gates->count - first;
  if (n > BLOCK) n = BLOCK;
  slices s;
  int code = slices_init(&s, j->context, j->extractor, n, error);
  for (size_t k = 0; k < n && !code; k++)
    code = measure_one(j, first + k, &s, k, error);
  if (!code && j->visit) {
    eda_slices in = slices_of(&s, j->gates, first, n);
    code = j->visit(j->data, first, &in, error);
  }
  if (!code) {
    eda_performance p = performance_part(j->performance, first, n);
    uint32_t *flags = j->print ? j->out->flags + first : NULL;
    code = slices_extract(&s, j->gates, first, flags, &p, error);
    if (!code && flags) performance_settle(&p, flags);
  }
  slices_clear(&s);
  return code;
}

static int gates_measure(measure_task *j, opc_error *error) {
  return eda_try_all(j->context, (j->gates->count + BLOCK - 1) / BLOCK,
                     measure_block, j, error);
}

int eda_measure(const opc_context *context, const eda_gates *gates,
                const eda_field *print, const opc_module *extractor,
                eda_measurement *out, opc_error *error) {
  return eda_measure_slices(context, gates, print, extractor, NULL, NULL, out,
                            error);
}

int eda_measure_slices(const opc_context *context, const eda_gates *gates,
                       const eda_field *print, const opc_module *extractor,
                       eda_slices_visit *visit, void *data,
                       eda_measurement *out, opc_error *error) {
  measure_task j = {context,           gates, print, extractor, out,
                    &out->performance, visit, data};
  return gates_measure(&j, error);
}

int eda_measure_drawn(const opc_context *context, const eda_gates *gates,
                      const opc_module *extractor, eda_performance *out,
                      opc_error *error) {
  measure_task j = {.context = context,
                    .gates = gates,
                    .extractor = extractor,
                    .performance = out};
  return gates_measure(&j, error);
}

/* ---- common parts ---- */

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
