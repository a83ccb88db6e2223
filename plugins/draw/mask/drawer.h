/* SPDX-License-Identifier: BSD-3-Clause */
/* Declarations shared by the files of draw.mask. */
#pragma once

#include "../view.h"

/* State to show: the drawn mask or the corrected mask, each with its printed
   image; the improvement by the correction; the number of transistors with the
   same mask. */
enum { BEFORE, AFTER, DIFFERENCE, CLASSES };

/* The instance of draw.mask. */
typedef struct drawer {
  const opc_host *host;
  view view;
  const eda_mask *mask;
  int state;
  const char *scale; /* parameter `scale` */
  double asked;      /* requested deviation at the ends of the colour scale, %;
                        0: automatic */
  int64_t insets;    /* largest number of insets */
  double range;      /* deviation at the ends of the colour scale, % */
  size_t beyond;     /* number of transistors beyond the range */
  size_t *worst;     /* [n_worst], transistors in the insets */
  size_t n_worst;
} drawer;

/* ---- figures.c ---- */

/* Set `asked` from `scale`. Return OPC_INVALID unless `scale` is `auto` or a
   percentage above 0 and at most 1e6 %. */
int drawer_check_scale(drawer *d, opc_error *error);

/* Return 1 if a transistor does not print as a separate transistor. The warning
   flags (EDA_PRINT_NOTES) do not count. In the state BEFORE, the flags are not
   known, and a transistor without a current counts as not printed. */
int drawer_fails(const drawer *d, size_t gate);

/* drawer_deviation returns the deviation of a transistor's drive current from
   the current of the drawn shapes, %, signed. drawer_figure returns the value
   that the colour of the transistor shows, %: the deviation, or in the state
   DIFFERENCE the change of |deviation|. Both return NAN if the current is not
   known. */
double drawer_deviation(const drawer *d, const eda_performance *p, size_t gate);
double drawer_figure(const drawer *d, size_t gate);

/* Set `range` and `beyond` of *d. */
void drawer_set_range(drawer *d);

/* Compute the mean |deviation| and the largest |deviation| of the transistors
   whose current is known, %. */
void drawer_statistics(const drawer *d, const eda_performance *of, double *mean,
                       double *max);

/* ---- insets.c: close-ups of the worst transistors below the window ---- */

/* Select the transistors of the insets, none if the layout is shown at a large
   scale. The caller frees d->worst. */
void drawer_choose_insets(drawer *d);

/* drawer_insets_height: return the height of the insets with captions. */
double drawer_insets_height(const drawer *d);
/* Draw all insets with frames and captions, and the letters and frames that
   show the positions of the insets in the layout. */
int drawer_put_insets(const drawer *d, opc_error *error);

/* Draw the layout in the window of d->view. */
int drawer_paint(const drawer *d, opc_error *error);

/* ---- map.c ---- */

/* Draw all transistors of a mask by classes and write the picture file. The
   colour of a transistor shows the value of drawer_figure or, in the state
   CLASSES, the number of transistors that share its mask. */
int drawer_map(const drawer *d, opc_error *error);
