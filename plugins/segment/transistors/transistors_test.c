/* SPDX-License-Identifier: BSD-3-Clause */
/* Drawings whose transistors, edges and names are known; what is refused; cells
   and a chip from outside. */
#include <eda/gates.h>
#include <eda/layout.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/testing/testing.h"

/* ---- drawing ---- */

typedef struct drawing {
  eda_layout *layout;
  int32_t cell;
} drawing;

static drawing drawing_new(void) {
  opc_error error;
  drawing d = {eda_layout_new(1, &error), 0};
  d.cell = eda_layout_cell(d.layout, "TOP", &error);
  return d;
}

static void box(drawing *d, const char *layer, int32_t x0, int32_t y0,
                int32_t x1, int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_cmpint(eda_layout_add_box(d->layout, d->cell, l, b, &error), ==,
                  OPC_OK);
}

/* With x and y swapped. */
static int swap;
static void draw(drawing *d, const char *layer, int32_t x0, int32_t y0,
                 int32_t x1, int32_t y1) {
  if (swap)
    box(d, layer, y0, x0, y1, x1);
  else
    box(d, layer, x0, y0, x1, y1);
}

/* ---- running ---- */

typedef struct result {
  opc_module *module;
  void *gates;
} result;

static result segment(void *layout, const char *map) {
  opc_error error;
  result r = {opc_test_module("segment.transistors", map, &error), NULL};
  if (!r.module) g_error("%s", error.message);
  opc_test_input(r.module, "layout", layout);
  if (opc_test_run(r.module, &r.gates, &error)) g_error("%s", error.message);
  return r;
}

static void result_free(result *r) {
  opc_test_release(r->module, &r->gates);
  opc_test_module_free(r->module);
}

static void refused(drawing *d, const char *map, int code,
                    const char *message) {
  opc_error error;
  void *out;
  g_autoptr(opc_module) m = opc_test_module("segment.transistors", map, &error);
  g_assert_nonnull(m);
  opc_test_input(m, "layout", d->layout);
  g_assert_cmpint(opc_test_run(m, &out, &error), ==, code);
  g_assert_cmpstr(error.message, ==, message);
  g_assert_null(out);
  eda_layout_free(d->layout);
}

/* ---- checks ---- */

static char *tell_gates(const eda_gates *g) {
  GString *s = g_string_new("");
  for (size_t i = 0; i < g->count; i++)
    g_string_append_printf(s, "%c%c %d,%d %gx%g space %g %g ends %g %g\n",
                           "np"[g->type[i]], "xy"[g->axis[i]], g -> box[i].x0,
                           g->box[i].y0, g->length[i], g->width[i],
                           g->space[2 * i], g->space[2 * i + 1],
                           g->extension[2 * i], g->extension[2 * i + 1]);
  return g_string_free(s, FALSE);
}

/* Where each fragment begins, its role and its gate. */
static char *tell_edges(const eda_edges *e) {
  static const char *const roles[] = {"-", "L<", "L>", "W<", "W>", "E<", "E>"};
  GString *s = g_string_new("");
  for (size_t p = 0; p < e->polygons; p++) {
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const eda_fragment *f = &e->fragments[i];
      g_string_append_printf(s, "%s%d,%d %s", i > e->start[p] ? "; " : "",
                             f->from.x, f->from.y, roles[f->role]);
      if (f->gate >= 0) g_string_append_printf(s, "%d", f->gate);
    }
    g_string_append_c(s, '\n');
  }
  return g_string_free(s, FALSE);
}

/* Fragments that do not move are the drawn polygons. */
static void check_rebuilt(const eda_gates *g, int layer) {
  const eda_edges *e = &g->edges[layer];
  const eda_shapes *drawn = &g->drawn[layer];
  g_assert_cmpuint(e->polygons, ==, drawn->count);
  for (size_t p = 0; p < e->polygons; p++) {
    uint32_t n = e->start[p + 1] - e->start[p], corner = drawn->start[p];
    const eda_fragment *f = e->fragments + e->start[p];
    for (uint32_t i = 0; i < n; i++) {
      eda_point a = f[(i + n - 1) % n].from, b = f[i].from,
                c = f[(i + 1) % n].from;
      g_assert_true((a.x == b.x) != (a.y == b.y));
      if ((a.x == b.x) == (b.x == c.x)) {
        /* A cut: on the way from one corner to the next. */
        g_assert_true((b.x > a.x) == (c.x > b.x) && (b.x < a.x) == (c.x < b.x));
        g_assert_true((b.y > a.y) == (c.y > b.y) && (b.y < a.y) == (c.y < b.y));
        continue;
      }
      g_assert_cmpint(b.x, ==, drawn->points[corner].x);
      g_assert_cmpint(b.y, ==, drawn->points[corner].y);
      corner++;
    }
    g_assert_cmpuint(corner, ==, drawn->start[p + 1]);
  }
}

/* Every gate owns its sides, each one fragment that covers them, and line ends
   where it says so. */
static void check_owned(const eda_gates *g) {
  g_autofree uint8_t *seen = g_new0(uint8_t, g->count);
  for (int layer = 0; layer < 2; layer++)
    for (size_t p = 0; p < g->edges[layer].polygons; p++) {
      const eda_edges *e = &g->edges[layer];
      for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
        const eda_fragment *f = &e->fragments[i];
        g_assert_true((f->role == EDA_FIXED) == (f->gate < 0));
        if (f->gate < 0) continue;
        g_assert_cmpint(f->gate, <, g->count);
        g_assert_true((f->role == EDA_W_LOW || f->role == EDA_W_HIGH) ==
                      (layer == EDA_ACTIVE));
        g_assert_false(seen[f->gate] & 1 << f->role);
        seen[f->gate] |= (uint8_t)(1 << f->role);
        const eda_box *b = &g->box[f->gate];
        eda_point to =
            e->fragments[i + 1 < e->start[p + 1] ? i + 1 : e->start[p]].from;
        int vertical = f->from.x == to.x, high = !(f->role & 1);
        int axis = g->axis[f->gate];
        g_assert_true(vertical == ((axis == EDA_X) == (f->role == EDA_L_LOW ||
                                                       f->role == EDA_L_HIGH)));
        /* Interior on the left. */
        g_assert_true(vertical ? (to.y > f->from.y) == high
                               : (to.x < f->from.x) == high);
        int32_t low = vertical ? MIN(f->from.y, to.y) : MIN(f->from.x, to.x);
        int32_t top = vertical ? MAX(f->from.y, to.y) : MAX(f->from.x, to.x);
        g_assert_cmpint(low, <=, vertical ? b->y0 : b->x0);
        g_assert_cmpint(top, >=, vertical ? b->y1 : b->x1);
        if (f->role >= EDA_END_LOW) continue;
        g_assert_cmpint(
            vertical ? f->from.x : f->from.y, ==,
            vertical ? (high ? b->x1 : b->x0) : (high ? b->y1 : b->y0));
      }
    }
  for (size_t i = 0; i < g->count; i++)
    for (int role = EDA_L_LOW; role <= EDA_END_HIGH; role++)
      g_assert_true(!(seen[i] & 1 << role) ==
                    (role >= EDA_END_LOW &&
                     isinf(g->extension[2 * i + (role == EDA_END_HIGH)])));
}

static void check_all(const eda_gates *g) {
  check_rebuilt(g, EDA_POLY);
  check_rebuilt(g, EDA_ACTIVE);
  check_owned(g);
}

static void segment_is(drawing *d, const char *map, const char *gates,
                       const char *poly, const char *active) {
  result r = segment(d->layout, map);
  const eda_gates *g = r.gates;
  check_all(g);
  g_autofree char *got = tell_gates(g);
  g_autofree char *got_poly = tell_edges(&g->edges[EDA_POLY]);
  g_autofree char *got_active = tell_edges(&g->edges[EDA_ACTIVE]);
  g_assert_cmpstr(got, ==, gates);
  g_assert_cmpstr(got_poly, ==, poly);
  g_assert_cmpstr(got_active, ==, active);
  result_free(&r);
  eda_layout_free(d->layout);
}

/* ---- layouts by hand ---- */

static void draw_single(drawing *d) {
  draw(d, "active", 0, 0, 400, 200);
  draw(d, "poly", 150, -100, 215, 300);
  draw(d, "nimplant", -50, -50, 450, 250);
}

static void test_vertical(void) {
  drawing d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{}", "nx 150,0 65x200 space 300 370 ends 100 100\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n",
             "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
  /* Line ends that are further than line_end are nobody's. */
  d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{ line_end: 99 nm }",
             "nx 150,0 65x200 space 300 370 ends inf inf\n",
             "150,-100 -; 215,-100 -; 215,-84 L>0; 215,284 -; 215,300 -; "
             "150,300 -; 150,284 L<0; 150,-84 -\n",
             "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
  /* On a grid of 5 nm, and with a larger overhang than the line has. */
  d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{ line_end: 0 nm, overhang: 200 nm, grid: 5 nm }",
             "nx 30,0 65x200 space 300 370 ends inf inf\n",
             "30,-20 -; 43,-20 L>0; 43,60 -; 30,60 L<0\n",
             "0,0 W<0; 80,0 -; 80,40 W>0; 0,40 -\n");
}

/* Whether line ends so far past the active are those of the transistor, which
   is `length` long. */
static int owns_end(int length, int reach) {
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 2000, 1000);
  draw(&d, "poly", 700, -reach, 700 + length, 1000 + reach);
  draw(&d, "nimplant", -50, -50, 2050, 1050);
  result r = segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  int owns = isfinite(g->extension[0]) != 0;
  g_assert_cmpint(owns, ==, isfinite(g->extension[1]) != 0);
  result_free(&r);
  eda_layout_free(d.layout);
  return owns;
}

/* What is not given: 200 nm of a gate of 65 nm are 461 of one of 150 nm, and
   1538, which is beyond 1 um, of 500 nm. */
static void test_lengths(void) {
  g_assert_true(owns_end(65, 200) && !owns_end(65, 201));
  g_assert_true(owns_end(150, 461) && !owns_end(150, 463));
  g_assert_true(owns_end(500, 600) && owns_end(500, 1000));
  g_assert_false(owns_end(500, 1001));
}

/* A print reaches L at least before it has merged. */
static void test_narrow_active(void) {
  drawing d = drawing_new();
  draw(&d, "active", 120, 0, 400, 200);
  draw(&d, "poly", 150, -100, 215, 300);
  draw(&d, "nimplant", -50, -50, 450, 250);
  segment_is(&d, "{}", "nx 150,0 65x200 space 130 370 ends 100 100\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n",
             "120,0 W<0; 400,0 -; 400,200 W>0; 120,200 -\n");
}

static void test_horizontal(void) {
  drawing d = drawing_new();
  swap = 1;
  draw_single(&d);
  swap = 0;
  segment_is(&d, "{}", "ny 0,150 65x200 space 300 370 ends 100 100\n",
             "-100,150 L<0; 300,150 E>0; 300,215 L>0; -100,215 E<0\n",
             "0,0 -; 200,0 W>0; 200,400 -; 0,400 W<0\n");
}

/* Figure 3.2: an upper and a lower transistor on each poly line, three on each
   diffusion; the lines of the left two reach far beyond. */
static void test_figure(void) {
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 900, 100);
  draw(&d, "active", 0, 300, 900, 500);
  draw(&d, "nwell", -100, 200, 1000, 600);
  draw(&d, "poly", 100, -400, 165, 900);
  draw(&d, "poly", 365, -120, 430, 620);
  draw(&d, "poly", 700, -120, 765, 620);
  segment_is(
      &d, "{}",
      "nx 100,0 65x100 space 200 200 ends inf inf\n"
      "nx 365,0 65x100 space 200 270 ends 120 inf\n"
      "nx 700,0 65x100 space 270 270 ends 120 inf\n"
      "px 100,300 65x200 space 200 200 ends inf inf\n"
      "px 365,300 65x200 space 200 270 ends inf 120\n"
      "px 700,300 65x200 space 270 270 ends inf 120\n",
      "100,-400 -; 165,-400 -; 165,-84 L>0; 165,184 -; 165,216 L>3; 165,584 -; "
      "165,900 -; 100,900 -; 100,584 L<3; 100,216 -; 100,184 L<0; 100,-84 -\n"
      "365,-120 E<1; 430,-120 L>1; 430,184 -; 430,216 L>4; 430,620 E>4; "
      "365,620 L<4; 365,216 -; 365,184 L<1\n"
      "700,-120 E<2; 765,-120 L>2; 765,184 -; 765,216 L>5; 765,620 E>5; "
      "700,620 L<5; 700,216 -; 700,184 L<2\n",
      "0,0 W<0; 265,0 W<1; 565,0 W<2; 900,0 -; 900,100 W>2; 565,100 W>1; "
      "265,100 W>0; 0,100 -\n"
      "0,300 W<3; 265,300 W<4; 565,300 W<5; 900,300 -; 900,500 W>5; "
      "565,500 W>4; 265,500 W>3; 0,500 -\n");
}

/* What is too near for two overhangs is shared half and half. */
static void test_shared_poly(void) {
  drawing d = drawing_new();
  draw(&d, "active", -100, -200, 200, -100);
  draw(&d, "active", -100, 51, 200, 150);
  draw(&d, "nimplant", -150, -250, 250, -50);
  draw(&d, "pimplant", -150, 0, 250, 200);
  draw(&d, "poly", 0, -300, 65, 250);
  segment_is(&d, "{}",
             "nx 0,-200 65x100 space 200 270 ends 100 inf\n"
             "px 0,51 65x99 space 200 270 ends inf 100\n",
             "0,-300 E<0; 65,-300 L>0; 65,-25 L>1; 65,250 E>1; 0,250 L<1; "
             "0,-25 L<0\n",
             "-100,-200 W<0; 200,-200 -; 200,-100 W>0; -100,-100 -\n"
             "-100,51 W<1; 200,51 -; 200,150 W>1; -100,150 -\n");
}

/* The line end beyond another gate is not one's own, be it near. */
static void test_near_end(void) {
  drawing d = drawing_new();
  draw(&d, "active", -100, 0, 200, 100);
  draw(&d, "active", -100, 200, 200, 300);
  draw(&d, "active", -100, 400, 200, 500);
  draw(&d, "nwell", -150, -50, 250, 550);
  draw(&d, "poly", 0, -100, 65, 600);
  segment_is(&d, "{ line_end: 2000 nm }",
             "px 0,0 65x100 space 200 270 ends 100 inf\n"
             "px 0,200 65x100 space 200 270 ends inf inf\n"
             "px 0,400 65x100 space 200 270 ends inf 100\n",
             "0,-100 E<0; 65,-100 L>0; 65,150 L>1; 65,350 L>2; 65,600 E>2; "
             "0,600 L<2; 0,350 L<1; 0,150 L<0\n",
             "-100,0 W<0; 200,0 -; 200,100 W>0; -100,100 -\n"
             "-100,200 W<1; 200,200 -; 200,300 W>1; -100,300 -\n"
             "-100,400 W<2; 200,400 -; 200,500 W>2; -100,500 -\n");
}

/* A poly that turns right 50 nm past the active, and a field poly near it. */
static void test_turning_poly(void) {
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 400, 200);
  draw(&d, "pwell", -500, -500, 900, 900);
  draw(&d, "poly", 150, -60, 215, 600);
  draw(&d, "poly", 215, 250, 700, 350);
  draw(&d, "poly", 450, -60, 515, 150);
  segment_is(
      &d, "{}", "nx 150,0 65x200 space 300 235 ends 60 inf\n",
      "150,-60 E<0; 215,-60 L>0; 215,250 -; 700,250 -; 700,350 -; 215,350 -; "
      "215,600 -; 150,600 -; 150,284 L<0\n"
      "450,-60 -; 515,-60 -; 515,150 -; 450,150 -\n",
      "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
}

/* The active jogs where the poly ends: its edge belongs to the gate as far as
   it goes. A word line crosses the same active the other way. */
static void test_bent_active(void) {
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 300, 200);
  draw(&d, "active", 215, 0, 300, 700);
  draw(&d, "pwell", -500, -500, 900, 900);
  draw(&d, "poly", 150, -100, 215, 300);
  draw(&d, "poly", 50, 400, 500, 465);
  segment_is(&d, "{}",
             "nx 150,0 65x200 space 300 170 ends 100 100\n"
             "ny 215,400 65x85 space 800 470 ends 165 200\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n"
             "50,400 L<1; 500,400 E>1; 500,465 L>1; 50,465 E<1\n",
             "0,0 W<0; 300,0 W>1; 300,700 -; 215,700 W<1; 215,200 W>0; "
             "0,200 -\n");
}

/* ---- types ---- */

/* A single transistor with the layers given by letters: n, p wells, N, P
   implants over it; in brackets beside it; with < in part. */
static void type_is(const char *layers, int code, const char *want) {
  static const char letters[] = "npNP";
  static const char *const names[] = {"nwell", "pwell", "nimplant", "pimplant"};
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 400, 200);
  draw(&d, "poly", 150, -100, 215, 300);
  int shift = 0;
  for (const char *c = layers; *c; c++) {
    if (*c == '(') shift = 1000;
    if (*c == ')') shift = 0;
    if (*c == '<') shift = 580;
    const char *l = strchr(letters, *c);
    if (l) draw(&d, names[l - letters], -400 + shift, -400, 600 + shift, 600);
  }
  if (code) {
    g_autofree char *message = g_strdup_printf(
        "transistor from (150, 0) to (215, 200) nm, cell 'TOP': %s", want);
    refused(&d, "{}", code, message);
    return;
  }
  result r = segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  g_assert_cmpuint(g->count, ==, 1);
  g_assert_true("np"[g->type[0]] == *want);
  g_assert_cmpfloat(opc_test_metric("nmos"), ==, *want == 'n');
  g_assert_cmpfloat(opc_test_metric("pmos"), ==, *want == 'p');
  result_free(&r);
  eda_layout_free(d.layout);
}

static void test_type(void) {
  type_is("n", 0, "p");
  type_is("(n)", 0, "n");
  type_is("p", 0, "n");
  type_is("(p)", 0, "p");
  type_is("n(p)", 0, "p");
  type_is("(n)p", 0, "n");
  type_is("N", 0, "n");
  type_is("P", 0, "p");
  type_is("N(P)", 0, "n");
  type_is("nN", 0, "n");
  type_is("(n)P", 0, "p");
  type_is("n(NP)", 0, "p");
  type_is("NP", OPC_INVALID, "both implants cover it");
  type_is("np", OPC_INVALID, "both wells cover it");
  type_is("<n", OPC_INVALID, "'nwell' covers it in part");
  type_is("<p", OPC_INVALID, "'pwell' covers it in part");
  type_is("n<N", OPC_INVALID, "'nimplant' covers it in part");
  type_is("<P", OPC_INVALID, "'pimplant' covers it in part");
  const char *unknown =
      "its type is unknown: there is no layer 'nwell' or 'pwell', and no "
      "implant covers it";
  type_is("", OPC_INVALID, unknown);
  type_is("(N)", OPC_INVALID, unknown);
}

/* A layer of the wells without a shape, as where its number is that of its
   texts, makes all transistors alike: that is told. One that lies elsewhere is
   not. */
static void test_no_well(void) {
  static const char *const wells[] = {"nwell", "pwell"};
  for (int k = 0; k < 2; k++)
    for (int shapes = 0; shapes < 2; shapes++) {
      opc_error error;
      drawing d = drawing_new();
      draw(&d, "active", 0, 0, 400, 200);
      draw(&d, "poly", 150, -100, 215, 300);
      g_assert_cmpint(eda_layout_layer(d.layout, wells[k], &error), >=, 0);
      if (shapes) draw(&d, wells[k], 1000, 0, 1100, 100);
      opc_test_forget();
      result r = segment(d.layout, "{}");
      g_autofree char *want = g_strdup_printf(
          "layer '%s' has no shape, so that all transistors are "
          "%c-transistors",
          wells[k], "np"[k]);
      g_assert_true((strstr(opc_test_log(), want) == NULL) == shapes);
      result_free(&r);
      eda_layout_free(d.layout);
    }
}

/* ---- refusals ---- */

static void test_refused(void) {
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 400, 200);
  refused(&d, "{}", OPC_INVALID,
          "no transistor: the layout has no layer 'poly', but active; its "
          "reader's 'layers' says which of them it is");
  d = drawing_new();
  draw(&d, "active", 0, 0, 400, 200);
  draw(&d, "poly", 400, 0, 465, 200);
  refused(&d, "{}", OPC_INVALID,
          "no transistor: layers 'poly' and 'active' do not cross");
  d = drawing_new();
  draw_single(&d);
  refused(&d, "{ top: NAND }", OPC_INVALID, "the layout has no cell 'NAND'");

  static const struct {
    eda_box poly[2];
    const char *fault;
  } bad[] = {
      {{{150, -100, 215, 150}},
       "(150, 0) to (215, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{150, 50, 215, 150}},
       "(150, 50) to (215, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{350, -50, 450, 150}},
       "(350, 0) to (400, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{150, -100, 215, 150}, {150, 100, 500, 150}},
       "(150, 0) to (400, 150) nm, cell 'TOP': it is not a rectangle"},
      {{{-50, -50, 450, 250}},
       "(0, 0) to (400, 200) nm, cell 'TOP': "
       "no two opposite sides are edges of poly"},
      {{{350, -50, 450, 250}},
       "(350, 0) to (400, 200) nm, cell 'TOP': "
       "no two opposite sides are edges of poly"},
      {{{350, -50, 400, 250}},
       "(350, 0) to (400, 200) nm, cell 'TOP': "
       "an edge of poly lies on an edge of active"},
      {{{150, 0, 215, 250}},
       "(150, 0) to (215, 200) nm, cell 'TOP': "
       "an edge of poly lies on an edge of active"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *message =
        g_strdup_printf("transistor from %s", bad[i].fault);
    d = drawing_new();
    draw(&d, "active", 0, 0, 400, 200);
    draw(&d, "nwell", 0, 0, 1, 1);
    for (int k = 0; k < 2 && bad[i].poly[k].x1; k++)
      draw(&d, "poly", bad[i].poly[k].x0, bad[i].poly[k].y0, bad[i].poly[k].x1,
           bad[i].poly[k].y1);
    refused(&d, "{}", OPC_INVALID, message);
  }
}

static void test_refused_shapes(void) {
  /* A ring of poly that lies on active; a slanted edge. */
  drawing d = drawing_new();
  draw(&d, "active", 0, 0, 500, 500);
  draw(&d, "poly", 100, 100, 400, 150);
  draw(&d, "poly", 100, 350, 400, 400);
  draw(&d, "poly", 100, 100, 150, 400);
  draw(&d, "poly", 350, 100, 400, 400);
  refused(&d, "{}", OPC_INVALID,
          "transistor from (100, 100) to (400, 400) nm, cell 'TOP': poly ends "
          "on active");
  d = drawing_new();
  draw_single(&d);
  opc_error error;
  eda_point slanted[] = {{0, 0}, {100, 0}, {0, 100}};
  eda_layout_add_polygon(d.layout, d.cell,
                         eda_layout_layer(d.layout, "poly", &error), slanted, 3,
                         &error);
  refused(&d, "{}", OPC_INVALID,
          "layer 'poly', in units of 1 nm: slanted edge from (100, 0) to (0, "
          "100)");
}

/* ---- instances ---- */

static void test_instances(void) {
  drawing d = drawing_new();
  opc_error error;
  drawing inverter = d;
  inverter.cell = eda_layout_cell(d.layout, "INV", &error);
  draw(&inverter, "active", 0, 0, 300, 100);
  draw(&inverter, "active", 0, 400, 300, 600);
  draw(&inverter, "nwell", -100, 300, 400, 700);
  draw(&inverter, "poly", 100, -100, 165, 700);
  eda_placement p = {
      .origin = {1000, 0}, .magnification = 1, .columns = 1, .rows = 1};
  g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter.cell, &p,
                                          "X1", &error),
                  ==, OPC_OK);
  p.origin = (eda_point){0, 1000};
  p.angle = 90;
  g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter.cell, &p,
                                          "X2", &error),
                  ==, OPC_OK);
  /* The top cell's own poly over the active of X1; its active touches that of
     X1 and covers one of X2, where it comes first. */
  draw(&d, "active", -100, 1000, 0, 1300);
  draw(&d, "poly", 1230, -100, 1270, 200);
  draw(&d, "active", 1300, 0, 1500, 100);
  draw(&d, "poly", 1400, -100, 1440, 200);
  result r = segment(d.layout, "{ top: TOP }");
  const eda_gates *g = r.gates;
  check_all(g);
  static const struct {
    const char *instance, *cell;
    unsigned number;
    int32_t x0, y0;
    int type, axis;
  } want[] = {
      {"X1", "INV", 1, 1100, 0, EDA_NMOS, EDA_X},
      {"X1", "INV", 2, 1230, 0, EDA_NMOS, EDA_X},
      {"", "TOP", 1, 1400, 0, EDA_NMOS, EDA_X},
      {"X1", "INV", 3, 1100, 400, EDA_PMOS, EDA_X},
      {"X2", "INV", 1, -600, 1100, EDA_PMOS, EDA_Y},
      {"", "TOP", 2, -100, 1100, EDA_NMOS, EDA_Y},
  };
  g_assert_cmpstr(g->name, ==, "TOP");
  g_assert_cmpuint(g->count, ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < g->count; i++) {
    g_assert_cmpstr(g->instance[i], ==, want[i].instance);
    g_assert_cmpstr(g->cell[i], ==, want[i].cell);
    g_assert_cmpuint(g->number[i], ==, want[i].number);
    g_assert_cmpint(g->box[i].x0, ==, want[i].x0);
    g_assert_cmpint(g->box[i].y0, ==, want[i].y0);
    g_assert_cmpint(g->type[i], ==, want[i].type);
    g_assert_cmpint(g->axis[i], ==, want[i].axis);
  }
  g_assert_cmpint(g->extent.x0, ==, -700);
  g_assert_cmpint(g->extent.x1, ==, 1500);
  result_free(&r);
  draw(&inverter, "poly", 200, -50, 240, 50);
  refused(&d, "{}", OPC_INVALID,
          "transistor from (1200, 0) to (1270, 100) nm, cell 'INV', instance "
          "'X1': it is not a rectangle");
}

/* ---- further layers ---- */

static void check_layer(const eda_gates *g, size_t layer, const char *name,
                        int corrected, const char *edges) {
  g_assert_cmpstr(g->layer[layer], ==, name);
  g_assert_cmpint(g->corrected[layer], ==, corrected);
  g_autofree char *got = tell_edges(&g->edges[layer]);
  g_assert_cmpstr(got, ==, edges);
}

/* Layers in the order of the flow, with contacts before them if any are drawn;
   their edges are nobody's, and the extent has them. */
static void test_also(void) {
  for (int contacts = 0; contacts < 2; contacts++) {
    drawing d = drawing_new();
    draw_single(&d);
    draw(&d, "M1", 2000, 0, 2100, 50);
    draw(&d, "M1", 2050, 50, 2100, 90);
    draw(&d, "M2", 0, 0, 10, 10);
    if (contacts) draw(&d, "contact", 20, 20, 80, 80);
    result r = segment(d.layout, "{ also: { metal2: M2, metal1: M1 } }");
    const eda_gates *g = r.gates;
    size_t first = contacts ? 3 : 2;
    check_owned(g);
    g_assert_cmpuint(g->layers, ==, first + 2);
    g_assert_cmpint(eda_gates_layer(g, "contact"), ==, contacts ? 2 : -1);
    if (contacts) check_layer(g, 2, "contact", 0, "");
    check_layer(g, first, "metal2", 1, "0,0 -; 10,0 -; 10,10 -; 0,10 -\n");
    check_layer(g, first + 1, "metal1", 1,
                "2000,0 -; 2100,0 -; 2100,90 -; 2050,90 -; 2050,50 -; "
                "2000,50 -\n");
    check_rebuilt(g, (int)first + 1);
    g_assert_cmpint(g->extent.x1, ==, 2100);
    opc_error error;
    g_assert_cmpint(eda_gates_check(g, &error), ==, OPC_OK);
    result_free(&r);
    eda_layout_free(d.layout);
  }
}

static void test_also_refused(void) {
  static const struct {
    const char *map, *message;
  } bad[] = {
      {"poly: M1", "'poly': there is a layer of that name already"},
      {"contact: M1", "'contact': there is a layer of that name already"},
      {"gates: poly", "'gates': layer poly is 'poly' already"},
      {"a: M1, b: M1", "'b': layer M1 is 'a' already"},
      {"poly_drawn: M1", "'poly_drawn' is no name of a layer"},
      {"'a b': M1", "'a b' is no name of a layer"},
      {"'': M1", "'' is no name of a layer"},
  };
  opc_error error;
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *map = g_strdup_printf("{ also: { %s } }", bad[i].map);
    g_assert_null(opc_test_module("segment.transistors", map, &error));
    g_assert_nonnull(strstr(error.message, bad[i].message));
  }
  drawing d = drawing_new();
  draw_single(&d);
  refused(&d, "{ also: { metal1: M1 } }", OPC_INVALID,
          "the layout has no layer 'M1'");
  d = drawing_new();
  draw_single(&d);
  eda_layout_layer(d.layout, "M1", &error);
  refused(&d, "{ also: { metal1: M1 } }", OPC_INVALID, "layer 'M1' is empty");
}

/* ---- notes ---- */

static void write_note(drawing *d, int32_t x, int32_t y, const char *text) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, "notes", &error);
  g_assert_cmpint(eda_layout_add_text(d->layout, d->cell, l, (eda_point){x, y},
                                      text, &error),
                  ==, OPC_OK);
}

/* An inverter with a note upon its n-transistor: as drawn, turned, mirrored,
   and four times in an array. */
static drawing noted(drawing *inverter) {
  static const eda_placement places[] = {
      {{1000, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{0, 2000}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}},
      {{3000, 2000}, 1, 180, 1, 1, 1, {0, 0}, {0, 0}},
      {{5000, 0}, 1, 0, 0, 2, 2, {800, 0}, {0, 1500}},
  };
  static const char *const names[] = {"X1", "X2", "X3", "XA"};
  opc_error error;
  drawing d = drawing_new();
  *inverter = d;
  inverter->cell = eda_layout_cell(d.layout, "INV", &error);
  draw(inverter, "active", 0, 0, 300, 100);
  draw(inverter, "active", 0, 400, 300, 600);
  draw(inverter, "nwell", -100, 300, 400, 700);
  draw(inverter, "poly", 100, -100, 165, 700);
  write_note(inverter, 100, 0, "weight=2");
  for (int i = 0; i < 4; i++)
    g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter->cell,
                                            &places[i], names[i], &error),
                    ==, OPC_OK);
  return d;
}

static void test_notes(void) {
  drawing inverter, d = noted(&inverter);
  /* One instance of its own, at the far corner of the gate; one without; a
     p-transistor; the same twice. */
  write_note(&d, 1165, 100, "ion=1.05");
  write_note(&d, 5101, 1, "");
  write_note(&d, 1130, 500, "ion=0.9");
  write_note(&d, 1131, 501, "ion=0.9");
  opc_test_forget();
  result r = segment(d.layout, "{ top: TOP }");
  const eda_gates *g = r.gates;
  g_assert_cmpuint(g->count, ==, 14);
  for (size_t i = 0; i < g->count; i++) {
    int n = g->type[i] == EDA_NMOS, own = !strcmp(g->instance[i], "X1"),
        taken = !strcmp(g->instance[i], "XA[0,0]");
    g_assert_cmpint(g->wish[i].given, ==, (n && !taken) || own);
    g_assert_cmpfloat(g->wish[i].weight, ==, n && !own && !taken ? 2 : 1);
    g_assert_cmpfloat(g->wish[i].target[EDA_WISH_ION], ==,
                      !own ? 1
                      : n  ? 1.05
                           : 0.9);
  }
  g_assert_null(strstr(opc_test_log(), "no transistor"));
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);

  /* Beside the gate by 1 nm, in every instance. */
  write_note(&inverter, 166, 50, "lost");
  opc_test_forget();
  r = segment(d.layout, "{ top: TOP }");
  g_assert_nonnull(strstr(opc_test_log(),
                          "texts of layer 'notes' on no transistor: 7, the "
                          "first 'lost' at (1166, 50) nm, instance 'X1'"));
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  write_note(&inverter, 130, 50, "weight=3");
  refused(&d, "{ top: TOP }", OPC_INVALID,
          "transistor 'X2:2' has two notes: 'weight=2', and at (-50, 2130) nm "
          "'weight=3'");
  drawing bad = drawing_new();
  draw_single(&bad);
  write_note(&bad, 160, 100, "wieght=2");
  refused(&bad, "{}", OPC_INVALID,
          "note of 'TOP:1': unknown word 'wieght', did you mean 'weight'?");
}

/* No such layer; such a layer without a text; a coarse grid. */
static void test_no_notes(void) {
  opc_error error;
  drawing d = drawing_new();
  draw_single(&d);
  result r = segment(d.layout, "{}");
  g_assert_null(((const eda_gates *)r.gates)->wish);
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  eda_layout_layer(d.layout, "notes", &error);
  r = segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  g_assert_nonnull(g->wish);
  for (size_t i = 0; i < g->count; i++)
    g_assert_cmpint(g->wish[i].given, ==, 0);
  eda_box b = g->box[0];
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  write_note(&d, b.x1, b.y1, "area=1.5");
  r = segment(d.layout, "{ grid: 5 nm }");
  g = r.gates;
  g_assert_cmpfloat(g->wish[0].target[EDA_WISH_AREA], ==, 1.5);
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  eda_layout_free(d.layout);
}

static void test_cancel(void) {
  drawing d = drawing_new();
  draw_single(&d);
  opc_test_cancel(TRUE);
  refused(&d, "{}", OPC_CANCELLED, "cancelled");
  opc_test_cancel(FALSE);
}

/* ---- the cell library ---- */

static char *data_file(const char *name) {
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *folder = data ? g_strdup(data)
                                 : g_build_filename(source ? source : ".", "..",
                                                    "shared", "data", NULL);
  return g_build_filename(folder, name, NULL);
}

/* NULL if there is no test data: the test is then skipped. */
static opc_module *read_gds(const char *name, double scale, void **layout) {
  g_autofree char *path = data_file(name);
  if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
    g_autofree char *reason = g_strdup_printf("no test data: %s", name);
    g_test_skip(reason);
    return NULL;
  }
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', scale: %g, layers: { active: 1/0, pwell: 2/0, nwell: 3/0, "
      "nimplant: 4/0, pimplant: 5/0, poly: 9/0, contact: 10/0 } }",
      path, scale);
  opc_error error;
  opc_module *reader = opc_test_module("read.gds", map, &error);
  if (!reader || opc_test_run(reader, layout, &error))
    g_error("%s", error.message);
  return reader;
}

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* devices.csv as sorted lines: cell, type, corners in units of 0.5 nm. */
static GPtrArray *read_devices(void) {
  g_autofree char *path = data_file("nangate45/devices.csv");
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  GPtrArray *out = g_ptr_array_new_with_free_func(g_free);
  for (char **line = lines + 1; *line && **line; line++) {
    g_auto(GStrv) f = g_strsplit(*line, ",", -1);
    int at[6];
    for (int k = 0; k < 6; k++)
      at[k] = (int)lround(g_ascii_strtod(f[3 + k], NULL) * 2000);
    g_ptr_array_add(
        out, g_strdup_printf("%s %c %d %d %d %d %d %d", f[0],
                             strstr(f[2], "PMOS") ? 'p' : 'n', at[0], at[1],
                             at[2], at[3], at[4], at[5]));
  }
  qsort(out->pdata, out->len, sizeof *out->pdata, by_text);
  return out;
}

static void test_nangate(void) {
  void *layout;
  opc_module *reader =
      read_gds("nangate45/NangateOpenCellLibrary.gds", 1, &layout);
  if (!reader) return;
  g_autoptr(GPtrArray) want = read_devices();
  g_autoptr(GPtrArray) got = g_ptr_array_new_with_free_func(g_free);
  size_t without = 0;
  for (size_t c = 0; c < eda_layout_cells(layout); c++) {
    const char *name = eda_layout_cell_name(layout, (int32_t)c);
    g_autofree char *map = g_strdup_printf("{ top: %s, grid: 0.5 nm }", name);
    opc_error error;
    g_autoptr(opc_module) m =
        opc_test_module("segment.transistors", map, &error);
    opc_test_input(m, "layout", layout);
    void *out;
    int code = opc_test_run(m, &out, &error);
    if (code) {
      g_assert_cmpstr(error.message, ==,
                      "no transistor: layers 'poly' and 'active' do not cross");
      without++;
      continue;
    }
    const eda_gates *g = out;
    check_all(g);
    g_assert_cmpfloat(opc_test_metric("snapped"), ==, 0);
    for (size_t i = 0; i < g->count; i++) {
      g_assert_cmpstr(g->cell[i], ==, name);
      g_assert_cmpuint(g->number[i], ==, i + 1);
      g_ptr_array_add(
          got, g_strdup_printf("%s %c %d %d %d %d %d %d", name,
                               "np"[g->type[i]], (int)(2 * g->length[i]),
                               (int)(2 * g->width[i]), g -> box[i].x0,
                               g->box[i].y0, g->box[i].x1, g->box[i].y1));
    }
    opc_test_release(m, &out);
  }
  qsort(got->pdata, got->len, sizeof *got->pdata, by_text);
  g_assert_cmpuint(without, ==, 135 - 127);
  g_assert_cmpuint(got->len, ==, 2590);
  g_assert_cmpuint(got->len, ==, want->len);
  for (guint i = 0; i < got->len; i++)
    g_assert_cmpstr(got->pdata[i], ==, want->pdata[i]);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

/* The space by asking every edge. */
static double slow_space(const eda_gates *g, size_t i, int side) {
  double away[2] = {INFINITY, INFINITY};
  const eda_box *b = &g->box[i];
  int x = g->axis[i] == EDA_X;
  double from = x ? (side ? b->x1 : b->x0) : (side ? b->y1 : b->y0);
  double middle = x ? (b->y0 + b->y1) / 2. : (b->x0 + b->x1) / 2.;
  for (int layer = 0; layer < 2; layer++)
    for (size_t p = 0; p < g->drawn[layer].count; p++) {
      const eda_shapes *s = &g->drawn[layer];
      for (uint32_t k = s->start[p]; k < s->start[p + 1]; k++) {
        eda_point u = s->points[k];
        eda_point v = s->points[k + 1 < s->start[p + 1] ? k + 1 : s->start[p]];
        double at = x ? u.x : u.y, low = x ? MIN(u.y, v.y) : MIN(u.x, v.x),
               high = x ? MAX(u.y, v.y) : MAX(u.x, v.x);
        if (at != (x ? v.x : v.y) || middle < low || middle >= high) continue;
        double far = side ? at - from : from - at;
        if (far > 0) away[layer] = fmin(away[layer], far);
      }
    }
  return fmin(away[EDA_POLY], 2 * fmax(away[EDA_ACTIVE], g->length[i]));
}

static void test_c432(void) {
  void *layout;
  opc_module *reader = read_gds("iscas85/c432/c432.gds", 1.3, &layout);
  if (!reader) return;
  opc_test_forget();
  result r = segment(layout, "{}");
  const eda_gates *g = r.gates;
  check_all(g);
  g_assert_cmpuint(g->count, ==, 820);
  g_assert_cmpfloat(opc_test_metric("transistors"), ==, 820);
  g_assert_cmpfloat(opc_test_metric("nmos"), ==, 410);
  g_assert_cmpfloat(opc_test_metric("snapped"), >, 0);
  g_assert_cmpfloat(opc_test_metric("snapped_worst"), <=, 0.5 * sqrt(2) + 1e-9);
  g_assert_nonnull(strstr(opc_test_log(), "vertices of layer 'poly'"));
  for (size_t i = 0; i < g->count; i++) {
    g_assert_cmpfloat(g->length[i], ==, 65);
    g_assert_true(g->instance[i][0] == 'U');
    for (int side = 0; side < 2; side++)
      g_assert_cmpfloat(g->space[2 * i + side], ==, slow_space(g, i, side));
  }
  result_free(&r);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/transistors/vertical", test_vertical);
  g_test_add_func("/transistors/lengths", test_lengths);
  g_test_add_func("/transistors/horizontal", test_horizontal);
  g_test_add_func("/transistors/figure-3.2", test_figure);
  g_test_add_func("/transistors/shared-poly", test_shared_poly);
  g_test_add_func("/transistors/narrow-active", test_narrow_active);
  g_test_add_func("/transistors/near-end", test_near_end);
  g_test_add_func("/transistors/turning-poly", test_turning_poly);
  g_test_add_func("/transistors/bent-active", test_bent_active);
  g_test_add_func("/transistors/type", test_type);
  g_test_add_func("/transistors/no-well", test_no_well);
  g_test_add_func("/transistors/refused", test_refused);
  g_test_add_func("/transistors/refused-shapes", test_refused_shapes);
  g_test_add_func("/transistors/instances", test_instances);
  g_test_add_func("/transistors/also", test_also);
  g_test_add_func("/transistors/also-refused", test_also_refused);
  g_test_add_func("/transistors/notes", test_notes);
  g_test_add_func("/transistors/no-notes", test_no_notes);
  g_test_add_func("/transistors/cancel", test_cancel);
  g_test_add_func("/transistors/nangate", test_nangate);
  g_test_add_func("/transistors/c432", test_c432);
  return g_test_run();
}
