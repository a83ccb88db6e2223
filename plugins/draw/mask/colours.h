/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours of all pictures of layouts. */
#ifndef OPCFLOW_DRAW_COLOURS_H
#define OPCFLOW_DRAW_COLOURS_H

#include <cairo.h>
#include <opcflow/gates.h>

typedef struct rgb {
  double r, g, b;
} rgb;

/* Of a literal like 0xe07000, for initialisers. */
#define RGB(hex)                                             \
  {                                                          \
    ((hex) >> 16 & 255) / 255.0, ((hex) >> 8 & 255) / 255.0, \
        ((hex)&255) / 255.0                                  \
  }

extern const rgb picture_drawn[OPC_LAYERS]; /* fills */
extern const rgb picture_mask[OPC_MASKS];   /* outlines */
extern const rgb picture_print[OPC_MASKS];  /* contours */
extern const rgb picture_ink, picture_faint, picture_unknown;

void picture_use(cairo_t *cairo, rgb colour);

/* Of a deviation, from blue by white to red; t from -1 to 1, clamped. */
rgb picture_diverging(double t);

/* Of an intensity, from dark to light, of growing lightness, so that it reads
   in grey as well; t from 0 to 1, clamped. */
rgb picture_sequential(double t);

#endif
