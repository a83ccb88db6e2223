/* SPDX-License-Identifier: BSD-3-Clause */
/* The loop with models and plugins of a few lines: a synthesizer that cuts a
   layer itself, patches, and what there is no transistor for. Edge placement
   errors against contours that are known in closed form. */
#include "core/correct/loop.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

#include <glib.h>
#include <math.h>
#include <string.h>

static opc_host *host;

/* ---- models ---- */

/* One coherent system without edges. */
static const double cut_off = 60, limit = 4 / 60.0;

static int nothing(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double band(const void *self) {
  (void)self;
  return limit;
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut_off * cut_off;
    out[2 * i] = (float)exp(-r);
    out[2 * i + 1] = 0;
  }
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  static const double one = 1;
  (void)self, (void)layer;
  const opc_systems systems = {.size = sizeof systems, .count = 1,
                               .weight = &one, .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = transfer, .scale = {1, 0}};
  return host->imaging->coherent_sum(host, mask, &systems, 0, out, error);
}

static int calibrate(void *self, const opc_module *litho, opc_error *error) {
  (void)self, (void)litho, (void)error;
  return OPC_OK;
}

static int print(const void *self, int layer, opc_field *f, opc_error *error) {
  (void)self, (void)layer, (void)error;
  for (int i = 0; i < f->nx * f->ny; i++)
    f->coefficients[i] = 0.6F - f->coefficients[i];
  return OPC_OK;
}

static size_t slicing(const void *self, const double **p, const double **s) {
  static const double middle = 0.5, all = 1;
  (void)self;
  *p = &middle;
  *s = &all;
  return 1;
}

static int extract(const void *self, const opc_slices *in, opc_performance *out,
                   opc_error *error) {
  (void)self, (void)out, (void)error;
  g_assert_cmpuint(in->count, ==, 0);
  return OPC_OK;
}

static const opc_litho litho = {.size = sizeof litho, .prepare = nothing,
                                .band = band, .image = image};
static const opc_resist resist = {.size = sizeof resist, .prepare = calibrate,
                                  .print = print};
static const opc_extract extractor = {.size = sizeof extractor,
                                      .prepare = nothing, .slicing = slicing,
                                      .extract = extract};
#define MODULE(kind_, operations_)                                       \
  &(const opc_module) {                                                  \
    &(const opc_plugin){.size = sizeof(opc_plugin), .id = "test.module", \
                        .kind = (kind_), .operations = (operations_)},   \
        NULL                                                             \
  }

/* ---- a layout without transistors: an L and a bar, grid 2 nm ---- */

static opc_point corners[] = {{0, 0},    {200, 0},  {200, 60}, {60, 60},
                              {60, 300}, {0, 300},  {120, 120}, {300, 120},
                              {300, 300}, {120, 300}};
static uint32_t starts[] = {0, 6, 10};
static const opc_gates metal = {
    .size = sizeof metal, .name = "metal", .grid = 2, .extent = {0, 0, 300, 300},
    .drawn[OPC_POLY] = {2, starts, corners, NULL}};

/* ---- a synthesizer that halves the error of each third of an edge ---- */

enum { THIRDS = 30 };

static struct synthesizer {
  opc_point from[THIRDS];
  double site[2 * THIRDS];
  uint32_t start[3];
  const char *spoil;           /* what to do wrong */
  const opc_box *assists;
  size_t assist_count;
  int drop;                    /* the last of them with the first moves */
  uint32_t first_simulations;  /* prints before the first moves */
  int updates;
  opc_printer *printer;
} own;

static int cut(void *self, const opc_gates *g, int layer, opc_cuts *cuts,
               opc_error *error) {
  (void)self, (void)error;
  if (layer != OPC_POLY) return OPC_OK;
  const opc_shapes *s = &g->drawn[layer];
  uint32_t n = 0;
  for (uint32_t p = 0; p < 2; p++) {
    uint32_t many = s->start[p + 1] - s->start[p];
    own.start[p] = n;
    for (uint32_t i = 0; i < many; i++) {
      opc_point a = s->points[s->start[p] + i],
                b = s->points[s->start[p] + (i + 1) % many];
      for (int k = 0; k < 3; k++, n++) {
        own.from[n] = (opc_point){a.x + (b.x - a.x) / 3 * k,
                                  a.y + (b.y - a.y) / 3 * k};
        own.site[2 * n] = (a.x + (b.x - a.x) * (2 * k + 1) / 6.0) * g->grid;
        own.site[2 * n + 1] = (a.y + (b.y - a.y) * (2 * k + 1) / 6.0) * g->grid;
      }
    }
  }
  own.start[2] = n;
  *cuts = (opc_cuts){.size = sizeof *cuts, .polygons = 2, .start = own.start,
                     .from = own.from, .site = own.site,
                     .assists = own.assists,
                     .assist_count = own.assist_count};
  if (!own.spoil) return OPC_OK;
  if (!strcmp(own.spoil, "count")) cuts->polygons = 1;
  if (!strcmp(own.spoil, "corner")) own.from[3].x -= 1;
  if (!strcmp(own.spoil, "first corner")) own.from[0].x += 1;
  if (!strcmp(own.spoil, "order")) own.from[1] = own.from[2];
  if (!strcmp(own.spoil, "off")) own.from[4].x += 1;
  if (!strcmp(own.spoil, "site")) own.site[9] += 1000;
  if (!strcmp(own.spoil, "nan")) own.site[0] = NAN;
  if (!strcmp(own.spoil, "end")) own.start[2] = 5;
  if (!strcmp(own.spoil, "none")) cuts->from = NULL;
  return OPC_OK;
}

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  (void)self, (void)error;
  g_assert_null(f->printed);
  g_assert_null(f->epe[OPC_POLY]);
  return OPC_OK;
}

static int update(void *self, const opc_feedback *f, opc_moves *m, int *done,
                  opc_error *error) {
  (void)self, (void)error;
  g_assert_nonnull(f->epe[OPC_POLY]);
  g_assert_null(f->epe[OPC_ACTIVE]);
  g_assert_null(m->shift[OPC_ACTIVE]);
  g_assert_nonnull(f->next_end);
  own.updates++;
  *done = 1;
  if (own.spoil && !strcmp(own.spoil, "at once")) return OPC_OK;
  if (f->iteration == 0) own.first_simulations = own.printer->simulations;
  double worst = 0;
  for (int i = 0; i < THIRDS; i++) {
    double epe = f->epe[OPC_POLY][i];
    g_assert_false(isnan(epe));
    worst = fmax(worst, fabs(epe));
    m->shift[OPC_POLY][i] -= (int32_t)lround(epe / f->gates->grid * 0.6);
  }
  *done = worst < 2 || f->iteration == 40;
  g_assert_nonnull(f->print[OPC_POLY].coefficients);
  g_assert_cmpuint(m->assist_count[OPC_POLY], ==,
                   own.assist_count - (own.drop && f->iteration > 0));
  if (own.drop && f->iteration == 0) m->assist_count[OPC_POLY]--;
  if (own.spoil && !strcmp(own.spoil, "far")) m->shift[OPC_POLY][7] = 1 << 21;
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  (void)self, (void)gate;
  return NULL;
}

static const opc_synthesizer cutter = {.size = sizeof cutter, .begin = begin,
                                       .update = update, .verdict = verdict,
                                       .cut = cut};
static const opc_synthesizer hasty = {.size = sizeof hasty, .begin = begin,
                                      .update = update, .verdict = verdict,
                                      .cut = cut,
                                      .flags = OPC_SYNTHESIZER_ENDS_ANYTIME};

/* ---- a regulator with one patch ---- */

static const opc_box patch = {-20, 100, 30, 140};
static const opc_box *patch_given, *bite_given;

static int rule(void *self, const opc_printed *p, opc_ruling *r,
                opc_error *error) {
  (void)self, (void)error;
  g_assert_nonnull(p->mask);
  g_assert_cmpuint(p->mask[OPC_POLY].count, ==, 2);
  g_assert_nonnull(p->print[OPC_ACTIVE].coefficients);
  r->patches[OPC_POLY] = patch_given;
  r->patch_count[OPC_POLY] = 1;
  r->bites[OPC_POLY] = bite_given;
  r->bite_count[OPC_POLY] = bite_given != NULL;
  return OPC_OK;
}

static const opc_regulator regulator = {.size = sizeof regulator, .rule = rule};

/* ---- the loop ---- */

static int run(opc_loop *l, const opc_synthesizer *s, const opc_module *drc,
               opc_error *error) {
  *l = (opc_loop){.host = host, .gates = &metal, .regulator = drc,
                  .extract = MODULE(OPC_KIND_EXTRACT, &extractor),
                  .synthesizer = MODULE(OPC_KIND_MASK, s),
                  .max_iterations = 60};
  opc_printer_make(&l->printer, host, &metal, MODULE(OPC_KIND_LITHO, &litho),
                   MODULE(OPC_KIND_RESIST, &resist), 400);
  own.printer = &l->printer;
  int code = opc_loop_run(l, error);
  l->printer.litho.litho = NULL;   /* the modules end here */
  return code;
}

static int64_t drawn_area2(void) {
  return host->geometry->area2(&metal.drawn[OPC_POLY]);
}

/* A metal layer: its print comes to lie on the drawn edges. */
static void test_fragments(void) {
  opc_loop l;
  opc_error error = {0};
  own.spoil = NULL;
  g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_OK);
  g_assert_cmpuint(l.summary.gates, ==, 0);
  g_assert_cmpuint(l.summary.sites, ==, THIRDS);
  g_assert_cmpuint(l.summary.lost, ==, 0);
  g_assert_cmpfloat(l.summary.epe_max, <, 2);
  /* Printing too large, the mask has become smaller. */
  g_assert_cmpint(host->geometry->area2(&l.mask[OPC_POLY]), <,
                  drawn_area2() * 9 / 10);
  /* The other layer was printed once. */
  g_assert_cmpuint(l.iterations, >, 2);
  g_assert_cmpuint(l.printer.simulations, <=, 2 + l.iterations);
  opc_loop_clear(&l);
}

static void test_patches(void) {
  opc_loop l;
  opc_error error = {0};
  own.spoil = NULL;
  for (int early = 0; early < 2; early++) {
    patch_given = &patch;
    g_assert_cmpint(run(&l, early ? &hasty : &cutter,
                        MODULE(OPC_KIND_DRC, &regulator), &error),
                    ==, OPC_OK);
    /* Settled before the first moves, or together with them. */
    g_assert_cmpuint(own.first_simulations, ==, early ? 2 : 3);
    opc_shapes box, outside, both;
    g_assert_true(opc_pieces_boxes(host, &patch, 1, NULL, 0, &box));
    const opc_geometry_service *g = host->geometry;
    g_assert_false(g->boolean(host, OPC_NOT, &box, &l.mask[OPC_POLY], &outside,
                              &error));
    g_assert_false(g->boolean(host, OPC_NOT, &l.mask[OPC_POLY],
                              &l.polygons[OPC_POLY], &both, &error));
    g_assert_cmpuint(outside.count, ==, 0);
    g_assert_cmpuint(both.count, ==, 1);   /* what the patch adds */
    g->release(&box);
    g->release(&outside);
    g->release(&both);
    opc_loop_clear(&l);
  }
  /* One that is content before it has seen the patch is asked again. */
  own.spoil = "at once";
  own.updates = 0;
  g_assert_cmpint(run(&l, &hasty, MODULE(OPC_KIND_DRC, &regulator), &error), ==,
                  OPC_OK);
  g_assert_cmpint(own.updates, ==, 2);
  g_assert_cmpuint(l.printer.simulations, ==, 3);
  opc_loop_clear(&l);
  own.spoil = NULL;
  static const opc_box wrong = {10, 0, 10, 5};
  patch_given = &wrong;
  g_assert_cmpint(run(&l, &cutter, MODULE(OPC_KIND_DRC, &regulator), &error),
                  ==, OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "regulator");
  g_assert_cmpstr(error.message, ==,
                  "number 1 of the patches of poly is no box: (10, 0) to (10, 5)");
  opc_loop_clear(&l);
}

/* What is bitten away is gone, of a patch as of the mask, and nothing else. */
static void test_bites(void) {
  static const opc_box bite = {-20, 120, 10, 160};
  opc_loop with, without;
  opc_error error = {0};
  opc_shapes box, gone, kept, rest;
  const opc_geometry_service *g = host->geometry;
  own.spoil = "at once";
  patch_given = &patch;
  own.updates = 0;
  g_assert_cmpint(
      run(&without, &hasty, MODULE(OPC_KIND_DRC, &regulator), &error), ==,
      OPC_OK);
  bite_given = &bite;
  own.updates = 0;
  g_assert_cmpint(run(&with, &hasty, MODULE(OPC_KIND_DRC, &regulator), &error),
                  ==, OPC_OK);
  bite_given = NULL;
  own.spoil = NULL;
  g_assert_true(opc_pieces_boxes(host, &bite, 1, NULL, 0, &box));
  g_assert_false(
      g->boolean(host, OPC_AND, &box, &with.mask[OPC_POLY], &kept, &error));
  g_assert_cmpuint(kept.count, ==, 0);
  g_assert_false(g->boolean(host, OPC_NOT, &without.mask[OPC_POLY],
                            &with.mask[OPC_POLY], &gone, &error));
  g_assert_false(g->boolean(host, OPC_NOT, &gone, &box, &rest, &error));
  g_assert_cmpint(g->area2(&gone), >, 0);
  g_assert_cmpuint(rest.count, ==, 0);
  g->release(&box);
  g->release(&gone);
  g->release(&kept);
  g->release(&rest);
  opc_loop_clear(&with);
  opc_loop_clear(&without);
}

/* Assist features are of the mask as they are, merged where they touch, and one
   that is taken away is not. */
static void test_assists(void) {
  static const opc_box bars[] = {{400, -100, 420, 400}, {410, 390, 500, 410},
                                 {-120, 0, -100, 200}};
  const opc_geometry_service *g = host->geometry;
  opc_loop l;
  opc_error error = {0};
  own.spoil = NULL;
  own.assists = bars;
  own.assist_count = 3;
  for (own.drop = 0; own.drop < 2; own.drop++) {
    g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_OK);
    opc_shapes added;
    g_assert_false(g->boolean(host, OPC_NOT, &l.mask[OPC_POLY],
                              &l.polygons[OPC_POLY], &added, &error));
    g_assert_cmpuint(added.count, ==, own.drop ? 1 : 2);
    int64_t both = 20 * 500 + 90 * 20 - 10 * 10;
    g_assert_cmpint(g->area2(&added), ==,
                    2 * (both + (own.drop ? 0 : 20 * 200)));
    g->release(&added);
    opc_loop_clear(&l);
  }
  own.drop = 0;
  static const opc_box wrong[] = {{0, 400, 10, 410}, {10, 400, 5, 410}};
  own.assists = wrong;
  own.assist_count = 2;
  g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "synthesizer");
  g_assert_cmpstr(error.message, ==,
                  "number 2 of the assists of poly is no box: (10, 400) to (5, "
                  "410)");
  opc_loop_clear(&l);
  own.assists = NULL;
  g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==,
                  "gives 2 assists of poly without their boxes");
  opc_loop_clear(&l);
  own.assist_count = 0;
}

static void test_faults(void) {
  const struct {
    const char *spoil, *message;
  } cases[] = {
      {"count", "cuts 1 polygons of poly, there are 2"},
      {"corner", "cuts poly: the end of fragment 4, (400, 40) nm, is not on the "
                 "edge from (0, 0) to (400, 0) nm, or not in its order"},
      {"first corner",
       "cuts poly: no fragment begins at the corner (0, 0) nm"},
      {"order", "cuts poly: the end of fragment 2, (264, 0) nm, is not on the "
                "edge from (0, 0) to (400, 0) nm, or not in its order"},
      {"off", "cuts poly: the end of fragment 4, (402, 40) nm, is not on the "
              "edge from (400, 0) to (400, 120) nm, or not in its order"},
      {"site", "cuts poly: the site of fragment 5, (400, 1060) nm, is not on "
               "the edge from (400, 0) to (400, 120) nm, or not in its order"},
      {"nan", "cuts poly: the site of fragment 1, (nan, 0) nm, is not on the "
              "edge from (0, 0) to (400, 0) nm, or not in its order"},
      {"end", "cuts poly: the fragments of polygon 2 end before they begin"},
      {"none", "cuts poly: fragments are missing"},
      {"far", "moves fragment 8 of poly by 2097152 steps, at most 1048576 are "
              "possible"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_loop l;
    opc_error error = {0};
    own.spoil = cases[i].spoil;
    g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_FAILED);
    g_assert_cmpstr(error.parameter, ==, "synthesizer");
    g_assert_cmpstr(error.message, ==, cases[i].message);
    opc_loop_clear(&l);
  }
}

/* ---- what is told of it ---- */

static GString *told;

static int keep_metric(void *data, const char *name, double value,
                       opc_error *error) {
  (void)data, (void)error;
  g_assert_true(isfinite(value));
  g_string_append_printf(told, "%s ", name);
  return OPC_OK;
}

static int keep_table(void *data, const char *name, uint32_t flags, size_t rows,
                      const opc_column *columns, size_t n, opc_error *error) {
  (void)data, (void)flags, (void)error;
  g_string_append_printf(told, "%s[%zu]", name, rows);
  if (!strcmp(name, "history"))
    for (size_t i = 0; i < n; i++)
      g_string_append_printf(told, ",%s", columns[i].name);
  g_string_append_c(told, ' ');
  return OPC_OK;
}

/* Without transistors, nothing is said of their performance. */
static void test_report(void) {
  const opc_sink sink = {.table = keep_table, .metric = keep_metric};
  opc_host *listener = opc_host_new(&sink);
  opc_loop l;
  opc_error error = {0};
  own.spoil = NULL;
  told = g_string_new(NULL);
  g_assert_cmpint(run(&l, &cutter, NULL, &error), ==, OPC_OK);
  const opc_mask mask = {.size = sizeof mask, .gates = &metal,
                         .iterations = l.iterations,
                         .simulations = l.printer.simulations};
  const opc_report report = {.mask = &mask, .sites = l.sites,
                             .extension = l.measured.extension,
                             .biases = &l.now.biases,
                             .synthesizer = l.synthesizer};
  g_assert_cmpint(opc_report_mask(listener, &report, &error), ==, OPC_OK);
  g_assert_cmpstr(told->str, ==,
                  "gates[0] effort[1] transistors epe_mean epe_max epe_lost "
                  "iterations simulations failed ");
  g_string_truncate(told, 0);
  g_assert_cmpint(opc_history_table(l.history, listener, &error), ==, OPC_OK);
  g_autofree char *want =
      g_strdup_printf("history[%u],iteration,epe_mean,epe_max,simulations ",
                      l.printer.simulations - 1);
  g_assert_cmpstr(told->str, ==, want);
  g_string_free(told, TRUE);
  opc_loop_clear(&l);
  opc_host_free(listener);
}

/* ---- sites ---- */

/* A field that is positive for |x - 500| < half, in either direction. */
static opc_field strip(double half, int axis) {
  opc_field f = {.frame = {0, 0, 1000, 1000}, .nx = 40, .ny = 40};
  f.coefficients = host->alloc(host, 1600, sizeof(float));
  for (int j = 0; j < 40; j++)
    for (int i = 0; i < 40; i++)
      f.coefficients[40 * j + i] =
          (float)(-cos(2 * M_PI * half / 1000) -
                  cos(M_PI * (axis == OPC_X ? i : j) / 20) /
                      opc_spline_sampled(1.0 / 40));
  return f;
}

/* Two edges of a box, one to the low and one to the high side. */
static void test_sites(void) {
  const struct {
    double half;      /* of the print; the drawn edges are at 500 -+ 100 */
    double site[2];   /* where the sites of the low and high edge are */
    double epe[2];
  } cases[] = {
      {130, {400, 600}, {30, 30}},
      {90, {400, 600}, {-10, -10}},
      {199, {400, 600}, {99, 99}},
      {201, {400, 600}, {NAN, NAN}},
      /* Just outside of the print, whose edge is near; far inside. */
      {103, {360, 640}, {-37, -37}},
      {103, {460, 560}, {63, 43}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int axis = 0; axis < 2; axis++) {
      opc_field f = strip(cases[i].half, axis);
      const opc_point box[] = {{400, 450}, {600, 450}, {600, 550}, {400, 550}};
      const opc_point turned[] = {{450, 400}, {550, 400}, {550, 600}, {450, 600}};
      const double low = cases[i].site[0], high = cases[i].site[1];
      const double x[] = {500, 450, high, 500, 500, 550, low, 500};
      const double y[] = {500, low, 550, 500, 500, high, 450, 500};
      uint32_t start[] = {0, 4};
      const opc_cuts cuts = {.size = sizeof cuts,
                             .polygons = 1,
                             .start = start,
                             .from = axis == OPC_X ? box : turned,
                             .site = axis == OPC_X ? x : y};
      opc_sites s;
      g_assert_true(opc_sites_make(host, &cuts, &s));
      opc_sites_measure(host, &s, &f);
      for (int side = 0; side < 2; side++) {
        int k = axis == OPC_X ? (side ? 1 : 3) : (side ? 2 : 0);
        double want = cases[i].epe[side], got = s.epe[k];
        if (isnan(want)) g_assert_true(isnan(got));
        else g_assert_cmpfloat(fabs(got - want), <, 0.02);
      }
      opc_sites_clear(host, &s);
      host->free(host, f.coefficients);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_host_new(NULL);
  g_test_add_func("/loop/fragments", test_fragments);
  g_test_add_func("/loop/patches", test_patches);
  g_test_add_func("/loop/bites", test_bites);
  g_test_add_func("/loop/assists", test_assists);
  g_test_add_func("/loop/faults", test_faults);
  g_test_add_func("/loop/report", test_report);
  g_test_add_func("/loop/sites", test_sites);
  int code = g_test_run();
  opc_host_free(host);
  return code;
}
