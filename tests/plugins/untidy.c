/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the extractor test.untidy, which works in a flow and violates the
   contract in ways that `opcflow lint` detects. */
#include <eda/extractor.h>
#include <opcflow/plugin.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct untidy {
  const opc_host *host;
  double size, shift;
} untidy;

static int calls;
static _Thread_local int mine;

/* ---- work ---- */

static int untidy_prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static size_t slicing(const void *self, const double **place,
                      const double **width) {
  static const double middle = 0.5, all = 1;
  (void)self;
  *place = &middle;
  *width = &all;
  return 1;
}

static void call_count(void *data, size_t i) {
  (void)data, (void)i;
  usleep(300);
  mine++;
}

/* The result depends on the number of calls and on the thread. */
static int untidy_extract(const void *self, const eda_slices *in,
                          eda_performance *out, opc_error *error) {
  const untidy *u = self;
  (void)error;
  mine = 0;
  opc_parallel(u->host->context, 40, call_count, NULL);
  for (size_t i = 0; i < in->count; i++) {
    out->ion[i] = out->ioff[i] = 1 + calls * 1e-9 + mine;
    out->leq_ion[i] = out->leq_ioff[i] = in->length[i];
    out->weq[i] = in->width[i];
    out->area[i] = in->width[i] * in->length[i];
  }
  calls++;
  return OPC_OK;
}

OPC_EXPORT int untidy_helper(void);
int untidy_helper(void) { return calls; }

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(untidy, size, .type = OPC_REAL,
                  .flags = OPC_REQUIRED | OPC_AT_LEAST | OPC_AT_MOST,
                  .unit = "nm", .min = 1, .max = 7, .summary = "a length."),
    OPC_PARAMETER(untidy, shift, .type = OPC_REAL, .unit = "nm",
                  .preset = "2 nm", .min = 1, .max = 7,
                  .summary = "a shift with bounds that have no effect"),
};

/* Leaks memory. */
static int untidy_check(void *self, opc_error *error) {
  static void *volatile last;
  const untidy *u = self;
  (void)error;
  last = malloc(1000);
  return u->size == 7 && last; /* without an error message */
}

/* ---- entry ---- */

static const eda_extractor functions = {
    .prepare = untidy_prepare, .slicing = slicing, .extract = untidy_extract};

OPC_PLUGIN(untidy, .id = "test.untidy", .kind = "extractor", .version = "1.0.0",
           .licence = "BSD-3-Clause",
           .summary = "Extractor that violates the contract",
           OPC_PARAMETERS(parameters), .check = untidy_check,
           OPC_FUNCTIONS(functions));
