/* SPDX-License-Identifier: BSD-3-Clause */
/* Measurements, compared with contours known in closed form. */
#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <string.h>

/* ---- measurements ---- */

static const double period = 1000;

/* Return the level a + b cos(kx) + c cos(ky), k = 2 pi / period, centred on (0,
   0). */
static eda_field level(double a, double b, double c) {
  eda_field f = {.frame = {0, 0, period, period}, .nx = 40, .ny = 40};
  f.coefficients = eda_alloc(1600, sizeof(float));
  for (int j = 0; j < 40; j++)
    for (int i = 0; i < 40; i++)
      f.coefficients[40 * j + i] =
          (float)(a + b * cos(M_PI * i / 20) + c * cos(M_PI * j / 20));
  eda_field_from_samples(NULL, &f);
  return f;
}

static double wave(double x) { return cos(2 * M_PI * x / period); }

/* An extractor that records its input. */
enum { SLICES = 5 };
static const double place[SLICES] = {0.05, 0.25, 0.5, 0.8, 1};
static const double share[SLICES] = {0.1, 0.3, 0.2, 0.3, 0.1};
static int beyond_table; /* 1: the extractor returns figures beyond the table */
static double seen_length[SLICES], seen_width[SLICES], seen_edge[SLICES];

static size_t slicing(const void *self, const double **p, const double **s) {
  (void)self;
  *p = place;
  *s = share;
  return SLICES;
}

static int slices_keep(const void *self, const eda_slices *in,
                       eda_performance *out, opc_error *error) {
  (void)self;
  (void)error;
  for (int i = 0; i < SLICES; i++) {
    seen_length[i] = in->length[i];
    seen_width[i] = in->width[i];
    seen_edge[i] = in->edge[i];
  }
  for (int k = 0; k < 6; k++) (&out->ion)[k][0] = 1;
  if (beyond_table) out->outside[0] = 1;
  return OPC_OK;
}

static const eda_extractor keeper = {.slicing = slicing,
                                     .extract = slices_keep};

typedef struct result {
  uint32_t flags;
  double extension[2];
  double figure[6];
  uint8_t outside;
} result;

/* Return `count` gates without names and instances, grid 1 nm. The arrays
   belong to the caller. */
static eda_gates gates_of(size_t count, eda_box *box, uint8_t *type,
                          uint8_t *axis, double *length, double *width,
                          double *space, double *extension) {
  return (eda_gates){.grid = 1,
                     .layers = 2,
                     .count = count,
                     .box = box,
                     .type = type,
                     .axis = axis,
                     .length = length,
                     .width = width,
                     .space = space,
                     .extension = extension};
}

/* Measure a gate of L 60 and W 300 around (0, 0), vertical or horizontal. */
static result gate_measure(eda_field poly, eda_field active, uint8_t axis,
                           double space, double extension) {
  eda_box box = axis == EDA_X ? (eda_box){-30, -150, 30, 150}
                              : (eda_box){-150, -30, 150, 30};
  uint8_t type = EDA_NMOS;
  double length = 60, width = 300;
  double both_spaces[2] = {space, space}, both[2] = {extension, INFINITY};
  eda_gates gates =
      gates_of(1, &box, &type, &axis, &length, &width, both_spaces, both);
  eda_field print[] = {poly, active};
  const opc_module module = {&keeper, NULL, "extractor.keeper"};
  result r = {.outside = 1}; /* start with the result of another image */
  double *figure = r.figure;
  eda_measurement out = {&r.flags,
                         r.extension,
                         {1, &figure[0], &figure[1], &figure[2], &figure[3],
                          &figure[4], &figure[5], &r.outside}};
  opc_error error;
  g_assert_cmpint(eda_measure(NULL, &gates, print, &module, &out, &error), ==,
                  OPC_OK);
  for (int layer = 0; layer < 2; layer++) eda_field_clear(&print[layer]);
  return r;
}

/* Poly whose length depends on the position along W, and an active of 290 nm.
   Both orientations yield equal results. */
static void test_slices(void) {
  const double a = -0.97, taper = 0.01, half = 145;
  for (int across = 0; across < 2; across++) {
    uint8_t axis = across ? EDA_Y : EDA_X;
    eda_field poly = level(a, across ? taper : 1, across ? 1 : taper);
    eda_field active = level(-wave(half), across, !across);
    result r = gate_measure(poly, active, axis, 400, INFINITY);
    g_assert_cmpuint(r.flags, ==, 0);
    for (int i = 0; i < SLICES; i++) {
      double y = half * (2 * place[i] - 1);
      double want = period / M_PI * acos(-a - taper * wave(y));
      g_assert_cmpfloat(fabs(seen_length[i] - want), <, 1e-3);
      g_assert_cmpfloat(fabs(seen_width[i] - 2 * half * share[i]), <, 1e-3);
      g_assert_cmpfloat(
          fabs(seen_edge[i] - 2 * half * fmin(place[i], 1 - place[i])), <,
          1e-3);
    }
    g_assert_true(isinf(r.extension[0]) && isinf(r.extension[1]));
  }
}

/* Poly that ends at y = -199 (the level varies along y only). */
static void test_extension(void) {
  eda_field poly = level(-wave(199), 0, 1), active = level(-wave(145), 0, 1);
  result r = gate_measure(poly, active, EDA_X, 400, 84);
  g_assert_cmpfloat(fabs(r.extension[0] - 54), <, 1e-3);
  g_assert_true(isinf(r.extension[1]));
  g_assert_true(r.flags & EDA_PRINT_MERGED); /* there is no edge along x */
  /* The poly ends 20 nm inside the active. */
  r = gate_measure(level(-wave(125), 0, 1), level(-wave(145), 0, 1), EDA_X, 400,
                   84);
  g_assert_cmpfloat(fabs(r.extension[0] + 20), <, 1e-3);
  g_assert_true(r.flags & EDA_PRINT_SHORT);
  g_assert_true(r.flags & EDA_PRINT_OPEN); /* the outer slices are open */
}

/* Figures beyond the device table are flagged. All figures of an open gate are
   0, even if the extractor returns other values. */
static void test_figures(void) {
  for (beyond_table = 0; beyond_table < 2; beyond_table++) {
    uint32_t mark = beyond_table ? EDA_PRINT_OUTSIDE : 0;
    result r = gate_measure(level(-wave(30), 1, 0), level(-wave(145), 0, 1),
                            EDA_X, 400, 84);
    g_assert_cmpuint(r.flags & EDA_PRINT_OUTSIDE, ==, mark);
    g_assert_cmpuint(r.outside, ==, beyond_table);
    g_assert_cmpuint(r.flags & ~(uint32_t)EDA_PRINT_NOTES, ==, 0);
    for (int k = 0; k < 6; k++) g_assert_cmpfloat(r.figure[k], ==, 1);
    const result none[] = {
        gate_measure(level(-2, 1, 0), level(-wave(145), 0, 1), EDA_X, 400, 84),
        gate_measure(level(-wave(30), 1, 0), level(-2, 0, 1), EDA_X, 400, 84)};
    for (int i = 0; i < 2; i++) {
      g_assert_cmpuint(none[i].flags & EDA_PRINT_OUTSIDE, ==, 0);
      g_assert_cmpuint(none[i].outside, ==, 0);
      for (int k = 0; k < 6; k++) g_assert_cmpfloat(none[i].figure[k], ==, 0);
    }
  }
  beyond_table = 0;
}

static void test_trouble(void) {
  /* The middle does not print. */
  result r =
      gate_measure(level(-2, 1, 0), level(-wave(145), 0, 1), EDA_X, 400, 84);
  g_assert_true(r.flags & EDA_PRINT_OPEN);
  r = gate_measure(level(-wave(30), 1, 0), level(-2, 0, 1), EDA_X, 400, 84);
  g_assert_true(r.flags & EDA_PRINT_NO_ACTIVE);
  /* The length exceeds half the space: 30 + 50 is less than 81 and more than
     79. */
  r = gate_measure(level(-wave(81), 1, 0), level(-wave(145), 0, 1), EDA_X, 100,
                   84);
  g_assert_true(r.flags & EDA_PRINT_MERGED);
  r = gate_measure(level(-wave(79), 1, 0), level(-wave(145), 0, 1), EDA_X, 100,
                   84);
  g_assert_false(r.flags & EDA_PRINT_MERGED);
}

/* An extractor with the figure (k + 1) W for figure k. */
static int widths_extract(const void *self, const eda_slices *in,
                          eda_performance *out, opc_error *error) {
  (void)self, (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double width = 0;
    for (size_t s = 0; s < SLICES; s++) width += in->width[SLICES * i + s];
    for (int k = 0; k < 6; k++) (&out->ion)[k][i] = (k + 1) * width;
    out->outside[i] = i % 2;
  }
  return OPC_OK;
}

/* Gates are measured in blocks, and each has its own figures. */
static void test_blocks(void) {
  enum { GATES = 150 };
  static const eda_extractor functions = {.slicing = slicing,
                                          .extract = widths_extract};
  const opc_module module = {&functions, NULL, "extractor.widths"};
  static eda_box box[GATES];
  static uint8_t type[GATES], axis[GATES];
  static double length[GATES], width[GATES], beside[2 * GATES];
  eda_gates gates =
      gates_of(GATES, box, type, axis, length, width, beside, beside);
  eda_performance out;
  opc_error error;
  for (int i = 0; i < GATES; i++) {
    box[i] = (eda_box){200 * i, 0, 200 * i + 60, 300 + i};
    axis[i] = EDA_X;
    length[i] = 60;
    width[i] = 300 + i;
    beside[2 * i] = beside[2 * i + 1] = 140;
  }
  eda_performance_init(&out, GATES);
  g_assert_cmpint(eda_measure_drawn(NULL, &gates, &module, &out, &error), ==,
                  OPC_OK);
  for (int i = 0; i < GATES; i++) {
    for (int k = 0; k < 6; k++)
      g_assert_cmpfloat(fabs((&out.ion)[k][i] - (k + 1) * width[i]), <, 1e-9);
    g_assert_cmpuint(out.outside[i], ==, i % 2);
  }
  eda_performance_clear(&out);
}

/* An extractor whose device model begins above the length of the outer
   slices. */
static double modelled_from(const void *self, int type, const char *flavour) {
  (void)self;
  g_assert_cmpint(type, ==, EDA_NMOS);
  g_assert_null(flavour);
  return 66.5;
}

/* Slices of two gates with equal contours; the second gate represents three
   transistors. The lengths are known in closed form. */
static void test_short_slices(void) {
  const double a = -wave(30), taper = 0.005, half = 145;
  static const eda_extractor functions = {
      .slicing = slicing, .extract = widths_extract, .modelled = modelled_from};
  const opc_module module = {&functions, NULL, "extractor.widths"};
  const eda_box box = {-30, -150, 30, 150};
  eda_box boxes[] = {box, box};
  uint8_t type[2] = {EDA_NMOS, EDA_NMOS}, axis[2] = {EDA_X, EDA_X};
  double length[] = {60, 60}, width[] = {300, 300};
  double beside[] = {400, 400, 400, 400};
  eda_gates gates =
      gates_of(2, boxes, type, axis, length, width, beside, beside);
  eda_field print[] = {level(a, 1, taper), level(-wave(half), 0, 1)};
  const uint32_t count[] = {1, 3};
  eda_measurement out;
  opc_error error;
  eda_measurement_init(&out, 2);
  eda_short_slices sum = {0};
  g_assert_cmpint(eda_measure_short(NULL, &gates, print, &module, count, &out,
                                    &sum, &error),
                  ==, OPC_OK);
  double shortest = INFINITY, below = 0;
  for (int i = 0; i < SLICES; i++) {
    double y = half * (2 * place[i] - 1);
    double l = period / M_PI * acos(-a - taper * wave(y));
    shortest = fmin(shortest, l);
    below += l < 66.5;
  }
  g_assert_true(below > 0 && below < SLICES);
  g_assert_cmpfloat(sum.slices, ==, 4 * SLICES);
  g_assert_cmpfloat(sum.below, ==, 4 * below);
  g_assert_cmpfloat(sum.gates, ==, 4);
  g_assert_cmpfloat(fabs(sum.shortest - shortest), <, 1e-3);
  g_assert_cmpfloat(sum.modelled, ==, 66.5);
  char text[400];
  eda_short_slices_text(&sum, text, sizeof text);
  g_assert_nonnull(strstr(text, "in 4 transistors, are shorter"));
  sum.gates = 0;
  eda_short_slices_text(&sum, text, sizeof text);
  g_assert_cmpstr(text, ==, "");
  eda_measurement_clear(&out);
  for (int k = 0; k < 2; k++) eda_field_clear(&print[k]);
}

/* Printed edges at -30 and 30 nm, and an image 2 + cos(k (x - 20)). */
static void test_section(void) {
  for (int across = 0; across < 2; across++)
    for (int layer = 0; layer < 2; layer++) {
      int along_x = across == layer; /* the direction of the section */
      eda_box box = along_x ? (eda_box){-30, -150, 40, 150}
                            : (eda_box){-150, -30, 150, 40};
      uint8_t axis = across ? EDA_Y : EDA_X;
      double size[2] = {70, 500}, beside[2] = {200, 200};
      eda_gates gates = {.grid = 1,
                         .layers = 2,
                         .count = 1,
                         .box = &box,
                         .axis = &axis,
                         .length = &size[layer],
                         .width = &size[!layer],
                         .space = beside};
      eda_field print = level(-wave(30), along_x, !along_x);
      eda_field image = level(2, along_x, !along_x);
      image.frame.x0 = image.frame.y0 = 20;
      eda_section s = eda_gate_section(&gates, 0, layer, &print, &image);
      double k = 2 * M_PI / period;
      g_assert_cmpfloat(fabs(s.length - 60), <, 1e-3);
      g_assert_cmpfloat(fabs(s.low - k * sin(k * 50) / (2 + cos(k * 50))), <,
                        1e-6);
      g_assert_cmpfloat(fabs(s.high - k * sin(k * 10) / (2 + cos(k * 10))), <,
                        1e-6);
      /* The search for the edges of poly ends at half the space of 200 nm
         beyond the box: at -30 - 100 = -130 nm and 40 + 100 = 140 nm. */
      for (int less = 0; less < 2; less++) {
        eda_field wide = level(-wave(129 + 2 * less), along_x, !along_x);
        s = eda_gate_section(&gates, 0, layer, &wide, &image);
        g_assert_true(isnan(s.length) == (less && layer == EDA_POLY));
        eda_field_clear(&wide);
      }
      eda_field none = level(-2, along_x, !along_x);
      s = eda_gate_section(&gates, 0, layer, &none, &image);
      g_assert_true(isnan(s.length) && isnan(s.low) && isnan(s.high));
      eda_field_clear(&none);
      eda_field_clear(&print);
      eda_field_clear(&image);
    }
}

/* Statistics of gates with counts equal those of a list that repeats each gate
   as often as its count. */
static void test_spread(void) {
  enum { GATES = 6 };
  static uint8_t type[GATES] = {EDA_NMOS, EDA_NMOS, EDA_PMOS,
                                EDA_PMOS, EDA_NMOS, EDA_PMOS};
  static const uint32_t count[GATES] = {1, 3, 2, 1, 4, 0};
  static const uint32_t flags[GATES] = {0, EDA_PRINT_OUTSIDE, 0,
                                        0, EDA_PRINT_OPEN,    0};
  static const double off[GATES] = {1, -2, 3, -7, 50, 60};
  const eda_gates gates = {.count = GATES, .type = type};
  eda_performance drawn, printed;
  eda_performance_init(&drawn, GATES);
  eda_performance_init(&printed, GATES);
  double n[3] = {0}, mean[3] = {0}, square[3] = {0}, leak[3] = {0},
         all[3] = {0};
  for (int i = 0; i < GATES; i++) {
    drawn.ion[i] = 1e-4 * (i + 1);
    printed.ion[i] = drawn.ion[i] * (1 + off[i] / 100);
    drawn.ioff[i] = 1e-9 * (i + 1);
    printed.ioff[i] = 1e-9 * (i + 2);
    for (uint32_t k = 0; i != 4 && k < count[i]; k++)
      for (int t = type[i]; t <= 2; t += 2 - type[i]) {
        n[t]++, mean[t] += off[i];
        leak[t] += i + 2, all[t] += i + 1;
      }
  }
  for (int t = 0; t < 3; t++) mean[t] /= n[t];
  for (int i = 0; i < 4; i++)
    for (int t = type[i]; t <= 2; t += 2 - type[i])
      square[t] += count[i] * pow(off[i] - mean[t], 2);
  eda_spread_sums sums = {0};
  eda_spread_add(&sums, &gates, count, &drawn, &printed, flags);
  eda_spread s = eda_spread_end(&sums);
  for (int t = 0; t < 3; t++) {
    g_assert_cmpfloat(fabs(s.ion_mean[t] - mean[t]), <, 1e-9);
    g_assert_cmpfloat(fabs(s.ion_sd[t] - sqrt(square[t] / n[t])), <, 1e-9);
    g_assert_cmpfloat(fabs(s.leakage[t] - leak[t] / all[t]), <, 1e-9);
  }
  g_assert_cmpfloat(fabs(s.ion_worst + 7), <, 1e-9);
  g_assert_cmpuint(s.failed, ==, 4);
  g_assert_cmpuint(s.outside, ==, 3);
  static const uint32_t open[GATES] = {EDA_PRINT_OPEN, EDA_PRINT_OPEN,
                                       EDA_PRINT_OPEN, EDA_PRINT_OPEN,
                                       EDA_PRINT_OPEN, EDA_PRINT_OPEN};
  s = eda_spread_of(&gates, &drawn, &printed, open);
  g_assert_true(isnan(s.ion_worst) && isnan(s.ion_mean[2]) &&
                isnan(s.ion_sd[0]) && isnan(s.leakage[1]));
  g_assert_cmpuint(s.failed, ==, GATES);
  eda_performance_clear(&drawn);
  eda_performance_clear(&printed);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/measure/slices", test_slices);
  g_test_add_func("/measure/extension", test_extension);
  g_test_add_func("/measure/figures", test_figures);
  g_test_add_func("/measure/trouble", test_trouble);
  g_test_add_func("/measure/blocks", test_blocks);
  g_test_add_func("/measure/short-slices", test_short_slices);
  g_test_add_func("/measure/section", test_section);
  g_test_add_func("/measure/spread", test_spread);
  return g_test_run();
}
