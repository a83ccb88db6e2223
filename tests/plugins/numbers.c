/* SPDX-License-Identifier: BSD-3-Clause */
/* test.numbers: a step with a parameter of every type, for the tests of the
   framework. It adds its numbers to that of its input, publishes them, and
   does what `behave` tells it. */
#include <math.h>
#include <opcflow/opcflow.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- state ---- */

enum {
  WHOLE,
  SIZE,
  SHARE,
  PLAIN,
  LIST,
  NAMES,
  NOTE,
  WORD,
  FILE_IN,
  FILE_OUT,
  FLAG,
  LINE,
  PITCH,
  INPUT,
  MODEL,
  BEHAVE
};

/* The output, of the data kind "number". */
typedef struct number {
  double value;
  const opc_host *host;
} number;

typedef struct numbers {
  const opc_host *host;
  const opc_value *values;
} numbers;

/* ---- work ---- */

static void add_one(void *data, size_t i) {
  (void)i;
  __atomic_fetch_add((int *)data, 1, __ATOMIC_RELAXED);
}

static int write_file(const numbers *n, opc_error *error) {
  const char *path =
      n->host->output_path(n->host, n->values[FILE_OUT].text, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  if (!file || fputs("numbers\n", file) < 0 || fclose(file))
    return n->host->fail(n->host, error, OPC_IO, "output", "'%s': not written",
                         path);
  return OPC_OK;
}

static int publish(const numbers *n, double sum, opc_error *error) {
  const char *names[] = {"plain", "with, comma", "with \"quotes\""};
  const double reals[] = {sum, -0.001, NAN};
  const int64_t integers[] = {1, -2, 3};
  const opc_column columns[] = {{"name", NULL, OPC_TEXT, 0, names},
                                {"size", "nm", OPC_REAL, 2, reals},
                                {"count", NULL, OPC_INT, 0, integers}};
  int code =
      n->host->table(n->host, "numbers", OPC_TABLE_PRINT, 3, columns, 3, error);
  if (code) return code;
  return n->host->metric(n->host, "sum", sum, error);
}

static int misbehave(const numbers *n, opc_error *error) {
  switch (n->values[BEHAVE].integer) {
    case 1:
      return n->host->fail(n->host, error, OPC_FAILED, "size",
                           "%g nm is not possible", n->values[SIZE].real);
    case 2:
      return n->host->metric(n->host, "sum", NAN, error);
    case 3:
      return n->host->fail(n->host, error, OPC_LIMIT, NULL, "too much");
    case 4:
      while (!n->host->cancelled(n->host)) usleep(1000);
      return n->host->fail(n->host, error, OPC_CANCELLED, NULL, "stopped");
    case 5:
      return n->host->output_path(n->host, "../out", error) ? OPC_OK
                                                            : error->code;
    default:
      return OPC_OK;
  }
}

static int run(void *self, void **outputs, opc_error *error) {
  numbers *n = self;
  const opc_value *v = n->values;
  number *out = n->host->alloc(n->host, 1, sizeof *out);
  out->host = n->host;
  outputs[0] = out;
  double *sum = &out->value;
  if (v[INPUT].object) *sum = ((const number *)v[INPUT].object)->value;
  *sum += (double)v[WHOLE].integer + v[SIZE].real;
  for (size_t i = 0; i < v[LIST].count; i++) *sum += v[LIST].reals[i];
  int called = 0;
  n->host->parallel(n->host, 100, add_one, &called);
  if (called != 100)
    return n->host->fail(n->host, error, OPC_FAILED, NULL, "%d calls", called);
  int code = v[FILE_OUT].type ? write_file(n, error) : OPC_OK;
  if (!code) code = misbehave(n, error);
  return code ? code : publish(n, *sum, error);
}

static void release(void *object) {
  number *out = object;
  out->host->free(out->host, out);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    {"whole", OPC_INT, OPC_AT_LEAST | OPC_AT_MOST, NULL, "1", 0, 100, NULL,
     "a whole number"},
    {"size", OPC_REAL, OPC_REQUIRED | OPC_ABOVE | OPC_BELOW, "nm", NULL, 0,
     1000, NULL, "a length"},
    {"share", OPC_REAL, OPC_AT_LEAST, "%", "0.5 %", 0, 0, NULL, "a percentage"},
    {"plain", OPC_REAL, 0, NULL, "0.75", 0, 0, NULL, "a plain number"},
    {"list", OPC_REALS, 0, "nm", "[1 nm, 0.002 um]", 0, 0, NULL, "lengths"},
    {"names", OPC_MAP, 0, NULL, NULL, 0, 0, "poly|active", "names of layers"},
    {"note", OPC_TEXT, 0, NULL, "", 0, 0, NULL, "a text"},
    {"word", OPC_CHOICE, 0, NULL, "second", 0, 0, "first|second|third",
     "a word"},
    {"input", OPC_FILE, 0, NULL, NULL, 0, 0, NULL, "a file"},
    {"output", OPC_OUTPUT, 0, NULL, NULL, 0, 0, NULL, "a file to write"},
    {"flag", OPC_BOOL, 0, NULL, "false", 0, 0, NULL, "yes or no"},
    {"anchor.line", OPC_REAL, OPC_AT_LEAST, "nm", "65 nm", 1, 0, NULL,
     "a line"},
    {"anchor.pitch", OPC_REAL, 0, "nm", "250 nm", 0, 0, NULL, "its pitch"},
    {"add", OPC_INPUT, 0, NULL, NULL, 0, 0, "number", "another number"},
    {"model", OPC_SLOT, 0, NULL, NULL, 0, 0, "litho", "a model"},
    {"behave", OPC_CHOICE, OPC_NO_EFFECT, NULL, "well", 0, 0,
     "well|fail|nan|limit|wait|leave", "what to do"},
};

static const opc_metric metrics[] = {
    {"sum", "nm", OPC_LOWER, 0, 0.1, "the sum"},
};

/* ---- entry ---- */

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  if (values[PLAIN].real == 13) {
    host->fail(host, error, OPC_INVALID, "plain", "13 is not welcome");
    return NULL;
  }
  numbers *n = host->alloc(host, 1, sizeof *n);
  n->host = host;
  n->values = values;
  return n;
}

static void destroy(void *self) {
  numbers *n = self;
  n->host->free(n->host, n);
}

static const opc_port outputs[] = {{"sum", "number", release}};

static const opc_step operations = {
    .size = sizeof operations,
    .n_outputs = 1,
    .port_size = sizeof(opc_port),
    .outputs = outputs,
    .run = run,
};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "test.numbers",
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "A parameter of every type",
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
