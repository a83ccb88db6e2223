/* SPDX-License-Identifier: BSD-3-Clause */
/* Layer numbers as text, and default numbers of mask layers. */
#include <eda/formats.h>
#include <string.h>

int eda_layer_number_read(const char *text, uint32_t most,
                          eda_layer_number *out, int *any) {
  uint64_t value[2] = {0, 0};
  int parts = 0;
  while (parts < 2) {
    const char *start = text;
    while (*text >= '0' && *text <= '9' && text - start < 10)
      value[parts] = value[parts] * 10 + (uint64_t)(*text++ - '0');
    if (text == start || value[parts] > most) return 0;
    parts++;
    if (parts == 2 || *text != '/') break;
    text++;
  }
  if (*text || (parts == 1 && !any)) return 0;
  *out = (eda_layer_number){(uint32_t)value[0], (uint32_t)value[1]};
  if (any) *any = parts == 1;
  return 1;
}

/* The numbers are those of FreePDK45, in which metal1 has the number 11. */
uint32_t eda_gates_number(const eda_gates *gates, size_t layer) {
  if (layer == EDA_POLY) return 9;
  if (layer == EDA_ACTIVE) return 1;
  uint32_t number = 11;
  if (!strcmp(gates->layer[layer], "contact")) return 10;
  for (size_t k = EDA_ACTIVE + 1; k < layer; k++)
    number += strcmp(gates->layer[k], "contact") != 0;
  return number;
}
