/* SPDX-License-Identifier: BSD-3-Clause */
/* Sample data of steps: the sample files equal their source files, and the data
   describe the two transistors that segment.transistors finds. */
#include <eda/gates.h>
#include <opcflow/kind.h>
#include <string.h>

#include "tools/devel/testing.h"

static const opc_kind *kind;

static void *example(const char *name) {
  opc_error error = {0};
  for (size_t i = 0; i < kind->n_examples; i++)
    if (!strcmp(kind->examples[i].kind, name)) {
      const void *object = kind->examples[i].give(&error);
      g_assert_cmpstr(error.message, ==, "");
      g_assert_true(object == kind->examples[i].give(&error));
      return (void *)object;
    }
  return NULL;
}

static void test_samples(void) {
  static const char *const folders[] = {"plugins/kind/step", "data/cells65",
                                        "data/devices", "fuzz/seeds"};
  g_assert_cmpuint(kind->n_samples, >=, 5);
  for (size_t i = 0; i < kind->n_samples; i++) {
    const opc_sample *s = &kind->samples[i];
    g_autofree char *want = NULL;
    gsize size = 0;
    for (size_t k = 0; k < G_N_ELEMENTS(folders) && !want; k++) {
      g_autofree char *path = g_build_filename(g_getenv("OPCFLOW_SOURCE"),
                                               folders[k], s->name, NULL);
      g_file_get_contents(path, &want, &size, NULL);
    }
    g_assert_nonnull(want);
    g_assert_cmpmem(s->bytes, s->size, want, size);
  }
}

/* The layout has the same transistors as the sample gates. */
static void test_layout(void) {
  opc_error error = {0};
  void *layout = example("layout"), *output = NULL;
  g_assert_nonnull(layout);
  g_autoptr(opc_module) m =
      opc_test_module("segment.transistors", "{ grid: 1 nm }", &error);
  g_assert_cmpstr(error.message, ==, "");
  opc_test_input(m, "layout", layout);
  g_assert_cmpint(opc_test_run(m, &output, &error), ==, OPC_OK);
  const eda_gates *found = output, *want = example("gates");
  g_assert_cmpuint(found->count, ==, 2);
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpmem(&found->box[i], sizeof found->box[i], &want->box[i],
                    sizeof want->box[i]);
    g_assert_cmpint(found->type[i], ==, want->type[i]);
    g_assert_cmpfloat(found->length[i], ==, 60);
    g_assert_cmpfloat(found->width[i], ==, i ? 300 : 200);
  }
  opc_test_release(m, &output);
}

/* The mask prints inside its shapes and nowhere else. */
static void test_mask(void) {
  opc_error error = {0};
  const eda_mask *mask = example("mask");
  g_assert_nonnull(mask);
  g_assert_cmpint(eda_mask_check(mask, &error), ==, OPC_OK);
  const double x[] = {30, -150, 30, -150}, y[] = {500, 500, 750, 750};
  double poly[4], active[4];
  eda_field_sample(&mask->print[EDA_POLY], x, y, 4, poly);
  eda_field_sample(&mask->print[EDA_ACTIVE], x, y, 4, active);
  for (int i = 0; i < 4; i++) {
    g_assert_cmpint(poly[i] > 0, ==, i % 2 == 0);
    g_assert_cmpint(active[i] > 0, ==, i >= 2);
  }
  g_assert_cmpint(eda_area2(&mask->shapes[EDA_POLY]), ==, 2 * 60 * 1000);
}

int main(int argc, char **argv) {
  opc_error error = {0};
  g_test_init(&argc, &argv, NULL);
  opc_module *m = opc_test_module("kind.step", "{}", &error);
  g_assert_cmpstr(error.message, ==, "");
  kind = m->functions;
  g_test_add_func("/kind.step/samples", test_samples);
  g_test_add_func("/kind.step/layout", test_layout);
  g_test_add_func("/kind.step/mask", test_mask);
  int failed = g_test_run();
  opc_test_module_free(m);
  return failed;
}
