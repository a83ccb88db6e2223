/* SPDX-License-Identifier: BSD-3-Clause */
/* A mask is saved and loaded: a second file is byte-identical. Truncated files
   and files of other gates are rejected. */
#include <eda/gates.h>
#include <eda/memory.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

static const eda_gates *gates;

static eda_mask *mask_make(void) {
  eda_mask *m = eda_mask_new(gates);
  opc_error error;
  for (size_t k = 0; k < gates->layers; k++) {
    eda_field *f = &m->print[k];
    g_assert_cmpint(
        eda_boolean(EDA_OR, &gates->drawn[k], NULL, &m->shapes[k], &error), ==,
        OPC_OK);
    *f = (eda_field){{-1.5, 2.25, 100, 50 + (double)k}, 5, 3, NULL};
    f->coefficients = eda_alloc(15, sizeof(float));
    for (int i = 0; i < 15; i++) f->coefficients[i] = (float)i / 7;
  }
  eda_performance *all[] = {&m->design, &m->before, &m->after};
  for (size_t k = 0; k < G_N_ELEMENTS(all); k++) {
    eda_performance_init(all[k], gates->count);
    for (size_t i = 0; i < gates->count; i++) {
      all[k]->ion[i] = 1e-4 / (double)(3 + k + i);
      all[k]->ioff[i] = 1e-9 / (double)(3 + k + i);
      all[k]->leq_ion[i] = 60.1 + (double)i;
      all[k]->leq_ioff[i] = 59.9 - (double)i;
      all[k]->weq[i] = 200.3 + (double)k;
      all[k]->area[i] = 12000.7;
      all[k]->outside[i] = i == k;
    }
  }
  m->flags = eda_alloc(gates->count, sizeof *m->flags);
  m->flags[1] = EDA_PRINT_NECK;
  m->iterations = 3;
  m->simulations = 9;
  m->fine_simulations = 2;
  m->drawn_print[1] = eda_field_scaled(&m->print[1], 0.5);
  const eda_violation found[] = {{"extension; drawn so", 1, 2.5, -3, 12, 40},
                                 {"bridging", -1, 0, 0, 1, 2}};
  eda_mask_set_violations(m, found, G_N_ELEMENTS(found));
  return m;
}

static char *read_mask(const char *folder, gsize *n) {
  g_autofree char *path = g_build_filename(folder, "mask", NULL);
  char *text;
  g_assert_true(g_file_get_contents(path, &text, n, NULL));
  return text;
}

static void write_mask(const char *folder, const char *text, gsize n) {
  g_autofree char *path = g_build_filename(folder, "mask", NULL);
  g_assert_true(g_file_set_contents(path, text, (gssize)n, NULL));
}

static void assert_performance(const eda_performance *a,
                               const eda_performance *b) {
  g_assert_cmpmem(a->ion, a->count * 8, b->ion, b->count * 8);
  g_assert_cmpmem(a->ioff, a->count * 8, b->ioff, b->count * 8);
  g_assert_cmpmem(a->leq_ion, a->count * 8, b->leq_ion, b->count * 8);
  g_assert_cmpmem(a->leq_ioff, a->count * 8, b->leq_ioff, b->count * 8);
  g_assert_cmpmem(a->weq, a->count * 8, b->weq, b->count * 8);
  g_assert_cmpmem(a->area, a->count * 8, b->area, b->count * 8);
  g_assert_cmpmem(a->outside, a->count, b->outside, b->count);
}

static void test_equal(void) {
  g_autofree char *folder = g_dir_make_tmp("kept-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "mask", NULL);
  opc_error error;
  eda_mask *a = mask_make();
  void *made = NULL;
  g_assert_cmpint(eda_mask_save(a, folder, &error), ==, OPC_OK);
  g_assert_cmpint(eda_mask_restore(gates, folder, &made, &error), ==, OPC_OK);
  const eda_mask *b = made;
  g_assert_cmpint(eda_mask_check(b, &error), ==, OPC_OK);
  g_assert_true(b->gates == gates);
  for (size_t k = 0; k < gates->layers; k++) {
    const eda_shapes *s = &a->shapes[k], *t = &b->shapes[k];
    g_assert_cmpuint(s->count, ==, t->count);
    if (s->count) {
      size_t n = s->start[s->count];
      g_assert_cmpmem(s->start, (s->count + 1) * 4, t->start,
                      (t->count + 1) * 4);
      g_assert_cmpmem(s->points, n * sizeof *s->points, t->points,
                      n * sizeof *t->points);
      g_assert_true(!s->hole == !t->hole);
      if (s->hole) g_assert_cmpmem(s->hole, s->count, t->hole, t->count);
    }
    g_assert_cmpmem(&a->print[k].frame, sizeof(eda_frame), &b->print[k].frame,
                    sizeof(eda_frame));
    g_assert_cmpint(b->print[k].nx, ==, 5);
    g_assert_cmpint(b->print[k].ny, ==, 3);
    g_assert_cmpmem(a->print[k].coefficients, 60, b->print[k].coefficients, 60);
  }
  assert_performance(&a->design, &b->design);
  assert_performance(&a->before, &b->before);
  assert_performance(&a->after, &b->after);
  g_assert_cmpmem(a->flags, gates->count * 4, b->flags, gates->count * 4);
  g_assert_cmpuint(b->iterations, ==, 3);
  g_assert_cmpuint(b->simulations, ==, 9);
  g_assert_cmpuint(b->fine_simulations, ==, 2);
  g_assert_null(b->drawn_print[0].coefficients);
  g_assert_cmpmem(a->drawn_print[1].coefficients, 60,
                  b->drawn_print[1].coefficients, 60);
  g_assert_cmpuint(b->n_violations, ==, 2);
  g_assert_cmpstr(b->violations[0].rule, ==, "extension; drawn so");
  g_assert_cmpint(b->violations[0].gate, ==, 1);
  g_assert_true(b->violations[0].x == 2.5 && b->violations[0].limit == 40);
  g_assert_cmpint(b->violations[1].gate, ==, -1);
  eda_mask_free(made);
  eda_mask_free(a);
  g_assert_cmpint(g_remove(path), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* Truncated or extended files, and files with absurd counts, are rejected. */
static void test_damaged(void) {
  g_autofree char *folder = g_dir_make_tmp("kept-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "mask", NULL);
  opc_error error;
  eda_mask *a = mask_make();
  gsize n;
  g_assert_cmpint(eda_mask_save(a, folder, &error), ==, OPC_OK);
  eda_mask_free(a);
  g_autofree char *text = read_mask(folder, &n);
  for (gsize k = 0; k < n; k += 1 + k / 16) {
    void *made = NULL;
    write_mask(folder, text, k);
    g_assert_cmpint(eda_mask_restore(gates, folder, &made, &error), ==,
                    OPC_FAILED);
    eda_mask_free(made);
  }
  for (gsize k = 0; k + 8 <= n; k += 4 + k / 64 * 4) {
    void *made = NULL;
    g_autofree char *wild = g_memdup2(text, n);
    memset(wild + k, 0xff, 4);
    write_mask(folder, wild, n);
    int code = eda_mask_restore(gates, folder, &made, &error);
    g_assert_true(code == OPC_OK || code == OPC_FAILED);
    eda_mask_free(made);
  }
  g_assert_cmpint(g_remove(path), ==, 0);
  void *made = NULL;
  g_assert_cmpint(eda_mask_restore(gates, folder, &made, &error), ==, OPC_IO);
  eda_mask_free(made);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  gates = eda_gates_sample();
  g_test_add_func("/kept/equal", test_equal);
  g_test_add_func("/kept/damaged", test_damaged);
  return g_test_run();
}
