/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the data that library.build passes to library.place. */
#include <correct/library.h>

const char *const correct_library_models[LIBRARY_MODELS] = {"litho", "resist",
                                                            "extractor"};

static void clear_cell(gpointer item) {
  library_cell *c = item;
  g_free(c->name);
  g_free(c->geometry);
  correct_entry_free(c->entry);
}

library *correct_library_new(double grid) {
  library *l = g_new0(library, 1);
  l->grid = grid;
  l->cells = g_array_new(FALSE, TRUE, sizeof(library_cell));
  g_array_set_clear_func(l->cells, clear_cell);
  return l;
}

void correct_library_free(void *object) {
  library *l = object;
  if (!l) return;
  for (int k = 0; k < LIBRARY_MODELS; k++) g_free(l->model[k]);
  g_array_free(l->cells, TRUE);
  g_free(l);
}

int correct_library_check(const void *object, opc_error *error) {
  const library *l = object;
  return l->cells ? OPC_OK
                  : opc_fail(error, OPC_FAILED, NULL,
                             "the library has no list of cells");
}

int correct_library_take_models(const opc_host *host,
                                char *model[LIBRARY_MODELS], opc_error *error) {
  const opc_results *results = opc_get_results(host);
  for (int k = 0; k < LIBRARY_MODELS; k++) {
    const char *sum = results->identity(host, correct_library_models[k], error);
    if (!sum) return error->code;
    g_free(model[k]);
    model[k] = g_strdup(sum);
  }
  return OPC_OK;
}
