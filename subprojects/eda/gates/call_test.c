/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of faulty plugins, which write one byte before or beyond each of their
   arrays. All tests also run in a process with guard pages. */
#include <eda/check.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gates/fence.h"

/* ---- faulty plugins ---- */

enum { NONE = 99, GATES = 2, LAYERS = 2, MOST = 3 };
static int at_fault,
    before_it;           /* array beside which a plugin writes; 1: before it */
static const char *text; /* verdict or name of a rule */
static size_t violations = 5;
static int fails; /* 1: the synthesizer reports an error */

/* Write one byte beside array `i` if this array is at fault. */
static void leave(int i, void *array, size_t bytes) {
  if (i == at_fault) ((char *)array)[before_it ? -1 : (int)bytes] = 0;
}

static int move_all(void *self, const eda_feedback *feedback, eda_moves *m,
                    int *done, opc_error *error) {
  static const eda_box box = {0, 0, 3, 4};
  (void)self;
  int32_t *of[] = {m->l, m->w, m->jog, m->aside};
  g_assert_cmpuint(feedback->iteration, ==, 7);
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < GATES; i++) of[k][i] += 10 * k + i;
    leave(k, of[k], GATES * sizeof **of);
  }
  m->shift[1][2] = -5;
  leave(4, m->shift[1], 3 * sizeof(int32_t));
  m->part[EDA_PARTS].to = 8;
  leave(5, m->part, GATES * EDA_PARTS * sizeof *m->part);
  m->assists[1] = (eda_boxes){&box, 1};
  leave(6, m->assists, LAYERS * sizeof *m->assists);
  *done = 1;
  return fails ? opc_fail(error, OPC_IO, NULL, "lost") : OPC_OK;
}

static const char *verdict_of(const void *self, size_t gate) {
  (void)self;
  return gate ? text : NULL;
}

static const eda_synthesizer moving = {.update = move_all,
                                       .verdict = verdict_of};
static const opc_module synthesizer = {&moving, NULL, "synthesizer.moving"};

static int rule_all(void *self, const eda_printed *printed, eda_ruling *r,
                    opc_error *error) {
  static const eda_box box = {0, 0, 3, 4};
  (void)self, (void)printed, (void)error;
  r->vetoes[1] = 3;
  r->end[3] = 6;
  r->added[0] = r->cutouts[1] = (eda_boxes){&box, 1};
  r->transistors = 1;
  leave(0, r->vetoes, GATES * sizeof *r->vetoes);
  leave(1, r->end, 2 * GATES * sizeof *r->end);
  leave(2, r->added, LAYERS * sizeof *r->added);
  leave(3, r->cutouts, LAYERS * sizeof *r->cutouts);
  return OPC_OK;
}

static int list_violations(void *self, const eda_printed *printed,
                           eda_violation *list, size_t most, size_t *count,
                           opc_error *error) {
  (void)self, (void)printed, (void)error;
  *count = violations;
  for (size_t i = 0; i < most && i < violations; i++)
    list[i] = (eda_violation){.rule = text, .gate = (int32_t)i - 1};
  leave(0, list, most * sizeof *list);
  return OPC_OK;
}

static const eda_regulator ruling = {.rule = rule_all,
                                     .violations = list_violations};
static const opc_module regulator = {&ruling, NULL, "regulator.ruling"};

static int extract_all(const void *self, const eda_slices *in,
                       eda_performance *out, opc_error *error) {
  (void)self, (void)error;
  for (int k = 0; k < 6; k++) {
    double *figure = (&out->ion)[k];
    for (size_t i = 0; i < in->count; i++) figure[i] = k + (double)i / 8;
    leave(k, figure, in->count * sizeof *figure);
  }
  out->outside[1] = 1;
  leave(6, out->outside, in->count);
  return OPC_OK;
}

static void slice_gate(const void *self, const eda_printed_gate *gate,
                       double *place, double *width) {
  (void)self, (void)gate;
  place[0] = 0.25, place[1] = 0.75;
  width[0] = 0.4, width[1] = 0.6;
  leave(0, place, 4 * sizeof *place); /* the widths follow the places */
}

static const eda_extractor slicing = {.extract = extract_all,
                                      .slice = slice_gate};
static const opc_module extractor = {&slicing, NULL, "extractor.slicing"};

/* Change the values in place in layer 0; replace the values in layer 1. */
static int print_layer(const void *self, int layer, eda_field *field,
                       opc_error *error) {
  (void)self, (void)error;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  if (layer) {
    const eda_field old = *field;
    eda_field_clear(field);
    *field = old;
    field->coefficients = eda_alloc(n, sizeof(float));
  }
  for (size_t i = 0; i < n; i++) field->coefficients[i] = (float)i + 0.5F;
  leave(layer, field->coefficients, n * sizeof(float));
  return OPC_OK;
}

static const eda_resist printing = {.print = print_layer};
static const opc_module resist = {&printing, NULL, "resist.printing"};

/* ---- tests ---- */

/* Check the error of a call that wrote before or beyond `array`. */
static void expect_left(int code, const char *array, const opc_error *error) {
  if (at_fault == NONE) {
    g_assert_cmpint(code, ==, OPC_OK);
    return;
  }
  g_autofree char *want = g_strdup_printf(
      "writes %s the array of %s", before_it ? "before" : "beyond", array);
  g_assert_cmpint(code, ==, OPC_FAILED);
  g_assert_cmpstr(error->message, ==, want);
}

/* Call `test` for each of n arrays and each side, then without a fault. */
static void each_fault(int n, void (*test)(int good)) {
  for (at_fault = 0; at_fault < n; at_fault++)
    for (before_it = 0; before_it < 2; before_it++) test(0);
  at_fault = NONE;
  test(1);
}

/* The moves of a faulty synthesizer are not used. */
static void try_update(int good) {
  static const char *const names[] = {
      "moves of L",          "moves of W", "jogs",   "moves aside",
      "shifts of fragments", "parts",      "assists"};
  const eda_gates *g = eda_gates_sample();
  int32_t of[4][GATES] = {{100}, {200}, {300}, {400}}, shifts[3] = {1, 2, 3};
  int32_t *shift[LAYERS] = {NULL, shifts};
  eda_boxes assists[LAYERS] = {{NULL, 0}};
  eda_part part[GATES * EDA_PARTS] = {{0}};
  eda_moves m = {of[0], of[1], of[2], shift, assists, part, of[3]};
  const size_t fragments[LAYERS] = {0, 3};
  const eda_feedback feedback = {.iteration = 7, .gates = g};
  int done = 0;
  opc_error error;
  g_assert_cmpuint(g->count, ==, GATES);
  int code = eda_call_update(NULL, &synthesizer, &feedback, fragments, &m,
                             &done, &error);
  if (fails) {
    g_assert_cmpint(code, ==, OPC_IO);
    g_assert_cmpstr(error.message, ==, "lost");
  } else {
    expect_left(code, good ? "" : names[at_fault], &error);
  }
  for (int k = 0; k < 4; k++) {
    g_assert_cmpint(of[k][0], ==, 100 * (k + 1) + (good ? 10 * k : 0));
    g_assert_cmpint(of[k][1], ==, good ? 10 * k + 1 : 0);
  }
  g_assert_cmpint(shifts[2], ==, good ? -5 : 3);
  g_assert_cmpint(part[EDA_PARTS].to, ==, good ? 8 : 0);
  g_assert_cmpuint(assists[1].count, ==, good);
}

static void test_update(void) {
  each_fault(7, try_update);
  fails = 1;
  for (at_fault = 0; at_fault < 7; at_fault++) try_update(0);
}

static void try_rule(int good) {
  static const char *const names[] = {"vetoes", "line ends", "added shapes",
                                      "cut-outs"};
  const eda_printed printed = {.gates = eda_gates_sample()};
  uint32_t vetoes[GATES] = {0};
  int32_t end[2 * GATES] = {0};
  eda_boxes added[LAYERS] = {{NULL, 0}}, cutouts[LAYERS] = {{NULL, 0}};
  eda_ruling r = {
      .vetoes = vetoes, .end = end, .added = added, .cutouts = cutouts};
  opc_error error;
  int code = eda_call_rule(NULL, &regulator, &printed, 0, &r, &error);
  expect_left(code, good ? "" : names[at_fault], &error);
  g_assert_cmpuint(vetoes[1], ==, good ? 3 : 0);
  g_assert_cmpint(end[3], ==, good ? 6 : 0);
  g_assert_cmpuint(added[0].count, ==, good);
  g_assert_cmpuint(cutouts[1].count, ==, good);
  g_assert_cmpuint(r.transistors, ==, good);
}

static void test_rule(void) { each_fault(4, try_rule); }

/* The plugin finds more violations than the MOST for which the list has
   capacity. */
static void try_violations(int good) {
  const eda_printed printed = {.gates = eda_gates_sample()};
  eda_violation list[MOST] = {{0}};
  opc_error error;
  size_t count = 0;
  text = "width";
  int code = eda_call_violations(NULL, &regulator, &printed, list, MOST, &count,
                                 &error);
  expect_left(code, "violations", &error);
  g_assert_cmpuint(count, ==, good ? 5 : 0);
  for (int i = 0; i < MOST; i++) {
    g_assert_cmpstr(list[i].rule, ==, good ? "width" : NULL);
    g_assert_cmpint(list[i].gate, ==, good ? i - 1 : 0);
  }
}

/* Texts are copied. Texts that are too long or not UTF-8 are refused. */
static void test_texts(void) {
  char word[300] = "sound";
  const char *verdict;
  opc_error error;
  each_fault(1, try_violations);
  violations = 1;
  eda_violation list[MOST] = {{0}};
  const eda_printed printed = {.gates = eda_gates_sample()};
  size_t count;
  g_assert_cmpint(eda_call_violations(NULL, &regulator, &printed, list, MOST,
                                      &count, &error),
                  ==, OPC_OK);
  g_assert_cmpuint(count, ==, 1);
  text = word;
  g_assert_cmpint(eda_call_verdict(NULL, &synthesizer, 0, &verdict, &error), ==,
                  OPC_OK);
  g_assert_cmpstr(verdict, ==, "");
  g_assert_cmpint(eda_call_verdict(NULL, &synthesizer, 1, &verdict, &error), ==,
                  OPC_OK);
  memset(word, 'x', 201);
  g_assert_cmpstr(verdict, ==, "sound");
  for (size_t n = 200; n < 202; n++) {
    word[n] = 0;
    g_assert_cmpint(eda_call_verdict(NULL, &synthesizer, 1, &verdict, &error),
                    ==, n > 200 ? OPC_FAILED : OPC_OK);
    word[n] = 'x';
  }
  g_assert_cmpstr(error.message, ==,
                  "a verdict is not a text of at most 200 bytes");
  g_snprintf(word, sizeof word, "ab\xff");
  g_assert_cmpint(eda_call_verdict(NULL, &synthesizer, 1, &verdict, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.message, ==, "a verdict is not UTF-8: byte 3 is 0xff");
}

static void try_extract(int good) {
  const eda_slices in = {.count = GATES, .slices = 1};
  eda_performance out;
  opc_error error;
  eda_performance_init(&out, GATES);
  int code = eda_call_extract(NULL, &extractor, &in, &out, &error);
  expect_left(code, at_fault == 6 ? "outside" : "figures", &error);
  for (int k = 0; k < 6; k++)
    g_assert_cmpfloat((&out.ion)[k][1], ==, good ? k + 0.125 : 0);
  g_assert_cmpuint(out.outside[1], ==, good);
  eda_performance_clear(&out);
}

static void try_slice(int good) {
  const eda_printed_gate gate = {.width = 100};
  double both[4] = {0};
  opc_error error;
  int code = eda_call_slice(NULL, &extractor, &gate, 2, both, &error);
  expect_left(code, "places and widths", &error);
  g_assert_cmpfloat(both[1], ==, good ? 0.75 : 0);
  g_assert_cmpfloat(both[2], ==, good ? 0.4 : 0);
}

static void test_extract(void) {
  each_fault(7, try_extract);
  each_fault(1, try_slice);
}

/* A resist may change the values in place or replace the array. An array that
   the resist allocates has no guard words. */
static void test_print(void) {
  for (int layer = 0; layer < 2; layer++)
    for (int good = 0; good < 2; good++) {
      eda_field f = {.frame = {0, 0, 80, 60}, .nx = 8, .ny = 6};
      opc_error error;
      f.coefficients = eda_alloc(48, sizeof(float));
      at_fault = good ? NONE : 0;
      before_it = 0;
      int code = eda_call_print(NULL, &resist, layer, &f, &error);
      if (!layer) expect_left(code, "level sets", &error);
      if (good || layer) {
        g_assert_cmpint(code, ==, OPC_OK);
        g_assert_cmpfloat(f.coefficients[47], ==, 47.5);
      }
      eda_field_clear(&f);
    }
}

/* With guard pages, a pointer to a freed array is not valid, even if new arrays
   have been created. */
static void test_retired(void) {
#ifndef __SANITIZE_ADDRESS__
  if (!g_getenv("OPCFLOW_GUARD")) return;
  int status;
  pid_t child = fork();
  if (!child) {
    volatile char *old = fence_new(100, 1, NULL);
    signal(SIGSEGV, SIG_DFL);
    fence_free((void *)old);
    for (int i = 0; i < 100; i++) (void)fence_new(100, 1, NULL);
    old[50] = 1;
    _exit(0);
  }
  g_assert_cmpint(waitpid(child, &status, 0), ==, child);
  g_assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV);
#endif
}

int main(int argc, char **argv) {
  fflush(NULL);
  pid_t paged = fork();
  if (!paged) {
    g_setenv("OPCFLOW_GUARD", "pages", TRUE);
    if (!freopen("/dev/null", "w", stdout)) _exit(99);
  } else {
    g_unsetenv("OPCFLOW_GUARD");
  }
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/call/update", test_update);
  g_test_add_func("/call/rule", test_rule);
  g_test_add_func("/call/texts", test_texts);
  g_test_add_func("/call/extract", test_extract);
  g_test_add_func("/call/print", test_print);
  g_test_add_func("/call/retired", test_retired);
  int status = 0, code = g_test_run();
  if (paged) g_assert_cmpint(waitpid(paged, &status, 0), ==, paged);
  g_assert_cmpint(status, ==, 0);
  return code;
}
