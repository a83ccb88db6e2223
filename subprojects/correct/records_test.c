/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests which parts of added shapes the record of a corrected transistor
   contains, and the classes of equal masked environments. */
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>

#include "environments/correction.h"

enum { LAYERS = 2, RADIUS = 1000 };

static const eda_box gate = {0, 0, 100, 60};

typedef struct kept {
  opc_bytes bytes;
  GByteArray *all;
} kept;

static void kept_add(opc_bytes *bytes, const void *from, size_t size) {
  g_byte_array_append(((kept *)bytes)->all, from, (guint)size);
}

/* Return the shape in the record of a transistor to which the regulator added
   `shape`; an empty box if there is none. `rule`: smallest width of the mask,
   nm. */
static eda_box recorded(eda_box shape, double rule, double grid) {
  eda_box box = gate;
  uint8_t axis = EDA_X;
  uint32_t place = 0, flags = 0;
  eda_chip chip = {.grid = grid};
  const correct_settings with = {
      .rules = {[EDA_RULE_WIDTH] = rule, [EDA_RULE_EDGE] = rule / 2}};
  const work w = {.with = &with, .radius = RADIUS, .chip = &chip};
  const eda_gates gates = {
      .grid = grid, .count = 1, .layers = LAYERS, .box = &box, .axis = &axis};
  eda_boxes begun[2 * LAYERS] = {{0}};
  loop l = {.gates = &gates,
            .begun = begun,
            .guard.flags = &flags,
            .measured.flags = &flags};
  opc_error error;
  correct_trial_init(&l.now, LAYERS, 1);
  eda_performance_init(&l.before, 1);
  eda_performance_init(&l.design, 1);
  eda_performance_init(&l.measured.performance, 1);
  correct_trial_set_boxes(&l.now.added[EDA_ACTIVE], (eda_boxes){&shape, 1});
  kept out = {{.add = kept_add}, g_byte_array_new()};
  g_assert_cmpint(correction_put(&w, &l, &place, &out.bytes, &error), ==,
                  OPC_OK);
  corrected one;
  const char *at = correction_begin(NULL, (const char *)out.all->data);
  const char *end = correction_next(at, &one);
  g_assert_true(end == (const char *)out.all->data + out.all->len);
  eda_chip_box b = {0};
  g_assert_cmpuint(one.mask.boxes, <=, 1);
  if (one.mask.boxes) memcpy(&b, end - sizeof b, sizeof b);
  g_byte_array_unref(out.all);
  eda_performance_clear(&l.before);
  eda_performance_clear(&l.design);
  eda_performance_clear(&l.measured.performance);
  correct_trial_clear(&l.now);
  return one.mask.boxes ? eda_chip_place(gate, EDA_X, 0, b.box) : b.box;
}

/* A shape is clipped at the radius. A remnant that the rules forbid is omitted;
   a small shape within the radius is not a remnant. */
static void test_clipped(void) {
  static const struct {
    eda_box shape, want;
    double rule, grid;
  } cases[] = {
      {{20, 900, 80, 916}, {20, 900, 80, 916}, 40, 1},
      {{20, 1044, 80, 1060}, {20, 1044, 80, 1060}, 40, 1},
      {{20, 1010, 80, 1160}, {20, 1010, 80, 1060}, 40, 1},
      {{20, 1044, 80, 1200}, {0}, 40, 1},
      {{20, 1044, 80, 1200}, {20, 1044, 80, 1060}, 16, 1},
      {{20, 1010, 80, 1160}, {0}, 40, 0.5},
      {{1085, 0, 1200, 60}, {0}, 40, 1},
      {{-1100, 0, -960, 60}, {-1000, 0, -960, 60}, 40, 1},
      {{-1100, 0, -961, 60}, {0}, 40, 1},
      {{20, 1061, 80, 1200}, {0}, 40, 1},
  };
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    eda_box b = recorded(cases[k].shape, cases[k].rule, cases[k].grid);
    g_test_message("case %zu", k);
    g_assert_cmpmem(&b, sizeof b, &cases[k].want, sizeof b);
  }
}

/* ---- classes of masked environments ---- */

enum { GATES = 600, MARGIN = 30 };

static int is_near(const eda_chip_gate *g, const eda_chip_gate *o) {
  return o->box.x0 <= g->box.x1 + MARGIN && o->box.x1 >= g->box.x0 - MARGIN &&
         o->box.y0 <= g->box.y1 + MARGIN && o->box.y1 >= g->box.y0 - MARGIN;
}

/* Describe the neighbours of transistor i, seen from its lower left corner. All
   transistors have the same axis and no flip. The caller frees the text. */
static char *neighbours_of(const eda_chip *c, size_t i) {
  const eda_chip_gate *g = &c->gate[i];
  GString *text = g_string_new(NULL);
  for (size_t k = 0; k < c->count; k++) { /* sorted by place */
    const eda_chip_gate *o = &c->gate[k];
    if (is_near(g, o))
      g_string_append_printf(text, "%d %d %d %d %u,", o->box.x0 - g->box.x0,
                             o->box.y0 - g->box.y0, o->box.x1 - g->box.x0,
                             o->box.y1 - g->box.y0, o->mask);
  }
  return g_string_free(text, FALSE);
}

/* Make rows of transistors of two heights and two masks, so that environments
   repeat. The rare tall transistors reach into the next bands. */
static void fill_rows(eda_chip *c) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(5);
  for (int i = 0; i < GATES; i++) {
    int x = i % 20 * 40, y = i / 20 * 35,
        high = g_rand_int_range(rand, 0, 99) ? 20 : 150;
    c->gate[i] =
        (eda_chip_gate){.box = {x, y, x + 10, y + high},
                        .mask = (uint32_t)(g_rand_int_range(rand, 0, 30) == 0)};
  }
}

/* For any height of the bands, the classes equal those found by comparing all
   transistors with all others. */
static void test_prints(void) {
  opc_error error;
  const opc_host host = {0};
  eda_chip *c = eda_alloc(1, sizeof *c);
  if (eda_chip_reserve(c, GATES, &error)) g_error("%s", error.message);
  c->count = GATES;
  fill_rows(c);
  uint32_t want[GATES], classes = 0;
  GHashTable *known =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < GATES; i++) {
    char *text = neighbours_of(c, i);
    gpointer of = g_hash_table_lookup(known, text);
    want[i] = of ? GPOINTER_TO_UINT(of) - 1 : classes;
    if (!of)
      g_hash_table_insert(known, g_strdup(text), GUINT_TO_POINTER(++classes));
    g_free(text);
  }
  g_hash_table_destroy(known);
  g_assert_cmpuint(classes, >, 20);
  g_assert_cmpuint(classes, <, GATES / 2);
  for (int32_t window = 1; window < 100000; window *= 7) {
    work w = {.host = &host,
              .margin = MARGIN,
              .window = window,
              .tallest = 150,
              .chip = c,
              .prints = work_sums(),
              .sums = g_ptr_array_new_with_free_func(g_free)};
    prints_find(&w);
    g_assert_cmpuint(c->prints, ==, classes);
    for (size_t i = 0; i < GATES; i++)
      g_assert_cmpuint(c->gate[i].print, ==, want[i]);
    prints_clear(&w);
    g_hash_table_destroy(w.prints);
    g_ptr_array_free(w.sums, TRUE);
    free(w.print);
    free(w.print_first);
    free(w.tried);
  }
  eda_chip_free(c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/records/clipped", test_clipped);
  g_test_add_func("/records/prints", test_prints);
  return g_test_run();
}
