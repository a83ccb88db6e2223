/* SPDX-License-Identifier: BSD-3-Clause */
/* Images as sums of coherent systems: a transform back for each system, its
   square added up on a grid fine enough that nothing folds into the band of
   the intensity, and one transform forth and back to the coefficients of a
   B-spline. */
#include "core/imaging/fft.h"
#include "core/imaging/imaging.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Systems are added up in this many sums, each in order, and the sums in
   order: the result does not know how many threads there were. */
enum { SUMS = 4 };

static const double default_step = 32;   /* nm */

typedef struct job {
  const opc_host *host;
  const opc_spectrum *mask;
  const opc_systems *systems;
  int nx, ny;              /* the grid of the fields */
  float *sum[SUMS];        /* ny * nx each */
  int failed;              /* atomic */
} job;

/* The mask's coefficient a[k, l], from the half that is stored. */
static inline float complex coefficient(const opc_spectrum *m, int k, int l) {
  const float complex *a = (const float complex *)m->data;
  if (k >= 0) return a[(size_t)(l < 0 ? l + m->rows : l) * m->columns + k];
  l = -l;
  return conjf(a[(size_t)(l < 0 ? l + m->rows : l) * m->columns - k]);
}

/* The spectrum of the field of system s, in the order of the transform. */
static void fill(const job *j, size_t s, float complex *field, double *fx,
                 float complex *transfer) {
  const opc_spectrum *m = j->mask;
  double band = fmin(j->systems->band, m->band);
  int half = (int)floor(m->frame.height * band);
  memset(field, 0, sizeof *field * (size_t)j->nx * j->ny);
  for (int l = -half; l <= half; l++) {
    double fy = l / m->frame.height;
    int reach = (int)floor(m->frame.width * sqrt(fmax(0, band * band - fy * fy)));
    int n = 2 * reach + 1;
    for (int i = 0; i < n; i++) fx[i] = (i - reach) / m->frame.width;
    j->systems->transfer(j->systems->self, s, fx, fy, (size_t)n,
                         (float *)transfer);
    float complex *row = field + (size_t)(l < 0 ? l + j->ny : l) * j->nx;
    for (int i = 0; i < n; i++) {
      int k = i - reach;
      row[k < 0 ? k + j->nx : k] = transfer[i] * coefficient(m, k, l);
    }
  }
}

static void add_square(const float complex *field, float weight, size_t n,
                       float *sum) {
  const float *f = (const float *)field;
  for (size_t i = 0; i < n; i++)
    sum[i] += weight * (f[2 * i] * f[2 * i] + f[2 * i + 1] * f[2 * i + 1]);
}

static void work(void *data, size_t g) {
  job *j = data;
  size_t n = (size_t)j->nx * j->ny;
  float complex *field = opc_fft_alloc(n * sizeof *field);
  double *fx = malloc(sizeof *fx * (size_t)(j->nx + 1));
  float complex *transfer = malloc(sizeof *transfer * (size_t)(j->nx + 1));
  if (!field || !fx || !transfer) {
    __atomic_store_n(&j->failed, 1, __ATOMIC_RELAXED);
  } else {
    memset(j->sum[g], 0, n * sizeof(float));
    for (size_t s = g; s < j->systems->count; s += SUMS) {
      fill(j, s, field, fx, transfer);
      opc_fft_backward(j->nx, j->ny, field);
      add_square(field, (float)j->systems->weight[s], n, j->sum[g]);
    }
  }
  opc_fft_free(field);
  free(fx);
  free(transfer);
}

/* Coefficients of the spline that goes through the band-limited samples. */
static int to_spline(const job *j, double step, opc_field *out,
                     opc_error *error) {
  const opc_frame *f = &out->frame;
  double band = j->systems->intensity_band;
  int fine_x = opc_fft_size(f->width / step);
  int fine_y = opc_fft_size(f->height / step);
  /* The finer grid holds at least the band. */
  while (fine_x <= 2 * f->width * band) fine_x = opc_fft_size(fine_x + 2);
  while (fine_y <= 2 * f->height * band) fine_y = opc_fft_size(fine_y + 2);
  int width = j->nx / 2 + 1, fine_width = fine_x / 2 + 1, code = OPC_OK;
  float complex *coarse = opc_fft_alloc(sizeof *coarse * (size_t)width * j->ny);
  float complex *fine =
      opc_fft_alloc(sizeof *fine * (size_t)fine_width * fine_y);
  float *values = opc_fft_alloc(sizeof *values * (size_t)fine_x * fine_y);
  out->nx = fine_x;
  out->ny = fine_y;
  out->coefficients =
      j->host->alloc(j->host, (size_t)fine_x * fine_y, sizeof(float));
  if (!coarse || !fine || !values || !out->coefficients) {
    j->host->free(j->host, out->coefficients);
    out->coefficients = NULL;
    code = opc_fail(error, OPC_FAILED, NULL, "out of memory");
    goto done;
  }
  opc_fft_forward_real(j->nx, j->ny, j->sum[0], coarse);
  memset(fine, 0, sizeof *fine * (size_t)fine_width * fine_y);
  int half = (int)floor(f->height * band);
  double scale = 1.0 / ((double)j->nx * j->ny);
  for (int l = -half; l <= half; l++) {
    double fy = l / f->height;
    double sy = scale / opc_spline_sampled((double)l / fine_y);
    int reach = (int)floor(f->width * sqrt(fmax(0, band * band - fy * fy)));
    const float complex *from =
        coarse + (size_t)(l < 0 ? l + j->ny : l) * width;
    float complex *to = fine + (size_t)(l < 0 ? l + fine_y : l) * fine_width;
    for (int k = 0; k <= reach; k++)
      to[k] = from[k] * (float)(sy / opc_spline_sampled((double)k / fine_x));
  }
  opc_fft_backward_real(fine_x, fine_y, fine, values);
  memcpy(out->coefficients, values, sizeof *values * (size_t)fine_x * fine_y);
done:
  opc_fft_free(coarse);
  opc_fft_free(fine);
  opc_fft_free(values);
  return code;
}

int opc_coherent_sum(const opc_host *host, const opc_spectrum *mask,
                     const opc_systems *systems, double step, opc_field *out,
                     opc_error *error) {
  memset(out, 0, sizeof *out);
  if (!systems->count || !(systems->band > 0 && systems->intensity_band > 0))
    return opc_fail(error, OPC_INVALID, NULL, "an image needs a system");
  /* What a square has beyond the band of the intensity must not fold into
     it. */
  double samples = 2 * systems->band + systems->intensity_band;
  job j = {.host = host, .mask = mask, .systems = systems,
           .nx = opc_fft_size(mask->frame.width * samples),
           .ny = opc_fft_size(mask->frame.height * samples)};
  size_t n = (size_t)j.nx * j.ny;
  int code = OPC_OK;
  out->frame = mask->frame;
  size_t sums = systems->count < SUMS ? systems->count : SUMS;
  for (size_t g = 0; g < sums; g++)
    if (!(j.sum[g] = opc_fft_alloc(n * sizeof(float)))) j.failed = 1;
  if (!j.failed) host->parallel(host, sums, work, &j);
  if (j.failed) {
    code = opc_fail(error, OPC_FAILED, NULL, "out of memory");
  } else {
    for (size_t g = 1; g < sums; g++)
      for (size_t i = 0; i < n; i++) j.sum[0][i] += j.sum[g][i];
    code = to_spline(&j, step > 0 ? step : default_step, out, error);
  }
  for (size_t g = 0; g < sums; g++) opc_fft_free(j.sum[g]);
  return code;
}
