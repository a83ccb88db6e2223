/* SPDX-License-Identifier: BSD-3-Clause */
/* Model cards, and netlists with printed sizes: the text, with sizes, DLC and
   overlap capacitances computed by hand. Results in ngspice are tested with
   netlist.annotate. */
#include <eda/netlist.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *folder;

/* Write a file to the test's folder and return its path. */
static char *file_put(const char *name, const char *text) {
  char *path = g_build_filename(folder, name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

static void file_remove(char *path) {
  g_unlink(path);
  g_free(path);
}

/* ---- cards ---- */

/* Read the card `name` and write a copy with the name "copy" and a DLC 3 nm
   larger. Return the text (free()), or the error after the name of the file. */
static char *card_copy(const char *deck, const char *name, int type) {
  opc_error error;
  eda_pool pool = {0};
  eda_card card;
  char *path = file_put("card.sp", deck), *text;
  size_t size;
  if (eda_card_read(&pool, path, name, type, &card, &error)) {
    text = strdup(strstr(error.message, "card.sp") + strlen("card.sp"));
  } else {
    FILE *out = open_memstream(&text, &size);
    eda_card_write(out, &card, "copy", card.dlc + 3);
    fclose(out);
  }
  file_remove(path);
  eda_pool_clear(&pool);
  return text;
}

/* Overlaps that a card lacks: DLC Cox - CGSL with a positive DLC, otherwise 0.6
   XJ Cox, where Cox is 3.453133e-11 / TOX at levels 8 and 49, and EPSROX *
   8.85418e-12 / TOXE at levels 14 and 54. */
static void test_cards(void) {
  static const struct {
    const char *parameters, *want;
  } cases[] = {
      {"level=8 dlc=4n tox=2e-9 CGSO=1 cgdo=2",
       "copy nmos dlc=7e-9\n+ level=8 tox=2e-9 CGSO=1 cgdo=2\n"},
      {"level=49 lint=4n CGSO=1 cgdo=2",
       "copy nmos dlc=7e-9\n+ level=49 lint=4n CGSO=1 cgdo=2\n"},
      {"level=14 dlc=5n lint=4n CGSO=1 cgdo=2",
       "copy nmos dlc=8e-9\n+ level=14 lint=4n CGSO=1 cgdo=2\n"},
      {"level=54 lint=4n dlc=-5n CGSO=1 cgdo=2",
       "copy nmos dlc=-2e-9\n+ level=54 lint=4n CGSO=1 cgdo=2\n"},
      {"level=54 CGSO=1 cgdo=2 vth0='1 + 2' k1=a+b k2=-1e-3 k3='(4)'",
       "copy nmos dlc=3e-9\n+ level=54 CGSO=1 cgdo=2 vth0='1 + 2' k1='a+b' "
       "k2=-1e-3\n+ k3='(4)'\n"},
      /* 0.6 * 1.5e-7 * 3.453133e-11 / 150e-10 */
      {"level=8",
       "copy nmos dlc=3e-9\n+ level=8 cgso=2.0718798e-10 "
       "cgdo=2.0718798e-10\n"},
      /* 4e-9 * 3.453133e-11 / 2e-9 - 1e-11; the same */
      {"level=49 dlc=4n tox=2n cgsl=1e-11",
       "copy nmos dlc=7e-9\n+ level=49 tox=2n cgsl=1e-11 cgso=5.906266e-11 "
       "cgdo=6.906266e-11\n"},
      /* 0.6 * 1e-8 * 3.9 * 8.85418e-12 / 30e-10: a DLC that is not positive */
      {"level=54 dlc=0 xj=1e-8",
       "copy nmos dlc=3e-9\n+ level=54 xj=1e-8 cgso=6.9062604e-11 "
       "cgdo=6.9062604e-11\n"},
      /* 2e-9 * 2 * 8.85418e-12 / 1e-9; LINT is no DLC */
      {"level=14 dlc=2n toxe=1n epsrox=2 toxp=3n",
       "copy nmos dlc=5e-9\n+ level=14 toxe=1n epsrox=2 toxp=3n "
       "cgso=3.541672e-11 cgdo=3.541672e-11\n"},
      {"level=54 toxp=3n",
       ":2:1: model 'm' has no cgso, without which a DLC "
       "would change other properties"},
      {"level=54 mtrlmod=1 cgso=1",
       ":2:1: model 'm' has no cgdo, without "
       "which a DLC would change other "
       "properties"},
      {"level=54 xj='2*3'",
       ":2:1: model 'm' has no cgso, without which a DLC "
       "would change other properties"},
      {"level=1",
       ":2:21: a model of level 1 has no DLC, expected level 8, 49, "
       "14 or 54"},
      {"dlc=1n", ":2:1: model 'm' has no level"},
      {"level=54 dlc=1q2", ":2:28: '1q2' is not a number"},
      {"level=54 lint", ":2:24: 'lint' is not of the form NAME=VALUE"},
      {"level=54 lint= =2", ":2:24: 'lint' is not of the form NAME=VALUE"},
      {"level=54\n.model m nmos level=54", ":3:8: 'm' is already defined"}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autofree char *deck =
        g_strdup_printf("* t\n.model m nmos %s\n", cases[k].parameters);
    char *is = card_copy(deck, "M", EDA_NMOS);
    g_autofree char *want = g_strconcat(
        cases[k].want[0] == ':' ? "" : ".model ", cases[k].want, NULL);
    g_assert_cmpstr(is, ==, want);
    free(is);
  }
  char *is = card_copy("* t\n.model m pmos level=54\n", "m", EDA_NMOS);
  g_assert_cmpstr(is, ==, ":2:10: model 'm' is not of the type nmos");
  free(is);
  is = card_copy("* t\n.model mm nmos level=54\n", "m", EDA_NMOS);
  g_assert_cmpstr(is, ==, "' has no model 'm'");
  free(is);
}

/* Both models are in one file, or in two. Errors name the parameter of the
   file, and models of included files are found. */
static void test_files(void) {
  opc_error error;
  eda_pool pool = {0};
  eda_card card[2];
  const char *paths[2];
  char *inner = file_put("inner.sp",
                         ".model n nmos level=8 cgso=0 cgdo=0 dlc=2n\n"
                         ".model p pmos level=8 cgso=0 cgdo=0 dlc=3n\n");
  char *both = file_put("both.sp", ".include inner.sp\n");
  char *other =
      file_put("other.sp", ".model p pmos level=8 cgso=0 cgdo=0 dlc=4n\n");
  char *quoted = file_put("a\"b.sp", "* t\n");
  const char *names[2] = {"n", "p"}, *one[2] = {both, NULL},
             *two[2] = {both, other}, *missing[2] = {both, "/nowhere/x"},
             *bad[2] = {quoted, NULL}, *none[2] = {NULL, NULL};
  if (eda_cards_read(&pool, one, names, 1, paths, card, &error))
    g_error("%s", error.message);
  g_assert_true(g_path_is_absolute(paths[0]));
  g_assert_true(g_str_has_suffix(paths[0], "/both.sp"));
  g_assert_null(paths[1]);
  g_assert_cmpfloat_with_epsilon(card[0].dlc, 2, 1e-12);
  g_assert_cmpfloat_with_epsilon(card[1].dlc, 3, 1e-12);
  g_assert_cmpstr(card[1].kind, ==, "pmos");
  if (eda_cards_read(&pool, two, names, 1, paths, card, &error))
    g_error("%s", error.message);
  g_assert_true(g_str_has_suffix(paths[1], "/other.sp"));
  g_assert_cmpfloat_with_epsilon(card[0].dlc, 2, 1e-12);
  g_assert_cmpfloat_with_epsilon(card[1].dlc, 4, 1e-12);
  g_assert_cmpint(eda_cards_read(&pool, none, names, 0, paths, card, &error),
                  ==, OPC_OK);
  g_assert_true(!paths[0] && !paths[1]);
  g_assert_cmpint(eda_cards_read(&pool, missing, names, 1, paths, card, &error),
                  ==, OPC_IO);
  g_assert_cmpstr(error.parameter, ==, "pmos_models");
  g_assert_cmpstr(error.message, ==,
                  "cannot read '/nowhere/x': No such file or directory");
  g_assert_cmpint(eda_cards_read(&pool, bad, names, 0, paths, card, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "models");
  g_assert_nonnull(strstr(error.message,
                          "a\"b.sp': the simulator cannot open a file name "
                          "with a quote or line break"));
  names[1] = "q";
  g_assert_cmpint(eda_cards_read(&pool, one, names, 1, paths, card, &error), ==,
                  OPC_INVALID);
  g_assert_true(g_str_has_suffix(error.message, "has no model 'q'"));
  file_remove(inner);
  file_remove(both);
  file_remove(other);
  file_remove(quoted);
  eda_pool_clear(&pool);
}

/* ---- netlists ---- */

enum { GATES = 4, PORTS = 13 };

/* A circuit of two n-transistors and one p-transistor of two fingers. */
typedef struct bench {
  eda_gates gates;
  eda_mask mask;
  eda_circuit *circuit;
  eda_annotation a;
} bench;

static double width[GATES] = {100, 200, 100, 300};
static uint32_t numbers[GATES] = {1, 2, 3, 4};
static char *empty[GATES] = {(char *)"", (char *)"", (char *)"", (char *)"X9"};
static char *cells[GATES] = {(char *)"C", (char *)"C", (char *)"C",
                             (char *)"D"};

static bench bench_new(void) {
  static const uint32_t finger[GATES] = {0, 1, 2, 3};
  bench b = {.gates = {.count = GATES,
                       .width = width,
                       .number = numbers,
                       .instance = empty,
                       .cell = cells}};
  eda_performance_init(&b.mask.before, GATES);
  eda_performance_init(&b.mask.after, GATES);
  b.mask.flags = g_new0(uint32_t, GATES);
  for (size_t i = 0; i < GATES; i++) {
    b.mask.after.leq_ion[i] = 62;
    b.mask.after.weq[i] = 10 * ((double)i + 10);
    b.mask.after.area[i] = 62 * b.mask.after.weq[i];
    b.mask.before.leq_ion[i] = 70;
    b.mask.before.weq[i] = 110;
    b.mask.before.area[i] = 70 * 110;
  }
  b.circuit = eda_circuit_new(NULL, "top/cell", PORTS, PORTS, 3);
  for (uint32_t i = 0; i < PORTS; i++) {
    g_autofree char *name = g_strdup_printf(i % 2 ? "X/n%u" : "n%u", i);
    b.circuit->net[i] = eda_pool_text(&b.circuit->memory, name, strlen(name));
    b.circuit->port[i] = i;
  }
  static const eda_device devices[] = {
      {"MN", 0, 1, 2, 3, 60, 100, EDA_NMOS, 1, finger, "nfast"},
      {"XU/MN", 4, 1, 2, 3, 61, 210, EDA_NMOS, 1, finger + 1, NULL},
      {"xp", 0, 1, 5, 6, 59, 800, EDA_PMOS, 2, finger + 2, NULL}};
  memcpy(b.circuit->device, devices, sizeof devices);
  b.a = (eda_annotation){.circuit = b.circuit, .state = EDA_DRAWN};
  return b;
}

/* Set the pointers after the struct has its place. */
static void bench_link(bench *b) {
  b->circuit->gates = b->mask.gates = &b->gates;
  b->a.mask = &b->mask;
}

static void bench_free(bench *b) {
  eda_performance_clear(&b->mask.before);
  eda_performance_clear(&b->mask.after);
  g_free(b->mask.flags);
  eda_circuit_free(b->circuit);
}

static void expect_text(const bench *b, size_t transistors, size_t models,
                        const char *want) {
  opc_error error;
  eda_annotated counts = {0};
  char *is = eda_annotate(&b->a, &counts, &error);
  if (!is) g_error("%s", error.message);
  g_assert_cmpstr(is, ==, want);
  g_assert_cmpuint(counts.transistors, ==, transistors);
  g_assert_cmpuint(counts.models, ==, models);
  free(is);
}

#define HEAD                                                               \
  ".subckt top.cell n0 X.n1 n2 X.n3 n4 X.n5 n6 X.n7 n8 X.n9 n10\n+ X.n11 " \
  "n12\n"

/* The width of a finger is a share of the width in the netlist. */
static void test_drawn(void) {
  bench b = bench_new();
  bench_link(&b);
  b.a.mask = NULL;
  expect_text(&b, 4, 0,
              "* top/cell: sizes as drawn\n" HEAD
              "MN n0 X.n1 n2 X.n3 nfast w=100e-9 l=60e-9\n"
              "M.XU.MN n4 X.n1 n2 X.n3 nmos w=210e-9 l=61e-9\n"
              "M.xp n0 X.n1 X.n5 n6 pmos w=200e-9 l=59e-9\n"
              "M.xp_f2 n0 X.n1 X.n5 n6 pmos w=600e-9 l=59e-9\n.ends\n");
  b.a.subcircuits = 1;
  b.a.unit = 1000;
  b.a.model[EDA_NMOS] = "nx";
  expect_text(&b, 4, 0,
              "* top/cell: sizes as drawn\n" HEAD
              "XMN n0 X.n1 n2 X.n3 nx w=0.1 l=0.06\n"
              "XU.MN n4 X.n1 n2 X.n3 nx w=0.21 l=0.061\n"
              "xp n0 X.n1 X.n5 n6 pmos w=0.2 l=0.059\n"
              "xp_f2 n0 X.n1 X.n5 n6 pmos w=0.6 l=0.059\n.ends\n");
  bench_free(&b);
}

/* DLC changes by half of the length for the current minus the mean length:
   (62 - 58) / 2 = 2 nm, (62 - 65) / 2 = -1.5 nm. Equal changes share a card. */
static void test_printed(void) {
  static const char *key[] = {"level"}, *value[] = {"54"};
  static const eda_card n = {"n", "nmos", 1, key, value, 5},
                        p = {"p", "pmos", 1, key, value, -1};
  bench b = bench_new();
  bench_link(&b);
  b.a.state = EDA_BEFORE;
  expect_text(&b, 4, 0,
              "* top/cell: sizes as printed before correction\n" HEAD
              "MN n0 X.n1 n2 X.n3 nfast w=110e-9 l=70e-9\n"
              "M.XU.MN n4 X.n1 n2 X.n3 nmos w=110e-9 l=70e-9\n"
              "M.xp n0 X.n1 X.n5 n6 pmos w=110e-9 l=70e-9\n"
              "M.xp_f2 n0 X.n1 X.n5 n6 pmos w=110e-9 l=70e-9\n.ends\n");
  b.a.state = EDA_AFTER;
  b.a.card[EDA_NMOS] = &n;
  b.a.card[EDA_PMOS] = &p;
  b.a.model[EDA_NMOS] = "n";
  b.a.model[EDA_PMOS] = "p";
  b.mask.after.area[0] = 58 * 100;
  b.mask.after.area[1] = 65 * 110;
  b.mask.after.area[2] = 58 * 120;
  b.mask.after.area[3] = 58 * 130;
  b.mask.flags[0] = EDA_PRINT_NECK;
  expect_text(&b, 4, 3,
              "* top/cell: sizes as printed after correction\n"
              ".model n_dlcm150 nmos dlc=3.5e-9\n+ level=54\n"
              ".model n_dlc200 nmos dlc=7e-9\n+ level=54\n"
              ".model p_dlc200 pmos dlc=1e-9\n+ level=54\n" HEAD
              "MN n0 X.n1 n2 X.n3 n_dlc200 w=100e-9 l=62e-9\n"
              "M.XU.MN n4 X.n1 n2 X.n3 n_dlcm150 w=110e-9 l=62e-9\n"
              "M.xp n0 X.n1 X.n5 n6 p_dlc200 w=120e-9 l=62e-9\n"
              "M.xp_f2 n0 X.n1 X.n5 n6 p_dlc200 w=130e-9 l=62e-9\n.ends\n");
  bench_free(&b);
}

/* Each size that is no number, infinite or zero is refused. */
static void test_refused(void) {
  opc_error error;
  bench b = bench_new();
  bench_link(&b);
  b.a.state = EDA_AFTER;
  double *sizes[] = {&b.mask.after.leq_ion[3], &b.mask.after.weq[3],
                     &b.mask.after.area[3]};
  const double bad[] = {0, -5, (double)NAN, (double)INFINITY};
  for (size_t k = 0; k < G_N_ELEMENTS(sizes); k++)
    for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
      double good = *sizes[k];
      *sizes[k] = bad[i];
      g_assert_null(eda_annotate(&b.a, NULL, &error));
      g_assert_cmpstr(
          error.message, ==,
          "netlist device 'xp' has no size: the gate 'X9:4' does not print");
      *sizes[k] = good;
    }
  b.mask.after.area[1] = 110 * 20100; /* DLC of 10,019 nm */
  g_assert_null(eda_annotate(&b.a, NULL, &error));
  g_assert_cmpstr(error.message, ==,
                  "netlist device 'XU/MN' has no size: the gate 'C:2' does not "
                  "print well");
  b.mask.after.area[1] = 110 * 20000;
  b.mask.flags[2] = EDA_PRINT_SHORT | EDA_PRINT_WIDE;
  g_assert_null(eda_annotate(&b.a, NULL, &error));
  g_assert_nonnull(strstr(error.message, "'xp' has no size: the gate 'C:3' "));
  b.a.state = EDA_BEFORE; /* flags are those of the corrected mask */
  char *text = eda_annotate(&b.a, NULL, &error);
  g_assert_nonnull(text);
  free(text);
  bench_free(&b);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("annotate-test-XXXXXX", NULL);
  g_test_add_func("/annotate/cards", test_cards);
  g_test_add_func("/annotate/files", test_files);
  g_test_add_func("/annotate/drawn", test_drawn);
  g_test_add_func("/annotate/printed", test_printed);
  g_test_add_func("/annotate/refused", test_refused);
  int code = g_test_run();
  g_rmdir(folder);
  g_free(folder);
  return code;
}
