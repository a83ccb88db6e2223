/* SPDX-License-Identifier: BSD-3-Clause */
/* Allocation and release of gates, masks and their performance arrays. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 4096 }; /* size of a block of texts, bytes */

/* ---- gates ---- */

eda_gates *eda_gates_new(size_t layers, size_t count) {
  static uint64_t made; /* number of gates objects created; atomic */
  eda_gates *g = eda_alloc(1, sizeof *g);
  g->serial = __atomic_add_fetch(&made, 1, __ATOMIC_RELAXED);
  g->layers = layers;
  g->layer = eda_alloc(layers, sizeof *g->layer);
  g->corrected = eda_alloc(layers, sizeof *g->corrected);
  g->drawn = eda_alloc(layers, sizeof *g->drawn);
  g->edges = eda_alloc(layers, sizeof *g->edges);
  g->count = count;
  g->box = eda_alloc(count, sizeof *g->box);
  g->type = eda_alloc(count, sizeof *g->type);
  g->axis = eda_alloc(count, sizeof *g->axis);
  g->length = eda_alloc(count, sizeof *g->length);
  g->width = eda_alloc(count, sizeof *g->width);
  g->space = eda_alloc(2 * count, sizeof *g->space);
  g->extension = eda_alloc(2 * count, sizeof *g->extension);
  g->instance = eda_alloc(count, sizeof *g->instance);
  g->cell = eda_alloc(count, sizeof *g->cell);
  g->number = eda_alloc(count, sizeof *g->number);
  g->texts = g_string_chunk_new(CHUNK);
  return g;
}

void eda_gates_free(void *gates) {
  eda_gates *g = gates;
  if (!g) return;
  for (size_t k = 0; k < g->layers; k++) {
    eda_shapes_clear(&g->drawn[k]);
    free(g->edges[k].start);
    free(g->edges[k].fragments);
  }
  void *const arrays[] = {g->layer, g->corrected, g->drawn,     g->edges,
                          g->box,   g->type,      g->axis,      g->length,
                          g->width, g->space,     g->extension, g->instance,
                          g->cell,  g->number,    g->goal,      g->flavour};
  for (size_t i = 0; i < G_N_ELEMENTS(arrays); i++) free(arrays[i]);
  g_string_chunk_free(g->texts);
  free(g);
}

char *eda_gates_text(eda_gates *gates, const char *text) {
  return g_string_chunk_insert_const(gates->texts, text);
}

static void gates_copy_goal(eda_gates *to, size_t i, const eda_gates *from,
                            size_t j) {
  eda_goal goal = eda_gates_goal(from, j);
  if (!to->goal) {
    if (!goal.given) return;
    to->goal = eda_alloc(to->count, sizeof *to->goal);
    for (size_t k = 0; k < to->count; k++) to->goal[k] = eda_goal_none;
  }
  to->goal[i] = goal;
}

const char *eda_gates_flavour(const eda_gates *g, size_t i) {
  return g->flavour && g->flavour[i] ? g->flavour[i] : "";
}

static void gates_copy_flavour(eda_gates *to, size_t i, const eda_gates *from,
                               size_t j) {
  const char *flavour = eda_gates_flavour(from, j);
  if (!*flavour) return;
  if (!to->flavour) to->flavour = eda_alloc(to->count, sizeof *to->flavour);
  to->flavour[i] = eda_gates_text(to, flavour);
}

void eda_gates_copy(eda_gates *to, size_t i, const eda_gates *from, size_t j) {
  to->type[i] = from->type[j];
  to->axis[i] = from->axis[j];
  to->length[i] = from->length[j];
  to->width[i] = from->width[j];
  for (size_t side = 0; side < 2; side++) {
    to->space[2 * i + side] = from->space[2 * j + side];
    to->extension[2 * i + side] = from->extension[2 * j + side];
  }
  gates_copy_goal(to, i, from, j);
  gates_copy_flavour(to, i, from, j);
}

int eda_gates_layer(const eda_gates *gates, const char *name) {
  for (size_t k = 0; k < gates->layers; k++)
    if (!strcmp(gates->layer[k], name)) return (int)k;
  return -1;
}

/* ---- performance ---- */

enum {
  FIGURES = 6
}; /* consecutive array pointers in eda_performance, from `ion` on */

void eda_performance_init(eda_performance *p, size_t n) {
  p->count = n;
  for (int k = 0; k < FIGURES; k++)
    (&p->ion)[k] = eda_alloc_shared(n, sizeof(double));
  p->outside = eda_alloc_shared(n, sizeof *p->outside);
}

void eda_performance_copy(eda_performance *to, const eda_performance *from) {
  for (int k = 0; k < FIGURES && from->count; k++)
    memcpy((&to->ion)[k], (&from->ion)[k], from->count * sizeof(double));
  if (from->count) memcpy(to->outside, from->outside, from->count);
}

void eda_performance_take(eda_performance *to, size_t i,
                          const eda_performance *from, size_t j) {
  for (int k = 0; k < FIGURES; k++) (&to->ion)[k][i] = (&from->ion)[k][j];
  to->outside[i] = from->outside[j];
}

void eda_performance_one(eda_performance *to, const eda_performance *from,
                         size_t i) {
  eda_performance_take(to, i, from, i);
}

void eda_performance_clear(eda_performance *p) {
  for (int k = 0; k < FIGURES; k++) eda_free((&p->ion)[k]);
  eda_free(p->outside);
  *p = (eda_performance){0};
}

/* ---- masks ---- */

eda_moved *eda_moved_new(size_t layers, size_t gates) {
  eda_moved *m = eda_alloc(1, sizeof *m);
  *m = (eda_moved){.layers = layers, .gates = gates};
  m->w = eda_alloc(gates, sizeof *m->w);
  m->aside = eda_alloc(gates, sizeof *m->aside);
  m->l = eda_alloc(gates, sizeof *m->l);
  m->jog = eda_alloc(gates, sizeof *m->jog);
  m->end = eda_alloc(2 * gates, sizeof *m->end);
  m->part = eda_alloc(EDA_PARTS * gates, sizeof *m->part);
  m->flip = eda_alloc(gates, sizeof *m->flip);
  m->added = eda_alloc(layers, sizeof *m->added);
  m->cutouts = eda_alloc(layers, sizeof *m->cutouts);
  m->seen = eda_alloc(gates, sizeof *m->seen);
  return m;
}

void eda_moved_free(eda_moved *m) {
  if (!m) return;
  for (size_t k = 0; k < m->layers; k++) {
    free(m->added[k].box);
    free(m->cutouts[k].box);
  }
  free(m->w);
  free(m->aside);
  free(m->l);
  free(m->jog);
  free(m->end);
  free(m->part);
  free(m->flip);
  free(m->added);
  free(m->cutouts);
  free(m->seen);
  free(m);
}

eda_mask *eda_mask_new(const eda_gates *gates) {
  eda_mask *m = eda_alloc(1, sizeof *m);
  m->gates = gates;
  m->layers = gates->layers;
  m->shapes = eda_alloc(gates->layers, sizeof *m->shapes);
  m->print = eda_alloc(gates->layers, sizeof *m->print);
  m->drawn_print = eda_alloc(gates->layers, sizeof *m->drawn_print);
  return m;
}

static void drop_violations(eda_mask *m) {
  for (size_t i = 0; i < m->n_violations; i++)
    free((char *)m->violations[i].rule);
  free(m->violations);
}

void eda_mask_set_violations(eda_mask *m, const eda_violation *v, size_t n) {
  drop_violations(m);
  m->violations = eda_alloc(n, sizeof *v);
  m->n_violations = n;
  for (size_t i = 0; i < n; i++) {
    size_t bytes = strlen(v[i].rule) + 1;
    m->violations[i] = v[i];
    m->violations[i].rule = memcpy(eda_alloc(bytes, 1), v[i].rule, bytes);
  }
}

void eda_mask_free(void *mask) {
  eda_mask *m = mask;
  if (!m) return;
  for (size_t k = 0; k < m->layers; k++) {
    eda_shapes_clear(&m->shapes[k]);
    eda_field_clear(&m->print[k]);
    eda_field_clear(&m->drawn_print[k]);
  }
  free(m->shapes);
  free(m->print);
  free(m->drawn_print);
  drop_violations(m);
  eda_performance_clear(&m->design);
  eda_performance_clear(&m->before);
  eda_performance_clear(&m->after);
  free(m->flags);
  eda_moved_free(m->moved);
  eda_mask_free(m->flat);
  if (m->own) eda_chip_free(m->chip);
  free(m->count);
  eda_gates_free(m->own);
  free(m);
}
