/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step test.numbers, with a parameter of each type, for tests of
   the framework. The step adds the numbers to the number of the input,
   publishes the results, and has the fault selected by `behave`. */
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- state ---- */

enum {
  WELL,
  FAIL,
  NOT_A_NUMBER,
  LIMIT,
  WAIT,
  LEAVE,
  FIND,
  MANY,
  QUIET,
  TELL
}; /* values of `behave` */

typedef struct numbers {
  const opc_host *host;
  int64_t whole;
  double size, share, plain, line, pitch;
  opc_reals list;
  opc_map names;
  const char *note, *input, *output;
  int word, flag, behave;
  const double *add;
  const opc_module *model;
} numbers;

/* ---- work ---- */

static void add_one(void *data, size_t i) {
  (void)i;
  __atomic_fetch_add((int *)data, 1, __ATOMIC_RELAXED);
}

static int write_file(const numbers *n, opc_error *error) {
  const char *path = n->host->output_path(n->host, n->output, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  if (!file || fputs("numbers\n", file) < 0 || fclose(file))
    return opc_fail(error, OPC_IO, "output", "'%s': not written", path);
  return OPC_OK;
}

static int numbers_publish(const numbers *n, double sum, opc_error *error) {
  const char *names[] = {"plain", "with, comma", "with \"quotes\""};
  const double reals[] = {sum, -0.001, NAN};
  const int64_t integers[] = {1, -2, 3};
  const opc_column columns[] = {{"name", NULL, OPC_TEXT, 0, names},
                                {"size", "nm", OPC_REAL, 2, reals},
                                {"count", NULL, OPC_INT, 0, integers}};
  int code =
      opc_put_table(n->host, "numbers", OPC_TABLE_PRINT, 3, columns, 3, error);
  if (code) return code;
  return n->host->metric(n->host, "sum", sum, error);
}

static void find_one(void *data, size_t i) {
  const opc_host *host = ((const numbers *)data)->host;
  host->log(host, OPC_LOG_FINDING, "odd: %zu", i);
}

/* The second report follows the first so soon that the command does not print
   it. */
static void numbers_report(const numbers *n) {
  const opc_progress all[] = {
      {1, 1201, 0.5, "nm"}, {2, 1201, 0.5, "nm"}, {3, NAN, 0.25, NULL}};
  for (int i = 0; i < 3; i++) {
    if (i != 1) usleep(200000);
    n->host->progress(n->host, &all[i]);
  }
}

static int numbers_fault(const numbers *n, opc_error *error) {
  switch (n->behave) {
    case FAIL:
      return opc_fail(error, OPC_FAILED, "size", "%g nm is not possible",
                      n->size);
    case NOT_A_NUMBER:
      return n->host->metric(n->host, "sum", NAN, error);
    case LIMIT:
      return opc_fail(error, OPC_LIMIT, NULL, "too much");
    case WAIT:
      while (!opc_cancelled(n->host->context)) usleep(1000);
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    case LEAVE:
      return n->host->output_path(n->host, "../out", error) ? OPC_OK
                                                            : error->code;
    case FIND:
      for (int i = 0; i < 3; i++)
        n->host->log(n->host, OPC_LOG_FINDING, "%g nm is odd", n->size);
      return OPC_OK;
    case MANY:
      opc_parallel(n->host->context, 250, find_one, (void *)n);
      return OPC_OK;
    case TELL:
      numbers_report(n);
      return OPC_OK;
    default:
      return OPC_OK;
  }
}

static int numbers_run(void *self, void **outputs, opc_error *error) {
  const numbers *n = self;
  double *sum = malloc(sizeof *sum);
  outputs[0] = sum;
  *sum = (n->add ? *n->add : 0) + (double)n->whole + n->size;
  for (size_t i = 0; i < n->list.count; i++) *sum += n->list.values[i];
  n->host->log(n->host, OPC_LOG_DEBUG, "%zu numbers", n->list.count);
  int called = 0;
  opc_parallel(n->host->context, 100, add_one, &called);
  if (called != 100)
    return opc_fail(error, OPC_FAILED, NULL, "%d calls", called);
  int code = n->output ? write_file(n, error) : OPC_OK;
  if (!code) code = numbers_fault(n, error);
  return code || n->behave == QUIET ? code : numbers_publish(n, *sum, error);
}

static int check_number(const void *object, opc_error *error) {
  if (isfinite(*(const double *)object)) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL, "is no number");
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(numbers, whole, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1",
                  .max = 100, .summary = "a whole number"),
    OPC_PARAMETER(numbers, size, .type = OPC_REAL,
                  .flags = OPC_REQUIRED | OPC_ABOVE | OPC_BELOW, .unit = "nm",
                  .max = 1000, .summary = "a length"),
    OPC_PARAMETER(numbers, share, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "%", .preset = "0.5 %", .summary = "a percentage"),
    OPC_PARAMETER(numbers, plain, .type = OPC_REAL, .preset = "0.75",
                  .summary = "a plain number"),
    OPC_PARAMETER(numbers, list, .type = OPC_REALS, .unit = "nm",
                  .preset = "[1 nm, 0.002 um]", .summary = "lengths"),
    OPC_PARAMETER(numbers, names, .type = OPC_MAP, .choices = "poly|active",
                  .summary = "names of layers"),
    OPC_PARAMETER(numbers, note, .type = OPC_TEXT, .preset = "",
                  .summary = "a text"),
    OPC_PARAMETER(numbers, word, .type = OPC_CHOICE, .preset = "second",
                  .choices = "first|second|third", .summary = "a word"),
    OPC_PARAMETER(numbers, input, .type = OPC_FILE, .summary = "a file"),
    OPC_PARAMETER(numbers, output, .type = OPC_OUTPUT,
                  .summary = "a file to write"),
    OPC_PARAMETER(numbers, flag, .type = OPC_BOOL, .preset = "false",
                  .summary = "yes or no"),
    OPC_PARAMETER_NAMED("anchor.line", numbers, line, .type = OPC_REAL,
                        .flags = OPC_AT_LEAST, .unit = "nm", .preset = "65 nm",
                        .min = 1, .summary = "a line"),
    OPC_PARAMETER_NAMED("anchor.pitch", numbers, pitch, .type = OPC_REAL,
                        .unit = "nm", .preset = "250 nm",
                        .summary = "its pitch"),
    OPC_PARAMETER(numbers, add, .type = OPC_INPUT, .choices = "number",
                  .summary = "another number"),
    OPC_PARAMETER(numbers, model, .type = OPC_SLOT, .choices = "litho",
                  .summary = "a model"),
    OPC_PARAMETER(numbers, behave, .type = OPC_CHOICE, .flags = OPC_NO_EFFECT,
                  .preset = "well",
                  .choices = "well|fail|nan|limit|wait|leave|"
                             "find|many|quiet|echo",
                  .summary = "behaviour of the step"),
};

static const opc_metric metrics[] = {
    {"sum", "nm", OPC_LOWER, 0.1, "the sum"},
};

static int numbers_check(void *self, opc_error *error) {
  const numbers *n = self;
  if (n->plain != 13) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "plain", "13 is not welcome");
}

/* ---- entry ---- */

static const opc_port outputs[] = {{"sum", "number", check_number, free}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = numbers_run};

OPC_PLUGIN(numbers, .id = "test.numbers", .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "A parameter of every type",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = numbers_check, OPC_FUNCTIONS(functions));
