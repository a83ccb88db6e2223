/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step list.worst: a table of the transistors with the largest
   deviation of the on current. */
#include <eda/gates.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct list {
  const opc_host *host;
  const eda_mask *mask;
  int64_t most;
} list;

/* A row of the table. */
typedef struct entry {
  const char *cell;
  int64_t number;
  double deviation; /* % */
  size_t gate;
} entry;

/* ---- work ---- */

static int entry_compare(const void *a, const void *b) {
  const entry *p = a, *q = b;
  double x = fabs(p->deviation), y = fabs(q->deviation);
  if (x != y) return x > y ? -1 : 1;
  return p->gate < q->gate ? -1 : 1; /* a fixed order of equal deviations, for
                                        reproducible tables */
}

static int worst_publish(const list *s, const entry *e, size_t n,
                         opc_error *error) {
  const opc_column columns[] = {{"cell", NULL, OPC_TEXT, 0, &e->cell},
                                {"number", NULL, OPC_INT, 0, &e->number},
                                {"ion", "%", OPC_REAL, 3, &e->deviation}};
  int code = opc_put_rows(s->host, "worst", OPC_TABLE_PRINT, n, sizeof *e,
                          OPC_ARRAY(columns), error);
  if (code || !n) return code;
  return s->host->metric(s->host, "worst", fabs(e[0].deviation), error);
}

static int worst_run(void *self, void **outputs, opc_error *error) {
  const list *s = self;
  size_t n = s->mask->gates->count, most = (size_t)s->most;
  entry *entries = eda_alloc(n, sizeof *entries);
  (void)outputs;
  for (size_t i = 0; i < n; i++) {
    double drawn = s->mask->design.ion[i];
    entries[i] =
        (entry){.cell = s->mask->gates->cell[i],
                .number = s->mask->gates->number[i],
                .deviation = 100 * (s->mask->after.ion[i] - drawn) / drawn,
                .gate = i};
  }
  qsort(entries, n, sizeof *entries, entry_compare);
  int code = worst_publish(s, entries, n < most ? n : most, error);
  free(entries);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(list, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "mask with the transistors"),
    OPC_PARAMETER(list, most, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10", .min = 1,
                  .max = 1000000, .summary = "largest number of rows"),
};

static const opc_metric metrics[] = {
    {"worst", "%", OPC_LOWER, 0.01, "largest |Ion deviation|"},
};

/* ---- entry ---- */

static const opc_step functions = {.run = worst_run};

OPC_PLUGIN(
    list, .id = "list.worst", .kind = "step", .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "transistors with the largest deviation of the on current",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), OPC_FUNCTIONS(functions));
