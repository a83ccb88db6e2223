/* SPDX-License-Identifier: BSD-3-Clause */
/* Flattening, paths of placements, and layouts that cannot be flattened. */
#include <eda/layout.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct fixture {
  eda_layout *layout;
  int32_t layer;
} fixture;

static void set_up(fixture *f, double unit) {
  opc_error e;
  f->layout = eda_layout_new(unit, &e);
  f->layer = eda_layout_layer(f->layout, "poly", &e);
}

static void tear_down(fixture *f) { eda_layout_free(f->layout); }

static int32_t cell(fixture *f, const char *name) {
  opc_error e;
  return eda_layout_cell(f->layout, name, &e);
}

static void cell_draw(fixture *f, const char *in, eda_box box) {
  opc_error e;
  g_assert_cmpint(eda_layout_add_box(f->layout, cell(f, in), f->layer, box, &e),
                  ==, 0);
}

static void cell_place(fixture *f, const char *in, const char *child,
                       eda_placement p, const char *name) {
  opc_error e;
  if (p.magnification == 0) p.magnification = 1;
  if (!p.columns) p.columns = 1;
  if (!p.rows) p.rows = 1;
  g_assert_cmpint(eda_layout_add_instance(f->layout, cell(f, in),
                                          cell(f, child), &p, name, &e),
                  ==, 0);
}

static eda_flat flat(fixture *f, const char *top, double grid) {
  opc_error e;
  eda_flat out;
  int code =
      eda_layout_flatten(f->layout, cell(f, top), f->layer, grid, &out, &e);
  if (code) g_error("%s", e.message);
  return out;
}

static int assert_refused(fixture *f, const char *top, const char *why) {
  opc_error e;
  eda_flat out;
  int code = eda_layout_flatten(f->layout, cell(f, top), f->layer, 1, &out, &e);
  g_assert_cmpuint(out.shapes.count, ==, 0);
  if (code && !strstr(e.message, why)) g_error("%s", e.message);
  return code;
}

/* A polygon of three points in all eight orientations, computed by hand.
   Placement through two levels must equal direct placement. */
static void test_orientations(void) {
  const eda_point flag[] = {{1, 0}, {4, 0}, {1, 2}};
  const eda_point wanted[8][3] = {
      {{11, 20}, {14, 20}, {11, 22}}, {{10, 21}, {10, 24}, {8, 21}},
      {{9, 20}, {6, 20}, {9, 18}},    {{10, 19}, {10, 16}, {12, 19}},
      {{11, 20}, {14, 20}, {11, 18}}, {{10, 21}, {10, 24}, {12, 21}},
      {{9, 20}, {6, 20}, {9, 22}},    {{10, 19}, {10, 16}, {8, 19}},
  };
  for (int i = 0; i < 8; i++) {
    fixture f;
    opc_error e;
    set_up(&f, 1);
    g_assert_cmpint(
        eda_layout_add_polygon(f.layout, cell(&f, "A"), f.layer, flag, 3, &e),
        ==, 0);
    double angle = 90 * (i % 4) + (i % 2 ? 360 : -360);
    cell_place(&f, "B", "A",
               (eda_placement){{10, 20}, 1, angle, i >= 4, 1, 1, {0}, {0}},
               NULL);
    cell_place(&f, "C", "B", (eda_placement){.angle = 180, .origin = {0, 1}},
               NULL);
    cell_place(&f, "D", "C", (eda_placement){.angle = 180, .origin = {0, 1}},
               NULL);
    for (const char *top = "BD"; *top; top++) {
      char name[2] = {*top, 0};
      eda_flat out = flat(&f, name, 1);
      g_assert_cmpuint(out.shapes.count, ==, 1);
      g_assert_cmpmem(out.shapes.points, sizeof wanted[i], wanted[i],
                      sizeof wanted[i]);
      g_assert_cmpuint(out.vertices, ==, 3);
      g_assert_cmpuint(out.moved, ==, 0);
      eda_flat_clear(&out);
    }
    tear_down(&f);
  }
}

static void test_array(void) {
  fixture f;
  set_up(&f, 1);
  cell_draw(&f, "A", (eda_box){0, 0, 1, 1});
  cell_place(&f, "B", "A",
             (eda_placement){.origin = {100, 0},
                             .angle = 90,
                             .columns = 3,
                             .rows = 2,
                             .column_step = {10, 1},
                             .row_step = {-2, 20}},
             NULL);
  eda_flat out = flat(&f, "B", 1);
  g_assert_cmpuint(out.shapes.count, ==, 6);
  for (int i = 0; i < 6; i++) {
    int c = i % 3, r = i / 3;
    const eda_point *p = out.shapes.points + out.shapes.start[i];
    g_assert_cmpint(p->x, ==, 100 + 10 * c - 2 * r);
    g_assert_cmpint(p->y, ==, c + 20 * r);
    g_assert_cmpuint(out.placement[i], ==, 1 + i);
  }
  eda_flat_clear(&out);
  tear_down(&f);
}

/* Rotation by 45 degrees and magnification by 2 move (10, 0) to (14.14, 14.14).
   Two rotations by 45 degrees are exactly 90 degrees. */
static void test_any_angle(void) {
  fixture f;
  set_up(&f, 1);
  cell_draw(&f, "A", (eda_box){0, 0, 10, 30});
  cell_place(&f, "B", "A", (eda_placement){.magnification = 2, .angle = 45},
             NULL);
  cell_place(&f, "C", "B", (eda_placement){.magnification = 0.5, .angle = 45},
             NULL);
  eda_flat out = flat(&f, "B", 1);
  const eda_point b[] = {{0, 0}, {14, 14}, {-28, 57}, {-42, 42}};
  g_assert_cmpmem(out.shapes.points, sizeof b, b, sizeof b);
  g_assert_cmpuint(out.moved, ==, 3);
  /* the point (0, 30) becomes (-42.43, 42.43) */
  g_assert_cmpfloat_with_epsilon(out.worst, 60 - 42 * sqrt(2), 1e-9);
  eda_flat_clear(&out);
  out = flat(&f, "C", 1);
  const eda_point c[] = {{0, 0}, {0, 10}, {-30, 10}, {-30, 0}};
  g_assert_cmpmem(out.shapes.points, sizeof c, c, sizeof c);
  g_assert_cmpuint(out.moved, ==, 0);
  eda_flat_clear(&out);
  tear_down(&f);
}

/* 0.13 nm has no exact binary representation. Depending on the computation,
   1450 units are 188.5 nm, 188.49999999999997 or 188.50000000000003. Halves
   must be rounded up, and equal lengths must be equal at every position. */
static void test_halves(void) {
  fixture f;
  set_up(&f, 0.13);
  for (int i = -200; i < 200; i++)
    cell_draw(&f, "A", (eda_box){1450 + 100 * i, 50, 1550 + 100 * i, 150});
  eda_flat out = flat(&f, "A", 1);
  for (int i = -200; i < 200; i++) {
    const eda_point *p = out.shapes.points + 4 * (i + 200);
    /* edges at 188.5 + 13 i and 201.5 + 13 i */
    g_assert_cmpint(p[0].x, ==, 189 + 13 * i);
    g_assert_cmpint(p[1].x, ==, 202 + 13 * i);
    g_assert_cmpint(p[0].y, ==, 7);  /* 6.5 is rounded up */
    g_assert_cmpint(p[2].y, ==, 20); /* 19.5 is rounded up */
  }
  g_assert_cmpuint(out.vertices, ==, 1600);
  g_assert_cmpuint(out.moved, ==, 1600);
  g_assert_cmpfloat_with_epsilon(out.worst, sqrt(0.5), 1e-9);
  eda_flat_clear(&out);
  out = flat(&f, "A", 6.5);
  g_assert_cmpuint(out.moved, ==, 0);
  g_assert_cmpfloat(out.worst, ==, 0);
  eda_flat_clear(&out);
  tear_down(&f);
}

/* Units of hundredths of nm, compared with integer arithmetic. As doubles, some
   halves are slightly too small, others slightly too large. */
static void test_hundredths(void) {
  static const int units[] = {7, 13, 14, 29, 35, 57, 58, 115};
  for (size_t k = 0; k < G_N_ELEMENTS(units); k++) {
    fixture f;
    set_up(&f, units[k] / 100.0);
    for (int x = -5000; x < 5000; x++)
      cell_draw(&f, "A", (eda_box){x, x, x + 1, x + 1});
    eda_flat out = flat(&f, "A", 1);
    for (int x = -5000; x < 5000; x++) {
      int twice = 2 * units[k] * x + 100; /* x + 1/2, in 1/200 */
      int want = twice >= 0 ? twice / 200 : -((199 - twice) / 200);
      g_assert_cmpint(out.shapes.points[4 * (x + 5000)].x, ==, want);
    }
    eda_flat_clear(&out);
    tear_down(&f);
  }
}

/* Expected results of flattening and of paths, from a simple algorithm. */
typedef struct reference {
  GPtrArray *paths;
  GArray *corners; /* eda_point: one corner of each shape */
  GArray *placements;
} reference;

static void reference_descend(fixture *f, int32_t number, const int m[4],
                              int64_t dx, int64_t dy, const char *path,
                              reference *out) {
  size_t here = out->paths->len;
  g_ptr_array_add(out->paths, g_strdup(path));
  for (size_t i = 0; i < eda_layout_polygons(f->layout, number); i++) {
    size_t n;
    int32_t layer;
    eda_point p = *eda_layout_polygon(f->layout, number, i, &n, &layer);
    if (layer != f->layer) continue;
    eda_point q = {(int32_t)(m[0] * p.x + m[1] * p.y + dx),
                   (int32_t)(m[2] * p.x + m[3] * p.y + dy)};
    g_array_append_val(out->corners, q);
    g_array_append_val(out->placements, here);
  }
  for (size_t i = 0; i < eda_layout_instances(f->layout, number); i++) {
    int32_t child;
    eda_placement p;
    const char *name = eda_layout_instance(f->layout, number, i, &child, &p);
    static const int turn[4][4] = {
        {1, 0, 0, 1}, {0, -1, 1, 0}, {-1, 0, 0, -1}, {0, 1, -1, 0}};
    const int *t = turn[(int)p.angle / 90];
    int s = p.mirror ? -1 : 1;
    int local[4] = {t[0], s * t[1], t[2], s * t[3]};
    int all[4] = {
        m[0] * local[0] + m[1] * local[2], m[0] * local[1] + m[1] * local[3],
        m[2] * local[0] + m[3] * local[2], m[2] * local[1] + m[3] * local[3]};
    for (uint32_t r = 0; r < p.rows; r++)
      for (uint32_t c = 0; c < p.columns; c++) {
        int64_t x = p.origin.x + (int64_t)c * p.column_step.x +
                    (int64_t)r * p.row_step.x;
        int64_t y = p.origin.y + (int64_t)c * p.column_step.y +
                    (int64_t)r * p.row_step.y;
        g_autofree char *own =
            name ? g_strdup(name)
                 : g_strdup_printf("%s#%zu",
                                   eda_layout_cell_name(f->layout, child), i);
        g_autofree char *member = p.rows > 1 || p.columns > 1
                                      ? g_strdup_printf("[%u,%u]", c, r)
                                      : g_strdup("");
        g_autofree char *below =
            g_strdup_printf("%s%s%s%s", path, *path ? "/" : "", own, member);
        reference_descend(f, child, all, m[0] * x + m[1] * y + dx,
                          m[2] * x + m[3] * y + dy, below, out);
      }
  }
}

/* Build cells that place only later cells. */
static void random_cells(fixture *f, GRand *rand) {
  opc_error e;
  enum { CELLS = 6 };
  int32_t other = eda_layout_layer(f->layout, "other", &e);
  for (int i = 0; i < CELLS; i++) {
    char name[16];
    g_snprintf(name, sizeof name, "C%d", i);
    cell(f, name);
  }
  for (int i = 0; i < CELLS; i++) {
    int boxes = g_rand_int_range(rand, i + 1 == CELLS, 3);
    for (int k = 0; k < boxes; k++) {
      int x = g_rand_int_range(rand, -9, 9), y = g_rand_int_range(rand, -9, 9);
      int32_t layer = g_rand_int_range(rand, 0, 3) ? f->layer : other;
      g_assert_cmpint(eda_layout_add_box(f->layout, i, layer,
                                         (eda_box){x, y, x + 3, y + 2}, &e),
                      ==, 0);
      char text[8]; /* text at the corner; names the cell */
      g_snprintf(text, sizeof text, "%d", i);
      g_assert_cmpint(
          eda_layout_add_text(f->layout, i, layer, (eda_point){x, y}, text, &e),
          ==, 0);
    }
    for (int k = 0; k < 3 && i + 1 < CELLS; k++) {
      eda_placement p = {.origin = {g_rand_int_range(rand, -99, 99),
                                    g_rand_int_range(rand, -99, 99)},
                         .magnification = 1,
                         .angle = 90 * g_rand_int_range(rand, 0, 4),
                         .mirror = (uint32_t)g_rand_int_range(rand, 0, 2),
                         .columns = (uint32_t)g_rand_int_range(rand, 1, 3),
                         .rows = (uint32_t)g_rand_int_range(rand, 1, 3),
                         .column_step = {g_rand_int_range(rand, -50, 50), 7},
                         .row_step = {-4, g_rand_int_range(rand, -50, 50)}};
      g_assert_cmpint(eda_layout_add_instance(
                          f->layout, i, g_rand_int_range(rand, i + 1, CELLS),
                          &p, g_rand_boolean(rand) ? "X" : NULL, &e),
                      ==, 0);
    }
  }
}

/* Check that the text at the corner of each shape is flattened to the same
   point as the corner. */
static void check_texts(fixture *f, const eda_flat *shapes) {
  opc_error e;
  eda_flat_texts t;
  g_assert_cmpint(eda_layout_flatten_texts(f->layout, 0, f->layer, 1, &t, &e),
                  ==, 0);
  g_assert_cmpuint(t.at.shapes.count, ==, shapes->shapes.count);
  for (size_t i = 0; i < t.at.shapes.count; i++) {
    eda_point p = t.at.shapes.points[i];
    eda_point q = shapes->shapes.points[shapes->shapes.start[i]];
    g_assert_true(p.x == q.x && p.y == q.y);
    g_assert_cmpuint(t.at.placement[i], ==, shapes->placement[i]);
    char path[256];
    int32_t at =
        eda_layout_path(f->layout, 0, t.at.placement[i], path, sizeof path);
    g_assert_cmpint(at, ==, atoi(t.text[i]));
    uint32_t depth = *path ? 1 : 0;
    for (const char *c = path; *c; c++) depth += *c == '/';
    g_assert_cmpuint(t.depth[i], ==, depth);
  }
  eda_flat_texts_clear(&t);
  g_assert_null(t.text);
}

static void test_against_recursion(void) {
  GRand *rand = g_rand_new_with_seed(2);
  for (int round = 0; round < 30; round++) {
    fixture f;
    set_up(&f, 1);
    random_cells(&f, rand);
    reference want = {g_ptr_array_new_with_free_func(g_free),
                      g_array_new(FALSE, FALSE, sizeof(eda_point)),
                      g_array_new(FALSE, FALSE, sizeof(size_t))};
    reference_descend(&f, 0, (const int[]){1, 0, 0, 1}, 0, 0, "", &want);
    eda_flat out = flat(&f, "C0", 1);
    g_assert_cmpuint(out.shapes.count, ==, want.corners->len);
    for (size_t i = 0; i < out.shapes.count; i++) {
      eda_point p = out.shapes.points[out.shapes.start[i]];
      eda_point q = g_array_index(want.corners, eda_point, i);
      g_assert_true(p.x == q.x && p.y == q.y);
      size_t placement = g_array_index(want.placements, size_t, i);
      char path[256];
      g_assert_cmpint(
          eda_layout_path(f.layout, 0, out.placement[i], path, sizeof path), >=,
          0);
      g_assert_cmpstr(path, ==, want.paths->pdata[placement]);
    }
    check_texts(&f, &out);
    eda_flat_clear(&out);
    g_ptr_array_free(want.paths, TRUE);
    g_array_free(want.corners, TRUE);
    g_array_free(want.placements, TRUE);
    tear_down(&f);
  }
  g_rand_free(rand);
}

/* Test cells with texts only, a scale and a magnification, and a layer without
   texts. */
static void test_texts(void) {
  fixture f;
  opc_error e;
  eda_flat_texts t;
  set_up(&f, 0.5);
  cell_draw(&f, "TOP", (eda_box){0, 0, 1, 1});
  eda_layout_add_text(f.layout, cell(&f, "NOTE"), f.layer, (eda_point){4, 2},
                      "a b", &e);
  cell_place(&f, "TOP", "NOTE", (eda_placement){.origin = {100, 0}}, "X1");
  cell_place(
      &f, "TOP", "NOTE",
      (eda_placement){
          .origin = {200, 0}, .angle = 90, .magnification = 2, .mirror = 1},
      "X2");
  g_assert_cmpint(
      eda_layout_flatten_texts(f.layout, cell(&f, "TOP"), f.layer, 1, &t, &e),
      ==, 0);
  g_assert_cmpuint(t.at.shapes.count, ==, 2);
  static const int32_t want[2][2] = {{52, 1}, {102, 4}};
  for (int i = 0; i < 2; i++) {
    char path[8];
    g_assert_cmpint(t.at.shapes.points[i].x, ==, want[i][0]);
    g_assert_cmpint(t.at.shapes.points[i].y, ==, want[i][1]);
    g_assert_cmpstr(t.text[i], ==, "a b");
    eda_layout_path(f.layout, cell(&f, "TOP"), t.at.placement[i], path,
                    sizeof path);
    g_assert_cmpstr(path, ==, i ? "X2" : "X1");
  }
  eda_flat_texts_clear(&t);
  int32_t other = eda_layout_layer(f.layout, "other", &e);
  g_assert_cmpint(
      eda_layout_flatten_texts(f.layout, cell(&f, "TOP"), other, 1, &t, &e), ==,
      0);
  g_assert_cmpuint(t.at.shapes.count, ==, 0);
  eda_flat_texts_clear(&t);
  g_assert_cmpint(eda_layout_flatten_texts(f.layout, 7, other, 1, &t, &e), ==,
                  OPC_INVALID);
  tear_down(&f);
}

static void test_path(void) {
  fixture f;
  char path[64], small[6];
  set_up(&f, 1);
  cell_draw(&f, "NAND", (eda_box){0, 0, 1, 1});
  cell_place(&f, "BLOCK", "EMPTY", (eda_placement){0}, "nothing");
  cell_place(&f, "BLOCK", "NAND", (eda_placement){.columns = 2, .rows = 2},
             NULL);
  cell_place(&f, "TOP", "BLOCK", (eda_placement){0}, "XU1");
  int32_t top = cell(&f, "TOP");
  g_assert_cmpint(eda_layout_path(f.layout, top, 0, path, sizeof path), ==,
                  top);
  g_assert_cmpstr(path, ==, "");
  g_assert_cmpint(eda_layout_path(f.layout, top, 4, path, sizeof path), ==,
                  cell(&f, "NAND"));
  g_assert_cmpstr(path, ==, "XU1/NAND#1[0,1]");
  g_assert_cmpint(eda_layout_path(f.layout, top, 4, small, sizeof small), ==,
                  cell(&f, "NAND"));
  g_assert_cmpstr(small, ==, "XU1/N");
  g_assert_cmpint(eda_layout_path(f.layout, top, 6, path, sizeof path), ==, -1);
  g_assert_cmpint(eda_layout_path(f.layout, 99, 0, path, sizeof path), ==, -1);
  tear_down(&f);
}

/* Test thousands of levels, billions of shapes, and circular placements. */
static void test_hostile(void) {
  fixture f;
  set_up(&f, 1);
  cell_draw(&f, "0", (eda_box){0, 0, 1, 1});
  for (int i = 1; i < 20000; i++) {
    char up[16], down[16];
    g_snprintf(up, sizeof up, "%d", i);
    g_snprintf(down, sizeof down, "%d", i - 1);
    cell_place(&f, up, down, (eda_placement){.origin = {1, 0}}, NULL);
  }
  eda_flat out = flat(&f, "19999", 1);
  g_assert_cmpuint(out.shapes.count, ==, 1);
  g_assert_cmpint(out.shapes.points[0].x, ==, 19999);
  eda_flat_clear(&out);
  /* an array of 10^10 members; nested, more members than 64 bits can count */
  eda_placement many = {.columns = 100000, .rows = 100000};
  cell_place(&f, "many", "0", many, NULL);
  cell_place(&f, "more", "many", many, NULL);
  cell_place(&f, "most", "more", many, NULL);
  g_assert_cmpint(
      assert_refused(&f, "many", "too large to flatten: 10000000000"), ==,
      OPC_INVALID);
  g_assert_cmpint(assert_refused(&f, "most", "too large to flatten"), ==,
                  OPC_INVALID);
  /* a hundred shapes, two million placements */
  cell_place(&f, "deep", "19999", (eda_placement){.columns = 100, .rows = 1},
             NULL);
  g_assert_cmpint(assert_refused(&f, "deep", "100 shapes, 400 points"), ==,
                  OPC_INVALID);
  /* all of these placements are empty */
  cell_place(&f, "void", "hole", many, NULL);
  cell_place(&f, "voids", "void", many, NULL);
  out = flat(&f, "voids", 1);
  g_assert_cmpuint(out.shapes.count, ==, 0);
  eda_flat_clear(&out);
  cell_place(&f, "19999", "self", (eda_placement){0}, NULL);
  cell_place(&f, "self", "self", (eda_placement){0}, NULL);
  g_assert_cmpint(assert_refused(&f, "self", "cycle"), ==, OPC_INVALID);
  g_assert_cmpint(assert_refused(&f, "19999", "cycle"), ==, OPC_INVALID);
  out = flat(&f, "19998", 1);
  g_assert_cmpuint(out.shapes.count, ==, 1);
  eda_flat_clear(&out);
  tear_down(&f);
}

static void test_range(void) {
  fixture f;
  set_up(&f, 1);
  cell_draw(&f, "A", (eda_box){0, 0, 1 << 30, 1});
  eda_flat out = flat(&f, "A", 1);
  g_assert_cmpint(out.shapes.points[1].x, ==, 1 << 30);
  eda_flat_clear(&out);
  cell_place(&f, "B", "A", (eda_placement){.origin = {1, 0}}, NULL);
  g_assert_cmpint(assert_refused(&f, "B", "2^30"), ==, OPC_INVALID);
  cell_place(&f, "C0", "A", (eda_placement){.magnification = 1e300}, NULL);
  cell_place(&f, "C1", "C0", (eda_placement){.magnification = 1e300}, NULL);
  g_assert_cmpint(assert_refused(&f, "C1", "2^30"), ==, OPC_INVALID);
  tear_down(&f);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/flatten/orientations", test_orientations);
  g_test_add_func("/flatten/array", test_array);
  g_test_add_func("/flatten/any-angle", test_any_angle);
  g_test_add_func("/flatten/halves", test_halves);
  g_test_add_func("/flatten/hundredths", test_hundredths);
  g_test_add_func("/flatten/against-recursion", test_against_recursion);
  g_test_add_func("/flatten/texts", test_texts);
  g_test_add_func("/flatten/path", test_path);
  g_test_add_func("/flatten/hostile", test_hostile);
  g_test_add_func("/flatten/range", test_range);
  return g_test_run();
}
