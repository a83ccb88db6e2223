/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/sha256.h"

#include <string.h>

/* FIPS 180-4's own examples. */
static void test_known(void) {
  static const struct {
    const char *text, *sum;
  } cases[] = {
      {"abc",
       "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_sha256 sum;
    opc_sha256_begin(&sum);
    opc_sha256_add(&sum, cases[i].text, strlen(cases[i].text));
    g_autofree char *text = opc_sha256_end(&sum);
    g_assert_cmpstr(text, ==, cases[i].sum);
  }
}

/* All lengths around blocks, in pieces of any size, as GLib has them. */
static void test_lengths(void) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(7);
  guint8 data[1024];
  for (size_t i = 0; i < sizeof data; i++) data[i] = (guint8)g_rand_int(rand);
  for (size_t n = 0; n <= sizeof data; n++) {
    opc_sha256 sum;
    opc_sha256_begin(&sum);
    for (size_t at = 0; at < n;) {
      size_t some = (size_t)g_rand_int_range(rand, 0, 200);
      some = MIN(some, n - at);
      opc_sha256_add(&sum, data + at, some);
      at += some;
    }
    g_autofree char *text = opc_sha256_end(&sum);
    g_autofree char *want =
        g_compute_checksum_for_data(G_CHECKSUM_SHA256, data, n);
    g_assert_cmpstr(text, ==, want);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/sha256/known", test_known);
  g_test_add_func("/sha256/lengths", test_lengths);
  return g_test_run();
}
