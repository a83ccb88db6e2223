/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulates the transistors. A model card is simulated with one transistor,
   whose length is changed from the longest to the shortest; results before a
   failure of the card are kept. In a library, bins and expressions depend on L
   and W, so one circuit has a transistor for each length. */
#include <eda/memory.h>
#include <eda/simulator.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ngspice.h"

/* Work unit of one process: transistor type, quantity and width. */
typedef struct simulation_task {
  const plan *p;
  currents *out;
  int type, current, code;
  size_t width; /* index of the width */
  size_t done;  /* number of simulated lengths, from the longest */
  int narrower; /* 1: narrower than any bin, not simulated */
  opc_error error;
} simulation_task;

static const char *const type_names[TYPES] = {
    [EDA_NMOS] = "n", [EDA_PMOS] = "p"};
static const char *const current_names[QUANTITIES] = {
    [EDA_ION] = "Ion", [EDA_IOFF] = "Ioff", [CGATE] = "Cgate"};

/* Number of parts of the gate's swing. The capacitance is measured in the
   middle of each part, at a frequency at which the gate resistance has no
   effect. Twice as many parts change the result by less than 1e-4. */
enum { SWING = 32 };
static const double frequency = 1e6; /* Hz */

/* Current tolerances for circuits of a library, A. Ioff may be 1e-13 A, so gmin
   is 1e-20 S. The tolerance of Ion is limited by rounding of the currents. For
   capacitances, the simulator's default is sufficient. */
static const double least_current[QUANTITIES] = {
    [EDA_ION] = 1e-15, [EDA_IOFF] = 1e-19, [CGATE] = 1e-12};

/* Disable the last method of finding an operating point. This method uses the
   state after a transient of 10 us, which may not have settled: the error is 2
   % for a long PSP transistor. Instead, ngspice reports a failure. */
static const char no_transient[] = "optran 1 1 1 0 0 0\n";

static double width_of(const simulation_task *j) {
  return j->p->each_width[j->width];
}

static double *currents_of(const simulation_task *j) {
  return j->out->at[j->type][j->current] + j->width * j->p->count;
}

/* Return 1 if this task also simulates the reference transistor. */
static int has_reference(const simulation_task *j) {
  return j->p->reference_length > 0 && j->width + 1 == j->p->widths;
}

/* Return the number of analyses per transistor. */
static size_t analyses(const simulation_task *j) {
  return j->current == CGATE ? SWING : 1;
}

static double sign_of(const simulation_task *j) {
  return j->type == EDA_PMOS ? -1 : 1;
}

/* Write the commands of the analyses. The gate charge over the swing is the sum
   of small-signal capacitances; leakage is in phase and does not contribute. */
static void put_analyses(const simulation_task *j, GString *out) {
  double end = sign_of(j) * j->p->bias[j->current].gate;
  if (j->current != CGATE) g_string_append(out, "op\n");
  for (int i = 0; j->current == CGATE && i < SWING; i++)
    g_string_append_printf(out, "alter vgate = %.17g\nac lin 1 %g %g\n",
                           (i + 0.5) / SWING * end, frequency, frequency);
}

/* ---- a card ---- */

static char *make_deck(const simulation_task *j) {
  const plan *p = j->p;
  const bias *b = &p->bias[j->current];
  double sign = sign_of(j);
  return g_strdup_printf(
      "device table\n"
      ".include \"%s\"\n"
      ".options temp=%.17g gmin=1e-15 reltol=1e-6 abstol=1e-15\n"
      "m1 drain gate 0 0 %s w=%.17gn l=%.17gn\n"
      "vdrain drain 0 %.17g\n"
      "vgate gate 0 %.17g ac 1 90\n"
      ".end\n",
      p->path[j->type], p->temperature, p->model[j->type], width_of(j),
      p->length[p->count - 1], sign * b->drain, sign * b->gate);
}

/* Return the commands: the reference transistor, if any, then all lengths from
   the longest down. */
static char *make_commands(const simulation_task *j) {
  const plan *p = j->p;
  GString *out = g_string_new(no_transient);
  for (size_t i = 0; i < p->overrides.count; i++)
    g_string_append_printf(out, "altermod %s %s = %s\n", p->model[j->type],
                           p->overrides.pairs[i].key,
                           p->overrides.pairs[i].value);
  if (has_reference(j))
    g_string_append_printf(out,
                           "alter @m1[w] = %.17gn\nalter @m1[l] = %.17gn\n",
                           p->reference_width, p->reference_length);
  if (has_reference(j)) {
    put_analyses(j, out);
    g_string_append_printf(out, "alter @m1[w] = %.17gn\n", width_of(j));
  }
  for (size_t i = p->count; i-- > 0;) {
    g_string_append_printf(out, "alter @m1[l] = %.17gn\n", p->length[i]);
    put_analyses(j, out);
  }
  return g_string_free(out, FALSE);
}

/* Round a value to the digits of the table, so that comparisons use the rounded
   currents. */
static double table_round(double x) {
  char text[32];
  g_snprintf(text, sizeof text, "%.6e", x);
  return g_ascii_strtod(text, NULL);
}

/* Return the value of a transistor from its analyses: the current of the
   voltage source at the drain or the gate. The gate source has a phase of 90
   degrees, so the real part is the capacitive current. */
static double value_of(const simulation_task *j, const eda_spice_plot *plot,
                       const char *name) {
  double sum = 0;
  for (size_t i = 0; i < analyses(j); i++) {
    const eda_spice_vector *v = eda_spice_vector_find(&plot[i], name);
    sum += v && v->count ? v->value[0] : (double)NAN;
  }
  return table_round(j->current == CGATE ? sum / (2 * G_PI * frequency * SWING)
                                         : -sign_of(j) * sum);
}

static void keep_simulator(const simulation_task *j,
                           const eda_spice_result *r) {
  const char *at = r->words ? strstr(r->words, "ngspice-") : NULL;
  if (j->type || j->current || j->width + 1 < j->p->widths) return;
  g_snprintf(j->out->simulator, sizeof j->out->simulator, "%.*s",
             at ? (int)strcspn(at, " \n") : 7, at ? at : "ngspice");
}

static void run_card(simulation_task *j) {
  eda_spice_result r = {0};
  g_autofree char *deck = make_deck(j), *commands = make_commands(j);
  const char *source = j->current == CGATE ? "i(vgate)" : "i(vdrain)";
  size_t skip = (size_t)has_reference(j), count = j->p->count;
  j->code = eda_spice_run(j->p->host->context, deck, commands, j->p->limit, &r,
                          &j->error);
  size_t done = r.count / analyses(j);
  if (skip && done)
    j->out->reference[j->type][j->current] = value_of(j, r.plot, source);
  for (size_t i = skip; i < done && i < skip + count; i++)
    currents_of(j)[count - 1 + skip - i] =
        value_of(j, &r.plot[i * analyses(j)], source);
  j->done = done > skip ? done - skip : 0;
  keep_simulator(j, &r);
  eda_spice_clear(&r);
}

/* ---- a library ---- */

/* Return the index of the first length with a bin; 0 if bins are extended or
   the model has no bins. */
static size_t first_modelled(const simulation_task *j) {
  const plan *p = j->p;
  eda_sizes bins;
  size_t i = 0;
  if (p->ends == EXTEND ||
      !eda_models_bins(p->models, p->model[j->type], &bins))
    return 0;
  while (i < p->count && p->length[i] < bins.length[0] - 1e-3) i++;
  return i;
}

/* Return 1 if the width is extrapolated. */
static int is_narrower(const simulation_task *j) {
  const plan *p = j->p;
  eda_sizes bins;
  return p->ends == SLOPE && p->models &&
         eda_models_bins(p->models, p->model[j->type], &bins) &&
         width_of(j) < bins.width[0] - 1e-3;
}

static void put_device(const simulation_task *j, GString *out, size_t i,
                       double length, double width) {
  const plan *p = j->p;
  double unit = eda_models_unit(p->models);
  int kind = eda_models_kind(p->models, p->model[j->type]);
  g_string_append_printf(out, "%c%zu d%zu g%zu 0 0 %s w=%.12g l=%.12g\n",
                         kind == EDA_MODEL_SUBCIRCUIT ? 'x' : 'm', i, i, i,
                         p->model[j->type], width / unit, length / unit);
  g_string_append_printf(out, "vg%zu g%zu gate 0\nv%zu d%zu 0 %.17g\n", i, i, i,
                         i, sign_of(j) * p->bias[j->current].drain);
}

static char *library_deck(const simulation_task *j, size_t first) {
  const plan *p = j->p;
  double width = width_of(j);
  eda_sizes sizes = {{p->length[first], p->length[p->count - 1]},
                     {width, width}};
  if (has_reference(j)) {
    sizes.width[0] = fmin(width, p->reference_width);
    sizes.width[1] = fmax(width, p->reference_width);
    sizes.length[0] = fmin(sizes.length[0], p->reference_length);
    sizes.length[1] = fmax(sizes.length[1], p->reference_length);
  }
  g_autofree char *models =
      eda_models_cut(p->models, p->model[j->type], &sizes, p->ends == EXTEND);
  GString *out = g_string_new("device table\n");
  g_string_append(out, models);
  g_string_append_printf(
      out, ".options temp=%.17g gmin=1e-20 reltol=1e-6 abstol=%g\n",
      p->temperature, least_current[j->current]);
  g_string_append_printf(out, "vgate gate 0 %.17g ac 1 90\n",
                         sign_of(j) * p->bias[j->current].gate);
  for (size_t i = first; i < p->count; i++)
    put_device(j, out, i, p->length[i], width);
  if (has_reference(j))
    put_device(j, out, p->count, p->reference_length, p->reference_width);
  g_string_append(out, ".end\n");
  return g_string_free(out, FALSE);
}

static void run_library(simulation_task *j) {
  const plan *p = j->p;
  size_t first = first_modelled(j);
  if (first == p->count) {
    j->code = opc_fail(&j->error, OPC_FAILED, NULL,
                       "the library has no bin for the size");
    return;
  }
  eda_spice_result r = {0};
  g_autofree char *deck = library_deck(j, first);
  g_autoptr(GString) commands = g_string_new(no_transient);
  put_analyses(j, commands);
  j->code = eda_spice_run(p->host->context, deck, commands->str, p->limit, &r,
                          &j->error);
  int whole = r.count >= analyses(j);
  for (size_t i = first; i <= p->count && whole; i++) {
    char name[32];
    g_snprintf(name, sizeof name, "i(v%s%zu)", j->current == CGATE ? "g" : "",
               i);
    double *to = i < p->count ? &currents_of(j)[i]
                              : &j->out->reference[j->type][j->current];
    if (i < p->count || has_reference(j)) *to = value_of(j, r.plot, name);
  }
  j->done = whole ? p->count - first : 0;
  if (!j->code)
    (void)opc_fail(&j->error, OPC_FAILED, NULL,
                   "the library has no bin for the size");
  keep_simulator(j, &r);
  eda_spice_clear(&r);
}

static void run_job(void *data, size_t index) {
  simulation_task *j = (simulation_task *)data + index;
  j->narrower = is_narrower(j);
  if (j->narrower) return;
  if (j->p->models)
    run_library(j);
  else
    run_card(j);
}

/* ---- range of valid lengths ---- */

/* Return 1 if this current must increase with decreasing length: Ion and
   Ioff if there is one width, otherwise only Ion of the widest transistor. */
static int must_rise(const simulation_task *j) {
  return (j->p->widths == 1 && j->current != CGATE) ||
         (j->current == EDA_ION && j->width + 1 == j->p->widths);
}

/* Return the fault of a current at length i compared with the next longer
   length, or NULL if the current is valid. */
static const char *current_fault(const simulation_task *j, size_t i) {
  const double *y = currents_of(j);
  if (i + j->done < j->p->count) return j->error.message;
  if (!isfinite(y[i])) return "the value is not a number";
  if (!(y[i] > 0))
    return j->current == CGATE
               ? "the value is not above 0"
               : "the current does not flow from drain to source";
  if (must_rise(j) && i + 1 < j->p->count && !(y[i] > y[i + 1]))
    return "the current does not rise with decreasing length";
  return NULL;
}

/* Write a text such as "Ion of the p-transistor at 42 nm", with the width if
   there are several. */
static void length_describe(const simulation_task *j, double length,
                            char text[96]) {
  char width[32] = "";
  if (j->p->widths > 1)
    g_snprintf(width, sizeof width, ", W %g nm,", width_of(j));
  g_snprintf(text, 96, "%s of the %s-transistor%s at %g nm",
             current_names[j->current], type_names[j->type], width, length);
}

/* Find the shortest length from which all longer lengths are valid. Return an
   error if too few lengths are valid. *why receives the fault of the next
   shorter length, or NULL if all lengths are valid. */
static int find_end(const simulation_task *j, size_t *first, const char **why,
                    opc_error *error) {
  enum { LEAST = 3 }; /* needed by the interpolation of extractors */
  const plan *p = j->p;
  size_t i = p->count;
  *why = NULL;
  while (i > 0 && !(*why = current_fault(j, i - 1))) i--;
  *first = i;
  if (p->count - i >= LEAST && (!*why || p->ends != REFUSE)) return OPC_OK;
  return opc_fail(error, OPC_FAILED, j->type == EDA_PMOS ? "pmos" : "nmos",
                  "model '%s', %s at %g nm: %s", p->model[j->type],
                  current_names[j->current], p->length[i - 1], *why);
}

/* Extrapolate to lengths below `first`, linearly in the logarithm. The slope is
   measured up to a length 5 % larger, because the step of a table may be too
   small. */
static int go_on(const simulation_task *j, size_t first, opc_error *error) {
  const double part = 1.05;
  const double *x = j->p->length;
  double *y = currents_of(j);
  size_t to = first + 1;
  while (to + 1 < j->p->count && x[to] < part * x[first]) to++;
  double slope = log(y[to] / y[first]) / (x[to] - x[first]);
  if (must_rise(j) && !(slope < 0)) {
    char what[96];
    length_describe(j, x[first], what);
    return opc_fail(error, OPC_FAILED, "ends",
                    "%s cannot be extrapolated: the slope is not negative",
                    what);
  }
  for (size_t i = 0; i < first; i++)
    y[i] = table_round(y[first] * exp(slope * (x[i] - x[first])));
  return OPC_OK;
}

/* Determine the first valid length of one current. */
static int settle_end(const simulation_task *j, opc_error *error) {
  const plan *p = j->p;
  currents *out = j->out;
  const char *why;
  size_t first;
  int code = find_end(j, &first, &why, error);
  if (code || !why) return code;
  if (p->ends == SLOPE) {
    if (first > out->simulated[j->type]) out->simulated[j->type] = first;
    return go_on(j, first, error);
  }
  /* Log each fault once, not for each width. */
  size_t *logged = &out->cut[j->type][j->current];
  if (first <= *logged) return OPC_OK;
  *logged = first;
  char what[96];
  length_describe(j, p->length[first - 1], what);
  p->host->log(p->host, OPC_LOG_WARNING,
               "model '%s' is valid from %g nm: %s: %s", p->model[j->type],
               p->length[first], what, why);
  if (first > out->first) out->first = first;
  return OPC_OK;
}

static int check_reference(const simulation_task *j, opc_error *error) {
  double value = j->out->reference[j->type][j->current];
  if (!has_reference(j)) return OPC_OK;
  if (isfinite(value) && value > 0) return OPC_OK;
  return opc_fail(error, OPC_FAILED, "reference.length",
                  "model '%s', %s at %g nm: %s", j->p->model[j->type],
                  current_names[j->current], j->p->reference_length,
                  j->code ? j->error.message : "no value was measured");
}

/* Extrapolate to narrower widths: the logarithm of current per width is linear
   in 1 / W, which continues the contribution of the edges. The slope is
   measured between the narrowest simulated width and a width at least 10 %
   wider. */
static int go_narrower(const simulation_task *j, opc_error *error) {
  const double part = 1.1;
  const plan *p = j->p;
  const simulation_task *row = j - j->width; /* values of the narrowest
                                                simulated width */
  size_t a = 0, b;
  while (a < p->widths && row[a].narrower) a++;
  for (b = a + 1; b + 1 < p->widths; b++)
    if (p->each_width[b] >= part * p->each_width[a]) break;
  if (b >= p->widths)
    return opc_fail(error, OPC_FAILED, "widths",
                    "fewer than two widths are in the bins of model '%s'",
                    p->model[j->type]);
  double wa = p->each_width[a], wb = p->each_width[b], w = width_of(j);
  double share = (1 / w - 1 / wa) / (1 / wa - 1 / wb);
  const double *ya = currents_of(&row[a]), *yb = currents_of(&row[b]);
  for (size_t i = 0; i < p->count; i++) {
    double slope = log(ya[i] / wa) - log(yb[i] / wb);
    currents_of(j)[i] = table_round(w / wa * ya[i] * exp(share * slope));
  }
  j->out->narrowest[j->type] = wa;
  return OPC_OK;
}

static int settle_all(const simulation_task *jobs, size_t count,
                      opc_error *error) {
  for (size_t i = 0; i < count; i++) {
    const simulation_task *j = &jobs[i];
    if (j->code && j->code != OPC_FAILED) {
      *error = j->error;
      return j->code;
    }
    int code = check_reference(j, error);
    if (!code && !j->narrower) code = settle_end(j, error);
    if (code) return code;
  }
  for (size_t i = 0; i < count; i++)
    if (jobs[i].narrower && go_narrower(&jobs[i], error)) return error->code;
  return OPC_OK;
}

int simulate(const plan *p, currents *out, opc_error *error) {
  int each = plan_quantities(p);
  size_t count = (size_t)(TYPES * each) * p->widths;
  simulation_task *jobs = eda_alloc(count, sizeof *jobs);
  for (size_t i = 0; i < count; i++)
    jobs[i] = (simulation_task){.p = p,
                                .out = out,
                                .width = i % p->widths,
                                .type = (int)(i / p->widths) / each,
                                .current = (int)(i / p->widths) % each};
  opc_parallel(p->host->context, count, run_job, jobs);
  int code = settle_all(jobs, count, error);
  free(jobs);
  return code;
}
