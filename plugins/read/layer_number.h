/* SPDX-License-Identifier: BSD-3-Clause */
/* How the layers of numbered formats (GDSII, OASIS) are written: "9/0". Shared
   by their readers and writers. */
#ifndef OPCFLOW_LAYER_NUMBER_H
#define OPCFLOW_LAYER_NUMBER_H

#include <stdint.h>

typedef struct layer_number {
  uint32_t layer, datatype;
} layer_number;

/* "9/0" or, where `any` is given, "9" for every datatype (*any = 1); numbers
   up to `most`. 0 if it is neither. */
static inline int layer_number_parse(const char *text, uint32_t most,
                                     layer_number *out, int *any) {
  uint64_t value[2] = {0, 0};
  int parts = 0;
  while (parts < 2) {
    const char *start = text;
    while (*text >= '0' && *text <= '9' && text - start < 10)
      value[parts] = value[parts] * 10 + (uint64_t)(*text++ - '0');
    if (text == start || value[parts] > most) return 0;
    parts++;
    if (*text != '/') break;
    text++;
  }
  if (*text || (parts == 1 && !any)) return 0;
  *out = (layer_number){(uint32_t)value[0], (uint32_t)value[1]};
  if (any) *any = parts == 1;
  return 1;
}

#endif
