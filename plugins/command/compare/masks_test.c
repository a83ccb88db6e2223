/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparisons of synthetic GDSII files of rectangles with known differences. */
#include "masks.h"

#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>

#include "boxes_test.h"

/* Complete the file and return its path (g_free). */
static char *file_end(GByteArray *to, gboolean whole) {
  char *path = NULL;
  g_assert_cmpint(g_file_open_tmp("mask-XXXXXX", &path, NULL), >=, 0);
  record_put(to, EDA_GDS_ENDSTR, EDA_GDS_NOTHING, "", 0);
  if (whole) record_put(to, EDA_GDS_ENDLIB, EDA_GDS_NOTHING, "", 0);
  g_assert_true(
      g_file_set_contents(path, (char *)to->data, (gssize)to->len, NULL));
  g_byte_array_unref(to);
  return path;
}

/* Compare two files and remove them. */
static int files_compare(char *a, char *b, mask_difference **out, size_t *n,
                         opc_error *error) {
  int code = masks_compare(a, b, out, n, error);
  g_test_message("%s", code ? error->message : "good");
  g_unlink(a);
  g_unlink(b);
  g_free(a);
  g_free(b);
  return code;
}

static void test_areas(void) {
  GByteArray *a = file_begin(1), *b = file_begin(1);
  /* Layer 9: the box grows by 100 nm at the left and the right; the upper part
     of the grown box is a separate polygon. */
  put_box(a, 9, 0, 0, 1000, 2000);
  put_box(b, 9, -100, 0, 1100, 1000);
  put_box(b, 9, -100, 1000, 1100, 2000);
  /* Layer 1: equal areas, divided into different polygons. */
  put_box(a, 1, 0, 0, 500, 500);
  put_box(b, 1, 0, 0, 250, 500);
  put_box(b, 1, 250, 0, 500, 500);
  /* Layer 3: in one of the files only. */
  put_box(b, 3, 0, 0, 1000, 1000);
  put_box(b, 3, 2000, 0, 3000, 500);
  mask_difference *d;
  opc_error error = {0};
  size_t n;
  g_assert_false(
      files_compare(file_end(a, TRUE), file_end(b, TRUE), &d, &n, &error));
  g_assert_cmpuint(n, ==, 3);
  g_assert_cmpuint(d[0].layer, ==, 1);
  g_assert_cmpfloat(d[0].area, ==, 0);
  g_assert_cmpint(d[0].places, ==, 0);
  g_assert_cmpuint(d[1].layer, ==, 3);
  g_assert_cmpfloat_with_epsilon(d[1].base, 0, 1e-12);
  g_assert_cmpfloat_with_epsilon(d[1].area, 1.5, 1e-12);
  g_assert_cmpint(d[1].places, ==, 2);
  g_assert_cmpuint(d[2].layer, ==, 9);
  g_assert_cmpfloat_with_epsilon(d[2].base, 2, 1e-12);
  g_assert_cmpfloat_with_epsilon(d[2].other, 2.4, 1e-12);
  g_assert_cmpfloat_with_epsilon(d[2].area, 0.4, 1e-12);
  g_assert_cmpint(d[2].places, ==, 2);
  g_assert_cmpint(d[2].rectangles, ==, 2);
  free(d);
}

/* A frame is one polygon, not two. */
static void test_hole(void) {
  GByteArray *a = file_begin(2), *b = file_begin(2);
  put_box(a, 9, 0, 0, 500, 500);
  put_box(b, 9, 100, 100, 400, 400);
  mask_difference *d;
  opc_error error = {0};
  size_t n;
  g_assert_false(
      files_compare(file_end(a, TRUE), file_end(b, TRUE), &d, &n, &error));
  g_assert_cmpuint(n, ==, 1);
  g_assert_cmpint(d->places, ==, 1);
  g_assert_cmpint(d->rectangles, ==, 4);
  g_assert_cmpfloat_with_epsilon(d->area, 1 - 0.36, 1e-12);
  free(d);
}

static void test_bad(void) {
  mask_difference *d;
  opc_error error = {0};
  size_t n;
  g_assert_cmpint(files_compare(file_end(file_begin(1), TRUE),
                                file_end(file_begin(2), TRUE), &d, &n, &error),
                  ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "grids of 1 nm and 2 nm"));
  g_assert_null(d);
  files_compare(file_end(file_begin(1), TRUE), file_end(file_begin(1), FALSE),
                &d, &n, &error);
  g_assert_nonnull(
      strstr(error.message, "byte 34: not a GDSII file, or truncated"));
  GByteArray *a = file_begin(1);
  record_put(a, EDA_GDS_SREF, EDA_GDS_NOTHING, "", 0);
  files_compare(file_end(a, TRUE), file_end(file_begin(1), TRUE), &d, &n,
                &error);
  g_assert_nonnull(strstr(error.message, "other than the polygons"));
  a = file_begin(1);
  record_put(a, EDA_GDS_LAYER, EDA_GDS_INT2, "", 1);
  files_compare(file_end(a, TRUE), file_end(file_begin(1), TRUE), &d, &n,
                &error);
  g_assert_nonnull(strstr(error.message, "byte 30: a record is too short"));
  g_assert_cmpint(masks_compare("/nowhere", "/nowhere", &d, &n, &error), ==,
                  OPC_IO);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/masks/areas", test_areas);
  g_test_add_func("/masks/hole", test_hole);
  g_test_add_func("/masks/bad", test_bad);
  return g_test_run();
}
