/* SPDX-License-Identifier: BSD-3-Clause */
/* Common header of the files of score.iccad: pixels of 1 nm on a periodic
   square tile. The target is the pattern that shall print. */
#pragma once

#include <eda/gates.h>
#include <eda/resist.h>

/* A tile. */
typedef struct iccad_tile {
  int32_t x0, y0; /* lower left corner, nm */
  int32_t side;   /* nm, equal to the number of pixels */
} iccad_tile;

/* A site on the boundary of the target. */
typedef struct iccad_site {
  int32_t x, y;  /* adjacent pixel inside the target: its lower left corner */
  int8_t dx, dy; /* step to the adjacent pixel outside */
} iccad_site;

/* Set the pixels with centres inside the shapes to 1. Return OPC_OK or an
   error. */
int iccad_fill(const eda_shapes *shapes, double grid, const iccad_tile *tile,
               uint8_t *pixels, opc_error *error);

/* Models and tile of a simulation. iccad_expose sets the pixels that print if
   the intensity is multiplied by `dose` and the defocus is `defocus` nm.
   Returns OPC_OK or an error. */
typedef struct iccad_print {
  const opc_context *context;
  const opc_module *litho, *resist;
  const iccad_tile *tile;
} iccad_print;
int iccad_expose(const iccad_print *print, const eda_spectrum *mask,
                 double dose, double defocus, uint8_t *pixels,
                 opc_error *error);

/* Find the sites along the edges of the target, `spacing` nm apart. Return
   their number; free *sites with free(). */
size_t iccad_sites(const eda_shapes *target, double grid, int32_t spacing,
                   iccad_site **sites);

/* Features of the target in a printed image. */
typedef struct iccad_features {
  int64_t lost;    /* features without a printed pixel */
  int64_t broken;  /* printed pieces in excess of one per feature */
  int64_t bridged; /* connections between features */
  int64_t extra;   /* printed pieces outside of all features */
} iccad_features;
iccad_features iccad_compare(const iccad_tile *tile, const uint8_t *target,
                             const uint8_t *print);

/* Return a pixel of the periodic tile. */
static inline uint8_t iccad_at(const iccad_tile *t, const uint8_t *pixels,
                               int64_t x, int64_t y) {
  int64_t c = (x - t->x0) % t->side, r = (y - t->y0) % t->side;
  if (c < 0) c += t->side;
  if (r < 0) r += t->side;
  return pixels[r * t->side + c];
}
