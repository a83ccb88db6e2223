/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements netlist.annotate: writes a circuit with the printed sizes of its
   transistors as a SPICE netlist (thesis 3.3.3, equations 3.11 to 3.14). */
#include <eda/file.h>
#include <eda/netlist.h>
#include <glib.h>
#include <opcflow/step.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

typedef struct annotator {
  const opc_host *host;
  const eda_circuit *circuit;
  const eda_mask *mask;
  int state; /* EDA_DRAWN, EDA_BEFORE or EDA_AFTER; -1 if not given */
  const char *n_model, *p_model, *cards, *file;
  int subcircuits;
  double unit; /* nm; NAN if not given */
} annotator;

/* Default model names. */
static const char *const presets[2] = {"nmos", "pmos"};

/* ---- work ---- */

static int write_file(const annotator *s, const char *text, opc_error *error) {
  const char *path = s->host->output_path(s->host, s->file, error);
  if (!path) return error->code;
  FILE *f = fopen(path, "wb");
  if (f) (void)fputs(text, f);
  return eda_file_close(f, path, NULL, error);
}

static int check_mask(eda_annotation *a, opc_error *error) {
  static const char *const states[] = {"drawn", "before", "after"};
  if (a->state == EDA_DRAWN) return OPC_OK;
  if (!a->mask)
    return opc_fail(error, OPC_INVALID, "mask",
                    "a mask is needed for state '%s'", states[a->state]);
  if (eda_mask_flat(a->mask, &a->mask, error)) return error->code;
  if (a->mask->gates != a->circuit->gates)
    return opc_fail(error, OPC_INVALID, "mask",
                    "the mask and the circuit belong to different gates");
  return OPC_OK;
}

static int netlist_annotate(const annotator *s, eda_pool *pool,
                            opc_error *error) {
  const opc_host *host = s->host;
  eda_card cards[2];
  eda_annotation a = {.circuit = s->circuit,
                      .mask = s->mask,
                      .state = s->state >= 0 ? s->state
                               : s->mask     ? EDA_AFTER
                                             : EDA_DRAWN,
                      .subcircuits = s->subcircuits,
                      .unit = s->unit > 0 ? s->unit : 0};
  const char *names[2] = {s->n_model, s->p_model};
  if (check_mask(&a, error)) return error->code;
  for (int type = 0; type < 2; type++)
    a.model[type] = names[type] ? names[type] : s->cards ? presets[type] : NULL;
  for (int type = 0; type < 2 && s->cards; type++) {
    if (eda_card_read(pool, s->cards, a.model[type], type, &cards[type], error))
      return error->code;
    a.card[type] = &cards[type];
  }
  eda_annotated counts;
  char *text = eda_annotate(&a, &counts, error);
  if (!text) return error->code;
  int code = write_file(s, text, error);
  free(text);
  if (!code)
    code = host->metric(host, "transistors", (double)counts.transistors, error);
  if (!code) code = host->metric(host, "models", (double)counts.models, error);
  return code;
}

static int annotate_run(void *self, void **outputs, opc_error *error) {
  eda_pool pool = {0};
  (void)outputs;
  int code = netlist_annotate(self, &pool, error);
  eda_pool_clear(&pool);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(annotator, circuit, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "circuit",
                  .summary = "netlist matched with gates"),
    OPC_PARAMETER(annotator, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "corrected mask with printed image"),
    OPC_PARAMETER(annotator, state, .type = OPC_CHOICE,
                  .choices = "drawn|before|after",
                  .summary = "state whose sizes are written; default: after "
                             "with a mask, else drawn"),
    OPC_PARAMETER_NAMED("nmos", annotator, n_model, .type = OPC_TEXT,
                        .summary = "name of the n model; default: the models "
                                   "in the netlist, or nmos with `models`"),
    OPC_PARAMETER_NAMED("pmos", annotator, p_model, .type = OPC_TEXT,
                        .summary = "name of the p model; default: the models "
                                   "in the netlist, or pmos with `models`"),
    OPC_PARAMETER_NAMED(
        "models", annotator, cards, .type = OPC_FILE,
        .summary = "file with both model cards; required to correct DLC"),
    OPC_PARAMETER(annotator, subcircuits, .type = OPC_BOOL, .preset = "false",
                  .summary = "models as subcircuits: X instead of M at the "
                             "beginning of each transistor"),
    OPC_PARAMETER(
        annotator, unit, .type = OPC_REAL, .unit = "nm",
        .flags = OPC_ABOVE | OPC_AT_MOST, .min = 0, .max = 1e9,
        .summary =
            "unit of the written sizes; default: sizes are in m, as in 65e-9"),
    OPC_PARAMETER(annotator, file, .type = OPC_OUTPUT, .preset = "netlist.sp",
                  .summary = "netlist file to write"),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0,
     "number of written transistors; each finger counts"},
    {"models", NULL, OPC_NEUTRAL, 0,
     "number of written model cards, one for each DLC"},
};

/* Names are written as given, so characters that end a word of a netlist are
   refused. */
static int annotate_check(void *self, opc_error *error) {
  const annotator *s = self;
  const char *names[2] = {s->n_model, s->p_model};
  for (int type = 0; type < 2; type++) {
    const char *at = names[type];
    while (at && g_ascii_isgraph(*at) && !strchr("=(),;'\"", *at)) at++;
    if (at && (*at || at == names[type]))
      return opc_fail(error, OPC_INVALID, type ? "pmos" : "nmos",
                      "'%s' is not a model name", names[type]);
  }
  return OPC_OK;
}

/* ---- entry ---- */

/* Results of the step are not reused, because `models` may include other
   files. */
static const opc_step functions = {.run = annotate_run,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(
    annotator, .id = "netlist.annotate", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "write a netlist with the printed sizes of the transistors",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = annotate_check, OPC_FUNCTIONS(functions));
