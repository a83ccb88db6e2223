/* SPDX-License-Identifier: BSD-3-Clause */
/* test.untidy: an extractor that works and breaks the contract where no flow
   would notice; `opcflow lint` does. */
#include <opcflow/opcflow.h>
#include <stdlib.h>
#include <unistd.h>

static const opc_host *host;
static int calls;
static _Thread_local int mine;

/* ---- work ---- */

static int prepare(void *self, opc_error *error) {
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

static void count(void *data, size_t i) {
  (void)data, (void)i;
  usleep(300);
  mine++;
}

/* Depends on how often it was called, and on who does the work. */
static int extract(const void *self, const opc_slices *in, opc_performance *out,
                   opc_error *error) {
  (void)self, (void)error;
  mine = 0;
  host->parallel(host, 40, count, NULL);
  for (size_t i = 0; i < in->count; i++) {
    out->ion[i] = out->ioff[i] = 1 + calls * 1e-9 + mine;
    out->leq_ion[i] = out->leq_ioff[i] = in->length[i];
    out->weq[i] = in->width[i];
    out->area[i] = in->width[i] * in->length[i];
  }
  calls++;
  return OPC_OK;
}

/* ---- entry ---- */

static void *create(const opc_host *h, const opc_value *values,
                    opc_error *error) {
  (void)error;
  host = h;
  if (values[0].real == 7) return NULL; /* and does not say why */
  return calloc(1, 1000);
}

static void destroy(void *self) { (void)self; }

OPC_EXPORT int untidy_helper(void);
int untidy_helper(void) { return calls; }

static const void *get_extension(const char *id) {
  static const opc_renames none = {.size = sizeof none};
  return *id ? &none : NULL;
}

static const opc_parameter parameters[] = {
    {"size", OPC_REAL, OPC_REQUIRED | OPC_AT_LEAST | OPC_AT_MOST, "nm", NULL, 1,
     7, NULL, "a length."},
};

static const opc_extract operations = {.size = sizeof operations,
                                       .prepare = prepare,
                                       .slicing = slicing,
                                       .extract = extract};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "test.untidy",
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "Breaks the contract",
    .kind = OPC_KIND_EXTRACT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
    .get_extension = get_extension,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
