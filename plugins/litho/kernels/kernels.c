/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements litho.kernels: imaging by given kernels, for example of the ICCAD
   2013 contest (S. Banerjee, Z. Li, S. R. Nassif, ICCAD 2013, 271). The
   intensity is the sum of weight |mask * kernel|^2. The values of a kernel at
   the multiples of 1 / period define the kernel as a function within a square
   of one period around the origin. Values at other frequencies are the Fourier
   transform of that function. */
#include <eda/litho.h>
#include <math.h>
#include <opcflow/plugin.h>

#include "files.h"

/* ---- state ---- */

enum { FOCUS, DEFOCUS, SETS };

typedef struct model {
  const opc_host *host;
  const char *path[SETS]; /* files of the kernels in focus and out of focus; the
                             second may be NULL */
  int64_t wanted;      /* number of kernels of each set; OPC_NO_INT for all */
  double period, dose; /* period, nm; factor on the intensity */
  int dark_field;
  kernel_set set[SETS];
} model;

static const double coarsest = 32; /* largest grid spacing of an image, nm */

/* ---- work: between the frequencies ---- */

/* Weights of the values with index first .. last for interpolation at a
   frequency. */
typedef struct reach {
  int first, last;
  double weight[KERNEL_MOST];
} reach;

/* Compute the weights sin(pi (place - k)) / (pi (place - k)), k = -half ..
   half. These weights interpolate, at the frequency `place` in units of 1 /
   period, the Fourier transform of a function that is zero outside of one
   period. */
static void reach_spread(double place, int half, reach *r) {
  static const double same = 1e-6;
  double nearest = round(place);
  r->first = 0;
  r->last = 2 * half;
  if (fabs(place - nearest) < same) {
    if (fabs(nearest) > half) {
      r->last = -1;
      return;
    }
    r->first = r->last = (int)nearest + half;
    r->weight[r->first] = 1;
    return;
  }
  double wave = sin(M_PI * place) / M_PI;
  for (int k = -half; k <= half; k++)
    r->weight[k + half] = (k % 2 ? -wave : wave) / (place - k);
}

/* A kernel set and its period, nm: `self` of view_transfer. */
typedef struct view {
  const kernel_set *set;
  double period;
} view;

static void view_transfer(const void *self, size_t s, const double *fx,
                          double fy, size_t n, float *out) {
  const view *v = self;
  const kernel_set *set = v->set;
  int size = set->size;
  const float *data = set->data + 2 * s * (size_t)size * (size_t)size;
  double row[2 * KERNEL_MOST] = {0};
  reach r = {.last = -1};
  reach_spread(fy * v->period, set->half, &r);
  for (int l = r.first; l <= r.last; l++)
    for (int i = 0; i < 2 * size; i++)
      row[i] += r.weight[l] * (double)data[2 * l * size + i];
  for (size_t i = 0; i < n; i++) {
    double re = 0, im = 0;
    reach_spread(fx[i] * v->period, set->half, &r);
    for (int k = r.first; k <= r.last; k++) {
      re += r.weight[k] * row[2 * k];
      im += r.weight[k] * row[2 * k + 1];
    }
    out[2 * i] = (float)re;
    out[2 * i + 1] = (float)im;
  }
}

/* ---- work: images ---- */

static int model_prepare(void *self, opc_error *error) {
  model *m = self;
  for (int i = 0; i < SETS; i++) {
    kernel_set_clear(&m->set[i]);
    if (!m->path[i]) continue;
    kernel_set *set = &m->set[i];
    size_t most = m->wanted > 0 ? (size_t)m->wanted : 0;
    int code = kernel_set_read(m->path[i], most, set, error);
    if (code) return code;
    /* Scale the weights by the dose; compute the clear field for the log. */
    double clear = 0;
    size_t size = (size_t)set->size, middle = size * size / 2;
    for (size_t s = 0; s < set->count; s++) {
      const float *h = set->data + 2 * (s * size * size + middle);
      set->weight[s] *= m->dose;
      clear += set->weight[s] * (double)(h[0] * h[0] + h[1] * h[1]);
    }
    m->host->log(m->host, OPC_LOG_INFO,
                 "litho.kernels: %zu kernels %s, clear field %.4f", set->count,
                 i == FOCUS ? "in focus" : "out of focus", clear);
  }
  return OPC_OK;
}

static double set_band(const model *m, const kernel_set *set) {
  /* Include the zeros that surround the nonzero values. */
  return (set->radius + 1) / m->period;
}

static double model_band(const void *self) {
  const model *m = self;
  return fmax(set_band(m, &m->set[FOCUS]), set_band(m, &m->set[DEFOCUS]));
}

static eda_kernels kernels_of(const model *m, const view *v) {
  double sign = m->dark_field ? -1 : 1;
  return (eda_kernels){.count = v->set->count,
                       .weight = v->set->weight,
                       .band = set_band(m, v->set),
                       .intensity_band = 2 * set_band(m, v->set),
                       .transfer = view_transfer,
                       .self = v,
                       .offset = {m->dark_field, 0},
                       .scale = {sign, 0}};
}

static int image_of(const model *m, const kernel_set *set,
                    const eda_spectrum *mask, eda_field *out,
                    opc_error *error) {
  view v = {set, m->period};
  eda_kernels kernels = kernels_of(m, &v);
  /* Four samples for the shortest period of the intensity. */
  double step = fmin(coarsest, 0.25 / kernels.intensity_band);
  return eda_coherent_sum(m->host->context, mask, &kernels, step, out, error);
}

static int model_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  const model *m = self;
  (void)layer; /* all layers have the same tone */
  return image_of(m, &m->set[FOCUS], mask, out, error);
}

/* Return the kernel set for a defocus. If the parameter 'defocus' is required
   but not set, return NULL and set *error. */
static const kernel_set *set_at(const model *m, double defocus,
                                opc_error *error) {
  if (defocus == 0) return &m->set[FOCUS];
  if (m->path[DEFOCUS]) return &m->set[DEFOCUS];
  opc_fail(error, OPC_INVALID, "defocus",
           "an image out of focus needs the kernels of 'defocus'");
  return NULL;
}

static int model_image_at(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, eda_field *out, opc_error *error) {
  const model *m = self;
  const kernel_set *set = set_at(m, defocus, error);
  (void)layer;
  return set ? image_of(m, set, mask, out, error) : error->code;
}

static int model_gradient(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, const eda_field *weight,
                          eda_field *out, opc_error *error) {
  const model *m = self;
  view v = {set_at(m, defocus, error), m->period};
  (void)layer;
  if (!v.set) return error->code;
  eda_kernels kernels = kernels_of(m, &v);
  return eda_coherent_gradient(m->host->context, mask, &kernels, weight, out,
                               error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("focus", model, path[FOCUS], .type = OPC_FILE,
                        .flags = OPC_REQUIRED | OPC_BESIDE,
                        .summary = "text file of the weights of the kernels in "
                                   "focus, in the folder of fh0.bin ..."),
    OPC_PARAMETER_NAMED(
        "defocus", model, path[DEFOCUS], .type = OPC_FILE, .flags = OPC_BESIDE,
        .summary =
            "text file of the weights of the kernels at any other focus"),
    OPC_PARAMETER(
        model, period, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm",
        .preset = "2048 nm",
        .summary = "reciprocal of the frequency spacing of the kernels"),
    OPC_PARAMETER_NAMED(
        "kernels", model, wanted, .type = OPC_INT, .flags = OPC_AT_LEAST,
        .min = 1,
        .summary =
            "number of kernels to use, from the first one on; default: all"),
    OPC_PARAMETER(model, dose, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .preset = "1", .summary = "factor on the intensity"),
    OPC_PARAMETER_NAMED("tone", model, dark_field, .type = OPC_CHOICE,
                        .preset = "dark", .choices = "clear|dark",
                        .summary = "field of the mask: clear with dark "
                                   "features, or dark with clear features"),
};

static void model_clear(void *self) {
  model *m = self;
  for (int i = 0; i < SETS; i++) kernel_set_clear(&m->set[i]);
}

/* ---- entry ---- */

static const eda_litho functions = {.prepare = model_prepare,
                                    .band = model_band,
                                    .image = model_image,
                                    .image_at = model_image_at,
                                    .gradient = model_gradient};
OPC_PLUGIN(
    model, .id = "litho.kernels", .kind = "litho", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary =
        "imaging by kernels from files in the format of the ICCAD 2013 contest",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    .clear = model_clear, OPC_FUNCTIONS(functions));
