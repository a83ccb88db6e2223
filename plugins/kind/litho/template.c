/* SPDX-License-Identifier: BSD-3-Clause */
/* @ID@: a litho model with one coherent kernel, whose transfer function is a
   Gaussian: the blurred mask. */
#include <eda/litho.h>
#include <math.h>
#include <opcflow/plugin.h>

typedef struct state {
  const opc_host *host;
  double blur; /* nm, standard deviation of the point spread function */
} state;

static int litho_prepare(void *self, opc_error *error) {
  (void)self, (void)error; /* called once: compute kernels here */
  return OPC_OK;
}

/* Return the band limit, 1/nm: at higher frequencies, the Gaussian is below
   1e-3. */
static double litho_band(const void *self) {
  return 0.6 / ((const state *)self)->blur;
}

static void litho_transfer(const void *self, size_t kernel, const double *fx,
                           double fy, size_t n, float *out) {
  double turns = 2 * acos(-1) * ((const state *)self)->blur;
  (void)kernel; /* there is only one kernel */
  for (size_t i = 0; i < n; i++) {
    out[2 * i] = (float)exp(-pow(turns * hypot(fx[i], fy), 2) / 2);
    out[2 * i + 1] = 0;
  }
}

static int litho_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  const state *s = self;
  eda_kernels kernels = {.count = 1,
                         .weight = &(double){1},
                         .band = litho_band(s),
                         .intensity_band = 2 * litho_band(s),
                         .transfer = litho_transfer,
                         .self = s,
                         .scale = {1, 0}};
  (void)layer; /* all layers have the same exposure */
  return eda_coherent_sum(s->host->context, mask, &kernels, 0, out, error);
}

static const opc_parameter parameters[] = {OPC_PARAMETER(
    state, blur, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
    .preset = "40 nm", .min = 1,
    .summary = "standard deviation of the point spread function")};
static const eda_litho functions = {
    .prepare = litho_prepare, .band = litho_band, .image = litho_image};
OPC_PLUGIN(state, .id = "@ID@", .kind = "litho", .version = "0.1.0",
           .licence = "BSD-3-Clause", .summary = "Gaussian blur of the mask",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
