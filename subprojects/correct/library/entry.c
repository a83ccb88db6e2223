/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the conversion of a corrected cell to bytes and back. */
#include <correct/entry.h>

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

/* ---- to bytes ---- */

static GVariant *pack_parts(const eda_part *part) {
  GVariantBuilder parts;
  g_variant_builder_init(&parts, G_VARIANT_TYPE("a(iii)"));
  for (int k = 0; k < EDA_PARTS && part[k].from < part[k].to; k++)
    g_variant_builder_add(&parts, "(iii)", part[k].from, part[k].to,
                          part[k].by);
  return g_variant_builder_end(&parts);
}

static gboolean is_in(eda_box cell, eda_box b) {
  return b.x0 + b.x1 >= 2 * cell.x0 && b.x0 + b.x1 <= 2 * cell.x1 &&
         b.y0 + b.y1 >= 2 * cell.y0 && b.y0 + b.y1 <= 2 * cell.y1;
}

static GVariant *pack_boxes(const eda_box_list *lists, size_t layers,
                            eda_box cell) {
  GVariantBuilder all;
  g_variant_builder_init(&all, G_VARIANT_TYPE("aa(iiii)"));
  for (size_t k = 0; k < layers; k++) {
    g_variant_builder_open(&all, G_VARIANT_TYPE("a(iiii)"));
    for (size_t i = 0; i < lists[k].count; i++) {
      eda_box b = lists[k].box[i];
      if (is_in(cell, b))
        g_variant_builder_add(&all, "(iiii)", b.x0, b.y0, b.x1, b.y1);
    }
    g_variant_builder_close(&all);
  }
  return g_variant_builder_end(&all);
}

GVariant *correct_entry_pack(const cut_out *cell, const eda_performance *design,
                             const eda_performance *after,
                             const uint32_t *flags, const eda_moved *m) {
  const eda_gates *g = cell->gates;
  GVariantBuilder all;
  g_variant_builder_init(&all,
                         G_VARIANT_TYPE("a(iiiiyydddddddddyuiiiiiia(iii)ds)"));
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    if (!cell->own[i]) continue;
    g_variant_builder_add(
        &all, "(iiiiyydddddddddyuiiiiii@a(iii)ds)", b.x0, b.y0, b.x1, b.y1,
        g->type[i], g->axis[i], g->length[i], g->width[i], design->ion[i],
        after->ion[i], after->ioff[i], after->leq_ion[i], after->leq_ioff[i],
        after->weq[i], after->area[i], after->outside[i], flags[i], m->w[i],
        m->aside[i], m->l[i], m->jog[i], m->end[2 * i], m->end[2 * i + 1],
        pack_parts(m->part + EDA_PARTS * i), m->seen[i],
        eda_gates_flavour(g, i));
  }
  return g_variant_new(
      "(@as@a(iiiiyydddddddddyuiiiiiia(iii)ds)@aa(iiii)@aa(iiii))",
      g_variant_new_strv((const char *const *)g->layer, (gssize)g->layers),
      g_variant_builder_end(&all), pack_boxes(m->added, g->layers, cell->box),
      pack_boxes(m->cutouts, g->layers, cell->box));
}

/* ---- from bytes ---- */

static gboolean unpack_gate(entry *e, size_t i, GVariant *from) {
  eda_box *b = &e->box[i];
  eda_performance *p = &e->after;
  eda_moved *m = e->moved;
  GVariantIter *parts;
  eda_part *part = m->part + EDA_PARTS * i, next;
  gboolean good = TRUE;
  g_variant_get(from, "(iiiiyydddddddddyuiiiiiia(iii)ds)", &b->x0, &b->y0,
                &b->x1, &b->y1, &e->type[i], &e->axis[i], &e->length[i],
                &e->width[i], &e->design[i], &p->ion[i], &p->ioff[i],
                &p->leq_ion[i], &p->leq_ioff[i], &p->weq[i], &p->area[i],
                &p->outside[i], &e->flags[i], &m->w[i], &m->aside[i], &m->l[i],
                &m->jog[i], &m->end[2 * i], &m->end[2 * i + 1], &parts,
                &m->seen[i], &e->flavour[i]);
  for (int k = 0;
       g_variant_iter_next(parts, "(iii)", &next.from, &next.to, &next.by); k++)
    if (k < EDA_PARTS)
      part[k] = next;
    else
      good = FALSE;
  g_variant_iter_free(parts);
  return good && b->x0 < b->x1 && b->y0 < b->y1 && e->type[i] <= EDA_PMOS &&
         e->axis[i] <= EDA_Y && isfinite(e->design[i]) && e->design[i] > 0 &&
         isfinite(m->seen[i]);
}

static gboolean unpack_boxes(GVariant *from, size_t layers,
                             eda_box_list *lists) {
  if (g_variant_n_children(from) != layers) return FALSE;
  for (size_t k = 0; k < layers; k++) {
    g_autoptr(GVariant) list = g_variant_get_child_value(from, k);
    GVariantIter each;
    eda_box b;
    g_variant_iter_init(&each, list);
    while (g_variant_iter_next(&each, "(iiii)", &b.x0, &b.y0, &b.x1, &b.y1)) {
      if (b.x0 > b.x1 || b.y0 > b.y1) return FALSE;
      eda_box_list_add(&lists[k], b);
    }
  }
  return TRUE;
}

entry *correct_entry_unpack(GVariant *data) {
  g_autoptr(GVariant) gates = g_variant_get_child_value(data, 1);
  g_autoptr(GVariant) added = g_variant_get_child_value(data, 2);
  g_autoptr(GVariant) cutouts = g_variant_get_child_value(data, 3);
  entry *e = g_new0(entry, 1);
  size_t n = e->gates = g_variant_n_children(gates);
  g_variant_get_child(data, 0, "^as", &e->layer);
  e->layers = g_strv_length(e->layer);
  e->box = eda_alloc(n, sizeof *e->box);
  e->type = eda_alloc(n, 1);
  e->axis = eda_alloc(n, 1);
  e->flavour = g_new0(char *, n + 1);
  e->length = eda_alloc(n, sizeof *e->length);
  e->width = eda_alloc(n, sizeof *e->width);
  e->design = eda_alloc(n, sizeof *e->design);
  e->flags = eda_alloc(n, sizeof *e->flags);
  eda_performance_init(&e->after, n);
  e->moved = eda_moved_new(e->layers, n);
  gboolean good = unpack_boxes(added, e->layers, e->moved->added) &&
                  unpack_boxes(cutouts, e->layers, e->moved->cutouts);
  for (size_t i = 0; i < n && good; i++) {
    g_autoptr(GVariant) one = g_variant_get_child_value(gates, i);
    good = unpack_gate(e, i, one);
  }
  if (good) return e;
  correct_entry_free(e);
  return NULL;
}

void correct_entry_free(entry *e) {
  if (!e) return;
  g_strfreev(e->layer);
  g_strfreev(e->flavour);
  free(e->box);
  free(e->type);
  free(e->axis);
  free(e->length);
  free(e->width);
  free(e->design);
  free(e->flags);
  eda_performance_clear(&e->after);
  eda_moved_free(e->moved);
  g_free(e);
}
