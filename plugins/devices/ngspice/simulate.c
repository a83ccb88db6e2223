/* SPDX-License-Identifier: BSD-3-Clause */
/* One transistor in a circuit of its own, whose length is altered from the
   longest down, so that what is simulated before a card fails is kept. */
#include <eda/simulator.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "ngspice.h"

/* A type and a current: one process. */
typedef struct job {
  const plan *p;
  currents *out;
  int type, current, code;
  size_t done; /* lengths that were simulated, from the longest */
  opc_error error;
} job;

static const char *const type_names[TYPES] = {
    [EDA_NMOS] = "n", [EDA_PMOS] = "p"};
static const char *const current_names[EDA_CURRENTS] = {
    [EDA_ION] = "Ion", [EDA_IOFF] = "Ioff"};

/* ---- one process ---- */

static char *make_deck(const job *j) {
  const plan *p = j->p;
  const bias *b = &p->bias[j->current];
  double sign = j->type == EDA_PMOS ? -1 : 1;
  return g_strdup_printf(
      "device table\n"
      ".include \"%s\"\n"
      ".options temp=%.17g gmin=1e-15 reltol=1e-6 abstol=1e-15\n"
      "m1 drain gate 0 0 %s w=%.17gn l=%.17gn\n"
      "vdrain drain 0 %.17g\n"
      "vgate gate 0 %.17g\n"
      ".end\n",
      p->path[j->type], p->temperature, p->model[j->type], p->width,
      p->length[p->count - 1], sign * b->drain, sign * b->gate);
}

/* The reference, if there is one, then all lengths from the longest down. */
static char *make_commands(const job *j) {
  const plan *p = j->p;
  GString *out = g_string_new(NULL);
  for (size_t i = 0; i < p->overrides.count; i++)
    g_string_append_printf(out, "altermod %s %s = %s\n", p->model[j->type],
                           p->overrides.pairs[i].key,
                           p->overrides.pairs[i].value);
  if (p->reference_length > 0)
    g_string_append_printf(out,
                           "alter @m1[w] = %.17gn\nalter @m1[l] = %.17gn\nop\n"
                           "alter @m1[w] = %.17gn\n",
                           p->reference_width, p->reference_length, p->width);
  for (size_t i = p->count; i-- > 0;)
    g_string_append_printf(out, "alter @m1[l] = %.17gn\nop\n", p->length[i]);
  return g_string_free(out, FALSE);
}

/* With the digits that a table has, so that it is the rounded currents that
   are compared. */
static double rounded(double x) {
  char text[32];
  g_snprintf(text, sizeof text, "%.6e", x);
  return g_ascii_strtod(text, NULL);
}

static double current_of(const job *j, const eda_spice_plot *plot) {
  const eda_spice_vector *v = eda_spice_vector_find(plot, "i(vdrain)");
  double into = v && v->count ? -v->value[0] : (double)NAN;
  return rounded(j->type == EDA_PMOS ? -into : into);
}

static void keep_simulator(const eda_spice_result *r, char name[32]) {
  const char *at = r->words ? strstr(r->words, "ngspice-") : NULL;
  g_snprintf(name, 32, "%.*s", at ? (int)strcspn(at, " \n") : 7,
             at ? at : "ngspice");
}

static void run_job(void *data, size_t index) {
  job *j = (job *)data + index;
  eda_spice_result r = {0};
  g_autofree char *deck = make_deck(j), *commands = make_commands(j);
  size_t skip = j->p->reference_length > 0, count = j->p->count;
  j->code = eda_spice_run(j->p->host->context, deck, commands, j->p->limit, &r,
                          &j->error);
  if (skip && r.count)
    j->out->reference[j->type][j->current] = current_of(j, &r.plot[0]);
  for (size_t i = skip; i < r.count && i < skip + count; i++)
    j->out->at[j->type][j->current][count - 1 + skip - i] =
        current_of(j, &r.plot[i]);
  j->done = r.count > skip ? r.count - skip : 0;
  if (!index) keep_simulator(&r, j->out->simulator);
  eda_spice_clear(&r);
}

/* ---- where a card ends ---- */

/* What is wrong with a current at length i, seen from the next longer one;
   NULL if it will do. */
static const char *fault(const job *j, size_t i) {
  const double *y = j->out->at[j->type][j->current];
  if (i + j->done < j->p->count) return j->error.message;
  if (!isfinite(y[i])) return "it is not a number";
  if (!(y[i] > 0)) return "it does not flow from drain to source";
  if (i + 1 < j->p->count && !(y[i] > y[i + 1]))
    return "it does not rise with decreasing length";
  return NULL;
}

/* The shortest length from which on a current will do. */
static int find_end(const job *j, size_t *first, opc_error *error) {
  enum { LEAST = 3 }; /* what an extractor's interpolation needs */
  const plan *p = j->p;
  const char *why = NULL;
  size_t i = p->count;
  while (i > 0 && !(why = fault(j, i - 1))) i--;
  if (!why) return OPC_OK;
  if (p->count - i < LEAST)
    return opc_fail(error, OPC_FAILED, j->type == EDA_PMOS ? "pmos" : "nmos",
                    "model '%s', %s at %g nm: %s", p->model[j->type],
                    current_names[j->current], p->length[i - 1], why);
  p->host->log(p->host, OPC_LOG_WARNING,
               "model '%s' is good from %g nm on: %s of the %s-transistor at "
               "%g nm: %s",
               p->model[j->type], p->length[i], current_names[j->current],
               type_names[j->type], p->length[i - 1], why);
  if (i > *first) *first = i;
  return OPC_OK;
}

static int check_reference(const job *j, opc_error *error) {
  double value = j->out->reference[j->type][j->current];
  if (!(j->p->reference_length > 0)) return OPC_OK;
  if (isfinite(value) && value > 0) return OPC_OK;
  return opc_fail(error, OPC_FAILED, "reference.length",
                  "model '%s', %s at %g nm: %s", j->p->model[j->type],
                  current_names[j->current], j->p->reference_length,
                  j->code ? j->error.message : "no current");
}

int simulate(const plan *p, currents *out, opc_error *error) {
  job jobs[TYPES * EDA_CURRENTS];
  for (int i = 0; i < TYPES * EDA_CURRENTS; i++)
    jobs[i] = (job){.p = p,
                    .out = out,
                    .type = i / EDA_CURRENTS,
                    .current = i % EDA_CURRENTS};
  opc_parallel(p->host->context, TYPES * EDA_CURRENTS, run_job, jobs);
  out->first = 0;
  for (int i = 0; i < TYPES * EDA_CURRENTS; i++) {
    const job *j = &jobs[i];
    if (j->code && j->code != OPC_FAILED) {
      *error = j->error;
      return j->code;
    }
    int code = check_reference(j, error);
    if (!code) code = find_end(j, &out->first, error);
    if (code) return code;
  }
  return OPC_OK;
}
