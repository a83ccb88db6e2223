/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the storage and comparison of masks. */
#include <correct/trial.h>

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

biases correct_biases_in(int32_t *all, size_t n) {
  return (biases){.w = all,
                  .aside = all + n,
                  .l = all + 2 * n,
                  .jog = all + 3 * n,
                  .end = all + 4 * n,
                  .part = (eda_part *)(all + 6 * n)};
}

void correct_trial_init(trial *t, size_t layers, size_t gates) {
  int32_t *all = eda_alloc(TRIAL_BIASES * gates, sizeof *all);
  *t = (trial){.layers = layers, .gates = gates};
  t->biases = correct_biases_in(all, gates);
  t->fragments = eda_alloc(layers, sizeof *t->fragments);
  t->shift = eda_alloc(layers, sizeof *t->shift);
  t->added = eda_alloc(layers, sizeof *t->added);
  t->cutouts = eda_alloc(layers, sizeof *t->cutouts);
  t->assists = eda_alloc(layers, sizeof *t->assists);
}

void correct_trial_clear(trial *t) {
  free(t->biases.w);
  for (size_t k = 0; t->shift && k < t->layers; k++) {
    free(t->shift[k]);
    free((eda_box *)t->added[k].box);
    free((eda_box *)t->cutouts[k].box);
    free((eda_box *)t->assists[k].box);
  }
  free(t->fragments);
  free(t->shift);
  free(t->added);
  free(t->cutouts);
  free(t->assists);
}

void correct_trial_cut(trial *t, size_t layer, size_t fragments) {
  t->fragments[layer] = fragments;
  t->shift[layer] = eda_alloc(fragments, sizeof *t->shift[layer]);
}

void correct_trial_set_boxes(eda_boxes *to, eda_boxes from) {
  if (from.count == to->count) {
    if (from.count)
      memmove((eda_box *)to->box, from.box, from.count * sizeof *from.box);
    return;
  }
  eda_box *copy = eda_alloc(from.count, sizeof *copy);
  if (from.count) memcpy(copy, from.box, from.count * sizeof *copy);
  free((eda_box *)to->box);
  *to = (eda_boxes){copy, from.count};
}

void correct_trial_set_both(eda_boxes *to, eda_boxes first, eda_boxes second) {
  eda_box_list all = {0};
  for (size_t i = 0; i < first.count; i++) eda_box_list_add(&all, first.box[i]);
  for (size_t i = 0; i < second.count; i++)
    eda_box_list_add(&all, second.box[i]);
  correct_trial_set_boxes(to, (eda_boxes){all.box, all.count});
  free(all.box);
}

void correct_trial_drop_boxes(eda_boxes *boxes, eda_box window) {
  eda_box *box = (eda_box *)boxes->box;
  size_t n = 0;
  for (size_t i = 0; i < boxes->count; i++)
    if (!eda_boxes_touch(box[i], window)) box[n++] = box[i];
  boxes->count = n;
}

void correct_trial_reset_boxes(eda_boxes *boxes, eda_box window,
                               eda_boxes begun) {
  eda_box_list all = {0};
  correct_trial_drop_boxes(boxes, window);
  for (size_t i = 0; i < boxes->count; i++)
    eda_box_list_add(&all, boxes->box[i]);
  for (size_t i = 0; i < begun.count; i++)
    if (eda_boxes_touch(begun.box[i], window))
      eda_box_list_add(&all, begun.box[i]);
  free((eda_box *)boxes->box);
  *boxes = (eda_boxes){all.box, all.count};
}

void correct_trial_copy(trial *to, const trial *from) {
  memcpy(to->biases.w, from->biases.w,
         TRIAL_BIASES * from->gates * sizeof(int32_t));
  for (size_t k = 0; k < from->layers; k++) {
    correct_trial_set_boxes(&to->added[k], from->added[k]);
    correct_trial_set_boxes(&to->cutouts[k], from->cutouts[k]);
    correct_trial_set_boxes(&to->assists[k], from->assists[k]);
    if (!from->shift[k]) continue;
    if (!to->shift[k]) correct_trial_cut(to, k, from->fragments[k]);
    memcpy(to->shift[k], from->shift[k], from->fragments[k] * sizeof(int32_t));
  }
}

static int numbers_differ(const int32_t *a, const int32_t *b, size_t n) {
  return memcmp(a, b, n * sizeof *a) != 0;
}

static int other_boxes(eda_boxes a, eda_boxes b) {
  return a.count != b.count ||
         (a.count && memcmp(a.box, b.box, a.count * sizeof *a.box) != 0);
}

int correct_trial_differs(const trial *a, const trial *b, size_t layer) {
  size_t n = a->gates;
  if (other_boxes(a->added[layer], b->added[layer]) ||
      other_boxes(a->cutouts[layer], b->cutouts[layer]) ||
      other_boxes(a->assists[layer], b->assists[layer]))
    return 1;
  if (a->shift[layer])
    return numbers_differ(a->shift[layer], b->shift[layer],
                          a->fragments[layer]);
  if (layer == EDA_ACTIVE)
    return numbers_differ(a->biases.w, b->biases.w, TRIAL_ACTIVE_BIASES * n);
  return layer == EDA_POLY &&
         numbers_differ(a->biases.l, b->biases.l, TRIAL_POLY_BIASES * n);
}
