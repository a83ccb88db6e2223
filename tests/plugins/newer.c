/* SPDX-License-Identifier: BSD-3-Clause */
/* test.newer: a step built for a later minor, whose structs have all grown at
   their ends. It loads, its arrays are read with their own sizes, and it works:
   nothing that this host knows has moved. It also renames a parameter. */
#include <opcflow/opcflow.h>
#include <string.h>

enum { SIZE, COUNT };

typedef struct newer {
  const opc_host *host;
  const opc_value *values;
} newer;

/* ---- work ---- */

static int run(void *self, void **outputs, opc_error *error) {
  const newer *n = self;
  double *out = n->host->alloc(n->host, 1, sizeof *out);
  *out = n->values[SIZE].real * (double)n->values[COUNT].integer;
  outputs[0] = out;
  return n->host->metric(n->host, "product", *out, error);
}

static opc_host const *last_host;

static void release(void *object) { last_host->free(last_host, object); }

/* ---- parameters: each entry larger than this host's ---- */

typedef struct later_parameter {
  opc_parameter now;
  const char *since;
  double step;
} later_parameter;

static const later_parameter parameters[] = {
    [SIZE] = {{.name = "part.size",
               .type = OPC_REAL,
               .flags = OPC_REQUIRED,
               .unit = "nm",
               .summary = "a length"},
              "1.0",
              0.5},
    [COUNT] = {{.name = "count",
                .type = OPC_INT,
                .preset = "3",
                .summary = "how many"},
               "1.1",
               1},
};

typedef struct later_metric {
  opc_metric now;
  uint64_t more;
} later_metric;

static const later_metric metrics[] = {
    {{.name = "product", .unit = "nm", .summary = "size times count"}, 7}};

typedef struct later_rename {
  opc_rename now;
  uint64_t more;
} later_rename;

static const later_rename old_names[] = {
    {{"length", "part.size", "1.1.0", NULL}, 1},
    {{"old.number", "count", "1.2.0", "it is a whole number now"}, 2},
};

static const opc_renames renames = {.size = sizeof renames,
                                    .count = 2,
                                    .rename_size = sizeof(later_rename),
                                    .renames = &old_names[0].now};

/* ---- entry ---- */

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  (void)error;
  newer *n = host->alloc(host, 1, sizeof *n);
  n->host = last_host = host;
  n->values = values;
  return n;
}

static void destroy(void *self) {
  newer *n = self;
  n->host->free(n->host, n);
}

typedef struct later_port {
  opc_port now;
  uint64_t more;
} later_port;

static const later_port ports[] = {{{"product", "length", release}, 3}};

static const struct {
  opc_step now;
  int (*later)(void *self);
} operations = {{.size = sizeof operations,
                 .n_outputs = 1,
                 .port_size = sizeof(later_port),
                 .outputs = &ports[0].now,
                 .run = run},
                NULL};

static const void *get_extension(const char *id) {
  return strcmp(id, OPC_RENAMED_PARAMETERS) ? NULL : &renames;
}

static const struct {
  opc_plugin now;
  const char *later[8];
} plugin = {{.size = sizeof plugin,
             .abi_major = OPC_ABI_MAJOR,
             .abi_minor = OPC_ABI_MINOR + 7,
             .id = "test.newer",
             .version = "1.2.0",
             .licence = "BSD-3-Clause",
             .summary = "From a later minor",
             .kind = OPC_KIND_STEP,
             .flags = OPC_DETERMINISTIC | OPC_REENTRANT | 1u << 9,
             .n_parameters = 2,
             .parameter_size = sizeof(later_parameter),
             .parameters = &parameters[0].now,
             .n_metrics = 1,
             .metric_size = sizeof(later_metric),
             .metrics = &metrics[0].now,
             .create = create,
             .destroy = destroy,
             .operations = &operations,
             .get_extension = get_extension},
            {"unknown"}};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin.now; }
