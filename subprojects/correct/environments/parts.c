/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the visit of the classes of a mask: one transistor of each class
   is on a sheet, with its environment and the masks of its neighbours. */
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include <correct/classes.h>
#include "sheet.h"
#include "window.h"

typedef struct parts {
  const eda_mask *mask;
  uint32_t *number; /* [classes], a transistor of each class */
  cover cover;
  pages pages;
  eda_mask_visit *visit;
  void *data;
} parts;

static int part_visit(const parts *p, size_t page, const sheet *s,
                      opc_error *error) {
  const eda_chip *chip = p->mask->chip;
  eda_mask *m;
  int code = sheet_mask(chip, s, &m, error);
  window_begin(m);
  for (size_t i = 0; i < s->gates->count; i++)
    window_put(p->mask, chip->gate[s->of[i]].print, m, i);
  const eda_mask_part part = {.mask = m,
                              .gate = s->place,
                              .clear = CLASSES_GAP,
                              .index = page,
                              .count = p->pages.count};
  if (!code) code = p->visit(p->data, &part, error);
  eda_mask_free(m);
  return code;
}

static int parts_all(const parts *p, const opc_context *context,
                     opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < p->pages.count && !code; k++) {
    sheet s;
    if (opc_cancelled(context))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    code = sheet_make(context, p->mask->chip, &p->cover, p->number, &p->pages,
                      k, 0, &s, error);
    if (!code) code = part_visit(p, k, &s, error);
    sheet_clear(&s);
  }
  return code;
}

int parts_visit(const eda_mask *mask, double reach, eda_mask_visit *visit,
                void *data, opc_error *error) {
  const classes_source *s = mask->data;
  const eda_gates *g = mask->gates;
  int32_t beyond = (int32_t)ceil(fmax(reach, s->margin) / g->grid),
          most = (int32_t)(PARTS_SIDE / g->grid) + 2 * beyond;
  parts p = {.mask = mask,
             .number = eda_alloc(g->count, sizeof *p.number),
             .visit = visit,
             .data = data};
  for (size_t k = 0; k < g->count; k++)
    p.number[k] = (uint32_t)eda_chip_find(mask->chip, g->box[k]);
  cover_make(g->box, g->count, beyond, most, &p.cover);
  pages_make(&p.cover, most, (int32_t)(CLASSES_GAP / g->grid), &p.pages);
  int code = parts_all(&p, s->host->context, error);
  pages_clear(&p.pages);
  cover_clear(&p.cover);
  free(p.number);
  return code;
}
