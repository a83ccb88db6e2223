/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the placement of assist features beside all edges (eda/srafs.h),
   and the limits of fragments beside assist features. */
#include <eda/memory.h>
#include <eda/srafs.h>
#include <string.h>

#include "epe.h"

/* ---- limits of fragments ---- */

/* Limit the outward shift of fragment i, so that the fragment keeps min_space
   to the assist features for all positions of its ends. */
static void limit_fragment(epe_layer *l, const eda_index *srafs, uint32_t i) {
  const epe_rules *r = l->rules;
  const epe_fragment *p = &l->fragments[i];
  int32_t space = r->min_space, most = r->max_shift, reach = most + space;
  int32_t line = epe_line(p, NULL, 0);
  int32_t m = epe_along(p, p->from), n = epe_along(p, p->to);
  int32_t low = (m < n ? m : n) - (p->corner ? most : 0) - space;
  int32_t high = (m < n ? n : m) + (p->corner ? most : 0) + space;
  int32_t near = p->sign > 0 ? line : line - reach;
  eda_box box = p->axis == EDA_X ? (eda_box){near, low, near + reach, high}
                                 : (eda_box){low, near, high, near + reach};
  eda_finder f = eda_index_find(srafs, box);
  for (uint32_t k; eda_index_next(&f, &k);) {
    eda_box sraf = l->srafs.box[k];
    if (!eda_boxes_overlap(sraf, box)) continue;
    int32_t off = p->axis == EDA_X
                      ? (p->sign > 0 ? sraf.x0 - line : line - sraf.x1)
                      : (p->sign > 0 ? sraf.y0 - line : line - sraf.y1);
    /* Diagonally beside a corner, a distance of min_space along one axis is
       sufficient. Choose the axis with the larger distance. */
    int32_t a = p->axis == EDA_X ? sraf.y0 : sraf.x0;
    int32_t b = p->axis == EDA_X ? sraf.y1 : sraf.x1;
    int32_t past = (int32_t)epe_max(a - (m < n ? n : m), (m < n ? m : n) - b);
    if (past > off && past > 0) continue;
    int32_t spacing = off > space ? off - space : 0;
    if (spacing < l->most[i]) l->most[i] = spacing;
  }
}

static void limit_fragments(epe_layer *l) {
  for (uint32_t i = 0; i < l->count; i++)
    l->most[i] = l->fragments[i].still ? 0 : l->rules->max_shift;
  eda_index *srafs = eda_index_new(l->srafs.box, l->srafs.count,
                                   l->rules->max_shift + l->rules->min_space);
  for (uint32_t i = 0; i < l->count; i++) limit_fragment(l, srafs, i);
  eda_index_free(srafs);
}

/* ---- placement ---- */

/* Return edge e as drawn. */
static eda_sraf_edge edge_of(const epe_layer *l, size_t e) {
  const epe_fragment *first = &l->fragments[l->edge[e]];
  const epe_fragment *last = &l->fragments[l->edge[e + 1] - 1];
  int32_t a = epe_along(first, first->from), b = epe_along(last, last->to);
  return (eda_sraf_edge){first->axis == EDA_X, first->sign,
                         epe_line(first, NULL, 0), a < b ? a : b,
                         a < b ? b : a};
}

int epe_place_srafs(epe_layer *l, const eda_sraf_rule *rule,
                    const eda_shapes *drawn, opc_error *error) {
  eda_sraf_edge *edges = eda_alloc(l->edges, sizeof *edges);
  for (size_t e = 0; e < l->edges; e++) edges[e] = edge_of(l, e);
  int code = eda_srafs_place(edges, l->edges, rule, drawn, &l->srafs, error);
  free(edges);
  if (!code && l->srafs.count) limit_fragments(l);
  return code;
}

int epe_replace_srafs(epe_layer *l, eda_boxes srafs) {
  if (srafs.count == l->srafs.count &&
      (!srafs.count ||
       !memcmp(srafs.box, l->srafs.box, srafs.count * sizeof *srafs.box)))
    return 0;
  l->srafs.count = 0;
  for (size_t i = 0; i < srafs.count; i++)
    eda_box_list_add(&l->srafs, srafs.box[i]);
  limit_fragments(l);
  return 1;
}
