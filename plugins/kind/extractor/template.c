/* SPDX-License-Identifier: BSD-3-Clause */
/* @ID@: the performance of a printed gate by a power law: a slice of width w
   and length l carries a current proportional to w / l^alpha. */
#include <eda/extractor.h>
#include <math.h>
#include <opcflow/plugin.h>

typedef struct state {
  const opc_host *host;
  double alpha;
} state;

static int extractor_prepare(void *self, opc_error *error) {
  (void)self, (void)error; /* called once: read device tables here */
  return OPC_OK;
}

/* Return four slices of equal width. */
static size_t extractor_slicing(const void *self, const double **place,
                                const double **width) {
  static const double middle[] = {0.125, 0.375, 0.625, 0.875};
  static const double quarter[] = {0.25, 0.25, 0.25, 0.25};
  (void)self;
  *place = middle;
  *width = quarter;
  return 4;
}

/* Compute currents and equivalent lengths. A slice of 65 nm length carries 1
   uA/nm and leaks 0.1 nA/nm; the leakage decreases by a factor of e for each
   additional 8 nm. leq_ion and leq_ioff are the lengths of rectangular gates
   with the same currents. */
static int extractor_extract(const void *self, const eda_slices *in,
                             eda_performance *out, opc_error *error) {
  double alpha = ((const state *)self)->alpha;
  (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double on = 0, off = 0, width = 0, area = 0;
    for (size_t k = i * in->slices; k < (i + 1) * in->slices; k++) {
      double length = fmax(in->length[k], 1);
      on += in->width[k] * 1e-6 * pow(65 / length, alpha);
      off += in->width[k] * 1e-10 * exp((65 - length) / 8);
      width += in->width[k];
      area += in->width[k] * in->length[k];
    }
    out->ion[i] = on;
    out->ioff[i] = off;
    out->weq[i] = width;
    out->area[i] = area;
    out->leq_ion[i] = on > 0 ? 65 / pow(on / width / 1e-6, 1 / alpha) : 0;
    out->leq_ioff[i] = off > 0 ? 65 - 8 * log(off / width / 1e-10) : 0;
  }
  return OPC_OK;
}

static const opc_parameter parameters[] = {OPC_PARAMETER(
    state, alpha, .type = OPC_REAL, .flags = OPC_ABOVE | OPC_AT_MOST,
    .preset = "1", .max = 4,
    .summary = "exponent of the length: Ion is proportional to 1 / L^alpha")};
static const eda_extractor functions = {.prepare = extractor_prepare,
                                        .slicing = extractor_slicing,
                                        .extract = extractor_extract};
OPC_PLUGIN(state, .id = "@ID@", .kind = "extractor", .version = "0.1.0",
           .licence = "BSD-3-Clause", .summary = "currents by a power law",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
