/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask spectra. The raster of the mask is transformed along x and, within the
   band, along y. The result is divided by the transform of the smoothing
   B-spline. Aliases stay below 1e-6 of the clear field, because this transform
   has zeros of tenth order. */
#include "imaging/fft.h"
#include "imaging/raster.h"

#include <eda/imaging.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples for each period of the highest frequency in the band. */
static const double oversampling = 3.1;

enum { MAX_SAMPLES = 1 << 28, LINES = 16 };

typedef struct spectrum_task {
  const opc_context *context;
  eda_spectrum *out;
  int nx, ny;
  float *samples;           /* [y][x] */
  float complex *by_column; /* [y][k], 0 <= k < columns */
  float *along; /* 1 / transform of the smoothing B-spline at frequency l along
                   y */
} spectrum_task;

static void forth_along_x(void *data, size_t block) {
  spectrum_task *j = data;
  if (opc_cancelled(j->context)) return;
  int y = (int)block * LINES, lines = j->ny - y < LINES ? j->ny - y : LINES;
  int width = j->nx / 2 + 1, columns = j->out->columns;
  float complex *half =
      eda_fft_alloc((size_t)lines * (size_t)width * sizeof *half);
  eda_fft_run(eda_fft_plan(EDA_FFT_REAL_FORWARD, j->nx, lines),
              j->samples + (size_t)y * j->nx, half);
  for (int l = 0; l < lines; l++)
    memcpy(j->by_column + (size_t)(y + l) * columns, half + (size_t)l * width,
           sizeof *half * (size_t)columns);
  eda_fft_free(half);
}

/* Transform a block of columns along y. Store the frequencies within the band,
   divided by the transform of the smoothing B-spline. */
static void forth_along_y(void *data, size_t block) {
  spectrum_task *j = data;
  if (opc_cancelled(j->context)) return;
  eda_spectrum *s = j->out;
  int k = (int)block * LINES,
      lines = s->columns - k < LINES ? s->columns - k : LINES;
  float complex *column = eda_fft_alloc((size_t)lines * j->ny * sizeof *column);
  for (int y = 0; y < j->ny; y++)
    for (int c = 0; c < lines; c++)
      column[(size_t)c * j->ny + y] =
          j->by_column[(size_t)y * s->columns + k + c];
  eda_fft_run(eda_fft_plan(EDA_FFT_FORWARD, j->ny, lines), column, NULL);
  int half[LINES] = {
      0}; /* highest frequency l of each column within the band */
  float scale[LINES];
  for (int c = 0; c < lines; c++) {
    double fx = (k + c) / s->frame.width;
    half[c] =
        (int)(s->frame.height * sqrt(fmax(0, s->band * s->band - fx * fx)));
    scale[c] = (float)(-1.0 / ((double)j->nx * j->ny) /
                       eda_raster_transform((double)(k + c) / j->nx));
  }
  float complex *a = (float complex *)s->data;
  for (int l = -half[0]; l <= half[0]; l++) {
    float complex *row = a + (size_t)(l < 0 ? l + s->rows : l) * s->columns + k;
    const float complex *from = column + (l < 0 ? l + j->ny : l);
    for (int c = 0; c < lines && abs(l) <= half[c]; c++)
      row[c] = from[(size_t)c * j->ny] * (scale[c] * j->along[abs(l)]);
  }
  eda_fft_free(column);
}

static void spectrum_transform(const opc_context *context, spectrum_task *j) {
  eda_spectrum *s = j->out;
  int half = (s->rows - 1) / 2;
  j->by_column =
      eda_fft_alloc((size_t)j->ny * (size_t)s->columns * sizeof *j->by_column);
  j->along = eda_fft_alloc(((size_t)half + 1) * sizeof *j->along);
  for (int l = 0; l <= half; l++)
    j->along[l] = (float)(1 / eda_raster_transform((double)l / j->ny));
  opc_parallel(context, (size_t)(j->ny + LINES - 1) / LINES, forth_along_x, j);
  opc_parallel(context, (size_t)(s->columns + LINES - 1) / LINES, forth_along_y,
               j);
  eda_fft_free(j->by_column);
  eda_fft_free(j->along);
  ((float complex *)s->data)[0] += 1; /* clear field */
}

int eda_mask_spectrum(const opc_context *context, const eda_shapes *shapes,
                      double grid, eda_frame frame, double band,
                      eda_spectrum *out, opc_error *error) {
  memset(out, 0, sizeof *out);
  if (!(frame.width > 0 && frame.height > 0 && band > 0 && grid > 0) ||
      !isfinite(frame.width * frame.height * band))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g nm has no area", frame.width,
                    frame.height);
  if (frame.width * frame.height * band * band * oversampling * oversampling >
      MAX_SAMPLES)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g um is too large for one field",
                    frame.width / 1e3, frame.height / 1e3);
  spectrum_task j = {.context = context,
                     .out = out,
                     .nx = eda_fft_size(frame.width * band * oversampling),
                     .ny = eda_fft_size(frame.height * band * oversampling)};
  *out = (eda_spectrum){.frame = frame, .band = band};
  out->columns = (int)floor(frame.width * band) + 1;
  out->rows = 2 * (int)floor(frame.height * band) + 1;
  out->data =
      eda_alloc((size_t)out->columns * out->rows, sizeof(float complex));
  j.samples = eda_fft_alloc((size_t)j.nx * j.ny * sizeof *j.samples);
  eda_raster raster;
  eda_raster_lay(context, shapes, grid, frame, j.nx, j.ny, &raster);
  eda_raster_sum(context, &raster, j.samples);
  eda_raster_clear(&raster);
  spectrum_transform(context, &j);
  eda_fft_free(j.samples);
  if (!opc_cancelled(context)) return OPC_OK;
  eda_spectrum_clear(out);
  return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
}
