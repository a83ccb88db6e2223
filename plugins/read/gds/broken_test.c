/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of truncated, altered, hostile and compressed files: rejected with the
   place of the error, in bounded time. */
#include <stdio.h>
#include <zlib.h>

#include "making_test.h"

/* Return the path of a file with the first `most` bytes of the gzip stream of n
   bytes. */
static char *save_packed(const void *bytes, size_t n, size_t most) {
  uLong capacity = compressBound((uLong)n) + 64;
  g_autofree uint8_t *out = g_malloc(capacity);
  z_stream z = {.next_in = (Bytef *)bytes,
                .avail_in = (uInt)n,
                .next_out = out,
                .avail_out = (uInt)capacity};
  g_assert_cmpint(
      deflateInit2(&z, 9, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY),
      ==, Z_OK);
  g_assert_cmpint(deflate(&z, Z_FINISH), ==, Z_STREAM_END);
  char *path = g_build_filename(opc_test_folder(), "packed.gds", NULL);
  g_assert_true(g_file_set_contents(path, (const char *)out,
                                    (gssize)MIN(z.total_out, most), NULL));
  deflateEnd(&z);
  return path;
}

static void test_refusals(void) {
  GByteArray *file = new_file();
  g_autofree char *path = file_save(file);
  assert_refused(path, "", OPC_IO, "ends before ENDLIB, at byte 62");
  put_cell(file, "A");
  put_empty(file, EDA_GDS_ENDSTR);
  guint second = file->len + 28;
  put_cell(file, "A");
  g_free(file_save(file));
  g_autofree char *twice =
      g_strdup_printf("'%s': cell 'A' a second time at byte %u", path, second);
  assert_refused(path, "", OPC_IO, twice);
  g_byte_array_set_size(file, 62);
  g_byte_array_append(file, (const uint8_t[]){0, 5, 5, 2, 0}, 5);
  g_free(file_save(file));
  assert_refused(path, "", OPC_IO, "impossible record length at byte 62");
  g_byte_array_set_size(file, 62);
  g_byte_array_append(file, (const uint8_t[]){0, 28, 5, 2, 0}, 5);
  g_free(file_save(file));
  assert_refused(path, "", OPC_IO, "truncated record at byte 62");
  g_byte_array_set_size(file, 62);
  put_empty(file, EDA_GDS_ENDEL);
  g_free(file_save(file));
  assert_refused(path, "", OPC_IO, "unexpected record at byte 62");
  g_byte_array_free(file, TRUE);
  g_assert_true(g_file_set_contents(path, "hello, world", -1, NULL));
  assert_refused(path, "", OPC_IO, "not a GDSII file: no HEADER at byte 0");
  /* Interpreted as GDSII, the length of the first record exceeds the file. */
  g_assert_true(g_file_set_contents(path, "(CIF file);\n", -1, NULL));
  assert_refused(path, "", OPC_IO, "not a GDSII file: no HEADER at byte 0");
}

static void test_truncated(void) {
  size_t n;
  g_autofree char *bytes = corpus_file("own_elements_a.gds", &n);
  if (!bytes) return;
  g_autofree char *path = g_build_filename(opc_test_folder(), "cut.gds", NULL);
  for (size_t at = 0;;) {
    opc_error e = {0};
    const uint8_t *record = (const uint8_t *)bytes + at;
    for (size_t more = 0; more < 4; more++) {
      write_bytes(path, bytes, at + more);
      g_assert_null(read_more(path, "", &e));
      g_autofree char *where = g_strdup_printf("at byte %zu", at);
      if (!g_str_has_suffix(e.message, where)) g_error("%s", e.message);
    }
    if (record[2] == EDA_GDS_ENDLIB) break;
    at += eda_gds_u16(record);
    g_assert_cmpuint(at, <, n);
  }
}

/* Test random changes; OPCFLOW_FUZZ sets a larger number of rounds. */
static void test_flipped(void) {
  static const char *const files[] = {"own_elements_a.gds", "klayout_t10.gds",
                                      "klayout_t11.gds", "klayout_arefs.gds"};
  const char *more = g_getenv("OPCFLOW_FUZZ");
  int rounds = more ? atoi(more) : 800;
  g_autofree char *path = g_build_filename(opc_test_folder(), "flip.gds", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    size_t n;
    g_autofree char *bytes = corpus_file(files[i], &n);
    if (!bytes) return;
    GRand *rand = g_rand_new_with_seed((guint32)i);
    for (int round = 0; round < rounds; round++) {
      g_autofree char *copy = g_memdup2(bytes, n);
      int flips = g_rand_int_range(rand, 1, 6);
      for (int k = 0; k < flips; k++) {
        int at = g_rand_int_range(rand, 0, (gint32)n);
        copy[at] = (char)(copy[at] ^ 1 << g_rand_int_range(rand, 0, 8));
      }
      write_bytes(path, copy, n);
      assert_survives("read.gds", path);
    }
    g_rand_free(rand);
  }
}

/* Test a chain of cells that place each other, and a huge array. */
static void test_hostile(void) {
  GByteArray *file = new_file();
  put_leaf(file);
  for (int i = 0; i < 300; i++) {
    char name[16], child[16];
    g_snprintf(name, sizeof name, "C%d", i);
    g_snprintf(child, sizeof child, "C%d", i - 1);
    put_cell(file, name);
    put_empty(file, EDA_GDS_AREF);
    put_text(file, EDA_GDS_SNAME, i ? child : "LEAF");
    put_u16s(file, EDA_GDS_COLROW, 2, (uint32_t[]){65535, 65535});
    put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, 65535, 0, 0, 65535});
    put_empty(file, EDA_GDS_ENDEL);
    put_empty(file, EDA_GDS_ENDSTR);
  }
  put_cell(file, "TOP");
  put_box(file, 1, 1);
  g_autofree char *path = file_finish(file);
  assert_survives("read.gds", path);
  file = new_file();
  put_leaf(file);
  put_cell(file, "TOP");
  put_empty(file, EDA_GDS_AREF);
  put_text(file, EDA_GDS_SNAME, "LEAF");
  put_u16s(file, EDA_GDS_COLROW, 2, (uint32_t[]){65535, 65535});
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, 65534, 0, 0, 65534});
  put_empty(file, EDA_GDS_ENDEL);
  g_free(file_finish(file));
  assert_refused(path, "", OPC_IO, "too many arrays");
  file = new_file(); /* fewer instances with long names */
  put_leaf(file);
  put_cell(file, "TOP");
  put_empty(file, EDA_GDS_AREF);
  put_text(file, EDA_GDS_SNAME, "LEAF");
  put_u16s(file, EDA_GDS_COLROW, 2, (uint32_t[]){1024, 512});
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, 1025, 0, 0, 513});
  put_u16s(file, EDA_GDS_PROPATTR, 1, (uint32_t[]){61});
  g_autofree char *name = g_strnfill(200, 'n');
  put_text(file, EDA_GDS_PROPVALUE, name);
  put_empty(file, EDA_GDS_ENDEL);
  g_free(file_finish(file));
  assert_refused(path, "", OPC_IO, "too many arrays");
}

/* Test a compressed file: the layout equals that of the plain file. A truncated
   file, a wrong checksum, and a file that expands a thousandfold are
   rejected. */
static void test_packed(void) {
  GByteArray *file = new_file();
  put_leaf(file);
  put_empty(file, EDA_GDS_ENDLIB);
  char *path = save_packed(file->data, file->len, G_MAXSIZE);
  eda_layout *layout = read_good(path, "");
  g_assert_cmpuint(eda_layout_polygons(layout, 0), ==, 1);
  eda_layout_free(layout);
  g_autofree char *packed = NULL;
  gsize n;
  g_assert_true(g_file_get_contents(path, &packed, &n, NULL));
  g_free(path);
  path = save_packed(packed, n, G_MAXSIZE);
  assert_refused(path, "", OPC_IO, "gzip: the content is compressed again");
  packed[n - 8] ^= 1; /* part of the checksum */
  g_assert_true(g_file_set_contents(path, packed, (gssize)n, NULL));
  assert_refused(path, "", OPC_IO, "gzip: incorrect data check");
  g_free(path);
  path = save_packed(file->data, file->len, n / 2);
  assert_refused(path, "", OPC_IO, "gzip: the data end too early");
  g_free(path);
  const size_t many = 120 << 20;
  g_autofree char *nothing = g_malloc0(many);
  path = save_packed(nothing, many, G_MAXSIZE);
  assert_refused(path, "", OPC_IO,
                 "gzip: the content is larger than any layout");
  g_free(path);
  g_byte_array_free(file, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-gds/packed", test_packed);
  g_test_add_func("/read-gds/refusals", test_refusals);
  g_test_add_func("/read-gds/truncated", test_truncated);
  g_test_add_func("/read-gds/flipped", test_flipped);
  g_test_add_func("/read-gds/hostile", test_hostile);
  return g_test_run();
}
