/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the textual findings of a correction. */
#include <correct/findings.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/report.h>

/* Largest relative distance of a drawn length from an end of the device table
   that causes a warning; about the deviation of a printed length from the drawn
   length before correction. */
static const double near_end = 0.1;

static const char *plural_of(size_t n) { return n == 1 ? "" : "s"; }
static const char *verb_of(size_t n) { return n == 1 ? "does" : "do"; }

/* ---- drawn ---- */

static void range_of_type(const opc_host *host, const eda_gates *g,
                          const opc_module *extractor, int type) {
  const eda_extractor *model = extractor->functions;
  double low, high, least = INFINITY, most = 0;
  size_t beyond = 0, count = 0;
  if (!model->range(extractor->self, type, &low, &high)) return;
  for (size_t i = 0; i < g->count; i++) {
    if (g->type[i] != type || *eda_gates_flavour(g, i)) continue;
    least = fmin(least, g->length[i]);
    most = fmax(most, g->length[i]);
    beyond += g->length[i] < low || g->length[i] > high;
    count++;
  }
  const char *name = type == EDA_PMOS ? "p" : "n";
  if (beyond)
    host->log(host, OPC_LOG_WARNING,
              "%zu of %zu %s-transistors are drawn with lengths (%g to %g nm) "
              "beyond the device table (%g to %g nm): check the 'scale' of the "
              "layout and that the table belongs to this process",
              beyond, count, name, least, most, low, high);
  else if (count &&
           (least * (1 - near_end) < low || most * (1 + near_end) > high))
    host->log(host, OPC_LOG_WARNING,
              "%s-transistors are drawn with lengths (%g to %g nm) near an end "
              "of the device table (%g to %g nm): printed lengths may be "
              "beyond the table",
              name, least, most, low, high);
}

/* Return the number of different values among n sizes. */
static size_t count_different(const double *size, size_t n) {
  double *sorted = g_new(double, n);
  size_t count = 0;
  for (size_t i = 0; i < n; i++) sorted[i] = size[i];
  qsort(sorted, n, sizeof *sorted, eda_doubles_rise);
  for (size_t i = 0; i < n; i++) count += !i || sorted[i] != sorted[i - 1];
  g_free(sorted);
  return count;
}

/* If layers are exchanged, most gates are longer than wide, and lengths are
   more diverse than widths. The warning requires both, because 5 V devices may
   be longer than wide. */
void correct_findings_of_drawing(const opc_host *host, const eda_gates *g,
                                 const opc_module *extractor) {
  const eda_extractor *model = extractor->functions;
  size_t longer = 0;
  for (size_t i = 0; i < g->count; i++) longer += g->length[i] > g->width[i];
  if (2 * longer > g->count && count_different(g->length, g->count) >
                                   count_different(g->width, g->count))
    host->log(host, OPC_LOG_WARNING,
              "%zu of %zu transistors are drawn longer than wide: check that "
              "the layers poly and active are not exchanged",
              longer, g->count);
  for (int type = 0; model->range && type < 2; type++)
    range_of_type(host, g, extractor, type);
}

/* ---- printed ---- */

/* Return the name and position of a gate, "XU1:3 at (120, 340) nm". */
static char *place_of(const eda_gates *g, size_t i) {
  eda_box b = g->box[i];
  char *name = correct_report_gate_name(g, i);
  char *place = g_strdup_printf("%s at (%g, %g) nm", name,
                                ((double)b.x0 + b.x1) / 2 * g->grid,
                                ((double)b.y0 + b.y1) / 2 * g->grid);
  g_free(name);
  return place;
}

/* Number of transistors with a fault, and index of the first gate. */
typedef struct fault {
  size_t count, first;
} fault;

static void fault_add(fault *f, size_t i, size_t n) {
  if (!f->count) f->first = i;
  f->count += n;
}

/* Log the faults among `all` transistors. */
static void log_failed(const opc_host *host, const eda_gates *g, size_t all,
                       const fault *bad, const fault *lost) {
  if (bad->count) {
    g_autofree char *place = place_of(g, bad->first);
    host->log(host, OPC_LOG_FINDING,
              "%zu of %zu transistor%s %s not print as one transistor, and %s "
              "no results: first %s",
              bad->count, all, plural_of(all), verb_of(bad->count),
              bad->count == 1 ? "has" : "have", place);
  }
  if (lost->count) {
    g_autofree char *place = place_of(g, lost->first);
    host->log(host, OPC_LOG_FINDING,
              "%zu transistor%s that printed with the drawn mask %s not print "
              "any more: first %s",
              lost->count, plural_of(lost->count), verb_of(lost->count), place);
  }
}

void correct_findings_of_print(const opc_host *host, const eda_gates *g,
                               const uint32_t *count, const uint32_t *flags,
                               const uint32_t *before) {
  fault bad = {0}, lost = {0};
  size_t all = 0, outside = 0, good_before = 0;
  for (size_t i = 0; i < g->count; i++) {
    size_t n = count ? count[i] : 1;
    int was_good = before && !eda_print_failed(before[i]);
    all += n;
    good_before += was_good ? n : 0;
    if (!eda_print_failed(flags[i])) {
      outside += flags[i] & EDA_PRINT_OUTSIDE ? n : 0;
      continue;
    }
    fault_add(&bad, i, n);
    if (was_good) fault_add(&lost, i, n);
  }
  log_failed(host, g, all, &bad, &lost);
  if (before && all && !good_before)
    host->log(host, OPC_LOG_FINDING,
              "no transistor of the drawn mask prints: check the 'scale' of "
              "the layout, that optics and resist belong to the process, and "
              "that poly and active are not exchanged");
  if (outside)
    host->log(host, OPC_LOG_FINDING,
              "results of %zu of %zu transistors are extrapolated beyond the "
              "device table by the last slope and are not reliable",
              outside, all);
}

int correct_slices_add(const opc_host *host, const eda_mask *m,
                       const uint32_t *count, const opc_module *extractor,
                       eda_short_slices *sum, opc_error *error) {
  eda_measurement again;
  eda_measurement_init(&again, m->gates->count);
  int code = eda_measure_short(host->context, m->gates, m->print, extractor,
                               count, &again, sum, error);
  eda_measurement_clear(&again);
  return code;
}

int correct_slices_report(const opc_host *host, const eda_short_slices *sum,
                          opc_error *error) {
  char text[400];
  eda_short_slices_text(sum, text, sizeof text);
  if (*text) host->log(host, OPC_LOG_FINDING, "%s", text);
  const opc_metric_value value = {"short_slices", sum->below};
  return opc_put_metrics(host, &value, 1, error);
}

int correct_findings_of_slices(const opc_host *host, const eda_mask *m,
                               const opc_module *extractor, opc_error *error) {
  eda_short_slices sum = {0};
  if (!m->gates->count) return OPC_OK;
  int code = correct_slices_add(host, m, NULL, extractor, &sum, error);
  return code ? code : correct_slices_report(host, &sum, error);
}

/* ---- guard ---- */

void correct_findings_of_guard(const opc_host *host, const guard *g, int held) {
  const char *are = g->worse == 1 ? " is" : "s are";
  if (!held && (g->worse || g->lost))
    host->log(
        host, OPC_LOG_FINDING,
        "guard: off: %zu transistor%s worse than drawn and worse than the "
        "limit, %zu that printed with the drawn mask %s not print any more",
        g->worse, are, g->lost, verb_of(g->lost));
  if (held && g->worse)
    host->log(host, OPC_LOG_FINDING,
              "%zu transistor%s worse than drawn because of neighbours or "
              "rules: see 'verdict' in gates.csv",
              g->worse, are);
  if (g->ruled) {
    const guarded *s = &g->state[g->first];
    host->log(host, OPC_LOG_FINDING,
              "%zu transistor%s beyond the limit of Ion, because the rest of "
              "%s correction violates a rule: the first is %s at (%g, %g) nm",
              g->ruled, g->ruled == 1 ? " is" : "s are",
              g->ruled == 1 ? "its" : "their", s->rule, s->at[0], s->at[1]);
  }
  if (g->back)
    host->log(
        host, OPC_LOG_INFO,
        "%zu transistor%s reverted towards the drawn mask, which was better",
        g->back, plural_of(g->back));
}

OPC_PRINTF(3, 4)
static void log_nothing(const opc_host *host, int level, const char *format,
                        ...) {
  (void)host, (void)level, (void)format;
}

opc_host correct_findings_discarded(const opc_host *host) {
  opc_host quiet = *host;
  quiet.log = log_nothing;
  return quiet;
}
