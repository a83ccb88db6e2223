/* SPDX-License-Identifier: BSD-3-Clause */
/* A mask by classes: visits of all strips and classes, the flat mask, and
   files. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

enum { COUNT = 6, CLASSES = 3 };

/* Lower edges, and the classes, of transistors 60 by 200. Strips begin at 0,
   4000 and 8000. */
static const int32_t lows[COUNT] = {100, 3999, 4000, 7999, 8000, 9000};
static const uint32_t classes[COUNT] = {0, 1, 0, 2, 1, 0};

static eda_layout *layout;
static double reach_last;

static eda_box box_of(int i) {
  return (eda_box){100 * i, lows[i], 100 * i + 60, lows[i] + 200};
}

/* Return a chip without transistors. */
static eda_chip *chip_empty(void) {
  eda_chip *c = eda_alloc(1, sizeof *c);
  *c = (eda_chip){.layout = layout,
                  .segment = {.grid = 1},
                  .grid = 1,
                  .extent = {0, 0, 300000, 10000},
                  .layers = 2};
  c->layer = eda_alloc(2, sizeof *c->layer);
  c->layer[0] = strdup("poly");
  c->layer[1] = strdup("active");
  c->corrected = eda_alloc(2, 1);
  c->corrected[0] = c->corrected[1] = 1;
  return c;
}

static eda_chip *chip_make(void) {
  eda_chip *c = chip_empty();
  c->count = COUNT;
  c->masks = c->prints = CLASSES;
  c->parts = c->boxes = 2;
  c->gate = eda_alloc(COUNT, sizeof *c->gate);
  c->mask = eda_alloc(CLASSES, sizeof *c->mask);
  c->part = eda_alloc(2, sizeof *c->part);
  c->box = eda_alloc(2, sizeof *c->box);
  for (int i = 0; i < COUNT; i++)
    c->gate[i] = (eda_chip_gate){
        .box = box_of(i), .mask = classes[i], .print = classes[i]};
  c->mask[1] = (eda_chip_mask){.w = 5, .parts = 2, .boxes = 1};
  c->mask[2] = (eda_chip_mask){.l = -3, .box = 1, .boxes = 1};
  c->part[0] = (eda_part){0, 10, 1};
  c->part[1] = (eda_part){20, 30, -1};
  c->box[0] = (eda_chip_box){{1, 2, 3, 4}, 1, 0};
  c->box[1] = (eda_chip_box){{5, 6, 7, 8}, 0, 1};
  return c;
}

/* Make a window with all transistors within 300 units of the core. The first
   three transistors are in the cell A, the others in the instance X1. */
static int window_make(const eda_mask *mask, eda_box core, eda_mask **out,
                       opc_error *error) {
  int index[COUNT], n = 0;
  (void)error;
  for (int i = COUNT; i-- > 0;) {
    eda_box b = mask->chip->gate[i].box;
    if (b.y1 > core.y0 - 300 && b.y0 < core.y1 + 300) index[n++] = i;
  }
  eda_gates *g = eda_gates_new(2, (size_t)n);
  g->grid = 1;
  for (int i = 0; i < n; i++) {
    g->box[i] = box_of(index[i]);
    g->instance[i] = eda_gates_text(g, index[i] < 3 ? "" : "X1");
    g->cell[i] = eda_gates_text(g, "A");
  }
  *out = eda_mask_new(g);
  (*out)->own = g;
  (*out)->count = eda_alloc((size_t)n, sizeof *(*out)->count);
  return OPC_OK;
}

static int visit_classes(const eda_mask *mask, double reach,
                         eda_mask_visit *visit, void *data, opc_error *error) {
  reach_last = reach;
  for (size_t k = 0; k < CLASSES; k++) {
    const eda_mask_part part = {
        .mask = mask, .clear = reach, .index = k, .count = CLASSES};
    if (visit(data, &part, error)) return error->code;
  }
  return OPC_OK;
}

static const eda_mask_access access_all = {.size = sizeof(eda_mask_access),
                                           .window = window_make,
                                           .each_class = visit_classes,
                                           .side = 500.5};

static eda_mask *mask_make(void) {
  eda_mask *m = eda_chip_mask_new(chip_make());
  m->access = &access_all;
  return m;
}

/* ---- visits ---- */

typedef struct visits {
  const eda_mask *mask; /* whole mask */
  size_t parts;
  size_t of[COUNT]; /* number of visits of each transistor */
  GString *numbers;
  size_t fails_at;
} visits;

static int visit_strip(void *data, const eda_mask_part *part,
                       opc_error *error) {
  visits *v = data;
  g_assert_cmpuint(part->index, ==, v->parts++);
  g_assert_cmpuint(part->count, ==, 3);
  g_assert_true(isnan(part->clear));
  const eda_gates *g = part->mask->gates;
  for (size_t i = 0; i < g->count; i++) {
    size_t k = eda_chip_find(v->mask->chip, g->box[i]);
    int strip = MIN(g->box[i].y0 / 4000, 2);
    if (strip != (int)part->index) {
      g_assert_cmpuint(part->gate[i], ==, UINT32_MAX);
      continue;
    }
    g_assert_cmpuint(part->gate[i], ==, classes[k]);
    v->of[k]++;
    g_string_append_printf(v->numbers, "%s:%u ", eda_gates_owner(g, i),
                           g->number[i]);
  }
  return v->parts == v->fails_at ? opc_fail(error, OPC_IO, NULL, "enough")
                                 : OPC_OK;
}

/* Each transistor is visited once, in the strip of its lower edge, with the
   next number of its instance or cell. */
static void test_strips(void) {
  opc_error error;
  eda_mask *m = mask_make();
  visits v = {.mask = m, .numbers = g_string_new(NULL)};
  if (eda_mask_each_strip(m, visit_strip, &v, &error))
    g_error("%s", error.message);
  g_assert_cmpuint(v.parts, ==, 3);
  for (int i = 0; i < COUNT; i++) g_assert_cmpuint(v.of[i], ==, 1);
  g_assert_cmpstr(v.numbers->str, ==, "A:1 A:2 X1:1 A:3 X1:2 X1:3 ");
  g_string_free(v.numbers, TRUE);
  v = (visits){.mask = m, .numbers = g_string_new(NULL), .fails_at = 2};
  g_assert_cmpint(eda_mask_each_strip(m, visit_strip, &v, &error), ==, OPC_IO);
  g_assert_cmpuint(v.parts, ==, 2);
  g_string_free(v.numbers, TRUE);
  eda_mask_free(m);
}

static int visit_whole(void *data, const eda_mask_part *part,
                       opc_error *error) {
  (void)error;
  g_assert_true(part->mask == data);
  g_assert_null(part->gate);
  g_assert_cmpuint(part->index, ==, 0);
  g_assert_cmpuint(part->count, ==, 1);
  g_assert_true(isnan(part->clear));
  ((eda_mask *)data)->iterations++;
  return OPC_OK;
}

static int visit_class(void *data, const eda_mask_part *part,
                       opc_error *error) {
  (void)error;
  g_assert_cmpfloat(part->clear, ==, 70);
  *(size_t *)data += part->index + 1;
  return OPC_OK;
}

/* A flat mask is one part. The outline of a part of a mask by classes has the
   width of a part and of its margins, rounded up. */
static void test_parts(void) {
  opc_error error;
  size_t sum = 0;
  eda_mask *flat = eda_mask_new(eda_gates_sample()), *m = mask_make();
  g_assert_false(eda_mask_each_strip(flat, visit_whole, flat, &error));
  g_assert_false(eda_mask_each_class(flat, 70, visit_whole, flat, &error));
  g_assert_cmpuint(flat->iterations, ==, 2);
  g_assert_false(eda_mask_each_class(m, 70, visit_class, &sum, &error));
  g_assert_cmpuint(sum, ==, 1 + 2 + 3);
  g_assert_cmpfloat(reach_last, ==, 70);
  eda_gates outline = eda_mask_part_outline(flat, 70);
  g_assert_cmpint(outline.extent.x0, ==, -200);
  m->own->grid = 2;
  outline = eda_mask_part_outline(m, 70);
  g_assert_true(outline.extent.x0 == 0 && outline.extent.y0 == 0);
  g_assert_cmpint(outline.extent.x1, ==, 321); /* 640.5 / 2 */
  g_assert_cmpint(outline.extent.y1, ==, 321);
  eda_mask_free(flat);
  eda_mask_free(m);
}

/* All calls return the same flat mask; its gates belong to the chip. */
static void test_flat(void) {
  static const char *const want[COUNT] = {"X1:1", "X1:2", "X1:3",
                                          "A:1",  "A:2",  "A:3"};
  opc_error error;
  const eda_mask *flat, *again;
  eda_mask *m = mask_make(), *sample = eda_mask_new(eda_gates_sample());
  g_assert_false(eda_mask_flat(m, &flat, &error));
  g_assert_false(eda_mask_flat(m, &again, &error));
  g_assert_true(flat == again && flat != m);
  g_assert_true(flat->gates == m->chip->flat);
  g_assert_null(flat->own);
  g_assert_null(flat->count);
  for (size_t i = 0; i < COUNT; i++) {
    g_autofree char *name = g_strdup_printf(
        "%s:%u", eda_gates_owner(flat->gates, i), flat->gates->number[i]);
    g_assert_cmpstr(name, ==, want[i]);
  }
  g_assert_false(eda_mask_flat(sample, &again, &error));
  g_assert_true(again == sample);
  g_assert_cmpfloat(eda_mask_flat_bytes(sample), ==, 0);
  g_assert_cmpfloat(eda_mask_flat_bytes(m), ==,
                    2 * eda_segment_bytes(layout, 0, &m->chip->segment));
  g_assert_cmpfloat(eda_mask_flat_bytes(m), >, 0);
  /* A second mask of the chip uses the same gates. */
  eda_mask *other = eda_mask_new(m->gates);
  eda_mask_share(other, m);
  g_assert_true(other->chip == m->chip && other->access == m->access);
  g_assert_cmpmem(other->count, CLASSES * sizeof *other->count, m->count,
                  CLASSES * sizeof *m->count);
  g_assert_cmpuint(other->count[0], ==, 3);
  g_assert_cmpuint(other->count[1], ==, 2);
  g_assert_cmpint(other->moved->w[1], ==, 5);
  g_assert_cmpint(other->moved->l[2], ==, -3);
  g_assert_false(eda_mask_flat(other, &again, &error));
  g_assert_true(again != flat && again->gates == flat->gates);
  eda_mask_free(other);
  eda_mask_free(sample);
  eda_mask_free(m);
}

/* ---- files ---- */

static char *file_text(const char *folder, gsize *n) {
  g_autofree char *path = g_build_filename(folder, "classes", NULL);
  char *text;
  g_assert_true(g_file_get_contents(path, &text, n, NULL));
  return text;
}

/* A restored mask has the same displacements and figures; a second file is
   byte-identical. Truncated files and classes without transistors are
   refused. */
static void test_file(void) {
  opc_error error;
  void *made = NULL;
  gsize n, again;
  g_autofree char *folder = g_dir_make_tmp("parts-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "classes", NULL);
  eda_mask *m = mask_make();
  m->moved = eda_chip_moved(m->chip, m->gates);
  m->moved->seen[1] = 0.25;
  m->own->space[3] = 17.5;
  m->own->extension[5] = 33.25;
  m->own->length[2] = 60.5;
  m->after.ion[2] = 3e-4;
  m->flags[1] = EDA_PRINT_WIDE;
  if (eda_mask_save(m, folder, &error)) g_error("%s", error.message);
  g_autofree char *text = file_text(folder, &n);
  if (eda_chip_mask_restore(chip_empty(), folder, &made, &error))
    g_error("%s", error.message);
  const eda_mask *b = made;
  g_assert_cmpmem(b->chip->gate, COUNT * sizeof *b->chip->gate, m->chip->gate,
                  COUNT * sizeof *m->chip->gate);
  g_assert_cmpmem(b->chip->mask, CLASSES * sizeof *b->chip->mask, m->chip->mask,
                  CLASSES * sizeof *m->chip->mask);
  g_assert_cmpuint(b->chip->prints, ==, CLASSES);
  g_assert_cmpint(b->chip->part[1].from, ==, 20);
  g_assert_cmpint(b->chip->box[1].box.x1, ==, 7);
  g_assert_cmpuint(b->count[2], ==, 1);
  g_assert_cmpfloat(b->gates->space[3], ==, 17.5);
  g_assert_cmpfloat(b->gates->extension[5], ==, 33.25);
  g_assert_cmpfloat(b->gates->length[2], ==, 60.5);
  g_assert_cmpfloat(b->gates->width[2], ==, 200);
  g_assert_cmpfloat(b->after.ion[2], ==, 3e-4);
  g_assert_cmpuint(b->flags[1], ==, EDA_PRINT_WIDE);
  const eda_moved *d = b->moved;
  g_assert_true(d->w[1] == 5 && d->l[2] == -3 && d->seen[1] == 0.25);
  g_assert_cmpint(d->part[EDA_PARTS + 1].by, ==, -1);
  g_assert_cmpuint(d->added[1].count, ==, 1);
  g_assert_cmpuint(d->added[0].count, ==, 0);
  g_assert_cmpuint(d->cutouts[0].count, ==, 1);
  g_assert_cmpint(d->cutouts[0].box[0].x0, ==, m->gates->box[2].x0 + 5);
  g_assert_false(eda_mask_save(b, folder, &error));
  g_autofree char *second = file_text(folder, &again);
  g_assert_cmpmem(text, n, second, again);
  eda_mask_free(made);
  for (gsize k = 0; k < n; k += 1 + k / 8) {
    made = NULL;
    g_assert_true(g_file_set_contents(path, text, (gssize)k, NULL));
    g_assert_cmpint(eda_chip_mask_restore(chip_empty(), folder, &made, &error),
                    ==, OPC_FAILED);
    g_assert_nonnull(strstr(error.message, "does not belong to this mask"));
    eda_mask_free(made);
  }
  /* Class 2 has one transistor. */
  m->chip->gate[3].print = 1;
  g_assert_false(eda_mask_save(m, folder, &error));
  made = NULL;
  g_assert_cmpint(eda_chip_mask_restore(chip_empty(), folder, &made, &error),
                  ==, OPC_FAILED);
  g_assert_null(made);
  g_unlink(path);
  g_assert_cmpint(eda_chip_mask_restore(chip_empty(), folder, &made, &error),
                  ==, OPC_IO);
  g_rmdir(folder);
  eda_mask_free(m);
}

int main(int argc, char **argv) {
  opc_error error;
  g_test_init(&argc, &argv, NULL);
  layout = eda_layout_new(1, &error);
  int32_t top = eda_layout_cell(layout, "TOP", &error),
          poly = eda_layout_layer(layout, "poly", &error);
  eda_layout_add_box(layout, top, poly, (eda_box){0, 0, 9, 9}, &error);
  g_test_add_func("/parts/strips", test_strips);
  g_test_add_func("/parts/parts", test_parts);
  g_test_add_func("/parts/flat", test_flat);
  g_test_add_func("/parts/file", test_file);
  int code = g_test_run();
  eda_layout_free(layout);
  return code;
}
