/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates single plugin instances for tests and stores their results. */
#include "tools/devel/testing.h"

#include <base/file.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <store/files.h>
#include <store/store.h>
#include <string.h>

#include "core/binding/binding.h"
#include "core/binding/inner.h"
#include "core/plugin/declaration.h"
#include "core/plugin/host.h"
#include "core/plugin/value.h"
#include "tools/devel/published.h"

static struct {
  opc_registry *registry;
  opc_source *source;
  opc_published published;
  GString *log;
  char *cell; /* text returned by the last call */
  int cancel;
} state;

/* ---- state ---- */

static void remove_all(void) { opc_published_clear(&state.published); }

/* Runs before main(), because tests may change the plugin folders later. */
__attribute__((constructor)) static void state_start(void) {
  state.source = opc_source_new("test", "");
  opc_published_init(&state.published, g_get_tmp_dir());
  state.log = g_string_new(NULL);
  atexit(remove_all);
}

static void take_log(void *data, const char *path, int level,
                     const char *message) {
  static GMutex lock;
  (void)data, (void)path, (void)level;
  g_mutex_lock(&lock);
  g_string_append_printf(state.log, "%s\n", message);
  g_mutex_unlock(&lock);
}

static int is_cancelled(void *data) {
  (void)data;
  return state.cancel;
}

static const opc_watch watch = {.log = take_log, .cancelled = is_cancelled};

const opc_host *opc_test_host(void) {
  static opc_binding nobody = {.run = &state.published};
  static opc_host *host;
  if (!host) host = opc_host_new("test", &watch, &state.published.host);
  host->data = &nobody;
  return host;
}

const char *opc_test_folder(void) {
  return opc_published_folder(&state.published);
}

/* ---- modules ---- */

static opc_binding *binding_of(opc_module *module) {
  return (opc_binding *)((char *)module - offsetof(opc_binding, module));
}

/* Return a store in the folder OPCFLOW_STORE; NULL if the variable is not
   set. */
static opc_store *open_store(void) {
  const char *folder = g_getenv("OPCFLOW_STORE");
  opc_error none;
  return folder && *folder ? opc_store_open(&none) : NULL;
}

opc_module *opc_test_module(const char *id, const char *mapping,
                            opc_error *error) {
  if (!state.registry) state.registry = opc_registry_new(NULL);
  const opc_plugin *plugin = opc_registry_find(state.registry, id, error);
  if (!plugin) return NULL;
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_binding) b = NULL;
  g_autoptr(opc_node) map =
      opc_node_parse(state.source, mapping, strlen(mapping), problems);
  if (map && map->type != OPC_NODE_MAP) opc_wrong(problems, map, "not a map");
  if (!problems->list->len)
    b = opc_bind_plugin(state.registry, plugin, map, id, &map->at,
                        OPC_BIND_NO_INPUTS, problems);
  if (b)
    g_ptr_array_add(b->presets, g_steal_pointer(&map)); /* freed with `b` */
  if (!problems->list->len)
    opc_inner_open(b, state.registry, OPC_BIND_NO_INPUTS, problems);
  if (!problems->list->len)
    opc_binding_create(b, &watch, &state.published.host, problems);
  if (!problems->list->len) {
    b->store = open_store();
    return &g_steal_pointer(&b)->module;
  }
  g_autofree char *text = opc_problems_text(problems);
  opc_fail(error, opc_problems_code(problems), NULL, "%s", text);
  return NULL;
}

void opc_test_module_free(opc_module *module) {
  if (!module) return;
  opc_store *store = binding_of(module)->store;
  opc_binding_free(binding_of(module));
  opc_store_close(store);
}

void opc_test_input(opc_module *module, const char *name, void *object) {
  opc_binding *b = binding_of(module);
  int i = opc_parameter_find(b->plugin, name);
  uint32_t type = i < 0 ? 0 : b->plugin->parameters[i].type;
  if (type != OPC_INPUT && type != OPC_SLOT)
    g_error("'%s' has no input or slot '%s'", module->id, name);
  opc_binding_set(b, (size_t)i, object);
}

int opc_test_run(opc_module *module, void **outputs, opc_error *error) {
  const opc_step *step = module->functions;
  if (step->n_outputs) memset(outputs, 0, step->n_outputs * sizeof *outputs);
  int code = step->run(module->self, outputs, error);
  for (size_t i = 0; i < step->n_outputs && !code; i++)
    code = step->outputs[i].check(outputs[i], error);
  if (code) opc_test_release(module, outputs);
  return code;
}

void opc_test_release(opc_module *module, void **outputs) {
  const opc_step *step = module->functions;
  for (size_t i = step->n_outputs; i-- > 0;) {
    if (outputs[i]) step->outputs[i].release(outputs[i]);
    outputs[i] = NULL;
  }
}

/* ---- results ---- */

double opc_test_metric(const char *name) {
  const GArray *metrics = state.published.metrics;
  for (guint i = metrics->len; i-- > 0;) {
    const opc_published_metric *m =
        &g_array_index(metrics, opc_published_metric, i);
    if (!strcmp(m->name, name)) return m->value;
  }
  return NAN;
}

const opc_table *opc_test_table(const char *name) {
  const GPtrArray *tables = state.published.tables;
  for (guint i = tables->len; i-- > 0;) {
    const opc_table *table = tables->pdata[i];
    if (!strcmp(table->name, name)) return table;
  }
  return NULL;
}

const char *opc_test_log(void) { return state.log->str; }

void opc_test_forget(void) {
  opc_published_forget(&state.published);
  g_string_truncate(state.log, 0);
}

static const opc_column *find_column(const char *table, const char *column,
                                     size_t row) {
  const opc_table *t = opc_test_table(table);
  return t && row < t->rows ? opc_table_column(t, column) : NULL;
}

size_t opc_test_rows(const char *table) {
  const opc_table *t = opc_test_table(table);
  return t ? t->rows : 0;
}

const char *opc_test_text(const char *table, const char *column, size_t row) {
  const opc_column *c = find_column(table, column, row);
  g_free(state.cell);
  state.cell = c ? opc_table_cell(c, row) : NULL;
  return state.cell ? state.cell : "";
}

double opc_test_number(const char *table, const char *column, size_t row) {
  const opc_column *c = find_column(table, column, row);
  if (c && c->type == OPC_REAL) return ((const double *)c->data)[row];
  if (c && c->type == OPC_INT) return (double)((const int64_t *)c->data)[row];
  return NAN;
}

void opc_test_cancel(int cancel) { state.cancel = cancel; }
