/* SPDX-License-Identifier: BSD-3-Clause */
/* list.worst: the transistors of a mask that are furthest from their drawn on
   current, as a table. */
#include <math.h>
#include <opcflow/gates.h>
#include <opcflow/step.h>
#include <stdlib.h>

/* ---- state ---- */

enum { MASK, MOST, PARAMETERS };

typedef struct list {
  const opc_host *host;
  const opc_value *values;
} list;

typedef struct entry {
  double deviation;   /* % */
  size_t gate;
} entry;

/* ---- work ---- */

static int compare(const void *a, const void *b) {
  const entry *p = a, *q = b;
  double x = fabs(p->deviation), y = fabs(q->deviation);
  if (x != y) return x > y ? -1 : 1;
  return p->gate < q->gate ? -1 : 1;   /* the same order on each machine */
}

static int publish(const list *s, const opc_gates *g, const entry *e, size_t n,
                   opc_error *error) {
  const opc_host *host = s->host;
  const char **cell = host->alloc(host, n, sizeof *cell);
  int64_t *number = host->alloc(host, n, sizeof *number);
  double *deviation = host->alloc(host, n, sizeof *deviation);
  int code = OPC_FAILED;
  if (cell && number && deviation) {
    for (size_t i = 0; i < n; i++) {
      cell[i] = g->cell[e[i].gate];
      number[i] = g->number[e[i].gate];
      deviation[i] = e[i].deviation;
    }
    const opc_column columns[] = {{"cell", NULL, OPC_TEXT, 0, cell},
                                  {"number", NULL, OPC_INT, 0, number},
                                  {"ion", "%", OPC_REAL, 3, deviation}};
    code = host->table(host, "worst", OPC_TABLE_PRINT, n, columns, 3, error);
  } else {
    host->fail(host, error, code, NULL, "out of memory");
  }
  host->free(host, cell);
  host->free(host, number);
  host->free(host, deviation);
  if (code || !n) return code;
  return host->metric(host, "worst", fabs(e[0].deviation), error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const list *s = self;
  const opc_mask *mask = s->values[MASK].object;
  size_t n = mask->gates->count, most = (size_t)s->values[MOST].integer;
  entry *entries = s->host->alloc(s->host, n, sizeof *entries);
  (void)outputs;
  if (!entries)
    return s->host->fail(s->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < n; i++) {
    double drawn = mask->design.ion[i];
    entries[i].deviation = 100 * (mask->after.ion[i] - drawn) / drawn;
    entries[i].gate = i;
  }
  qsort(entries, n, sizeof *entries, compare);
  int code = publish(s, mask->gates, entries, n < most ? n : most, error);
  s->host->free(s->host, entries);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    {"mask", OPC_INPUT, OPC_REQUIRED, NULL, NULL, 0, 0, "mask",
     "the mask whose transistors are listed"},
    {"most", OPC_INT, OPC_AT_LEAST | OPC_AT_MOST, NULL, "10", 1, 1000000, NULL,
     "how many at most"},
};

static const opc_metric metrics[] = {
    {"worst", "%", OPC_LOWER, 0, 0.01, "largest |Ion deviation|"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  list *s = host->alloc(host, 1, sizeof *s);
  if (!s) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  s->host = host;
  s->values = values;
  return s;
}

static void destroy(void *self) {
  list *s = self;
  s->host->free(s->host, s);
}

/* ---- entry ---- */

static const opc_step operations = {.size = sizeof operations, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "list.worst",
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "the transistors furthest from their drawn current",
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
