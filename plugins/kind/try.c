/* SPDX-License-Identifier: BSD-3-Clause */
/* Sample masks and images for the tests of all plugin kinds, and reports of
   faults in the results of plugins. */
#include "try.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

const eda_frame try_frame = {-1000, -1000, 2500, 3000};
const eda_frame try_other_frame = {-1237, -1111, 2900, 3300};

/* ---- reports ---- */

/* Return 1 if the call was cancelled because the time limit of `opcflow lint`
   expired. The cause may be a high load of the machine, so this adds a note and
   no fault. */
static int was_stopped(opc_inspector *in, const char *what, int code) {
  if (code != OPC_CANCELLED || !opc_cancelled(in->context)) return 0;
  in->note(in, "%s: stopped after the time limit of lint", what);
  return 1;
}

int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error) {
  if (!code) return 1;
  if (was_stopped(in, what, code)) return 0;
  error->message[sizeof error->message - 1] = 0;
  if (code < OPC_INVALID || code > OPC_CANCELLED)
    in->find(in, "%s returned the unknown code %d", what, code);
  else if (!*error->message)
    in->find(in, "%s failed without a message", what);
  else
    in->note(in, "%s: %s", what, error->message);
  return 0;
}

int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error) {
  if (code && !was_stopped(in, what, code))
    in->find(in, "%s: %s", what, error->message);
  return !code;
}

int try_call(opc_inspector *in, const char *what, int own, int code,
             opc_error *error) {
  if (own) return try_went_well(in, what, own, error);
  return try_is_sound(in, what, code, error);
}

void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame) {
  opc_error error = {0};
  int code = eda_check_field(field, frame, what, &error);
  if (try_is_sound(in, function, code, &error))
    in->add(
        in, field->coefficients,
        (size_t)field->nx * (size_t)field->ny * sizeof *field->coefficients);
}

/* ---- a mask and a model ---- */

int try_mask(opc_inspector *in, int layer, const eda_frame *frame, double band,
             eda_spectrum *mask) {
  const eda_gates *g = eda_gates_sample();
  opc_error error = {0};
  size_t drawn = (size_t)layer < g->layers ? (size_t)layer : EDA_POLY;
  int32_t x0 = (int32_t)lround(frame->x0 / g->grid),
          y0 = (int32_t)lround(frame->y0 / g->grid),
          x1 = x0 + (int32_t)lround(frame->width / g->grid),
          y1 = y0 + (int32_t)lround(frame->height / g->grid);
  const eda_shapes all = {
      .count = layer == TRY_FULL,
      .start = (uint32_t[]){0, 4},
      .points = (eda_point[]){{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}},
      .hole = (uint8_t[]){0}};
  int code = eda_mask_spectrum(in->context, layer < 0 ? &all : &g->drawn[drawn],
                               g->grid, *frame, band, mask, &error);
  if (code && !was_stopped(in, "a mask", code))
    in->find(
        in,
        "the spectrum of a test mask up to the model's band limit, %g 1/nm: %s",
        band, error.message);
  return !code;
}

/* The transfer function at the frequency f is 1 / (1 + (cut f)^2)^2, with `cut`
   in nm. At the band limit, 4 / cut, its value is 1/289 of the maximum. */
static const double cut = 120, limit = 4 / 120.0;

static int mask_prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double mask_band(const void *self) {
  (void)self;
  return limit;
}

static void mask_transfer(const void *self, size_t s, const double *fx,
                          double fy, size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut * cut;
    out[2 * i] = (float)(1 / ((1 + r) * (1 + r)));
    out[2 * i + 1] = 0;
  }
}

static int mask_image(const void *self, int layer, const eda_spectrum *mask,
                      eda_field *out, opc_error *error) {
  static const double one = 1;
  const opc_inspector *in = self;
  (void)layer;
  const eda_kernels kernels = {.count = 1,
                               .weight = &one,
                               .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = mask_transfer,
                               .scale = {1, 0}};
  return eda_coherent_sum(in->context, mask, &kernels, 0, out, error);
}

opc_module try_litho(const opc_inspector *in) {
  static const eda_litho functions = {
      .prepare = mask_prepare, .band = mask_band, .image = mask_image};
  return (opc_module){&functions, (void *)in, "lint.litho"};
}

int try_print(opc_inspector *in, int layer, eda_field *intensity) {
  eda_spectrum mask;
  opc_error error = {0};
  if (!try_mask(in, layer, &try_frame, limit, &mask)) return 0;
  int code = mask_image(in, layer, &mask, intensity, &error);
  eda_spectrum_clear(&mask);
  return try_is_sound(in, "the litho model of lint", code, &error);
}

int try_develop(opc_inspector *in, int layer, eda_field *print) {
  if (!try_print(in, layer, print)) return 0;
  for (int i = 0; i < print->nx * print->ny; i++)
    print->coefficients[i] = 0.3F - print->coefficients[i];
  return 1;
}

void try_performance(const eda_gates *g, eda_performance *out) {
  for (size_t i = 0; i < g->count; i++) {
    out->ion[i] = 1e-4 * g->width[i] / g->length[i];
    out->ioff[i] = 1e-9 * g->width[i] / g->length[i];
    out->leq_ion[i] = out->leq_ioff[i] = g->length[i];
    out->weq[i] = g->width[i];
    out->area[i] = g->width[i] * g->length[i];
  }
}

/* ---- several callers at once ---- */

/* Duration of the concurrent calls, s: sufficient for thousands of fast calls,
   and for some dozen thread switches on a shared processor. With half of the
   duration, rare races are not detected on a busy machine. */
static const double moment = 0.2;

/* Threads that call a task concurrently, and one of these threads. */
typedef struct crowd {
  int (*task)(void *data, size_t i);
  void *data;
  pthread_barrier_t start;
  int bad; /* atomic */
} crowd;

typedef struct caller {
  crowd *all;
  size_t i;
  pthread_t thread;
} caller;

static double time_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *call_often(void *data) {
  const caller *c = data;
  crowd *all = c->all;
  pthread_barrier_wait(&all->start);
  double end = time_now() + moment;
  do {
    if (!all->task(all->data, c->i))
      __atomic_store_n(&all->bad, 1, __ATOMIC_RELAXED);
  } while (!__atomic_load_n(&all->bad, __ATOMIC_RELAXED) && time_now() < end);
  return NULL;
}

int try_at_once(size_t n, int (*task)(void *data, size_t i), void *data) {
  static int tried; /* atomic */
  crowd all = {.task = task, .data = data};
  if (__atomic_exchange_n(&tried, 1, __ATOMIC_RELAXED)) return 1;
  caller *callers = eda_alloc(n, sizeof *callers);
  pthread_barrier_init(&all.start, NULL, (unsigned)n);
  for (size_t i = 0; i < n; i++) {
    callers[i] = (caller){.all = &all, .i = i};
    if (pthread_create(&callers[i].thread, NULL, call_often, &callers[i]))
      abort();
  }
  for (size_t i = 0; i < n; i++) pthread_join(callers[i].thread, NULL);
  pthread_barrier_destroy(&all.start);
  free(callers);
  return !all.bad;
}
