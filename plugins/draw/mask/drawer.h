/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of draw.mask have in common. */
#ifndef DRAW_MASK_H
#define DRAW_MASK_H

#include "../view.h"

/* What is shown: the drawn mask and its print, the corrected ones, or how much
   nearer to the design the correction has come. */
enum { BEFORE, AFTER, DIFFERENCE };

typedef struct drawer {
  const opc_host *host;
  view view;
  const eda_mask *mask;
  int state;
  const char *scale; /* as the flow has it */
  double asked;      /* % at the ends of the scale; 0: to the data */
  int64_t insets;    /* at most */
  double range;      /* the deviation at the ends of the scale, % */
  size_t beyond;     /* transistors with more than that */
  size_t *worst;     /* those in the insets */
  size_t n_worst;
} drawer;

/* ---- figures.c ---- */

int drawer_check_scale(drawer *d, opc_error *error);

/* Whether it does not print as a transistor of its own; notes on its print are
   no failure. What is told of the drawn mask are its currents only. */
int drawer_fails(const drawer *d, size_t gate);

/* Of a transistor's drive current, %; NAN where it has none. `figure` is what
   the colour shows. */
double drawer_deviation(const drawer *d, const eda_performance *p, size_t gate);
double drawer_figure(const drawer *d, size_t gate);

/* Choose range and beyond. */
void drawer_set_range(drawer *d);

/* Mean and largest deviation, of those that have one. */
void drawer_statistics(const drawer *d, const eda_performance *of, double *mean,
                       double *max);

/* ---- insets.c: close-ups of the worst transistors below the window ---- */

/* Choose them; free(d->worst). None where the layout is shown large. */
void drawer_choose_insets(drawer *d);

/* Their height with what stands below them. */
double drawer_insets_height(const drawer *d);
int drawer_put_insets(const drawer *d, opc_error *error);

/* ---- mask.c ---- */

/* Whether a view is so small that lines would only cover each other. */
int drawer_is_coarse(const view *v);

/* All that lies in the window of d->view. */
int drawer_paint(const drawer *d, opc_error *error);

#endif
