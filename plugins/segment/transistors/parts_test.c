/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests which transistor owns the edges of a line with two transistors, unit by
   unit, for random lengths. */
#include <eda/gates.h>
#include <eda/layout.h>
#include <math.h>

#include "tools/devel/testing.h"

enum { L = 65 };

static uint32_t state = 17;

static int32_t by_lot(int32_t low, int32_t high) {
  state = state * 1664525u + 1013904223u;
  return low + (int32_t)((state >> 8) % (uint32_t)(high - low + 1));
}

/* A line over two actives. The line starts `before` ahead of the first active,
   which begins at 0, and ends `past` beyond the second active, which begins
   `gap` after the end of the first. The actives are `width` long along the line
   and extend `beside` beyond both sides of the line. */
typedef struct drawing {
  int32_t before, past, width[2], gap, beside[2];
  int32_t overhang, line_end, end;
  int turned; /* 1: the line is along x */
} drawing;

static drawing parts_draw(void) {
  drawing d = {.before = by_lot(20, 260),
               .past = by_lot(20, 260),
               .width = {by_lot(90, 300), by_lot(90, 300)},
               .gap = by_lot(40, 300),
               .beside = {by_lot(10, 200), by_lot(10, 200)},
               .overhang = by_lot(0, 160),
               .line_end = by_lot(0, 250),
               .turned = by_lot(0, 1)};
  d.end = d.width[0] + d.gap + d.width[1] + d.past;
  return d;
}

static void box_put(eda_layout *l, int32_t cell, const char *layer, int turned,
                    eda_box b) {
  opc_error error;
  if (turned) b = (eda_box){b.y0, b.x0, b.y1, b.x1};
  g_assert_cmpint(eda_layout_add_box(
                      l, cell, eda_layout_layer(l, layer, &error), b, &error),
                  ==, OPC_OK);
}

static eda_layout *layout_of(const drawing *d) {
  opc_error error;
  eda_layout *l = eda_layout_new(1, &error);
  int32_t cell = eda_layout_cell(l, "TOP", &error), x0 = -d->beside[0];
  int32_t x1 = L + d->beside[1], second = d->width[0] + d->gap;
  box_put(l, cell, "active", d->turned, (eda_box){x0, 0, x1, d->width[0]});
  box_put(l, cell, "active", d->turned,
          (eda_box){x0, second, x1, second + d->width[1]});
  box_put(l, cell, "nimplant", d->turned, (eda_box){-500, -900, 900, 1900});
  box_put(l, cell, "poly", d->turned, (eda_box){0, -d->before, L, d->end});
  return l;
}

/* Return the gate that owns the sides of the line from `at` to at + 1. */
static int owner(const drawing *d, int32_t at) {
  int32_t corner = MAX(d->overhang, d->line_end);
  int32_t low = d->before <= corner ? -d->before : -d->overhang;
  int32_t top = d->end - d->past;
  int32_t high = d->past <= corner ? d->end : top + d->overhang;
  int32_t first = d->width[0] + MIN(d->overhang, d->gap / 2);
  int32_t second = d->width[0] + d->gap - MIN(d->overhang, d->gap - d->gap / 2);
  return at >= low && at < first ? 0 : at >= second && at < high ? 1 : -1;
}

/* Assert the owner and extent of the fragment from f to `to`. */
static void assert_piece(const drawing *d, const eda_fragment *f,
                         eda_point to) {
  eda_point a = f->from, b = to;
  if (d->turned) a = (eda_point){a.y, a.x}, b = (eda_point){b.y, b.x};
  if (a.y == b.y) {
    int low = a.y == -d->before;
    int is_end = low ? d->before <= d->line_end : d->past <= d->line_end;
    g_assert_true(low || a.y == d->end);
    g_assert_cmpint(f->gate, ==, is_end ? !low : -1);
    g_assert_cmpint(f->role, ==,
                    !is_end ? EDA_FIXED
                    : low   ? EDA_END_LOW
                            : EDA_END_HIGH);
    return;
  }
  g_assert_true(a.x == 0 || a.x == L);
  for (int32_t at = MIN(a.y, b.y); at < MAX(a.y, b.y); at++) {
    g_assert_cmpint(f->gate, ==, owner(d, at));
    g_assert_cmpint(f->role, ==,
                    f->gate < 0 ? EDA_FIXED
                    : a.x == 0  ? EDA_L_LOW
                                : EDA_L_HIGH);
  }
}

static void test_line(void) {
  for (int n = 0; n < 150; n++) {
    drawing d = parts_draw();
    opc_error error;
    void *out = NULL;
    g_autofree char *p = g_strdup_printf("{ overhang: %d nm, line_end: %d nm }",
                                         d.overhang, d.line_end);
    g_autoptr(opc_module) m = opc_test_module("segment.transistors", p, &error);
    eda_layout *l = layout_of(&d);
    opc_test_input(m, "layout", l);
    if (opc_test_run(m, &out, &error)) g_error("%s", error.message);
    const eda_gates *g = out;
    g_assert_cmpuint(g->count, ==, 2);
    const eda_edges *e = &g->edges[EDA_POLY];
    g_assert_cmpuint(e->polygons, ==, 1);
    for (uint32_t i = 0; i < e->start[1]; i++)
      assert_piece(&d, &e->fragments[i],
                   e->fragments[i + 1 < e->start[1] ? i + 1 : 0].from);
    const int32_t ends[2] = {d.before, d.past};
    for (int i = 0; i < 2; i++) {
      g_assert_cmpint(g->axis[i], ==, d.turned ? EDA_Y : EDA_X);
      g_assert_cmpfloat(g->width[i], ==, d.width[i]);
      g_assert_cmpfloat(g->length[i], ==, L);
      g_assert_cmpfloat(g->extension[2 * i + i], ==,
                        ends[i] <= d.line_end ? ends[i] : INFINITY);
      g_assert_true(isinf(g->extension[2 * i + !i]));
      for (int side = 0; side < 2; side++)
        g_assert_cmpfloat(g->space[2 * i + side], ==,
                          2 * MAX(d.beside[side], L));
    }
    opc_test_release(m, &out);
    eda_layout_free(l);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/parts/line", test_line);
  return g_test_run();
}
