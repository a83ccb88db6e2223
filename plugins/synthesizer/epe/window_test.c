/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests averages of placement errors over doses, and printed images that vanish
   or cover everything. */
#include "trial_test.h"

#include "core/plugin/host.h"

static const opc_host *host;

/* ---- other doses ---- */

/* A line 200 nm wide and a printed image, of which the test uses the level set
   only. */
typedef struct seen {
  opc_module *module;
  eda_gates *gates;
  eda_cuts cuts;
  eda_field print[LAYERS];
  size_t count;
  int32_t *shift;
  double *epe;
  uint32_t iteration;
} seen;

static seen window_see(const char *parameters, eda_gates *gates) {
  opc_error error;
  seen s = {.module = opc_test_module("synthesizer.epe", parameters, &error),
            .gates = gates};
  if (!s.module) g_error("%s", error.message);
  const eda_synthesizer *o = s.module->functions;
  eda_feedback f = {.gates = gates};
  g_assert_cmpint(o->begin(s.module->self, &f, &error), ==, OPC_OK);
  g_assert_cmpint(o->cut(s.module->self, gates, EDA_POLY, &s.cuts, &error), ==,
                  OPC_OK);
  s.count = s.cuts.start[s.cuts.polygons];
  s.shift = g_new0(int32_t, s.count);
  s.epe = g_new0(double, s.count);
  eda_field *p = s.print;
  *p = (eda_field){{-100, 0, 400, 400}, 100, 100, NULL};
  p->coefficients = eda_alloc(10000, sizeof(float));
  return s;
}

/* Set the level set to cos + 0.3 cos 2 + 0.3 of 2 pi x / 400 nm from the middle
   of the line, times `scale`, plus `more`. */
static void window_expose(seen *s, double scale, double more) {
  for (int i = 0; i < 10000; i++) {
    double t = 2 * G_PI * (i % 100 * 4 - 200) / 400;
    double v = cos(t) + 0.3 * cos(2 * t) + 0.3;
    s->print->coefficients[i] = (float)(scale * v + more);
  }
  eda_field_from_samples(host->context, s->print);
}

static void window_check(seen *s, double nm) {
  opc_error error;
  int done = 0;
  const eda_synthesizer *o = s->module->functions;
  for (size_t i = 0; i < s->count; i++) s->epe[i] = nm;
  const double *epe[LAYERS] = {s->epe};
  int32_t *shift[LAYERS] = {s->shift};
  eda_boxes assists[LAYERS] = {s->cuts.assists};
  eda_feedback f = {.gates = s->gates,
                    .iteration = s->iteration++,
                    .epe = epe,
                    .print = s->print};
  eda_moves moves = {.shift = shift, .assists = assists};
  g_assert_cmpint(o->update(s->module->self, &f, &moves, &done, &error), ==,
                  OPC_OK);
}

static void window_end(seen *s) {
  opc_test_module_free(s->module);
  eda_field_clear(s->print);
  g_free(s->shift);
  g_free(s->epe);
}

/* Return the mean outward shift of the sides near the middle of the line. The
   sides are averaged because rounding to the grid is spread along them. */
static double move_of_middle(const seen *s) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < s->count; i++) {
    if (fabs(s->cuts.site[2 * i + 1] - 1000) > 400) continue;
    sum += s->shift[i];
    n++;
  }
  return sum / n;
}

/* The nominal contour is on the drawn edge, but the contours at the two other
   doses are 33.3 nm outside and 19.2 nm inside: c + 0.6 c^2 = -+0.35 with c the
   cosine. */
static void test_window(void) {
  const eda_box line = {0, 0, 200, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  double mean = 0;
  for (int k = -1; k <= 1; k += 2) {
    double c = (sqrt(1 + 2.4 * 0.35 * k) - 1) / 1.2;
    mean += (400 / (2 * G_PI) * acos(c) - 100) / 2;
  }
  for (int weight = 0; weight <= 2; weight++) {
    g_autofree char *p = g_strdup_printf(
        "{ damping: 1, blur: 20 nm, stiffness: 0.01, window: { level: 0.035, "
        "weight: %g } }",
        weight / 2.0);
    seen n = window_see(p, &s->gates);
    window_expose(&n, 0.1, 0);
    window_check(&n, 0);
    if (!weight) window_check(&n, 2); /* otherwise all errors are already 0 */
    double expected = weight ? -mean * weight / 2 : -2;
    g_assert_cmpfloat(fabs(move_of_middle(&n) - expected), <, 0.3);
    window_end(&n);
  }
}

/* A feature that vanishes after it printed too large must grow; a feature that
   then covers everything must shrink. */
static void test_gone(void) {
  const eda_box line = {0, 0, 200, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  for (int sign = -1; sign <= 1; sign += 2) {
    seen n = window_see("{}", &s->gates);
    window_expose(&n, 0.1, 0);
    window_check(&n, -sign * 5.0);
    double before = move_of_middle(&n);
    window_expose(&n, 0, sign);
    window_check(&n, NAN);
    g_assert_cmpfloat((move_of_middle(&n) - before) * sign, <, -1);
    window_end(&n);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/epe/window", test_window);
  g_test_add_func("/epe/gone", test_gone);
  return g_test_run();
}
