/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the loop with minimal models and plugins: a synthesizer that
   dissects a layer, added shapes, and layers without transistors. */
#include "models_test.h"

/* ---- a layout without transistors: an L and a bar, grid 2 nm ---- */

static eda_point outline[] = {{0, 0},     {200, 0},  {200, 60},  {60, 60},
                              {60, 300},  {0, 300},  {120, 120}, {300, 120},
                              {300, 300}, {120, 300}};
static uint32_t starts[] = {0, 6, 10};
static uint8_t all_corrected[] = {1, 1, 1, 1};
static char *names[] = {"poly", "active", "metal1", "metal2"};
static eda_edges no_edges[4];
static eda_shapes drawn_poly[] = {{2, starts, outline, NULL}, {0}};
static const eda_gates metal = {.name = (char *)"metal",
                                .grid = 2,
                                .extent = {0, 0, 300, 300},
                                .layers = 2,
                                .layer = names,
                                .corrected = all_corrected,
                                .drawn = drawn_poly,
                                .edges = no_edges};

/* ---- a synthesizer that halves the error of each third of an edge ---- */

enum { THIRDS = 30 };

typedef struct synthesizer {
  int layer; /* layer to dissect */
  eda_point from[THIRDS];
  double site[2 * THIRDS];
  uint32_t start[3];
  const char *spoil; /* kind of error in the returned fragments or shapes; NULL:
                        none */
  const eda_box *assists;
  size_t assist_count;
  int drop;                   /* number of scatter bars removed with the
                                 first displacements */
  uint32_t first_simulations; /* simulations before the first displacements */
  int updates;
  eda_printer *printer;
} synthesizer;

static synthesizer own;

static int cut_layer(void *self, const eda_gates *g, int layer, eda_cuts *cuts,
                     opc_error *error) {
  synthesizer *s = self;
  (void)error;
  if (layer != s->layer) return OPC_OK;
  const eda_shapes *drawn = &g->drawn[layer];
  uint32_t n = 0;
  for (uint32_t p = 0; p < 2; p++) {
    uint32_t many = drawn->start[p + 1] - drawn->start[p];
    s->start[p] = n;
    for (uint32_t i = 0; i < many; i++) {
      eda_point a = drawn->points[drawn->start[p] + i],
                b = drawn->points[drawn->start[p] + (i + 1) % many];
      for (int k = 0; k < 3; k++, n++) {
        s->from[n] =
            (eda_point){a.x + (b.x - a.x) / 3 * k, a.y + (b.y - a.y) / 3 * k};
        s->site[2 * n] = (a.x + (b.x - a.x) * (2 * k + 1) / 6.0) * g->grid;
        s->site[2 * n + 1] = (a.y + (b.y - a.y) * (2 * k + 1) / 6.0) * g->grid;
      }
    }
  }
  s->start[2] = n;
  *cuts = (eda_cuts){.polygons = 2,
                     .start = s->start,
                     .from = s->from,
                     .site = s->site,
                     .assists = {s->assists, s->assist_count}};
  if (!s->spoil) return OPC_OK;
  if (!strcmp(s->spoil, "count")) cuts->polygons = 1;
  if (!strcmp(s->spoil, "corner")) s->from[3].x -= 1;
  if (!strcmp(s->spoil, "first corner")) s->from[0].x += 1;
  if (!strcmp(s->spoil, "order")) s->from[1] = s->from[2];
  if (!strcmp(s->spoil, "off")) s->from[4].x += 1;
  if (!strcmp(s->spoil, "site")) s->site[9] += 1000;
  if (!strcmp(s->spoil, "nan")) s->site[0] = NAN;
  if (!strcmp(s->spoil, "end")) s->start[2] = 5;
  if (!strcmp(s->spoil, "none")) cuts->from = NULL;
  return OPC_OK;
}

static int begin_moves(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)error;
  g_assert_null(f->printed);
  for (size_t k = 0; k < f->gates->layers; k++) g_assert_null(f->epe[k]);
  return OPC_OK;
}

static int update_moves(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  synthesizer *s = self;
  int layer = s->layer;
  (void)error;
  for (size_t k = 0; k < f->gates->layers; k++) {
    g_assert_true((f->epe[k] != NULL) == ((int)k == layer));
    g_assert_true((m->shift[k] != NULL) == ((int)k == layer));
  }
  g_assert_nonnull(f->next_end);
  s->updates++;
  *done = 1;
  if (s->spoil && !strcmp(s->spoil, "at once")) return OPC_OK;
  if (f->iteration == 0) s->first_simulations = s->printer->simulations;
  double worst = 0;
  for (int i = 0; i < THIRDS; i++) {
    double epe = f->epe[layer][i];
    g_assert_false(isnan(epe));
    worst = fmax(worst, fabs(epe));
    m->shift[layer][i] -= (int32_t)lround(epe / f->gates->grid * 0.6);
  }
  *done = worst < 2 || f->iteration == 40;
  g_assert_nonnull(f->print[layer].coefficients);
  g_assert_cmpuint(m->assists[layer].count, ==,
                   s->assist_count - (s->drop && f->iteration > 0));
  if (s->drop && f->iteration == 0) m->assists[layer].count--;
  if (s->spoil && !strcmp(s->spoil, "far")) m->shift[layer][7] = 1 << 21;
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  (void)self, (void)gate;
  return NULL;
}

static const eda_synthesizer cutter = {.begin = begin_moves,
                                       .update = update_moves,
                                       .verdict = verdict,
                                       .cut = cut_layer};
static const eda_synthesizer hasty = {.begin = begin_moves,
                                      .update = update_moves,
                                      .verdict = verdict,
                                      .cut = cut_layer,
                                      .flags = EDA_SYNTHESIZER_ENDS_ANYTIME};

/* ---- a regulator with one added shape ---- */

static const eda_box shape = {-20, 100, 30, 140};
static const eda_box *added_given, *cutout_given;

static int set_rules(void *self, const eda_printed *p, eda_ruling *r,
                     opc_error *error) {
  (void)self, (void)error;
  g_assert_cmpuint(p->shapes[EDA_POLY].count, ==, 2);
  g_assert_nonnull(p->print[EDA_ACTIVE].coefficients);
  g_assert_cmpuint(r->added[EDA_POLY].count + r->cutouts[EDA_POLY].count, ==,
                   0);
  r->added[EDA_POLY] = (eda_boxes){added_given, 1};
  r->cutouts[EDA_POLY] = (eda_boxes){cutout_given, cutout_given != NULL};
  return OPC_OK;
}

static int none_broken(void *self, const eda_printed *p, eda_violation *v,
                       size_t most, size_t *count, opc_error *error) {
  (void)self, (void)p, (void)v, (void)most, (void)error;
  *count = 0;
  return OPC_OK;
}

static const eda_regulator regulator = {.rule = set_rules,
                                        .violations = none_broken};

/* ---- the loop ---- */

static const eda_litho *optics = &litho;

/* Run a loop with all models that a correction requires; `edges` may be NULL.
 */
static int run_loop(loop *l, const eda_gates *gates, const opc_module *main_one,
                    const opc_module *edges, const opc_module *drc,
                    opc_error *error) {
  *l = (loop){.host = &host,
              .gates = gates,
              .regulator = drc,
              .extractor = MODULE(&extractor, NULL),
              .drivers = {[MAIN].module = main_one, [EDGES].module = edges},
              .max_iterations = 60};
  eda_printer_init(&l->printer, NULL, gates, MODULE(optics, NULL),
                   MODULE(&resist, NULL), 400);
  l->printer.fine = 1e-4;
  own.printer = &l->printer;
  int code = correct_loop_run(l, error);
  l->printer.litho.litho = NULL; /* end of the module list */
  return code;
}

static int run_step(loop *l, const eda_synthesizer *s, const opc_module *drc,
                    opc_error *error) {
  return run_loop(l, &metal, MODULE(s, &own), NULL, drc, error);
}

static int64_t drawn_area2(void) { return eda_area2(&metal.drawn[EDA_POLY]); }

/* The printed image of a metal layer converges to the drawn edges. */
static void test_fragments(void) {
  loop l;
  opc_error error = {0};
  own.spoil = NULL;
  g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_OK);
  g_assert_cmpuint(l.summary.gates, ==, 0);
  g_assert_cmpuint(l.summary.sites, ==, THIRDS);
  g_assert_cmpuint(l.summary.lost, ==, 0);
  g_assert_cmpfloat(l.summary.epe_max, <, 2);
  /* The image of the drawn mask is too large, so the corrected mask is
     smaller. */
  g_assert_cmpint(eda_area2(&l.mask[EDA_POLY]), <, drawn_area2() * 9 / 10);
  /* The other layer was simulated once. */
  g_assert_cmpuint(l.iterations, >, 2);
  g_assert_cmpuint(l.printer.simulations, <=, 2 + l.iterations);
  correct_loop_clear(&l);
}

/* Edges whose position differs in the final accurate simulation are corrected
   again. */
static void test_proof(void) {
  const eda_litho finer = {.prepare = prepare_nothing,
                           .band = model_band,
                           .image = model_image,
                           .image_fine = image_fine};
  loop l;
  opc_error error = {0};
  own.spoil = NULL;
  optics = &finer;
  for (int n = 0; n < FINE_PRINTS; n++) fine_adds[n] = n ? 0.1 : 0;
  memset(fine_prints, 0, sizeof fine_prints);
  g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_OK);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 3);
  g_assert_cmpint(fine_prints[EDA_ACTIVE], ==, 1);
  g_assert_cmpfloat(l.summary.epe_max, <, 2);
  optics = &litho;
  correct_loop_clear(&l);
}

static void test_added(void) {
  loop l;
  opc_error error = {0};
  own.spoil = NULL;
  for (int early = 0; early < 2; early++) {
    added_given = &shape;
    g_assert_cmpint(run_step(&l, early ? &hasty : &cutter,
                             MODULE(&regulator, NULL), &error),
                    ==, OPC_OK);
    /* The synthesizer of the added shape's layer sees the shape before its
       first displacements, or together with them. */
    g_assert_cmpuint(own.first_simulations, ==, early ? 2 : 3);
    eda_shapes box, outside, both;
    correct_shapes_of_boxes((boxes_lists){&(eda_boxes){&shape, 1}, 1}, &box);
    g_assert_false(
        eda_boolean(EDA_NOT, &box, &l.mask[EDA_POLY], &outside, &error));
    g_assert_false(eda_boolean(EDA_NOT, &l.mask[EDA_POLY],
                               &l.polygons[EDA_POLY], &both, &error));
    g_assert_cmpuint(outside.count, ==, 0);
    g_assert_cmpuint(both.count, ==, 1); /* area of the added shape */
    eda_shapes_clear(&box);
    eda_shapes_clear(&outside);
    eda_shapes_clear(&both);
    correct_loop_clear(&l);
  }
  /* A synthesizer that finishes before the shape is added is called again. */
  own.spoil = "at once";
  own.updates = 0;
  g_assert_cmpint(run_step(&l, &hasty, MODULE(&regulator, NULL), &error), ==,
                  OPC_OK);
  g_assert_cmpint(own.updates, ==, 2);
  g_assert_cmpuint(l.printer.simulations, ==, 3);
  correct_loop_clear(&l);
  own.spoil = NULL;
  static const eda_box wrong = {10, 0, 10, 5};
  added_given = &wrong;
  g_assert_cmpint(run_step(&l, &cutter, MODULE(&regulator, NULL), &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "regulator");
  g_assert_cmpstr(error.message, ==,
                  "number 1 of the added shapes of poly is not a valid box: "
                  "(10, 0) to (10, 5)");
  correct_loop_clear(&l);
}

/* Cut-outs remove area from added shapes and from the mask. They change nothing
   else. */
static void test_cutouts(void) {
  static const eda_box cutout = {-20, 120, 10, 160};
  loop with, without;
  opc_error error = {0};
  eda_shapes box, gone, kept, rest;
  own.spoil = "at once";
  added_given = &shape;
  own.updates = 0;
  g_assert_cmpint(run_step(&without, &hasty, MODULE(&regulator, NULL), &error),
                  ==, OPC_OK);
  cutout_given = &cutout;
  own.updates = 0;
  g_assert_cmpint(run_step(&with, &hasty, MODULE(&regulator, NULL), &error), ==,
                  OPC_OK);
  cutout_given = NULL;
  own.spoil = NULL;
  correct_shapes_of_boxes((boxes_lists){&(eda_boxes){&cutout, 1}, 1}, &box);
  g_assert_false(
      eda_boolean(EDA_AND, &box, &with.mask[EDA_POLY], &kept, &error));
  g_assert_cmpuint(kept.count, ==, 0);
  g_assert_false(eda_boolean(EDA_NOT, &without.mask[EDA_POLY],
                             &with.mask[EDA_POLY], &gone, &error));
  g_assert_false(eda_boolean(EDA_NOT, &gone, &box, &rest, &error));
  g_assert_cmpint(eda_area2(&gone), >, 0);
  g_assert_cmpuint(rest.count, ==, 0);
  eda_shapes_clear(&box);
  eda_shapes_clear(&gone);
  eda_shapes_clear(&kept);
  eda_shapes_clear(&rest);
  correct_loop_clear(&with);
  correct_loop_clear(&without);
}

/* Assist features are in the mask without change, merged where they touch.
   Removed assist features are not in the mask. */
static void test_assists(void) {
  static const eda_box bars[] = {
      {400, -100, 420, 400}, {410, 390, 500, 410}, {-120, 0, -100, 200}};
  loop l;
  opc_error error = {0};
  own.spoil = NULL;
  own.assists = bars;
  own.assist_count = 3;
  for (own.drop = 0; own.drop < 2; own.drop++) {
    g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_OK);
    eda_shapes added;
    g_assert_false(eda_boolean(EDA_NOT, &l.mask[EDA_POLY],
                               &l.polygons[EDA_POLY], &added, &error));
    g_assert_cmpuint(added.count, ==, own.drop ? 1 : 2);
    int64_t both = 20 * 500 + 90 * 20 - 10 * 10;
    g_assert_cmpint(eda_area2(&added), ==,
                    2 * (both + (own.drop ? 0 : 20 * 200)));
    eda_shapes_clear(&added);
    correct_loop_clear(&l);
  }
  own.drop = 0;
  static const eda_box wrong[] = {{0, 400, 10, 410}, {10, 400, 5, 410}};
  own.assists = wrong;
  own.assist_count = 2;
  g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "synthesizer");
  g_assert_cmpstr(error.message, ==,
                  "number 2 of the assists of poly is not a valid box: (10, "
                  "400) to (5, 410)");
  correct_loop_clear(&l);
  own.assists = NULL;
  g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==,
                  "returns 2 assists of poly without an array of boxes");
  correct_loop_clear(&l);
  own.assist_count = 0;
}

static void test_faults(void) {
  const struct {
    const char *spoil, *message;
  } cases[] = {
      {"count", "fragments 1 polygons of poly, expected 2"},
      {"corner",
       "fragments of poly: the end of fragment 4, (400, 40) nm, is not on the "
       "edge from (0, 0) to (400, 0) nm, or not in order along the edge"},
      {"first corner",
       "fragments of poly: no fragment begins at the corner (0, 0) nm"},
      {"order",
       "fragments of poly: the end of fragment 2, (264, 0) nm, is not on the "
       "edge from (0, 0) to (400, 0) nm, or not in order along the edge"},
      {"off",
       "fragments of poly: the end of fragment 4, (402, 40) nm, is not on the "
       "edge from (400, 0) to (400, 120) nm, or not in order along the edge"},
      {"site",
       "fragments of poly: the site of fragment 5, (400, 1060) nm, is not on "
       "the edge from (400, 0) to (400, 120) nm, or not in order along the "
       "edge"},
      {"nan",
       "fragments of poly: the site of fragment 1, (nan, 0) nm, is not on the "
       "edge from (0, 0) to (400, 0) nm, or not in order along the edge"},
      {"end",
       "fragments of poly: the fragments of polygon 2 end before they begin"},
      {"none", "fragments of poly: an array is missing"},
      {"far",
       "moves fragment 8 of poly by 2097152 steps, expected at most 1048576"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    loop l;
    opc_error error = {0};
    own.spoil = cases[i].spoil;
    g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_FAILED);
    g_assert_cmpstr(error.parameter, ==, "synthesizer");
    g_assert_cmpstr(error.message, ==, cases[i].message);
    correct_loop_clear(&l);
  }
}

/* ---- layers that no transistor moves ---- */

enum { METAL = 2, POWER, LAYERS };

/* Return the sample of two transistors, with the L and the bar in metal1, and
   with a metal2 that is not corrected. */
static const eda_gates *stack(void) {
  static eda_shapes drawn[LAYERS];
  static eda_edges edges[LAYERS];
  static eda_fragment fragments[10];
  static eda_point large[10]; /* coordinates on a grid of 1 nm */
  static eda_gates g;
  g = *eda_gates_sample();
  memcpy(drawn, g.drawn, METAL * sizeof *drawn);
  memcpy(edges, g.edges, METAL * sizeof *edges);
  drawn[METAL] = drawn[POWER] = (eda_shapes){2, starts, large, NULL};
  for (int i = 0; i < 10; i++) {
    large[i] = (eda_point){2 * outline[i].x, 2 * outline[i].y};
    fragments[i] = (eda_fragment){.from = large[i], .gate = -1};
  }
  edges[METAL] = edges[POWER] = (eda_edges){2, starts, fragments};
  g.extent.x1 = MAX(g.extent.x1, 600);
  g.layers = LAYERS;
  g.layer = names;
  g.corrected = all_corrected;
  g.drawn = drawn;
  g.edges = edges;
  return &g;
}

/* Number of displacements after which the synthesizer of transistors
   finishes. */
static int moves_left, mover_updates;

static int move_gates(void *self, const eda_feedback *f, eda_moves *m,
                      int *done, opc_error *error) {
  (void)self, (void)error;
  for (size_t k = 0; k < f->gates->layers; k++) {
    g_assert_null(f->epe[k]);
    g_assert_null(m->shift[k]);
  }
  mover_updates++;
  m->l[0] += 4;
  m->w[1] -= 2;
  *done = --moves_left <= 0;
  return OPC_OK;
}

static const eda_synthesizer mover = {
    .begin = begin_moves, .update = move_gates, .verdict = verdict};

/* Displacements of gates by this synthesizer must be ignored. */
static int update_edges(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  g_assert_cmpint(m->l[0], ==, MIN(4 * (int)f->iteration, 8));
  m->l[0] = m->w[0] = m->jog[0] = 99;
  m->assists[EDA_POLY] = (eda_boxes){&shape, 1};
  return update_moves(self, f, m, done, error);
}

static const eda_synthesizer edges_cutter = {.begin = begin_moves,
                                             .update = update_edges,
                                             .verdict = verdict,
                                             .cut = cut_layer};

static int run_stack(loop *l, int with_edges, const opc_module *drc) {
  opc_error error = {0};
  moves_left = 2;
  mover_updates = own.updates = 0;
  own.spoil = NULL;
  own.layer = METAL;
  int code =
      run_loop(l, stack(), MODULE(&mover, NULL),
               with_edges ? MODULE(&edges_cutter, &own) : NULL, drc, &error);
  own.layer = EDA_POLY;
  return code;
}

static size_t differences(const eda_shapes *a, const eda_shapes *b) {
  eda_shapes both;
  opc_error error;
  g_assert_false(eda_boolean(EDA_XOR, a, b, &both, &error));
  size_t n = both.count;
  eda_shapes_clear(&both);
  return n;
}

/* Metal layers are corrected by a synthesizer of their own, without effect on
   the transistors. Without such a synthesizer, they stay as drawn. */
static void test_edges(void) {
  loop with, without;
  g_assert_cmpint(run_stack(&without, 0, NULL), ==, OPC_OK);
  g_assert_cmpint(mover_updates, ==, 2);
  /* Expect one simulation of each layer, and another one of poly and active
     after each of two displacements. */
  g_assert_cmpuint(without.printer.simulations, ==, LAYERS + 2 * 2);
  for (int k = METAL; k < LAYERS; k++)
    g_assert_cmpuint(differences(&without.mask[k], &without.gates->drawn[k]),
                     ==, 0);
  g_assert_cmpint(run_stack(&with, 1, NULL), ==, OPC_OK);
  g_assert_cmpint(mover_updates, ==, 2);
  g_assert_cmpint(own.updates, >, mover_updates);
  g_assert_cmpuint(with.iterations, ==, own.updates);
  for (int k = 0; k < METAL; k++)
    g_assert_cmpuint(differences(&with.mask[k], &without.mask[k]), ==, 0);
  g_assert_cmpuint(differences(&with.mask[POWER], &without.mask[POWER]), ==, 0);
  g_assert_cmpint(eda_area2(&with.mask[METAL]), <,
                  eda_area2(&without.mask[METAL]));
  g_assert_cmpint(with.now.biases.l[0], ==, 8);
  g_assert_cmpint(with.now.biases.w[0], ==, 0);
  g_assert_cmpint(with.now.biases.w[1], ==, -4);
  g_assert_cmpuint(with.printer.simulations, <=,
                   LAYERS + 2 * 2 + with.iterations);
  g_assert_cmpuint(with.summary.sites, ==, THIRDS);
  g_assert_cmpfloat(with.summary.epe_max, <, 2);
  correct_loop_clear(&with);
  correct_loop_clear(&without);
}

/* A shape added to a metal layer requires another call of the synthesizer of
   that layer, as in poly. The other synthesizer is not affected. */
static const eda_box metal_added[] = {{-20, 180, 30, 220}, {-20, 80, 30, 90}};
static size_t metal_count = 1; /* 2 once smoothed, before a simulation */

static int rule_metal(void *self, const eda_printed *p, eda_ruling *r,
                      opc_error *error) {
  (void)self, (void)error;
  g_assert_cmpuint(p->shapes[METAL].count, >=, 2);
  r->added[METAL] = (eda_boxes){metal_added, metal_count};
  return OPC_OK;
}

static int smooth_metal(void *self, const eda_printed *p, eda_ruling *r,
                        opc_error *error) {
  metal_count = 2;
  return rule_metal(self, p, r, error);
}

static const eda_regulator metal_regulator = {
    .rule = rule_metal, .violations = none_broken, .smooth = smooth_metal};

static void test_edges_ruled(void) {
  loop l;
  g_assert_cmpint(run_stack(&l, 1, MODULE(&metal_regulator, NULL)), ==, OPC_OK);
  g_assert_cmpuint(own.first_simulations, ==, LAYERS + 1);
  g_assert_cmpint(mover_updates, ==, 2);
  eda_shapes box, outside;
  opc_error error;
  correct_shapes_of_boxes((boxes_lists){&(eda_boxes){metal_added, 2}, 1}, &box);
  g_assert_false(eda_boolean(EDA_NOT, &box, &l.mask[METAL], &outside, &error));
  g_assert_cmpuint(outside.count, ==, 0);
  g_assert_cmpuint(l.now.assists[EDA_POLY].count, ==, 0);
  eda_shapes_clear(&box);
  eda_shapes_clear(&outside);
  correct_loop_clear(&l);
}

/* ---- report ---- */

/* Without transistors, no figures of performance are reported. */
static void test_report(void) {
  loop l;
  opc_error error = {0};
  own.spoil = NULL;
  published = g_string_new(NULL);
  g_assert_cmpint(run_step(&l, &cutter, NULL, &error), ==, OPC_OK);
  const eda_mask mask = {.gates = &metal,
                         .iterations = l.iterations,
                         .simulations = l.printer.simulations};
  const report report_input = {.mask = &mask,
                               .sites = l.sites,
                               .extension = l.measured.extension,
                               .biases = &l.now.biases,
                               .synthesizer = MODULE(&cutter, &own)};
  g_assert_cmpint(correct_report_mask(&host, &report_input, &error), ==,
                  OPC_OK);
  g_assert_cmpstr(published->str, ==,
                  "gates[0] effort[1] transistors epe_mean epe_max epe_lost "
                  "iterations simulations fine_simulations failed ");
  g_string_truncate(published, 0);
  g_assert_cmpint(correct_history_report(&l.history, &host, &error), ==,
                  OPC_OK);
  g_autofree char *want = g_strdup_printf(
      "history[%u],iteration,epe_mean,epe_max,simulations,"
      "fine_simulations,model ",
      l.printer.simulations - 1);
  g_assert_cmpstr(published->str, ==, want);
  g_string_free(published, TRUE);
  correct_loop_clear(&l);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/loop/fragments", test_fragments);
  g_test_add_func("/loop/proof", test_proof);
  g_test_add_func("/loop/added", test_added);
  g_test_add_func("/loop/cutouts", test_cutouts);
  g_test_add_func("/loop/assists", test_assists);
  g_test_add_func("/loop/faults", test_faults);
  g_test_add_func("/loop/edges", test_edges);
  g_test_add_func("/loop/edges-ruled", test_edges_ruled);
  g_test_add_func("/loop/report", test_report);
  return g_test_run();
}
