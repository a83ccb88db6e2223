/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the steps that take a mask by classes against the same steps on the
   flat mask with all transistors and shapes. */
#include <eda/print.h>
#include <eda/runs.h>
#include <math.h>

#include "chip_test.h"
#include "tests/shapes.h"

#define TWO ", layers: { poly: poly, active: active }, fine: off"

/* A mask by classes, the same mask flat, and the steps that own them. */
typedef struct both {
  drawing d;
  opc_module *by_classes, *whole;
  eda_mask *classes, *flat;
  eda_gates *gates;
  eda_layout *shapes;
} both;

static both both_of(drawing d) {
  both b = {.d = d, .gates = flat(&d)};
  b.by_classes = chip_of(&d, CHEAP ", radius: 800 nm");
  b.classes = run_step(b.by_classes);
  b.shapes = mask_of(b.classes->chip, b.gates);
  b.whole = make_sample("given", TWO ", margin: 4000 nm");
  opc_test_input(b.whole, "gates", b.gates);
  opc_test_input(b.whole, "mask_layout", b.shapes);
  b.flat = run_step(b.whole);
  g_assert_cmpuint(b.flat->gates->count, ==, b.classes->chip->count);
  return b;
}

static void both_clear(both *b) {
  release_sample(b->by_classes, b->classes);
  release_sample(b->whole, b->flat);
  eda_gates_free(b->gates);
  eda_layout_free(b->shapes);
  eda_layout_free(b->d.layout);
}

/* 24 transistors of two classes and one of a class of its own, which deviates
   more: figures that ignore the numbers of transistors differ. All tests share
   these masks and must not change them. */
static both uneven;

static void uneven_set_up(void) {
  drawing d = eight_orientations();
  box(&d, d.top, "active", 0, -6000, 400, -5600);
  box(&d, d.top, "poly", 150, -6084, 250, -5516);
  uneven = both_of(d);
}

/* Return the class of transistor i of a flat mask. */
static size_t class_of(const both *b, size_t i) {
  size_t k = eda_chip_find(b->classes->chip, b->flat->gates->box[i]);
  g_assert_cmpuint(k, !=, SIZE_MAX);
  return b->classes->chip->gate[k].print;
}

static void expect_near(const char *what, double a, double b, double most) {
  if (!(fabs(a - b) <= most) && !(isnan(a) && isnan(b)))
    g_error("%s: %.9g by classes, %.9g flat", what, a, b);
}

static void keep_metrics(const char *const *name, size_t n, double *out) {
  for (size_t k = 0; k < n; k++) out[k] = opc_test_metric(name[k]);
}

static void expect_metrics(const char *const *name, size_t n,
                           const double *want, double most) {
  for (size_t k = 0; k < n; k++) {
    double got = opc_test_metric(name[k]);
    g_test_message("%s: %.6g, flat %.6g", name[k], got, want[k]);
    expect_near(name[k], got, want[k], most * fmax(1, fabs(want[k])));
  }
}

/* ---- verify ---- */

/* Return a device table whose model covers none of the n-transistors. */
static char *modelled_table(void) {
  g_autofree char *name = ptm65(), *text = NULL;
  g_assert_true(g_file_get_contents(name, &text, NULL, NULL));
  char *at = strstr(text, "\nlength:"), *path = NULL;
  g_autofree char *all = g_strdup_printf("%.*s\nnmos_modelled: 300 nm%s",
                                         (int)(at - text), text, at);
  path = g_build_filename(opc_test_folder(), "modelled.yaml", NULL);
  g_assert_true(g_file_set_contents(path, all, -1, NULL));
  return path;
}

/* Models of the verification; `make_sample` sets those of the correction. */
static opc_module *verification(const eda_mask *mask) {
  g_autofree char *devices = modelled_table();
  g_autofree char *map = g_strdup_printf(
      "{ litho: { use: litho.hopkins, kernels: 12, defocus: 50 nm }, resist: { "
      "use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }, "
      "extractor: { use: extractor.plain, devices: '%s' }, fine: off, margin: "
      "4000 nm, transistors: all.csv }",
      devices);
  opc_error error = {0};
  opc_module *m = opc_test_module("verify", map, &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "mask", (void *)mask);
  return m;
}

static const char *const verified[] = {
    "ion_mean",   "ion_max",      "ion_stdv", "area_mean",   "ioff_mean",
    "ioff_total", "ioff_total_n", "failed",   "short_slices"};

static void expect_figures(const both *b, const eda_mask *got,
                           const eda_mask *want) {
  for (size_t i = 0; i < want->gates->count; i++) {
    size_t k = class_of(b, i);
    expect_near("Ion", got->after.ion[k] / want->after.ion[i], 1, 1e-3);
    expect_near("Ioff", got->after.ioff[k] / want->after.ioff[i], 1, 0.03);
    expect_near("drawn", got->design.ion[k] / want->design.ion[i], 1, 1e-9);
    g_assert_cmpuint(got->flags[k], ==, want->flags[i]);
  }
}

/* Return the file of all transistors. */
static eda_table *all_transistors(void) {
  opc_error error = {0};
  g_autofree char *path = g_build_filename(opc_test_folder(), "all.csv", NULL);
  eda_table *t = eda_table_read(path, &error);
  if (!t) g_error("%s", error.message);
  return t;
}

/* Check the names of the file against the table of the flat mask. */
static void expect_names(const opc_table *gates, const eda_table *all) {
  const char *const *name = opc_table_column(gates, "transistor")->data;
  g_assert_cmpuint(eda_table_rows(all), ==, gates->rows);
  for (size_t i = 0; i < gates->rows; i++)
    g_assert_cmpstr(eda_table_text(all, i, 0), ==, name[i]);
}

/* Check all transistors of classes against those of the flat mask. */
static void expect_all(eda_table *want, eda_table *got) {
  static const char *const equal[] = {"transistor", "cell", "type", "l",
                                      "w",          "x",    "y",    "print"};
  static const char *const near[] = {"ion_after", "area_after", "leq_ion",
                                     "weq"};
  g_assert_cmpuint(eda_table_rows(got), ==, eda_table_rows(want));
  for (size_t i = 0; i < eda_table_rows(got); i++) {
    for (size_t k = 0; k < G_N_ELEMENTS(equal); k++) {
      size_t c = (size_t)eda_table_find(got, equal[k]);
      g_assert_cmpstr(eda_table_text(got, i, c), ==,
                      eda_table_text(want, i, c));
    }
    for (size_t k = 0; k < G_N_ELEMENTS(near); k++) {
      size_t c = (size_t)eda_table_find(got, near[k]);
      expect_near(near[k], eda_table_numbers(got, c)[i],
                  eda_table_numbers(want, c)[i], 0.08);
    }
  }
}

static void test_verify(void) {
  both b = uneven;
  double want[G_N_ELEMENTS(verified)];
  opc_module *one = verification(b.flat), *two = verification(b.classes);
  eda_mask *truth = run_step(one);
  keep_metrics(verified, G_N_ELEMENTS(verified), want);
  eda_table *all = all_transistors();
  expect_names(opc_test_table("gates"), all);
  eda_mask *out = run_step(two);
  eda_table *of_classes = all_transistors();
  expect_all(all, of_classes);
  eda_table_free(of_classes);
  eda_table_free(all);
  g_assert_cmpuint(out->gates->count, ==, b.classes->gates->count);
  expect_figures(&b, out, truth);
  expect_metrics(verified, G_N_ELEMENTS(verified), want, 0.03);
  g_assert_cmpfloat(want[0], >, 1); /* the models differ */
  double sum = 0;
  for (size_t k = 0; k < out->gates->count; k++)
    sum += fabs(eda_deviation(out->after.ion[k], out->design.ion[k]));
  g_assert_cmpfloat(fabs(sum / (double)out->gates->count / want[0] - 1), >,
                    0.05);

  /* The verified mask is a mask by classes, also after its restoration. */
  opc_error error = {0};
  const opc_step *step = two->functions;
  void *outputs[] = {out}, *again[] = {NULL};
  g_assert_false(step->save(two->self, outputs, opc_test_folder(), &error));
  g_assert_false(step->restore(two->self, opc_test_folder(), again, &error));
  const eda_mask *restored = again[0], *plain, *of_input;
  g_assert_cmpmem(restored->after.ion, out->gates->count * sizeof(double),
                  out->after.ion, out->gates->count * sizeof(double));
  g_assert_true(restored->chip == b.classes->chip);
  g_assert_false(eda_mask_flat(restored, &plain, &error));
  g_assert_false(eda_mask_flat(b.classes, &of_input, &error));
  g_assert_true(plain->gates == of_input->gates && plain != of_input);
  g_assert_true(plain->after.ion[0] == restored->after.ion[class_of(&b, 0)]);
  eda_mask_free(again[0]);
  release_sample(two, out);
  release_sample(one, truth);
}

/* ---- process.window ---- */

static const char *const windows[] = {
    "exposure_latitude", "depth_of_focus", "nils_min",
    "failed_max",        "ion_window",     "ioff_window",
    "both_window",       "ion_sd_max",     "ion_worst",
    "leakage_max",       "meef_mean",      "meef_max",
    "ion_per_nm_mean",   "ion_per_nm_max", "transistors_failed_max"};

/* Return the numbers of all real columns of a table, row by row. */
static GArray *numbers_of(const char *name) {
  const opc_table *t = opc_test_table(name);
  GArray *out = g_array_new(FALSE, FALSE, sizeof(double));
  g_assert_nonnull(t);
  for (size_t k = 0; k < t->n_columns; k++)
    for (size_t i = 0; i < t->rows; i++)
      if (t->columns[k].type == OPC_REAL)
        g_array_append_val(out, ((const double *)t->columns[k].data)[i]);
  return out;
}

static void expect_numbers(const char *name, const GArray *want, double most) {
  g_autoptr(GArray) got = numbers_of(name);
  g_assert_cmpuint(got->len, ==, want->len);
  g_assert_cmpuint(got->len, >, 10);
  for (guint i = 0; i < got->len; i++) {
    double b = g_array_index(want, double, i);
    expect_near(name, g_array_index(got, double, i), b, most * fmax(1, b));
  }
}

static opc_module *window_of(const eda_mask *mask) {
  opc_module *m = make_sample(
      "process.window",
      ", dose: [-4 %, 0 %, 4 %], defocus: [0 nm, 50 nm], margin: 4000 nm, "
      "mask_error: [-2 nm, 0 nm, 2 nm], cut_lines: true");
  opc_test_input(m, "mask", (void *)mask);
  opc_error error = {0};
  opc_test_forget();
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  return m;
}

static void test_window(void) {
  both b = uneven;
  double want[G_N_ELEMENTS(windows)];
  opc_test_module_free(window_of(b.flat));
  keep_metrics(windows, G_N_ELEMENTS(windows), want);
  g_autoptr(GArray) lengths = numbers_of("process_window");
  g_autoptr(GArray) currents = numbers_of("performance_window");
  opc_test_module_free(window_of(b.classes));
  expect_metrics(windows, G_N_ELEMENTS(windows), want, 0.015);
  expect_numbers("process_window", lengths, 0.05);
  expect_numbers("performance_window", currents, 0.08);
  size_t cuts = opc_test_table("cut_lines")->rows;
  g_assert_cmpuint(cuts, ==, 6 * b.classes->gates->count);
}

/* ---- draw.image ---- */

static opc_module *image_of(const eda_mask *mask) {
  opc_error error = {0};
  opc_module *m = opc_test_module(
      "draw.image",
      "{ first: { litho: { use: litho.hopkins, kernels: 12 }, resist: { use: "
      "resist.threshold, threshold: 0.3 } }, second: { litho: { use: "
      "litho.hopkins, kernels: 12, defocus: 80 nm }, resist: { use: "
      "resist.threshold, threshold: 0.3 } }, margin: 3000 nm, window: [3000 "
      "nm, -1000 nm, 5000 nm, 1000 nm], width: 300 }",
      &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "mask", (void *)mask);
  opc_test_forget();
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  return m;
}

static void test_image(void) {
  static const char *const name[] = {"rms", "max"};
  double want[2];
  both b = uneven;
  opc_test_module_free(image_of(b.flat));
  keep_metrics(name, 2, want);
  g_autoptr(GArray) truth = numbers_of("models");
  opc_test_module_free(image_of(b.classes));
  g_assert_cmpfloat(want[0], >, 1);
  expect_metrics(name, 2, want, 0.01);
  expect_numbers("models", truth, 0.01);
}

/* ---- all transistors ---- */

/* Return several strips of transistors; instances cross the strips. */
static drawing many(void) {
  drawing d = drawing_new();
  for (int k = 0; k < 8; k++)
    place_sample(&d, 700 * (k % 3), 3300 * k, k % 2, 90 * (k % 2), 25);
  return d;
}

typedef struct visited {
  const eda_gates *truth;
  size_t next, parts;
  const both *b;
} visited;

static int expect_next(void *data, const eda_mask_part *part,
                       opc_error *error) {
  visited *v = data;
  const eda_gates *g = part->mask->gates, *t = v->truth;
  (void)error;
  v->parts = part->count;
  for (size_t i = 0; i < g->count; i++) {
    size_t k = part->gate[i], j = v->next;
    if (k == UINT32_MAX) continue;
    v->next++;
    g_assert_cmpmem(&g->box[i], sizeof *g->box, &t->box[j], sizeof *t->box);
    g_assert_cmpstr(g->instance[i], ==, t->instance[j]);
    g_assert_cmpstr(g->cell[i], ==, t->cell[j]);
    g_assert_cmpuint(g->number[i], ==, t->number[j]);
    g_assert_cmpuint(k, ==, class_of(v->b, j));
    g_assert_true(part->mask->after.ion[i] == v->b->classes->after.ion[k]);
  }
  return OPC_OK;
}

/* Strips visit the transistors of a flat segmentation in its order, with its
   names; the flat mask has its gates and the shapes of the given mask. */
static void test_all(void) {
  both b = both_of(many());
  opc_error error = {0};
  const eda_mask *all;
  visited v = {.truth = b.gates, .b = &b};
  if (eda_mask_each_strip(b.classes, expect_next, &v, &error))
    g_error("%s", error.message);
  g_assert_cmpuint(v.next, ==, b.gates->count);
  g_assert_cmpuint(v.parts, >, 2);
  if (eda_mask_flat(b.classes, &all, &error)) g_error("%s", error.message);
  g_assert_cmpuint(all->gates->count, ==, b.gates->count);
  for (size_t i = 0; i < b.gates->count; i++) {
    g_assert_cmpstr(all->gates->instance[i], ==, b.gates->instance[i]);
    g_assert_cmpuint(all->gates->number[i], ==, b.gates->number[i]);
    g_assert_true(all->after.ion[i] == b.classes->after.ion[class_of(&b, i)]);
  }
  for (size_t k = 0; k < 2; k++)
    g_assert_cmpfloat(shapes_difference(&all->shapes[k], &b.flat->shapes[k]),
                      ==, 0);
  both_clear(&b);
}

/* ---- netlist ---- */

/* Return a netlist of the transistors of `uneven`, each cell with nets of its
   own. */
static char *netlist_write(void) {
  GString *text = g_string_new(".subckt TOP VSS VDD\n");
  for (int i = 0; i < 12; i++)
    g_string_append_printf(text,
                           "MA%d A%d B%d C%d 0 nmos w=400n l=65n\n"
                           "MB%d C%d D%d E%d 0 nmos w=400n l=65n\n",
                           i, i, i, i, i, i, i, i);
  g_string_append(text, "MX F G H 0 nmos w=400n l=100n\n.ends\n");
  char *path = g_build_filename(opc_test_folder(), "in.sp", NULL);
  g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
  g_string_free(text, TRUE);
  return path;
}

/* Return the netlist with the sizes of `mask` (g_free), of the circuit matched
   with the gates of `of`. */
static char *annotated(const both *b, const char *input, const void *of,
                       const eda_mask *mask) {
  opc_error error = {0};
  g_autofree char *in = netlist_write(), *out = NULL,
                  *map = g_strdup_printf("{ file: '%s' }", in);
  opc_module *match = opc_test_module("netlist.match", map, &error);
  opc_module *write = opc_test_module("netlist.annotate", "{}", &error);
  if (!match || !write) g_error("%s", error.message);
  opc_test_input(match, "layout", b->d.layout);
  opc_test_input(match, input, (void *)of);
  void *circuit = run_step(match), *none[1];
  opc_test_input(write, "circuit", circuit);
  opc_test_input(write, "mask", (void *)mask);
  if (opc_test_run(write, none, &error)) g_error("%s", error.message);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "netlist.sp", NULL);
  g_assert_true(g_file_get_contents(path, &out, NULL, NULL));
  opc_test_module_free(write);
  release_sample(match, circuit);
  return g_steal_pointer(&out);
}

/* The netlist of a mask by classes has the bytes of the netlist of a flat mask
   with the sizes of the classes. */
static void test_netlist(void) {
  both b = uneven;
  size_t n = b.gates->count;
  const eda_performance *of = &b.classes->after;
  eda_mask sized = *b.flat;
  sized.after.leq_ion = eda_alloc(n, sizeof(double));
  sized.after.weq = eda_alloc(n, sizeof(double));
  sized.after.area = eda_alloc(n, sizeof(double));
  sized.flags = eda_alloc(n, sizeof *sized.flags);
  for (size_t i = 0; i < n; i++) {
    size_t k = class_of(&b, i);
    sized.after.leq_ion[i] = of->leq_ion[k];
    sized.after.weq[i] = of->weq[k];
    sized.after.area[i] = of->area[k];
    sized.flags[i] = b.classes->flags[k];
  }
  g_autofree char *want = annotated(&b, "gates", b.gates, &sized),
                  *got = annotated(&b, "mask", b.classes, b.classes);
  g_assert_cmpstr(got, ==, want);
  free(sized.after.leq_ion);
  free(sized.after.weq);
  free(sized.after.area);
  free(sized.flags);
}

/* ---- files ---- */

/* The cost of the cells of a layout whose cells are apart is that of the flat
   mask. */
static void test_cost(void) {
  static const char *const name[] = {"rectangles", "rectangles_drawn",
                                     "shots",      "shots_drawn",
                                     "slivers",    "vertices"};
  both b = uneven;
  const eda_mask *masks[] = {b.flat, b.classes};
  double want[G_N_ELEMENTS(name)];
  for (int k = 0; k < 2; k++) {
    opc_error error = {0};
    opc_module *m = opc_test_module("cost.fracture", "{}", &error);
    if (!m) g_error("%s", error.message);
    opc_test_input(m, "mask", (void *)masks[k]);
    opc_test_forget();
    if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
    if (!k) keep_metrics(name, G_N_ELEMENTS(name), want);
    opc_test_module_free(m);
  }
  g_assert_cmpfloat(want[0], >, want[1]); /* the correction adds rectangles */
  expect_metrics(name, G_N_ELEMENTS(name), want, 0);
}

/* Return the area by which a layer of a file differs from shapes. */
static double file_differs(const eda_layout *file, const char *layer,
                           const eda_shapes *want) {
  opc_error error = {0};
  eda_flat all;
  int32_t number = eda_layout_select(file, layer, &error),
          top = eda_layout_top(file, &error);
  if (number < 0 || top < 0) g_error("%s: %s", layer, error.message);
  g_assert_false(eda_layout_flatten(file, top, number, 1, &all, &error));
  double area = shapes_difference(&all.shapes, want);
  eda_flat_clear(&all);
  return area;
}

/* The file for KLayout has all drawn and all mask shapes. */
static void test_klayout(void) {
  static const char *const drawn[] = {"109/0", "101/0"}, *const masks[] = {
                                                             "9/0", "1/0"};
  both b = both_of(many());
  opc_error error = {0};
  opc_module *m = opc_test_module("write.klayout", "{ worst: 2 }", &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "mask", b.classes);
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  opc_test_module_free(m);
  g_autofree char *map =
      g_strdup_printf("{ file: '%s/run.oas' }", opc_test_folder());
  opc_module *reader = opc_test_module("read.oasis", map, &error);
  if (!reader) g_error("%s", error.message);
  eda_layout *file = run_step(reader);
  for (size_t k = 0; k < 2; k++) {
    g_assert_cmpfloat(file_differs(file, masks[k], &b.flat->shapes[k]), ==, 0);
    g_assert_cmpfloat(file_differs(file, drawn[k], &b.gates->drawn[k]), ==, 0);
  }
  release_sample(reader, file);
  both_clear(&b);
}

/* ---- the store ---- */

/* A mask that was saved and restored has the same transistors, figures and
   shapes. */
static void test_restore(void) {
  both b = uneven;
  opc_error error = {0};
  const eda_mask *all;
  void *outputs[] = {b.classes}, *again[] = {NULL};
  const opc_step *step = b.by_classes->functions;
  opc_module *other = chip_of(&b.d, CHEAP ", radius: 800 nm");
  if (step->save(b.by_classes->self, outputs, opc_test_folder(), &error) ||
      step->restore(other->self, opc_test_folder(), again, &error))
    g_error("%s", error.message);
  const eda_mask *m = again[0];
  const eda_chip *x = m->chip, *y = b.classes->chip;
  g_assert_cmpmem(x->gate, x->count * sizeof *x->gate, y->gate,
                  y->count * sizeof *y->gate);
  g_assert_cmpmem(x->mask, x->masks * sizeof *x->mask, y->mask,
                  y->masks * sizeof *y->mask);
  for (size_t i = 0; i < b.flat->gates->count; i++) {
    size_t k = class_of(&b, i);
    g_assert_true(m->after.ion[k] == b.classes->after.ion[k]);
    g_assert_true(m->design.ioff[k] == b.classes->design.ioff[k]);
    g_assert_true(m->gates->length[k] == b.gates->length[i]);
    g_assert_cmpuint(m->count[k], ==, b.classes->count[k]);
  }
  if (eda_mask_flat(m, &all, &error)) g_error("%s", error.message);
  for (size_t k = 0; k < 2; k++)
    g_assert_cmpfloat(shapes_difference(&all->shapes[k], &b.flat->shapes[k]),
                      ==, 0);
  release_sample(other, again[0]);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  uneven_set_up();
  g_test_add_func("/parts/verify", test_verify);
  g_test_add_func("/parts/window", test_window);
  g_test_add_func("/parts/image", test_image);
  g_test_add_func("/parts/all", test_all);
  g_test_add_func("/parts/netlist", test_netlist);
  g_test_add_func("/parts/cost", test_cost);
  g_test_add_func("/parts/klayout", test_klayout);
  g_test_add_func("/parts/restore", test_restore);
  int code = g_test_run();
  both_clear(&uneven);
  return code;
}
