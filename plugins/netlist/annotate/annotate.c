/* SPDX-License-Identifier: BSD-3-Clause */
/* netlist.annotate: a circuit with the sizes that its transistors print with,
   as a SPICE netlist (thesis 3.3.3, equations 3.11 to 3.14). */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "../annotate_text.h"

/* ---- state ---- */

typedef struct annotator {
  const opc_host *host;
  const opc_value *values;
} annotator;

enum { CIRCUIT, MASK, STATE, N_MODEL, P_MODEL, CARDS, OUTPUT, PARAMETERS };

/* ---- work ---- */

static int write_file(const annotator *s, const char *text, opc_error *error) {
  const char *path =
      s->host->output_path(s->host, s->values[OUTPUT].text, error);
  if (!path) return error->code;
  FILE *f = fopen(path, "wb");
  size_t n = strlen(text);
  int good = f && fwrite(text, 1, n, f) == n;
  int why = errno;
  if (f && fclose(f)) {
    good = 0;
    why = errno;
  }
  if (good) return OPC_OK;
  return s->host->fail(s->host, error, OPC_IO, NULL, "'%.300s': %s", path,
                       strerror(why));
}

static int check(const annotator *s, const netlist_annotation *a,
                 opc_error *error) {
  if (a->state == NETLIST_DRAWN) return OPC_OK;
  if (!a->mask)
    return s->host->fail(s->host, error, OPC_INVALID, "mask",
                         "a mask is needed for state '%s'",
                         s->values[STATE].text);
  if (a->mask->gates != a->circuit->gates)
    return s->host->fail(s->host, error, OPC_INVALID, "mask",
                         "the mask is of other gates than the circuit");
  return OPC_OK;
}

static int annotate(const annotator *s, pool *p, opc_error *error) {
  const opc_value *v = s->values;
  const opc_host *host = s->host;
  netlist_model cards[2];
  netlist_annotation a = {
      .circuit = v[CIRCUIT].object,
      .mask = v[MASK].type == OPC_ABSENT ? NULL : v[MASK].object,
      .model = {[OPC_NMOS] = v[N_MODEL].text, [OPC_PMOS] = v[P_MODEL].text}};
  a.state = v[STATE].type != OPC_ABSENT ? (int)v[STATE].integer
            : a.mask                    ? NETLIST_AFTER
                                        : NETLIST_DRAWN;
  if (check(s, &a, error)) return error->code;
  if (v[CARDS].type != OPC_ABSENT)
    for (int type = 0; type < 2; type++) {
      if (netlist_model_read(host, p, v[CARDS].text, a.model[type], type,
                             &cards[type], error))
        return error->code;
      a.card[type] = &cards[type];
    }
  netlist_counts counts;
  char *text = netlist_annotate(host, &a, &counts, error);
  if (!text) return error->code;
  int code = write_file(s, text, error);
  host->free(host, text);
  if (!code)
    code = host->metric(host, "transistors", (double)counts.transistors, error);
  if (!code) code = host->metric(host, "models", (double)counts.models, error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  pool p = {0};
  (void)outputs;
  int code = annotate(self, &p, error);
  pool_clear(&p);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [CIRCUIT] = {.name = "circuit",
                 .type = OPC_INPUT,
                 .flags = OPC_REQUIRED,
                 .choices = "circuit",
                 .summary = "the netlist and its gates"},
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .choices = "mask",
              .summary = "the corrected mask, with what it prints"},
    [STATE] = {.name = "state",
               .type = OPC_CHOICE,
               .choices = "drawn|before|after",
               .summary = "whose sizes to write; if not given, after where "
                          "there is a mask, else drawn"},
    [N_MODEL] = {.name = "nmos",
                 .type = OPC_TEXT,
                 .preset = "nmos",
                 .summary = "the name of the n model"},
    [P_MODEL] = {.name = "pmos",
                 .type = OPC_TEXT,
                 .preset = "pmos",
                 .summary = "the name of the p model"},
    [CARDS] = {.name = "models",
               .type = OPC_FILE,
               .summary = "the file with both model cards; DLC is corrected "
                          "only where it is given"},
    [OUTPUT] = {.name = "file",
                .type = OPC_OUTPUT,
                .preset = "netlist.sp",
                .summary = "the netlist to write"},
};

static const opc_metric metrics[] = {
    {.name = "transistors", .summary = "transistors written, finger by finger"},
    {.name = "models",
     .summary = "model cards written, one for each DLC of its own"},
};

/* ---- entry ---- */

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  annotator *s = host->alloc(host, 1, sizeof *s);
  if (!s) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  s->host = host;
  s->values = values;
  return s;
}

static void destroy(void *self) {
  annotator *s = self;
  s->host->free(s->host, s);
}

static const opc_step operations = {.size = sizeof operations, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "netlist.annotate",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "write a netlist with the sizes that transistors print with",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
