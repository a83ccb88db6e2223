/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests extractors, resists, litho models and regulators in Python: data as the
   plugin receives them, and results as the caller receives them. */
#include "py_test.h"

#include <eda/memory.h>

static const char extractor[] =
    "class Formula(Extractor):\n"
    "    \"\"\"Current in proportion to W / L\"\"\"\n"
    "    slices = integer('slices', preset=3)\n"
    "    def slicing(self):\n"
    "        n = self.slices\n"
    "        return (np.arange(n) + 0.5) / n, np.full(n, 1 / n)\n"
    "    def extract(self, s, out):\n"
    "        out.ion[:] = (s.width / s.length).sum(axis=1) * (1 + s.type)\n"
    "        out.ioff[:] = s.edge[:, 1]\n"
    "        out.leq_ion[:], out.leq_ioff[:] = s.length[:, 0], s.length[:, 2]\n"
    "        out.weq[:] = s.width.sum(axis=1)\n"
    "        out.area[:] = 7\n"
    "        out.outside[:] = 1\n";

static void test_extractor(void) {
  if (is_skipped()) return;
  write_plugin("extractor.formula", extractor);
  g_autoptr(opc_module) m = make("extractor.formula", "{}");
  const eda_extractor *e = m->functions;
  opc_error error = {0};
  const double *place, *share;
  g_assert_cmpint(e->prepare(m->self, &error), ==, OPC_OK);
  g_assert_cmpint(e->slicing(m->self, &place, &share), ==, 3);
  g_assert_true(place[1] == 0.5 && share[2] == 1 / 3.0);
  const uint8_t type[] = {EDA_NMOS, EDA_PMOS};
  const double width[] = {100, 100, 100, 200, 200, 250};
  const double length[] = {50, 64, 80, 32, 40, 100};
  const double edge[] = {1, 2, 3, 4, 5, 6};
  const eda_slices in = {.count = 2,
                         .slices = 3,
                         .type = type,
                         .width = width,
                         .length = length,
                         .edge = edge};
  eda_performance out;
  eda_performance_init(&out, 2);
  g_assert_cmpint(e->extract(m->self, &in, &out, &error), ==, OPC_OK);
  g_assert_true(out.ion[0] == 100 / 50.0 + 100 / 64.0 + 100 / 80.0);
  g_assert_true(out.ion[1] == 2 * (200 / 32.0 + 200 / 40.0 + 250 / 100.0));
  g_assert_true(out.ioff[0] == 2 && out.ioff[1] == 5);
  g_assert_true(out.leq_ion[1] == 32 && out.leq_ioff[1] == 100);
  g_assert_true(out.weq[1] == 650 && out.area[0] == 7 && out.outside[1] == 1);
  /* Slices have two dimensions, even if a gate has one slice. */
  const eda_slices one = {.count = 2,
                          .slices = 1,
                          .type = type,
                          .width = width,
                          .length = length,
                          .edge = edge};
  g_assert_cmpint(e->extract(m->self, &one, &out, &error), ==, OPC_FAILED);
  g_assert_nonnull(
      strstr(error.message, "index 1 is out of bounds for axis 1"));
  eda_performance_clear(&out);
}

static const char sums[] =
    "class Sums(Extractor):\n"
    "    \"\"\"Sums of two slices\"\"\"\n"
    "    keep = boolean('keep the arrays', preset=False)\n"
    "    kept = None\n"
    "    def slicing(self): return [0.25, 0.75], [0.5, 0.5]\n"
    "    def extract(self, s, out):\n"
    "        if self.keep and self.kept is None:\n"
    "            self.kept = s.width, s.width.copy(), out.ion\n"
    "        if self.kept and self.keep:\n"
    "            assert (self.kept[0] == self.kept[1]).all()\n"
    "            assert self.kept[2][0] in (0, 3)\n"
    "        assert not s.width.flags.writeable\n"
    "        with open('/proc/self/maps') as f: files = f.read()\n"
    "        assert files.count('opcflow-block') == 7 or self.keep\n"
    "        out.ion[:2] = s.width[:2].sum(axis=1)\n"
    "        out.area[-1] = s.edge[-1, 1]\n";

enum { MANY = 200000 };

/* Large arrays of eda_alloc_shared are not copied. Arrays that the plugin keeps
   retain their values; freed arrays are not mapped any more. */
static void shared_extract(const char *parameters, int calls) {
  g_autoptr(opc_module) m = make("extractor.sums", parameters);
  const eda_extractor *e = m->functions;
  opc_error error = {0};
  const uint8_t *type = eda_alloc_shared(MANY, 1);
  g_assert_cmpint(e->prepare(m->self, &error), ==, OPC_OK);
  for (int i = 0; i < calls; i++) {
    double *data = eda_alloc_shared(6 * (size_t)MANY, sizeof *data);
    eda_performance out;
    eda_performance_init(&out, MANY);
    const eda_slices in = {.count = MANY,
                           .slices = 2,
                           .type = type,
                           .width = data,
                           .length = data + 2 * (size_t)MANY,
                           .edge = data + 4 * (size_t)MANY};
    for (int k = 1; k < 4; k++) {
      data[0] = k, data[1] = 2, data[6 * (size_t)MANY - 1] = 10 * i + k;
      if (e->extract(m->self, &in, &out, &error))
        g_assert_cmpstr(error.message, ==, "");
      g_assert_true(out.ion[0] == k + 2 && out.area[MANY - 1] == 10 * i + k);
    }
    eda_performance_clear(&out);
    eda_free(data);
  }
  eda_free((void *)type);
}

static void test_shared(void) {
  if (is_skipped()) return;
  write_plugin("extractor.sums", sums);
  shared_extract("{}", 3);
  shared_extract("{ keep: true }", 3);
}

static const char resist[] =
    "class Level(Resist):\n"
    "    \"\"\"A threshold that depends on the layer\"\"\"\n"
    "    threshold = real('threshold', preset='0.25')\n"
    "    def prepare(self, scanner): self.na = scanner.na\n"
    "    def level(self, layer, image):\n"
    "        assert image.values.shape == (6, 8) and image.frame[2] == 800\n"
    "        return self.threshold * (1 + layer) - image.values\n";

/* A linear resist acts on values as on coefficients. */
static void test_resist(void) {
  if (is_skipped()) return;
  write_plugin("resist.level", resist);
  g_autoptr(opc_module) m = make("resist.level", "{}");
  const eda_resist *r = m->functions;
  opc_error error = {0};
  eda_field field = {{0, 0, 800, 600}, 8, 6, eda_alloc(48, sizeof(float))};
  for (int i = 0; i < 48; i++)
    field.coefficients[i] = (float)(i * 37 % 48) / 48;
  g_assert_cmpint(r->prepare(m->self, NULL, &error), ==, OPC_OK);
  g_assert_cmpint(r->print(m->self, 1, &field, &error), ==, OPC_OK);
  for (int i = 0; i < 48; i++)
    g_assert_cmpfloat_with_epsilon(field.coefficients[i],
                                   0.5 - (i * 37 % 48) / 48.0, 2e-6);
  eda_field_clear(&field);
}

static const char litho[] =
    "class Shifted(Litho):\n"
    "    \"\"\"A Gaussian, displaced by a phase\"\"\"\n"
    "    focuses = True\n"
    "    blur = real('blur', unit='nm', preset='40 nm')\n"
    "    def band(self): return 0.6 / self.blur\n"
    "    def scanner(self): return 193, 0.75\n"
    "    def image(self, layer, mask, defocus):\n"
    "        assert layer == EDGE and mask.band == self.band()\n"
    "        return mask.coherent(lambda fx, fy: np.exp(\n"
    "            -2 * (np.pi * self.blur) ** 2 * (fx ** 2 + fy ** 2)\n"
    "            + 2j * np.pi * ((30 + defocus) * fx + 70 * fy)))\n"
    "EDGE = 1\n";

/* The kernel of the plugin above. */
static void shifted_transfer(const void *self, size_t s, const double *fx,
                             double fy, size_t n, float *out) {
  const double turn = 2 * acos(-1), *dx = self;
  (void)s;
  for (size_t i = 0; i < n; i++) {
    double size = exp(-pow(turn * 40 * hypot(fx[i], fy), 2) / 2);
    double phase = turn * (*dx * fx[i] + 70 * fy);
    out[2 * i] = (float)(size * cos(phase));
    out[2 * i + 1] = (float)(size * sin(phase));
  }
}

static double field_difference(const eda_field *a, const eda_field *b) {
  enum { PLACES = 500 };
  double x[PLACES], y[PLACES], first[PLACES], second[PLACES], most = 0;
  for (int i = 0; i < PLACES; i++) {
    x[i] = a->frame.x0 + a->frame.width * i / PLACES;
    y[i] = a->frame.y0 + a->frame.height * (i * 7 % PLACES) / PLACES;
  }
  eda_field_sample(a, x, y, PLACES, first);
  eda_field_sample(b, x, y, PLACES, second);
  for (int i = 0; i < PLACES; i++)
    most = fmax(most, fabs(first[i] - second[i]));
  return most;
}

/* The image equals that of eda_coherent_sum with the same kernel. */
static void test_litho(void) {
  if (is_skipped()) return;
  write_plugin("litho.shifted", litho);
  g_autoptr(opc_module) m = make("litho.shifted", "{}");
  const eda_litho *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  opc_error error = {0};
  const eda_frame frame = {-700, -350, 1900, 1500};
  g_assert_true(o->band(m->self) == 0);
  g_assert_true(o->scanner(m->self).na == 0.75);
  g_assert_cmpint(o->prepare(m->self, &error), ==, OPC_OK);
  double band = o->band(m->self), dx;
  g_assert_true(band == 0.6 / 40);
  eda_kernels kernels = {.count = 1,
                         .weight = &(double){1},
                         .band = band,
                         .intensity_band = 2 * band,
                         .transfer = shifted_transfer,
                         .self = &dx,
                         .scale = {1, 0}};
  eda_spectrum mask;
  g_assert_cmpint(eda_mask_spectrum(NULL, &g->drawn[EDA_POLY], g->grid, frame,
                                    band, &mask, &error),
                  ==, OPC_OK);
  for (dx = 30; dx < 200; dx += 100) {
    eda_field own = {0}, truth = {0};
    int code = dx == 30 ? o->image(m->self, 1, &mask, &own, &error)
                        : o->image_at(m->self, 1, &mask, dx - 30, &own, &error);
    g_assert_cmpstr(error.message, ==, "");
    g_assert_cmpint(code, ==, OPC_OK);
    g_assert_cmpint(eda_coherent_sum(NULL, &mask, &kernels, 0, &truth, &error),
                    ==, OPC_OK);
    g_assert_cmpfloat(field_difference(&own, &truth), <, 2e-4);
    eda_field_clear(&own);
    eda_field_clear(&truth);
  }
  g_assert_cmpint(o->image(m->self, 0, &mask, &(eda_field){0}, &error), ==,
                  OPC_FAILED);
  eda_spectrum_clear(&mask);
}

static const char regulator[] =
    "class Rules(Regulator):\n"
    "    \"\"\"Rules\"\"\"\n"
    "    def rule(self, p, r):\n"
    "        assert p.iteration == 7 and p.l.tolist() == [3, -2]\n"
    "        assert p.want_head is None and p.gates.cell[0]\n"
    "        assert len(p.shapes) == len(p.gates.layers)\n"
    "        assert np.array_equal(p.shapes[POLY].points,\n"
    "                              p.gates.drawn[POLY].points)\n"
    "        r.vetoes[1] |= VETO_LONGER\n"
    "        r.end += (p.extension < 50).astype(np.int32)\n"
    "        r.transistors = int((p.flags == 0).sum())\n"
    "        r.added[1] = [[1, 2, 3, 4], [5, 6, 7, 8]]\n"
    "        r.cutouts[0] = np.array([[10, 20, 30, 40]])\n"
    "    def violations(self, p):\n"
    "        level = p.print[1]\n"
    "        assert level.frame.tolist() == [0, 0, 800, 600]\n"
    "        y, x = np.unravel_index(level.values.argmax(), "
    "level.values.shape)\n"
    "        return [('peak', -1, x, y, level.values.max(), 2.5),\n"
    "                ('other', 1, 0, 0, 1, 2)]\n";

static void test_regulator(void) {
  if (is_skipped()) return;
  write_plugin("regulator.rules", regulator);
  g_autoptr(opc_module) m = make("regulator.rules", "{}");
  const eda_regulator *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  const uint32_t flags[] = {0, EDA_PRINT_MERGED};
  const int32_t l[] = {3, -2}, w[] = {0, 1};
  const double extension[] = {60, INFINITY, INFINITY, -5};
  uint32_t vetoes[] = {0, EDA_VETO_WIDER};
  int32_t end[] = {0, 1, 2, 3};
  g_autofree eda_field *print = g_new0(eda_field, g->layers);
  g_autofree eda_boxes *boxes = g_new0(eda_boxes, 2 * g->layers);
  for (size_t k = 0; k < g->layers; k++)
    print[k] = (eda_field){{0, 0, 800, 600}, 8, 6, eda_alloc(48, 4)};
  print[1].coefficients[2 * 8 + 5] = 1;
  const eda_printed p = {.iteration = 7,
                         .gates = g,
                         .flags = flags,
                         .l = l,
                         .w = w,
                         .extension = extension,
                         .shapes = g->drawn,
                         .print = print};
  eda_ruling r = {.vetoes = vetoes,
                  .end = end,
                  .added = boxes,
                  .cutouts = boxes + g->layers};
  opc_error error = {0};
  eda_violation list[2];
  size_t count = 0;
  if (o->rule(m->self, &p, &r, &error)) g_assert_cmpstr(error.message, ==, "");
  g_assert_true(vetoes[0] == 0 &&
                vetoes[1] == (EDA_VETO_WIDER | EDA_VETO_LONGER));
  g_assert_true(end[0] == 0 && end[1] == 1 && end[2] == 2 && end[3] == 4);
  g_assert_cmpint(r.transistors, ==, 1);
  g_assert_true(boxes[1].count == 2 && boxes[1].box[1].x1 == 7);
  g_assert_true(r.cutouts[0].count == 1 && r.cutouts[0].box->y1 == 40);
  g_assert_true(!boxes[0].count && !r.cutouts[1].count);
  if (o->violations(m->self, &p, list, 1, &count, &error))
    g_assert_cmpstr(error.message, ==, "");
  g_assert_cmpint(count, ==, 2);
  g_assert_cmpstr(list[0].rule, ==, "peak");
  g_assert_true(list[0].gate == -1 && list[0].x == 5 && list[0].y == 2 &&
                list[0].limit == 2.5);
  double x = 500, y = 200, peak; /* node (5, 2) */
  eda_field_sample(&print[1], &x, &y, 1, &peak);
  g_assert_cmpfloat_with_epsilon(list[0].value, peak, 1e-6);
  for (size_t k = 0; k < g->layers; k++) eda_field_clear(&print[k]);
}

int main(int argc, char **argv) {
  set_up(argc, argv);
  g_test_add_func("/loader.py/kinds/extractor", test_extractor);
  g_test_add_func("/loader.py/kinds/shared", test_shared);
  g_test_add_func("/loader.py/kinds/resist", test_resist);
  g_test_add_func("/loader.py/kinds/litho", test_litho);
  g_test_add_func("/loader.py/kinds/regulator", test_regulator);
  return g_test_run();
}
