/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts slices of printed gates that are shorter than the device model
   covers. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Slices of all gates; failed gates are known only after the measurement.
   Arrays by gate. */
typedef struct slice_counts {
  const eda_gates *gates;
  const opc_module *extractor;
  double *slices, *below; /* number of slices; of slices shorter than the model
                             covers */
  double *shortest;       /* shortest slice of a gate, nm */
} slice_counts;

/* Return the shortest length that the device model of a gate covers, nm. */
static double gate_modelled(const slice_counts *c, size_t i) {
  const eda_extractor *x = c->extractor->functions;
  const eda_gates *g = c->gates;
  if (!x->modelled) return 0;
  return x->modelled(c->extractor->self, g->type[i],
                     g->flavour ? g->flavour[i] : NULL);
}

/* Count the slices of a block of gates. Slices without width do not count. */
static int slices_count(void *data, size_t first, const eda_slices *in,
                        opc_error *error) {
  const slice_counts *c = data;
  (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double limit = gate_modelled(c, first + i);
    c->shortest[first + i] = INFINITY;
    for (size_t s = i * in->slices; s < (i + 1) * in->slices; s++) {
      if (!(in->width[s] > 0)) continue;
      c->slices[first + i]++;
      c->below[first + i] += in->length[s] < limit;
      c->shortest[first + i] = fmin(c->shortest[first + i], in->length[s]);
    }
  }
  return OPC_OK;
}

/* Add the slices of the transistors that print. */
static void slices_add(const slice_counts *c, const uint32_t *count,
                       const uint32_t *flags, eda_short_slices *sum) {
  for (size_t i = 0; i < c->gates->count; i++) {
    double n = count ? count[i] : 1;
    if (n == 0 || eda_print_failed(flags[i])) continue;
    sum->slices += n * c->slices[i];
    sum->below += n * c->below[i];
    if (c->below[i] == 0) continue;
    if (sum->gates == 0 || c->shortest[i] < sum->shortest) {
      sum->shortest = c->shortest[i];
      sum->modelled = gate_modelled(c, i);
    }
    sum->gates += n;
  }
}

int eda_measure_short(const opc_context *context, const eda_gates *gates,
                      const eda_field *print, const opc_module *extractor,
                      const uint32_t *count, eda_measurement *out,
                      eda_short_slices *sum, opc_error *error) {
  size_t n = gates->count;
  slice_counts c = {.gates = gates, .extractor = extractor};
  c.slices = eda_alloc(3 * n, sizeof *c.slices);
  c.below = c.slices + n;
  c.shortest = c.below + n;
  int code = eda_measure_slices(context, gates, print, extractor, slices_count,
                                &c, out, error);
  if (!code) slices_add(&c, count, out->flags, sum);
  free(c.slices);
  return code;
}

void eda_short_slices_text(const eda_short_slices *s, char *text, size_t size) {
  *text = 0;
  if (!(s->gates > 0)) return;
  (void)snprintf(
      text, size,
      "%.0f of %.0f slices, in %.0f transistor%s, are shorter than the device "
      "model covers: the shortest is %.1f nm long, its model begins at %g nm; "
      "the device table extrapolates the model for these slices",
      s->below, s->slices, s->gates, s->gates == 1 ? "" : "s", s->shortest,
      s->modelled);
}
