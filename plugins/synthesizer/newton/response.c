/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements responses: the initial estimate from the slopes of the device
   curves, the update from measurements, and the resulting move. */
#include "response.h"

#include <math.h>
#include <string.h>

#include "tuning.h"

/* Flags of printed gates whose figures are not valid. */
static const uint32_t no_figures =
    EDA_PRINT_OPEN | EDA_PRINT_NO_ACTIVE | EDA_PRINT_MERGED | EDA_PRINT_ISLAND;

static int has_performance(const eda_performance *p, size_t i) {
  return p->ion[i] > 0 && p->ioff[i] > 0 && p->weq[i] > 0 && p->area[i] > 0;
}

void curves_measure(const eda_feedback *f, curve out[2]) {
  const eda_gates *g = f->gates;
  const eda_performance *d = f->design, *p = f->printed;
  double xy[2][2] = {{0}}, xx[2][2] = {{0}}, length[2] = {0}, n[2] = {0};
  for (size_t i = 0; i < g->count; i++) {
    int t = g->type[i] == EDA_PMOS;
    length[t] += g->length[i];
    n[t]++;
    if (!has_performance(p, i) || f->flags[i] & ~(uint32_t)EDA_PRINT_NOTES)
      continue;
    const double part = log(p->weq[i] / d->weq[i]);
    const double x[2] = {p->leq_ion[i] - d->leq_ion[i],
                         p->leq_ioff[i] - d->leq_ioff[i]};
    const double y[2] = {log(p->ion[i] / d->ion[i]) - part,
                         log(p->ioff[i] / d->ioff[i]) - part};
    for (int k = 0; k < 2; k++) {
      xy[t][k] += x[k] * y[k];
      xx[t][k] += x[k] * x[k];
    }
  }
  for (int t = 0; t < 2; t++) {
    double l = n[t] > 0 ? length[t] / n[t] : 1;
    for (int k = 0; k < 2; k++) {
      double slope = xx[t][k] > 0 ? xy[t][k] / xx[t][k] : 0;
      out[t].slope[k] = slope < 0 ? slope : -1 / l;
    }
    out[t].slope[AREA] = 1 / l;
  }
}

point point_of(const eda_performance *p, size_t i) {
  if (!has_performance(p, i)) return (point){{NAN, NAN}, {NAN, NAN}};
  return (point){{p->leq_ion[i], p->leq_ioff[i]},
                 {log(p->ion[i] / p->weq[i]), log(p->ioff[i] / p->weq[i])}};
}

int errors_of(const eda_feedback *f, size_t i, const double target[ERRORS],
              double out[ERRORS]) {
  const eda_performance *d = f->design, *p = f->printed;
  memset(out, 0, sizeof(double) * ERRORS);
  if (!has_performance(p, i) || f->flags[i] & no_figures) return 0;
  out[ION] = log(p->ion[i] / d->ion[i] / target[ION]);
  out[IOFF] = log(p->ioff[i] / d->ioff[i] / target[IOFF]);
  out[AREA] = log(p->area[i] / d->area[i] / target[AREA]);
  return 1;
}

/* A short line end makes the length short over a small part of the width. That
   part carries much of the current but changes the mean length little. After
   the repair of the line end, the gate is expected to have the current of a
   gate of uniform mean length. */
void errors_with_line_ends(const eda_feedback *f, size_t i,
                           const curve *of_type, double error[ERRORS]) {
  const eda_performance *p = f->printed;
  if (!has_performance(p, i)) return;
  double mean = p->area[i] / p->weq[i];
  error[ION] += of_type->slope[ION] * (mean - p->leq_ion[i]);
  error[IOFF] += of_type->slope[IOFF] * (mean - p->leq_ioff[i]);
}

response response_first(const eda_gates *g, size_t i, const curve *of_type,
                        const double gain[MOVES]) {
  response r = {.doubt = {tuned.doubt[BY_L], tuned.doubt[BY_W]},
                .slope = {of_type->slope[ION], of_type->slope[IOFF]}};
  for (int k = 0; k < ERRORS; k++) {
    double slope = k == AREA ? 1 / g->length[i] : of_type->slope[k];
    r.by[k][BY_L] = slope * gain[BY_L] * g->grid;
    r.by[k][BY_W] = gain[BY_W] * g->grid / g->width[i];
  }
  return r;
}

void response_bend(response *r, response *first, point from, point to,
                   double least) {
  for (int k = ION; k <= IOFF; k++) {
    double apart = to.length[k] - from.length[k];
    double slope = (to.drive[k] - from.drive[k]) / apart;
    if (!(fabs(apart) >= least && slope < 0)) continue;
    r->by[k][BY_L] *= slope / r->slope[k];
    first->by[k][BY_L] *= slope / first->slope[k];
    r->slope[k] = first->slope[k] = slope;
  }
}

static double limit_response(double x, double first, double trust) {
  double part = x / first;
  return first * fmin(fmax(part, 1 / trust), trust);
}

void response_learn(response *r, const response *first, const double dx[MOVES],
                    const double de[ERRORS], double noise) {
  double doubt[MOVES] = {0};
  for (int k = 0; k < ERRORS; k++) {
    double as_ion = first->by[k][BY_L] / first->by[ION][BY_L];
    double rest = de[k], part[MOVES];
    double square = as_ion * as_ion * noise * noise;
    for (int m = 0; m < MOVES; m++) {
      double spread = r->doubt[m] * r->by[k][m];
      part[m] = spread * spread * dx[m];
      square += part[m] * dx[m];
      rest -= r->by[k][m] * dx[m];
    }
    if (!(square > 0)) continue;
    double most = tuned.odd_surprise * sqrt(square);
    rest = fmin(fmax(rest, -most), most);
    for (int m = 0; m < MOVES; m++) {
      if (k == ION)
        doubt[m] = r->doubt[m] * sqrt(fmax(1 - part[m] * dx[m] / square, 0));
      r->by[k][m] = limit_response(r->by[k][m] + rest * part[m] / square,
                                   first->by[k][m], tuned.trust[m]);
    }
  }
  for (int m = 0; m < MOVES; m++)
    r->doubt[m] = fmax(doubt[m], tuned.least_doubt);
}

void response_solve(const response *r, const double error[ERRORS],
                    const double weight[ERRORS], const int free[MOVES],
                    double dx[MOVES]) {
  /* Normal equations of two unknowns; a move that is not free is omitted. */
  double a[MOVES][MOVES] = {{0}}, b[MOVES] = {0};
  for (int k = 0; k < ERRORS; k++)
    for (int m = 0; m < MOVES; m++) {
      if (!free[m]) continue;
      b[m] -= weight[k] * r->by[k][m] * error[k];
      for (int n = 0; n < MOVES; n++)
        if (free[n]) a[m][n] += weight[k] * r->by[k][m] * r->by[k][n];
    }
  dx[BY_L] = dx[BY_W] = 0;
  double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  if (free[0] && free[1] && det > 1e-6 * a[0][0] * a[1][1]) {
    dx[0] = (b[0] * a[1][1] - b[1] * a[0][1]) / det;
    dx[1] = (b[1] * a[0][0] - b[0] * a[1][0]) / det;
  } else if (free[0] && a[0][0] > 0) {
    dx[0] = b[0] / a[0][0];
  } else if (free[1] && a[1][1] > 0) {
    dx[1] = b[1] / a[1][1];
  }
}
