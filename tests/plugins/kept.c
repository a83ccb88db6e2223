/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step test.kept, whose outputs can be saved: a number plus the
   number of the input, and twice that sum. The log reports whether the step
   ran or was restored; `wait` delays the run. The step makes the file `hold`
   and waits until a test removes the file. */
#include <fcntl.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- state ---- */

typedef struct kept {
  const opc_host *host;
  double number;
  int number_given;
  int64_t wait; /* ms */
  const double *add;
  const char *file, *hold;
} kept;

/* ---- work ---- */

static int kept_run(void *self, void **outputs, opc_error *error) {
  const kept *k = self;
  double *sum = outputs[0] = malloc(sizeof *sum);
  double *twice = outputs[1] = malloc(sizeof *twice);
  *sum = k->number / 3 + (k->add ? *k->add : 0);
  *twice = 2 * *sum;
  (void)usleep((useconds_t)k->wait * 1000);
  int held = k->hold ? open(k->hold, O_WRONLY | O_CREAT, 0666) : -1;
  if (held >= 0) (void)close(held);
  while (held >= 0 && !access(k->hold, F_OK)) (void)usleep(1000);
  k->host->log(k->host, OPC_LOG_INFO, "ran");
  const opc_column columns[] = {{"sum", NULL, OPC_REAL, -1, sum}};
  int code = opc_put_table(k->host, "kept", 0, 1, columns, 1, error);
  if (!code) code = k->host->metric(k->host, "sum", *sum, error);
  if (code || !k->file) return code;
  const char *path = k->host->output_path(k->host, k->file, error);
  FILE *out = path ? fopen(path, "w") : NULL;
  if (!out) return opc_fail(error, OPC_IO, NULL, "not written");
  (void)fprintf(out, "%a\n", *sum);
  return fclose(out) ? opc_fail(error, OPC_IO, NULL, "not written") : OPC_OK;
}

static int number_file(const char *folder, const char *mode, double *number) {
  char path[4096];
  (void)snprintf(path, sizeof path, "%s/number", folder);
  FILE *file = fopen(path, mode);
  if (!file) return 0;
  size_t n = *mode == 'w' ? fwrite(number, sizeof *number, 1, file)
                          : fread(number, sizeof *number, 1, file);
  return !fclose(file) && n == 1;
}

static int kept_save(void *self, void *const *outputs, const char *folder,
                     opc_error *error) {
  (void)self;
  return number_file(folder, "wb", outputs[0])
             ? OPC_OK
             : opc_fail(error, OPC_IO, NULL, "not saved");
}

static int kept_restore(void *self, const char *folder, void **outputs,
                        opc_error *error) {
  const kept *k = self;
  outputs[0] = malloc(sizeof(double));
  if (!number_file(folder, "rb", outputs[0]))
    return opc_fail(error, OPC_IO, NULL, "not restored");
  double *twice = outputs[1] = malloc(sizeof *twice);
  *twice = 2 * *(double *)outputs[0];
  k->host->log(k->host, OPC_LOG_INFO, "restored");
  return OPC_OK;
}

static int check_number(const void *object, opc_error *error) {
  (void)object;
  (void)error;
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(kept, number, .type = OPC_REAL, .preset = "1",
                  .summary = "a number", .given = offsetof(kept, number_given)),
    OPC_PARAMETER(kept, wait, .type = OPC_INT, .flags = OPC_NO_EFFECT,
                  .preset = "0", .summary = "ms"),
    OPC_PARAMETER(kept, hold, .type = OPC_TEXT, .flags = OPC_NO_EFFECT,
                  .summary = "a file that a test removes"),
    OPC_PARAMETER(kept, add, .type = OPC_INPUT, .choices = "number",
                  .summary = "another number"),
    OPC_PARAMETER(kept, file, .type = OPC_OUTPUT, .summary = "a file"),
};

static const opc_metric metrics[] = {
    {"sum", NULL, OPC_LOWER, 0, "the sum"},
};

/* ---- entry ---- */

static const opc_port outputs[] = {{"sum", "number", check_number, free},
                                   {"twice", "number", check_number, free}};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = kept_run,
                                   .save = kept_save, .restore = kept_restore};

OPC_PLUGIN(kept, .id = TEST_ID, .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause",
           .summary = "Step whose output can be stored", .flags = TEST_FLAGS,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
