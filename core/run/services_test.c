/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of results that plugins keep outside runs: keys, identities, and hosts
   without a store. */
#include "core/run/services.h"

#include <opcflow/results.h>
#include <stdlib.h>
#include <string.h>

#include <store/store.h>
#include "core/binding/folder_test.h"
#include "core/binding/lookup.h"

static opc_flow *load(const char *size) {
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nsteps:\n"
      "  a: { use: test.numbers, size: %s }\n"
      "  b: { use: test.slotted }\n",
      size);
  return trial_load(text);
}

/* Create the instance of a step with the service of hosts outside runs. */
static const opc_host *host_of(const opc_flow *flow, const char *path,
                               opc_store *store) {
  opc_error error = {0};
  static const opc_host like = {.service = opc_results_service};
  opc_binding *b = (opc_binding *)opc_flow_binding(flow, path, &error);
  g_autoptr(opc_problems) problems = opc_problems_new();
  if (!b) g_error("%s", error.message);
  g_assert_true(opc_binding_create(b, NULL, &like, problems));
  b->store = store;
  return b->host;
}

static opc_store *store_open(void) {
  opc_error error = {0};
  opc_store *store = opc_store_open(&error);
  if (!store) g_error("%s", error.message);
  return store;
}

/* Results are found under their key, by the same plugin. */
static void test_kept(void) {
  g_autoptr(opc_flow) flow = load("50 nm");
  g_autoptr(opc_store) store = store_open();
  const opc_host *a = host_of(flow, "a", store), *b = host_of(flow, "b", store);
  const opc_results *r = opc_get_results(a);
  size_t size = 77;
  g_assert_null(r->find(a, "k", &size));
  r->keep(a, "k", "abc", 3);
  g_autofree char *found = r->find(a, "k", &size);
  g_assert_cmpmem(found, size, "abc", 3);
  g_assert_null(r->find(a, "l", &size));
  g_assert_null(r->find(b, "k", &size));
  r->keep(a, "k", "", 0);
  void *none = r->find(a, "k", &size);
  g_assert_nonnull(none);
  g_assert_cmpuint(size, ==, 0);
  free(none);
}

/* Nothing is kept without a store. */
static void test_without_store(void) {
  g_autoptr(opc_flow) flow = load("50 nm");
  const opc_host *a = host_of(flow, "a", NULL);
  const opc_results *r = opc_get_results(a);
  size_t size;
  r->keep(a, "k", "abc", 3);
  g_assert_null(r->find(a, "k", &size));
}

static char *identity_of(const char *size) {
  g_autoptr(opc_flow) flow = load(size);
  opc_error error = {0};
  const opc_host *a = host_of(flow, "a", NULL);
  const char *found = opc_get_results(a)->identity(a, NULL, &error);
  if (!found) g_error("%s", error.message);
  return g_strdup(found);
}

/* The identity depends on the values of parameters, not on their texts. A
   plugin that is not deterministic has none. */
static void test_identity(void) {
  g_autofree char *own = identity_of("50 nm");
  g_autofree char *again = identity_of("0.05 um");
  g_autofree char *other = identity_of("51 nm");
  g_assert_cmpuint(strlen(own), ==, 64);
  g_assert_cmpstr(own, ==, again);
  g_assert_cmpstr(own, !=, other);
  g_autoptr(opc_flow) flow = load("50 nm");
  opc_error error = {0};
  const opc_host *b = host_of(flow, "b", NULL);
  const opc_results *r = opc_get_results(b);
  g_assert_null(r->identity(b, "rule", &error));
  g_assert_cmpstr(error.message, ==,
                  "bad.none does not promise equal results for equal inputs");
  g_assert_null(r->identity(b, "none", &error));
  g_assert_cmpstr(error.message, ==, "test.slotted has no slot 'none'");
  g_assert_null(b->service(b, "opcflow.none/1"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  g_autofree char *store = g_build_filename(trial_folder, "store", NULL);
  g_setenv("OPCFLOW_STORE", store, TRUE);
  g_test_add_func("/services/kept", test_kept);
  g_test_add_func("/services/without-store", test_without_store);
  g_test_add_func("/services/identity", test_identity);
  return trial_end();
}
