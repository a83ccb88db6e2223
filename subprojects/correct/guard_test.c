/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the guard with synthesizers that follow a script of bad displacements,
   on two transistors that share one poly line. A line of 60 nm prints 80 nm
   wide here: a bias of -14 corrects its Ion, and one of -60 or less opens
   it. */
#include "models_test.h"

enum { GATES = 2, MOVES = 2 };

/* ---- a synthesizer with a script ---- */

typedef struct script {
  int32_t l[MOVES][GATES];
  int moves;
  double target[GATES];
} script;

static int begin_moves(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)error;
  g_assert_cmpuint(f->gates->count, ==, GATES);
  return OPC_OK;
}

static int update_moves(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  const script *s = self;
  (void)error;
  for (int i = 0; i < GATES && (int)f->iteration < s->moves; i++)
    m->l[i] = s->l[f->iteration][i];
  *done = (int)f->iteration + 1 >= s->moves;
  return OPC_OK;
}

static double target(const void *self, size_t gate) {
  return ((const script *)self)->target[gate];
}

static const eda_synthesizer scripted = {
    .begin = begin_moves, .update = update_moves, .target = target};
#define SCRIPTED(s) MODULE(&scripted, &(s))

/* ---- a regulator with prescribed violations ---- */

/* Tests a rule that transistor 0 violates, or that no transistor owns. The rule
   is violated if `drawn` is 1, or if a transistor of the bit mask `moved` has a
   displaced mask. */
enum { OWN = 1, OTHERS = 2 };
static int drawn, moved, nobodys;
static double aside[2]; /* distance of the violation from the drawn position
                           once masks are displaced, nm */

static int set_rules(void *self, const eda_printed *p, eda_ruling *r,
                     opc_error *error) {
  (void)self, (void)p, (void)r, (void)error;
  return OPC_OK;
}

static int violations(void *self, const eda_printed *p, eda_violation *v,
                      size_t most, size_t *count, opc_error *error) {
  (void)self, (void)error;
  int biased = p->l[0] || p->l[1];
  *count = drawn || (moved & OWN && p->l[0]) || (moved & OTHERS && p->l[1]);
  g_assert_cmpuint(most, >, 1);
  if (*count)
    v[0] = (eda_violation){
        .rule = biased ? "width: too much" : "width", .x = 30, .y = 200};
  if (*count && biased) v[0].x += aside[0], v[0].y += aside[1];
  if (*count && nobodys) v[0].gate = -1;
  return OPC_OK;
}

static const eda_regulator finder = {.rule = set_rules,
                                     .violations = violations};

/* ---- an extractor that couples two transistors ---- */

/* Transistor 0 has half of its current if transistor 1 does not print as drawn.
   The first call measures the drawn shapes. */
static int calls;

static int extract_coupled(const void *self, const eda_slices *in,
                           eda_performance *out, opc_error *error) {
  int code = model_extract(self, in, out, error);
  if (calls++ && !(in->length[1] > 70)) out->ion[0] /= 2;
  return code;
}

static const eda_extractor coupled = {.prepare = prepare_nothing,
                                      .slicing = model_slicing,
                                      .extract = extract_coupled};

/* ---- the loop ---- */

static double limit_of_guard = 0.5; /* % */
static int still;                   /* 1: transistor 0 keeps its mask */

static void run_step(loop *l, const opc_module *synthesizer,
                     const eda_extractor *e, const opc_module *regulator,
                     int hold) {
  opc_error error = {0};
  *l = (loop){.host = &host,
              .gates = eda_gates_sample(),
              .extractor = MODULE(e, NULL),
              .regulator = regulator,
              .max_iterations = 10,
              .hold = hold,
              .ion_limit = limit_of_guard,
              .drivers[MAIN].module = synthesizer};
  calls = 0;
  if (still) l->still = memset(eda_alloc(GATES, 1), 1, 1);
  eda_printer_init(&l->printer, NULL, l->gates, MODULE(&litho, NULL),
                   MODULE(&resist, NULL), 300);
  g_assert_cmpint(correct_loop_run(l, &error), ==, OPC_OK);
}

static double deviation_of(const loop *l, const eda_performance *p, size_t i) {
  return fabs(eda_deviation(p->ion[i], l->design.ion[i]));
}

/* Check the bias and verdict of `gate`. */
static void expect_result(const loop *l, size_t gate, int32_t bias,
                          const char *text) {
  g_autofree char *verdict = correct_guard_verdict(&l->guard, gate);
  g_assert_cmpint(l->now.biases.l[gate], ==, bias);
  g_assert_cmpstr(verdict, ==, text);
}

static void test_good(void) {
  script s = {.l = {{-14, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  run_step(&l, SCRIPTED(s), &extractor, NULL, 1);
  g_assert_cmpfloat(deviation_of(&l, &l.before, 0), >, 15);
  g_assert_cmpfloat(deviation_of(&l, &l.measured.performance, 0), <, 2);
  expect_result(&l, 0, -14, NULL);
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpuint(l.guard.prints, ==, 0);
  g_assert_cmpuint(l.guard.back + l.guard.worse + l.guard.lost, ==, 0);
  correct_loop_clear(&l);
}

/* A gate that opens is reverted to its best mask; the other gate keeps its
   mask. */
static void test_open(void) {
  script s = {.l = {{-12, -14}, {-62, -14}}, .moves = 2, .target = {1, 1}};
  loop l;
  for (int hold = 0; hold < 2; hold++) {
    run_step(&l, SCRIPTED(s), &extractor, NULL, hold);
    int open = (l.measured.flags[0] & EDA_PRINT_OPEN) != 0;
    g_assert_cmpint(open, ==, !hold);
    g_assert_cmpuint(l.guard.lost, ==, !hold);
    g_assert_cmpuint(l.guard.back, ==, hold);
    expect_result(&l, 0, hold ? -12 : -62,
                  hold ? "reverted: its best mask" : NULL);
    expect_result(&l, 1, -14, NULL);
    correct_loop_clear(&l);
  }
}

/* If the deviation is larger than with the drawn mask, the drawn mask is
   restored. */
static void test_worse(void) {
  script s = {.l = {{40, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  run_step(&l, SCRIPTED(s), &extractor, NULL, 0);
  g_assert_cmpuint(l.guard.worse, ==, 1);
  expect_result(&l, 0, 40, NULL);
  correct_loop_clear(&l);
  run_step(&l, SCRIPTED(s), &extractor, NULL, 1);
  expect_result(&l, 0, 0, "reverted: its best mask");
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpuint(l.guard.worse, ==, 0);
  g_assert_cmpuint(l.guard.prints, ==, 1);
  correct_loop_clear(&l);
}

/* A deviation larger than with the drawn mask, but within the limit, is
   accepted. */
static void test_limit(void) {
  script s = {.l = {{-1, -14}}, .moves = 1, .target = {0.822, 1}};
  loop l;
  for (int good = 0; good < 2; good++) {
    limit_of_guard = good ? 5 : 0.5;
    run_step(&l, SCRIPTED(s), &extractor, NULL, 1);
    expect_result(&l, 0, good ? -1 : 0,
                  good ? NULL : "reverted: its best mask");
    correct_loop_clear(&l);
  }
  limit_of_guard = 0.5;
}

/* The best mask is not restored if its line ends differ from the present ones.
 */
static int move_end(void *self, const eda_printed *p, eda_ruling *r,
                    opc_error *error) {
  (void)self, (void)p, (void)error;
  r->end[0] = 20;
  return OPC_OK;
}

static const eda_synthesizer hasty = {.begin = begin_moves,
                                      .update = update_moves,
                                      .target = target,
                                      .flags = EDA_SYNTHESIZER_ENDS_ANYTIME};
static const eda_regulator mover = {.rule = move_end, .violations = violations};

static void test_ends(void) {
  script s = {.l = {{-30, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  drawn = moved = 0;
  run_step(&l, MODULE(&hasty, &s), &extractor, MODULE(&mover, NULL), 1);
  expect_result(&l, 0, -15, "reverted: half of its best mask");
  expect_result(&l, 1, -14, NULL);
  correct_loop_clear(&l);
}

/* The guard compares with the synthesizer's target of Ion; NAN: no target. */
static void test_target(void) {
  script s = {.l = {{-14, 40}}, .moves = 1, .target = {0.82, NAN}};
  loop l;
  run_step(&l, SCRIPTED(s), &extractor, NULL, 1);
  expect_result(&l, 0, 0, "reverted: its best mask");
  expect_result(&l, 1, 40, NULL);
  correct_loop_clear(&l);
}

/* If the drawn mask satisfies a rule and the transistor's own edges suffice to
   satisfy it, the transistor is reverted. A rule that the drawn mask violates
   may remain violated. */
static void test_rules(void) {
  script s = {.l = {{-14, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  drawn = 1, moved = OWN;
  run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
  expect_result(&l, 0, -14, NULL);
  g_assert_cmpuint(l.guard.prints, ==, 0); /* nothing to revert */
  correct_loop_clear(&l);
  /* The position of a violation may differ slightly. */
  static const struct {
    double aside[2];
    int is_new;
  } places[] = {{{99, 0}, 0},  {{-99, 99}, 0}, {{0, -99}, 0},
                {{101, 0}, 1}, {{-101, 0}, 1}, {{0, 101}, 1}};
  for (size_t k = 0; k < G_N_ELEMENTS(places); k++) {
    memcpy(aside, places[k].aside, sizeof aside);
    run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
    g_assert_cmpint(l.guard.prints > 0, ==, places[k].is_new);
    correct_loop_clear(&l);
  }
  aside[0] = aside[1] = 0;
  drawn = 0;
  run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
  expect_result(
      &l, 0, 0,
      "reverted: as drawn, for the rule width: too much at (30, 200) nm");
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpuint(l.guard.back, ==, 1);
  g_assert_cmpuint(l.guard.ruled, ==, 1);
  g_assert_cmpuint(l.guard.first, ==, 0);
  correct_loop_clear(&l);
  /* With a limit above the drawn deviation, the rule matters only to the
     verdict. */
  limit_of_guard = 50;
  run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
  limit_of_guard = 0.5;
  g_assert_cmpuint(l.guard.back, ==, 1);
  g_assert_cmpuint(l.guard.ruled, ==, 0);
  correct_loop_clear(&l);
  nobodys = 1;
  run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
  expect_result(&l, 0, -14, NULL);
  correct_loop_clear(&l);
  nobodys = 0;
}

/* If the violation depends on a neighbour, too, nothing is reverted, because a
   drawn environment would violate more rules. */
static void test_rule_of_two(void) {
  script s = {.l = {{-14, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  drawn = 0, moved = OWN | OTHERS;
  run_step(&l, SCRIPTED(s), &extractor, MODULE(&finder, NULL), 1);
  expect_result(&l, 0, -14, NULL);
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpuint(l.guard.back + l.guard.worse, ==, 0);
  g_assert_cmpuint(l.guard.prints, ==, GUARD_DRAWN + 1);
  correct_loop_clear(&l);
}

/* A cut-out that opens a gate even with the drawn mask of the gate is removed
   together with all shapes nearby; distant shapes remain. The regulator does
   not put the cut-out back before the simulation of that mask. */
static int cutout_through(void *self, const eda_printed *p, eda_ruling *r,
                          opc_error *error) {
  static const eda_box all = {0, 150, 60, 250};
  (void)self, (void)p, (void)error;
  r->cutouts[EDA_POLY] = (eda_boxes){&all, 1};
  return OPC_OK;
}

static void test_surrounded(void) {
  static const eda_regulator cuts = {.rule = cutout_through,
                                     .violations = violations,
                                     .smooth = cutout_through};
  script s = {.l = {{-14, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  drawn = moved = 0;
  run_step(&l, MODULE(&hasty, &s), &extractor, MODULE(&cuts, NULL), 1);
  expect_result(&l, 0, 0, "reverted: as drawn, with all neighbours");
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpuint(l.now.cutouts[EDA_POLY].count, ==, 0);
  g_assert_cmpuint(l.guard.back, ==, 1);
  g_assert_cmpuint(l.guard.lost, ==, 0);
  correct_loop_clear(&l);
}

/* A transistor keeps its mask, and then prints open or violates a rule: the
   guard does not revert the neighbour. */
static void test_still(void) {
  static const eda_regulator cuts = {.rule = cutout_through,
                                     .violations = violations};
  script s = {.l = {{0, -14}}, .moves = 1, .target = {1, 1}};
  loop l;
  still = 1;
  for (int rule = 0; rule < 2; rule++) {
    const eda_regulator *regulator = rule ? &finder : &cuts;
    drawn = 0, moved = rule ? OTHERS : 0;
    run_step(&l, MODULE(&hasty, &s), &extractor, MODULE(regulator, NULL), 1);
    int open = (l.measured.flags[0] & EDA_PRINT_OPEN) != 0;
    g_assert_cmpint(open, ==, !rule);
    expect_result(&l, 1, -14, NULL);
    g_assert_cmpuint(l.guard.prints, ==, 0);
    correct_loop_clear(&l);
  }
  still = moved = 0;
}

/* Reverting the transistor's own edges has no effect: the verdict names the
   neighbour, and both transistors keep their best masks. */
static void test_neighbour(void) {
  script s = {.l = {{-14, -14}, {-8, -14}}, .moves = 2, .target = {1, 1}};
  loop l;
  drawn = moved = 0;
  run_step(&l, MODULE(&hasty, &s), &coupled, MODULE(&mover, NULL), 1);
  g_assert_cmpuint(l.guard.worse, ==, 1);
  expect_result(&l, 0, -14, "neighbour at (30, 750) nm");
  expect_result(&l, 1, -14, NULL);
  g_assert_cmpfloat(deviation_of(&l, &l.measured.performance, 0), >,
                    deviation_of(&l, &l.before, 0));
  correct_loop_clear(&l);
}

/* The cause is a shape of the regulator beside a transistor, not a displaced
   transistor. */
static int cutout_neighbour(void *self, const eda_printed *p, eda_ruling *r,
                            opc_error *error) {
  static const eda_box sides[] = {{0, 600, 7, 900}, {53, 600, 60, 900}};
  (void)self, (void)p, (void)error;
  r->cutouts[EDA_POLY] = (eda_boxes){sides, 2};
  return OPC_OK;
}

static void test_rule_beside(void) {
  static const eda_regulator biter = {.rule = cutout_neighbour,
                                      .violations = violations};
  script s = {.l = {{-14, 0}}, .moves = 1, .target = {1, 1}};
  loop l;
  drawn = moved = 0;
  run_step(&l, MODULE(&hasty, &s), &coupled, MODULE(&biter, NULL), 1);
  expect_result(&l, 0, -14, "rule: added shape beside at (30, 200) nm");
  g_assert_cmpuint(l.now.cutouts[EDA_POLY].count, ==, 2);
  g_assert_cmpuint(l.guard.worse, ==, 1);
  correct_loop_clear(&l);
}

/* Fragments of a layer that the synthesizer dissects are reverted. */
static int cut_layer(void *self, const eda_gates *g, int layer, eda_cuts *cuts,
                     opc_error *error) {
  static const uint32_t start[] = {0, 12};
  static eda_point from[12];
  static double site[24];
  (void)self, (void)error;
  if (layer != EDA_POLY) return OPC_OK;
  const eda_fragment *f = g->edges[EDA_POLY].fragments;
  for (int i = 0; i < 12; i++) {
    eda_point next = f[(i + 1) % 12].from;
    from[i] = f[i].from;
    site[2 * i] = (from[i].x + next.x) / 2.0;
    site[2 * i + 1] = (from[i].y + next.y) / 2.0;
  }
  *cuts = (eda_cuts){.polygons = 1, .start = start, .from = from, .site = site};
  return OPC_OK;
}

/* Displace both sides of transistor 0 too far inwards, and those of transistor
   1 correctly. */
static int update_fragments(void *self, const eda_feedback *f, eda_moves *m,
                            int *done, opc_error *error) {
  const eda_fragment *e = f->gates->edges[EDA_POLY].fragments;
  (void)self, (void)error;
  for (int i = 0; i < 12; i++)
    if (e[i].gate >= 0 && (e[i].role == EDA_L_LOW || e[i].role == EDA_L_HIGH))
      m->shift[EDA_POLY][i] = e[i].gate ? -7 : -16;
  *done = 1;
  return OPC_OK;
}

static const eda_synthesizer cutter = {
    .begin = begin_moves, .update = update_fragments, .cut = cut_layer};

static void test_fragments(void) {
  loop l;
  run_step(&l, MODULE(&cutter, NULL), &extractor, NULL, 1);
  const eda_fragment *e = l.gates->edges[EDA_POLY].fragments;
  for (int i = 0; i < 12; i++)
    if (e[i].role == EDA_L_LOW || e[i].role == EDA_L_HIGH)
      g_assert_cmpint(l.now.shift[EDA_POLY][i], ==, e[i].gate ? -7 : -8);
  g_assert_cmpuint(l.measured.flags[0] & EDA_PRINT_OPEN, ==, 0);
  g_assert_cmpuint(l.guard.back, ==, 1);
  correct_loop_clear(&l);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  published = g_string_new(NULL);
  g_test_add_func("/guard/good", test_good);
  g_test_add_func("/guard/open", test_open);
  g_test_add_func("/guard/worse", test_worse);
  g_test_add_func("/guard/limit", test_limit);
  g_test_add_func("/guard/ends", test_ends);
  g_test_add_func("/guard/target", test_target);
  g_test_add_func("/guard/rules", test_rules);
  g_test_add_func("/guard/rule-of-two", test_rule_of_two);
  g_test_add_func("/guard/surrounded", test_surrounded);
  g_test_add_func("/guard/still", test_still);
  g_test_add_func("/guard/neighbour", test_neighbour);
  g_test_add_func("/guard/rule-beside", test_rule_beside);
  g_test_add_func("/guard/fragments", test_fragments);
  int failed = g_test_run();
  g_string_free(published, TRUE);
  return failed;
}
