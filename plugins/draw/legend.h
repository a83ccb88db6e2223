/* SPDX-License-Identifier: BSD-3-Clause */
/* Titles and legends: entries flow from left to right, then down, so that any
   width of the paper will do. */
#ifndef OPCFLOW_DRAW_LEGEND_H
#define OPCFLOW_DRAW_LEGEND_H

#include "view.h"

enum { LEGEND_TEXT = 128, LEGEND_ENTRIES = 16 };

/* An entry: a sign, then a text. */
enum {
  LEGEND_PLAIN,
  LEGEND_FILL,
  LEGEND_LINE,
  LEGEND_CROSS,
  LEGEND_BAR,
  LEGEND_RAMP
};

typedef struct legend_entry {
  int sign;
  char text[LEGEND_TEXT];
  rgb colour;
  double line;            /* width of a LINE */
  rgb behind;             /* of a LINE that is drawn upon another one */
  double behind_line;     /* its width; 0: there is none */
  double size;            /* of a BAR, pixels */
  rgb (*ramp)(double t);  /* of a RAMP, t from 0 to 1 */
  char low[16], high[16]; /* what its ends mean */
} legend_entry;

typedef struct legend {
  legend_entry entry[LEGEND_ENTRIES];
  size_t n;
} legend;

/* At most LEGEND_ENTRIES; the text as by printf. */
legend_entry *legend_add(legend *l, int sign, rgb colour, const char *format,
                         ...) OPC_PRINTF(4, 5);

/* A round length of about a sixth of the window. */
void legend_add_scale_bar(legend *l, const view *v);

/* The entries from `top` on. Returns how high they stand. */
double legend_flow(const view *v, legend *l, double top, int draw);

/* A line of large letters; returns its height. Sets the font for what
   follows. */
double legend_heading(const view *v, const char *text, double top, int draw);

void legend_use_font(const view *v);

/* A line of text of its own, cut to the room it has. */
void legend_text(const view *v, const char *text, double x, double baseline,
                 double room);

/* A cross in a box on paper. */
void legend_cross(const view *v, double x, double y, double width,
                  double height);

#endif
