/* SPDX-License-Identifier: BSD-3-Clause */
/* Where two written masks differ. */
#pragma once

#include <eda/geometry.h>
#include <stdint.h>

/* A layer of both masks. Areas in um^2. */
typedef struct mask_difference {
  uint32_t layer, datatype;
  double base, other; /* areas */
  double area;        /* of what is in one of them alone */
  int64_t places;     /* polygons of that */
  int64_t rectangles; /* as many as it can be cut into by one way */
} mask_difference;

/* Compare two GDSII files as write.gds makes them of masks: polygons in one
   cell. *out: a row for each layer of either, by number, freed with free(), *n
   of them. OPC_IO, or OPC_INVALID for a file that is damaged, has more than
   polygons, or another grid than the other. [any] */
int masks_compare(const char *base, const char *other, mask_difference **out,
                  size_t *n, opc_error *error);
