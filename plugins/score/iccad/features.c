/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the features of the target that are printed, bridged or broken. A
   feature is a set of pixels that are connected by their sides. */
#include <eda/memory.h>
#include <stdlib.h>

#include "iccad.h"

/* ---- connected pixels ---- */

static int32_t set_root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static int32_t sets_join(int32_t *parent, int32_t a, int32_t b) {
  a = set_root(parent, a);
  b = set_root(parent, b);
  return a < b ? (parent[b] = a) : (parent[a] = b);
}

/* Label the connected sets. number[i] becomes the number of the set of pixel i,
   from 0, or -1 if the pixel is clear. Return the number of sets. */
static int32_t features_label(const iccad_tile *t, const uint8_t *pixels,
                              int32_t *number) {
  int32_t side = t->side, n = side * side, count = 0;
  for (int32_t i = 0; i < n; i++) {
    number[i] = pixels[i] ? i : -1;
    if (!pixels[i]) continue;
    if (i % side && pixels[i - 1]) sets_join(number, i, i - 1);
    if (i >= side && pixels[i - side]) sets_join(number, i, i - side);
  }
  /* The root of a set is the first of its pixels. */
  for (int32_t i = 0; i < n; i++)
    if (pixels[i] && number[i] != i) number[i] = set_root(number, i);
  int32_t *of = eda_alloc((size_t)n, sizeof *of);
  for (int32_t i = 0; i < n; i++)
    if (pixels[i] && number[i] == i) of[i] = count++;
  for (int32_t i = 0; i < n; i++)
    if (pixels[i]) number[i] = of[number[i]];
  free(of);
  return count;
}

/* ---- features and pieces ---- */

typedef struct meeting {
  int32_t feature, piece;
} meeting;

static int in_order(const void *a, const void *b) {
  const meeting *p = a, *q = b;
  return p->feature != q->feature
             ? (p->feature > q->feature) - (p->feature < q->feature)
             : (p->piece > q->piece) - (p->piece < q->piece);
}

/* Find all pairs of a feature and a printed piece with a common pixel, each
   pair once. */
static size_t features_meet(const iccad_tile *t, const int32_t *feature,
                            const int32_t *piece, meeting **out) {
  size_t n = (size_t)t->side * (size_t)t->side, count = 0, capacity = 0,
         kept = 0;
  meeting *m = NULL;
  for (size_t i = 0; i < n; i++) {
    if (feature[i] < 0 || piece[i] < 0) continue;
    meeting one = {feature[i], piece[i]};
    if (count && !in_order(&m[count - 1], &one)) continue;
    eda_grow(&m, &capacity, count + 1, sizeof *m);
    m[count++] = one;
  }
  if (count) qsort(m, count, sizeof *m, in_order);
  for (size_t i = 0; i < count; i++)
    if (!i || in_order(&m[i - 1], &m[i])) m[kept++] = m[i];
  *out = m;
  return kept;
}

iccad_features iccad_compare(const iccad_tile *t, const uint8_t *target,
                             const uint8_t *print) {
  size_t n = (size_t)t->side * (size_t)t->side;
  int32_t *feature = eda_alloc(n, sizeof *feature);
  int32_t *piece = eda_alloc(n, sizeof *piece);
  size_t features = (size_t)features_label(t, target, feature);
  size_t pieces = (size_t)features_label(t, print, piece);
  uint32_t *of_feature = eda_alloc(features, sizeof *of_feature);
  uint32_t *of_piece = eda_alloc(pieces, sizeof *of_piece);
  meeting *m;
  size_t count = features_meet(t, feature, piece, &m);
  iccad_features out = {0};
  for (size_t i = 0; i < count; i++) {
    out.broken += of_feature[m[i].feature]++ > 0;
    out.bridged += of_piece[m[i].piece]++ > 0;
  }
  for (size_t i = 0; i < features; i++) out.lost += !of_feature[i];
  for (size_t i = 0; i < pieces; i++) out.extra += !of_piece[i];
  free(m);
  free(of_feature);
  free(of_piece);
  free(feature);
  free(piece);
  return out;
}
