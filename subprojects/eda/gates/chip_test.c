/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors of a chip in all eight orientations: own coordinates unit by
   unit, displacements of each gate, and invalid chips. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

enum { W = 6, L = 3, GATES = 8 };

static uint32_t state = 3;

static int32_t random_draw(int32_t low, int32_t high) {
  state = state * 1664525u + 1013904223u;
  return low + (int32_t)((state >> 8) % (uint32_t)(high - low + 1));
}

/* Return gate k, with flips and axis from the bits of k. */
static eda_chip_gate lying(int k, int32_t x, int32_t y) {
  uint8_t axis = k & 4 ? EDA_Y : EDA_X;
  return (eda_chip_gate){
      .box = {x, y, x + (axis == EDA_X ? L : W), y + (axis == EDA_X ? W : L)},
      .axis = axis,
      .flip = (uint8_t)((k & 1 ? EDA_FLIP_L : 0) | (k & 2 ? EDA_FLIP_W : 0))};
}

static int box_has(eda_box b, int32_t x, int32_t y) {
  return x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1;
}

/* Compute the layout position of the unit square (l, w) of a gate. */
static void unit_of(const eda_chip_gate *g, int32_t l, int32_t w, int32_t *x,
                    int32_t *y) {
  if (g->flip & EDA_FLIP_L) l = L - 1 - l;
  if (g->flip & EDA_FLIP_W) w = W - 1 - w;
  *x = g->box.x0 + (g->axis == EDA_X ? l : w);
  *y = g->box.y0 + (g->axis == EDA_X ? w : l);
}

static void test_place(void) {
  for (int n = 0; n < 80; n++) {
    eda_chip_gate g = lying(n % 8, random_draw(-50, 50), random_draw(-50, 50));
    int32_t l = random_draw(-5, 5), w = random_draw(-5, 5);
    eda_box own = {l, w, l + random_draw(1, 4), w + random_draw(1, 4)};
    eda_box placed = eda_chip_place(g.box, g.axis, g.flip, own);
    for (l = -12; l < 12; l++)
      for (w = -12; w < 12; w++) {
        int32_t x, y;
        unit_of(&g, l, w, &x, &y);
        g_assert_cmpint(box_has(placed, x, y), ==, box_has(own, l, w));
      }
    eda_box back = eda_chip_own(g.box, g.axis, g.flip, placed);
    g_assert_cmpmem(&back, sizeof back, &own, sizeof own);
  }
}

/* A valid chip of eight gates and one mask with two parts, an added shape and a
   removed one. */
typedef struct whole {
  eda_chip chip;
  eda_chip_gate gate[GATES];
  eda_chip_mask mask[2];
  eda_part part[2];
  eda_chip_box box[2];
  char *layer[2];
  uint8_t corrected[2];
} whole;

static void whole_make(whole *t) {
  *t = (whole){.mask = {{.w = 3,
                         .aside = 2,
                         .l = -1,
                         .jog = 4,
                         .end = {5, 7},
                         .parts = 2,
                         .boxes = 2}},
               .part = {{-EDA_PART_END, 2, 1}, {4, W + 3, -2}},
               .box = {{{-1, 4, 2, 9}, 0, 0}, {{1, 1, 3, 2}, 1, 1}}};
  /* Two rows, so that the order is by y, then by x. */
  for (int k = 0; k < GATES; k++)
    t->gate[k] = lying(k, 20 * (k % 4), 20 * (k / 4));
  t->chip = (eda_chip){.layout = (const eda_layout *)t, /* the layout is not
                                                           used */
                       .grid = 1,
                       .layers = 2,
                       .layer = t->layer,
                       .corrected = t->corrected,
                       .count = GATES,
                       .gate = t->gate,
                       .masks = 2,
                       .prints = 1,
                       .parts = 2,
                       .boxes = 2,
                       .mask = t->mask,
                       .part = t->part,
                       .box = t->box};
}

static void test_find(void) {
  whole t;
  whole_make(&t);
  for (size_t k = 0; k < GATES; k++) {
    eda_box b = t.gate[k].box;
    g_assert_cmpuint(eda_chip_find(&t.chip, b), ==, k);
    for (int side = 0; side < 4; side++) {
      eda_box other = b;
      (&other.x0)[side]++;
      g_assert_true(eda_chip_find(&t.chip, other) == SIZE_MAX);
    }
  }
  g_assert_true(eda_chip_find(&t.chip, (eda_box){-9, 0, 0, 9}) == SIZE_MAX);
  g_assert_true(eda_chip_find(&t.chip, (eda_box){0, 99, 3, 105}) == SIZE_MAX);
  t.chip.count = 0;
  g_assert_true(eda_chip_find(&t.chip, t.gate[0].box) == SIZE_MAX);
}

/* Return the displacement by all parts that contain the position `at`, in grid
   steps from the LOW end. */
static int32_t by_at(const eda_part *part, int n, int32_t at) {
  int32_t by = 0;
  for (int k = 0; k < n; k++)
    if (part[k].from <= at && at < part[k].to) by += part[k].by;
  return by;
}

static void test_moved(void) {
  whole t;
  whole_make(&t);
  eda_box box[GATES + 1];
  for (int k = 0; k < GATES; k++) box[GATES - k] = t.gate[k].box;
  box[0] = (eda_box){0, 0, 3, 5}; /* a box that is not in the chip */
  const eda_gates window = {.layers = 2, .count = GATES + 1, .box = box};
  eda_moved *to = eda_chip_moved(&t.chip, &window);
  g_assert_cmpint(to->w[0] | to->l[0] | to->end[0] | to->part[0].by, ==, 0);
  for (size_t k = 0; k < GATES; k++) {
    size_t i = GATES - k;
    const eda_chip_gate *g = &t.gate[k];
    int back = (g->flip & EDA_FLIP_W) != 0;
    g_assert_cmpint(to->w[i], ==, 3);
    g_assert_cmpint(to->l[i], ==, -1);
    g_assert_cmpint(to->jog[i], ==, 4);
    g_assert_cmpint(to->aside[i], ==, back ? -2 : 2);
    g_assert_cmpint(to->end[2 * i], ==, back ? 7 : 5);
    g_assert_cmpint(to->end[2 * i + 1], ==, back ? 5 : 7);
    g_assert_cmpint(to->flip[i], ==, g->flip);
    const eda_part *part = to->part + EDA_PARTS * i;
    g_assert_cmpint(part[0].to, <=, part[1].from);
    for (int32_t w = -20; w < 30; w++)
      g_assert_cmpint(by_at(part, EDA_PARTS, w), ==,
                      by_at(t.part, 2, back ? W - 1 - w : w));
    for (int b = 0; b < 2; b++) {
      const eda_box_list *list = b ? &to->cutouts[1] : &to->added[0];
      eda_box want = eda_chip_place(g->box, g->axis, g->flip, t.box[b].box);
      g_assert_cmpuint(list->count, ==, GATES);
      g_assert_cmpmem(&list->box[GATES - 1 - k], sizeof want, &want,
                      sizeof want);
    }
  }
  g_assert_cmpuint(to->added[1].count + to->cutouts[0].count, ==, 0);
  eda_moved_free(to);
}

static void assert_refused(whole *t, const char *why) {
  opc_error error = {0};
  g_assert_cmpint(eda_chip_check(&t->chip, &error), ==, OPC_FAILED);
  if (!strstr(error.message, why)) g_error("%s: %s", why, error.message);
  whole_make(t);
}

static void test_check(void) {
  whole t;
  opc_error error = {0};
  whole_make(&t);
  if (eda_chip_check(&t.chip, &error)) g_error("%s", error.message);
  g_assert_cmpint(eda_chip_check(NULL, &error), ==, OPC_FAILED);
  t.chip.layout = NULL, assert_refused(&t, "the layout");
  t.chip.top = -1, assert_refused(&t, "the layout");
  t.chip.grid = 0, assert_refused(&t, "the grid is missing");
  t.chip.layers = 1, assert_refused(&t, "missing");
  t.chip.layer = NULL, assert_refused(&t, "missing");
  t.chip.corrected = NULL, assert_refused(&t, "missing");
  t.chip.gate = NULL, assert_refused(&t, "missing");
  t.chip.mask = NULL, assert_refused(&t, "missing");
  t.gate[3].box.x1 = t.gate[3].box.x0,
  assert_refused(&t, "transistor 4 has no size");
  t.gate[3].box.y1 = t.gate[3].box.y0,
  assert_refused(&t, "transistor 4 has no size");
  t.gate[4].box = t.gate[3].box, assert_refused(&t, "5 is out of order");
  t.gate[2].box.y0 -= 1, assert_refused(&t, "3 is out of order");
  t.gate[5].mask = 2, assert_refused(&t, "6 has no mask");
  t.gate[5].print = 1, assert_refused(&t, "6 has no mask or no class");
  t.gate[6].type = EDA_PMOS + 1, assert_refused(&t, "7 has no valid type");
  t.gate[6].axis = EDA_Y + 1,
  assert_refused(&t, "7 has no valid type, axis or flip");
  t.gate[6].flip = 1 + (EDA_FLIP_L | EDA_FLIP_W),
  assert_refused(&t, "7 has no valid type");
  t.mask[1].parts = EDA_PARTS + 1, t.chip.parts = EDA_PARTS + 1;
  assert_refused(&t, "mask 2 refers to parts");
  t.mask[1].part = 1, t.mask[1].parts = 2,
  assert_refused(&t, "mask 2 refers to parts");
  t.mask[1].box = 2, t.mask[1].boxes = 1,
  assert_refused(&t, "mask 2 refers to parts");
  t.box[1].layer = 2, assert_refused(&t, "box 2 has no valid layer");
  /* The largest allowed numbers. */
  t.mask[1] = (eda_chip_mask){.part = 1, .parts = 1, .box = 1, .boxes = 1};
  g_assert_cmpint(eda_chip_check(&t.chip, &error), ==, OPC_OK);
}

/* Records survive the growth of their file, which has no name. */
static void test_reserve(void) {
  opc_error error;
  g_autoptr(GError) fault = NULL;
  g_autofree char *folder = g_dir_make_tmp("chip-XXXXXX", &fault);
  g_assert_no_error(fault);
  g_setenv("TMPDIR", folder, TRUE);
  eda_chip *c = eda_alloc(1, sizeof *c);
  for (size_t n = 1; n < 300000; n = 3 * n + 1) {
    if (eda_chip_reserve(c, n, &error)) g_error("%s", error.message);
    for (; c->count < n; c->count++)
      c->gate[c->count].mask = (uint32_t)c->count;
    for (size_t i = 0; i < n; i++) g_assert_cmpuint(c->gate[i].mask, ==, i);
  }
  g_assert_cmpint(g_rmdir(folder), ==, 0);
  eda_chip_free(c);
  c = eda_alloc(1, sizeof *c);
  g_assert_cmpint(eda_chip_reserve(c, 1, &error), ==, OPC_IO);
  g_assert_nonnull(strstr(error.message, folder));
  g_assert_nonnull(strstr(error.message, "TMPDIR"));
  eda_chip_free(c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/chip/place", test_place);
  g_test_add_func("/chip/find", test_find);
  g_test_add_func("/chip/moved", test_moved);
  g_test_add_func("/chip/check", test_check);
  g_test_add_func("/chip/reserve", test_reserve);
  return g_test_run();
}
