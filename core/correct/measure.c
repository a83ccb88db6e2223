/* SPDX-License-Identifier: BSD-3-Clause */
/* From prints to performance: each gate is cut into the slices that the
   extractor asks for. */
#include "core/correct/check.h"
#include "core/correct/gate.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>

static opc_performance part(const opc_performance *p, size_t first, size_t n) {
  return (opc_performance){.count = n,
                           .ion = p->ion + first,
                           .ioff = p->ioff + first,
                           .leq_ion = p->leq_ion + first,
                           .leq_ioff = p->leq_ioff + first,
                           .weq = p->weq + first,
                           .area = p->area + first};
}

/* The slices of a range of gates; the last three arrays are its own. */
typedef struct slices {
  const double *place, *share;   /* of every gate that is not sliced by itself */
  size_t n;
  double *own;                   /* places and shares of one that is; or NULL */
  double *width, *length, *edge;
} slices;

static int slices_make(slices *s, const opc_module *extract, size_t gates,
                       opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  const char *before = opc_call(extract, error);
  s->n = model->slicing(extract->self, &s->place, &s->share);
  opc_leave(before);
  int code = opc_check_slicing(s->n, s->place, s->share, error);
  if (code) return opc_blame(error, code, "extract");
  size_t all = s->n * gates, own = OPC_HAS(model, slice) ? 2 * s->n : 0;
  s->width = calloc(3 * all + own + 1, sizeof *s->width);
  s->length = s->width + all;
  s->edge = s->length + all;
  s->own = own ? s->edge + all : NULL;
  return s->width ? OPC_OK
                  : opc_fail(error, OPC_FAILED, NULL, "out of memory");
}

/* Cut a gate, number k of the range. */
static int slices_cut(const slices *s, const opc_module *extract, size_t k,
                      opc_gate *gate,
                      opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  const double *place = s->place, *share = s->share;
  if (s->own) {
    const char *before = opc_call(extract, error);
    model->slice(extract->self, &gate->shown, s->own, s->own + s->n);
    opc_leave(before);
    place = s->own;
    share = s->own + s->n;
    int code = opc_check_slicing(s->n, place, share, error);
    if (code) return opc_blame(error, code, "extract");
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
   opc_check_performance. */
static int slices_extract(const slices *s, const opc_module *extract,
                          const opc_gates *gates, size_t first,
                          const uint32_t *flags, opc_performance *out,
                          opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  opc_slices in = {.size = sizeof in, .count = out->count, .slices = s->n,
                   .type = gates->type + first, .width = s->width,
                   .length = s->length, .edge = s->edge};
  const char *before = opc_call(extract, error);
  int code = model->extract(extract->self, &in, out, error);
  opc_leave(before);
  if (!code) code = opc_check_performance(gates, first, flags, out, error);
  return opc_blame(error, code, "extract");
}

int opc_measure(const opc_host *host, const opc_gates *gates,
                const opc_field print[OPC_MASKS], const opc_module *extract,
                size_t first, size_t last, opc_measurement *out,
                opc_error *error) {
  slices s;
  (void)host;
  int code = slices_make(&s, extract, last - first, error);
  if (code) return code;
  for (size_t i = first; i < last && !code; i++) {
    opc_gate gate;
    opc_gate_measure(gates, i, print, &gate);
    code = slices_cut(&s, extract, i - first, &gate, error);
    for (int side = 0; side < 2; side++)
      out->extension[2 * i + side] = gate.extension[side];
    out->flags[i] = gate.flags;
  }
  if (!code) {
    opc_performance p = part(&out->performance, first, last - first);
    code = slices_extract(&s, extract, gates, first, out->flags + first, &p,
                          error);
  }
  free(s.width);
  return code;
}

int opc_measure_drawn(const opc_gates *gates, const opc_module *extract,
                      opc_performance *out, opc_error *error) {
  slices s;
  int code = slices_make(&s, extract, gates->count, error);
  if (code) return code;
  for (size_t i = 0; i < gates->count && !code; i++) {
    opc_gate gate;
    opc_gate_draw(gates, i, &gate);
    code = slices_cut(&s, extract, i, &gate, error);
  }
  if (!code) code = slices_extract(&s, extract, gates, 0, NULL, out, error);
  free(s.width);
  return code;
}
