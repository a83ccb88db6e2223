/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verb `opcflow echo WORD ...`, which publishes the arguments
   and options, for tests of the framework. */
#include <opcflow/command.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct echo {
  const opc_host *host;
  int64_t max_cases;
  int mode, quiet;
  opc_reals sizes;
  const char *title, *output;
} echo;

static const char *const modes[] = {"first", "second"};

/* ---- work ---- */

static int write_words(const echo *t, size_t n, const char *const *words,
                       opc_error *error) {
  const char *path = t->host->output_path(t->host, t->output, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  if (!file) return opc_fail(error, OPC_IO, "output", "'%s'", path);
  for (size_t i = 0; i < n; i++) fprintf(file, "%s\n", words[i]);
  if (fclose(file))
    return opc_fail(error, OPC_IO, "output", "'%s': not written", path);
  return OPC_OK;
}

static int words_publish(const echo *t, size_t n, const char *const *words,
                         opc_error *error) {
  int64_t *lengths = malloc((n + 1) * sizeof *lengths);
  double sum = 0;
  for (size_t i = 0; i < n; i++) lengths[i] = (int64_t)strlen(words[i]);
  for (size_t i = 0; i < t->sizes.count; i++) sum += t->sizes.values[i];
  const opc_column columns[] = {{"word", NULL, OPC_TEXT, 0, words},
                                {"length", NULL, OPC_INT, 0, lengths}};
  int code =
      opc_put_table(t->host, "words", OPC_TABLE_PRINT, n, columns, 2, error);
  free(lengths);
  return code ? code : t->host->metric(t->host, "sum", sum, error);
}

static int echo_run(void *self, size_t n, const char *const *words,
                    opc_error *error) {
  const echo *t = self;
  if (!t->quiet)
    t->host->log(t->host, OPC_LOG_INFO, "%s%s%zu words, %s, %d cases",
                 t->title ? t->title : "", t->title ? ": " : "", n,
                 modes[t->mode], (int)t->max_cases);
  if (n && !strcmp(words[0], "limit"))
    return opc_fail(error, OPC_LIMIT, "max_cases", "too much");
  if (n && !strcmp(words[0], "crash")) abort();
  if (t->output) return write_words(t, n, words, error);
  return words_publish(t, n, words, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(echo, max_cases, .type = OPC_INT, .flags = OPC_AT_LEAST,
                  .preset = "2", .min = 1, .summary = "largest number"),
    OPC_PARAMETER(echo, mode, .type = OPC_CHOICE, .preset = "second",
                  .choices = "first|second", .summary = "a word"),
    OPC_PARAMETER(echo, quiet, .type = OPC_BOOL, .preset = "false",
                  .summary = "say nothing"),
    OPC_PARAMETER(echo, sizes, .type = OPC_REALS, .unit = "nm",
                  .summary = "lengths"),
    OPC_PARAMETER(echo, title, .type = OPC_TEXT, .summary = "first line"),
    OPC_PARAMETER(echo, output, .type = OPC_OUTPUT,
                  .summary = "file for the words"),
};

static const opc_metric metrics[] = {
    {"sum", "nm", OPC_LOWER, 0, "sum of all sizes"},
};

static int echo_check(void *self, opc_error *error) {
  const echo *t = self;
  if (t->max_cases != 13) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "max_cases", "13 is not welcome");
}

/* ---- entry ---- */

static const opc_command functions = {.arguments = "WORD ...", .run = echo_run};

OPC_PLUGIN(echo, .id = "command.echo", .kind = "command", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "Print the given words",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = echo_check, OPC_FUNCTIONS(functions));
