/* SPDX-License-Identifier: BSD-3-Clause */
/* Currents over length, from the extractor, of rectangular gates or of gates
   with the printed shape. */
#include <eda/check.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

/* Distance of the lengths, nm. Linear interpolation then has an error of 1e-3
   of ln Ioff where the logarithmic slope changes by 0.13 per nm. */
static const double grid = 0.25;

/* Difference up to which curves are equal: rounding errors. */
static const float same = 2e-5F;

void curves_init(curves *c, size_t gates, double low, double high) {
  *c = (curves){.first = low,
                .step = grid,
                .count = (size_t)ceil((high - low) / grid) + 2,
                .gates = gates,
                .kinds = gates,
                .kind = eda_alloc(gates, sizeof *c->kind)};
  for (size_t i = 0; i < gates; i++) c->kind[i] = (uint32_t)i;
  for (int q = 0; q < CURRENTS; q++)
    c->value[q] = eda_alloc(gates * c->count, sizeof *c->value[q]);
}

void curves_clear(curves *c) {
  free(c->kind);
  for (int q = 0; q < CURRENTS; q++) free(c->value[q]);
  *c = (curves){0};
}

/* Least length of a slice, nm. */
static const double least_slice = 1;

/* Extract one copy of a gate for each length of the curve. All slices of a copy
   have that length, or are as much longer than in `in` as the length exceeds
   `drawn`. */
static int fill_gate(const curves *c, const double *drawn,
                     const opc_context *context, const opc_module *extractor,
                     const eda_slices *in, size_t gate, eda_performance *out,
                     opc_error *error) {
  size_t n = in->slices, first = gate * n;
  double *all = eda_alloc(3 * c->count * n, sizeof *all), *width = all,
         *edge = width + c->count * n, *length = edge + c->count * n;
  uint8_t *type = eda_alloc(c->count, 1);
  const char **flavour = eda_alloc(c->count, sizeof *flavour);
  for (size_t k = 0; k < c->count; k++) {
    type[k] = in->type[gate];
    if (in->flavour) flavour[k] = in->flavour[gate];
    memcpy(width + k * n, in->width + first, n * sizeof *width);
    memcpy(edge + k * n, in->edge + first, n * sizeof *edge);
    for (size_t s = 0; s < n; s++) {
      double shape = drawn ? in->length[first + s] - *drawn : 0;
      length[k * n + s] =
          fmax(least_slice, shape + c->first + (double)k * c->step);
    }
  }
  const eda_slices some = {.count = c->count,
                           .slices = n,
                           .type = type,
                           .width = width,
                           .length = length,
                           .edge = edge,
                           .flavour = in->flavour ? flavour : NULL};
  int code = eda_call_extract(context, extractor, &some, out, error);
  free(type);
  free(flavour);
  free(all);
  return eda_blame(error, code, "extractor");
}

int curves_fill(curves *c, const opc_context *context,
                const opc_module *extractor, size_t first, const eda_slices *in,
                const eda_performance *drawn, const double *width,
                const double *length, opc_error *error) {
  eda_performance p;
  int code = OPC_OK;
  eda_performance_init(&p, c->count);
  for (size_t i = 0; i < in->count && !code; i++) {
    size_t gate = first + i;
    code = fill_gate(c, length ? length + gate : NULL, context, extractor, in,
                     i, &p, error);
    for (size_t k = 0; k < c->count && !code; k++) {
      double w = p.weq[k] / width[gate];
      size_t at = gate * c->count + k;
      c->value[ION][at] = (float)log(p.ion[k] / drawn->ion[gate] / w);
      c->value[IOFF][at] = (float)log(p.ioff[k] / drawn->ioff[gate] / w);
    }
  }
  eda_performance_clear(&p);
  return code;
}

static int curves_equal(const curves *c, size_t a, size_t b) {
  for (int q = 0; q < CURRENTS; q++)
    for (size_t k = 0; k < c->count; k++)
      if (!(fabsf(c->value[q][a * c->count + k] -
                  c->value[q][b * c->count + k]) <= same))
        return 0;
  return 1;
}

void curves_share(curves *c) {
  c->kinds = 0;
  for (size_t i = 0; i < c->gates; i++) {
    size_t k = 0;
    while (k < c->kinds && !curves_equal(c, k, i)) k++;
    c->kind[i] = (uint32_t)k;
    if (k < c->kinds) continue;
    for (int q = 0; q < CURRENTS; q++)
      memmove(c->value[q] + k * c->count, c->value[q] + i * c->count,
              c->count * sizeof *c->value[q]);
    c->kinds++;
  }
}

double curves_at(const curves *c, size_t gate, int current, double length) {
  const float *value = c->value[current] + c->kind[gate] * c->count;
  double t = (length - c->first) / c->step;
  t = fmax(0, fmin((double)(c->count - 1) - 1e-9, t));
  size_t i = (size_t)t;
  return (double)value[i] +
         (t - (double)i) * ((double)value[i + 1] - (double)value[i]);
}

double curves_length(const curves *c, size_t gate, int current, double value) {
  double low = c->first, high = low + c->step * (double)(c->count - 1);
  for (int i = 0; i < 50; i++) {
    double middle = (low + high) / 2;
    int more = curves_at(c, gate, current, middle) > value;
    low = more ? middle : low;
    high = more ? high : middle;
  }
  return (low + high) / 2;
}
