/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes single plugins and keeps what they publish, for tests. */
#include "tools/devel/testing.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <store/files.h>
#include "core/binding/binding.h"
#include "core/plugin/declaration.h"
#include "core/plugin/host.h"
#include "core/run/services.h"
#include "core/text/value.h"

static struct {
  opc_registry *registry;
  opc_source *source;
  char *folder;
  GHashTable *metrics; /* name -> double * */
  GHashTable *tables;  /* name -> opc_table * */
  GString *log;
  GPtrArray *paths;
  char *cell; /* the last text given out */
  int cancel;
} state;

/* ---- where it all goes ---- */

static void remove_folder(void) {
  if (state.folder) opc_remove_tree(state.folder);
}

/* Before main. The folders of plugins may still change. */
__attribute__((constructor)) static void start(void) {
  state.source = opc_source_new("test", "");
  state.metrics =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  state.tables = g_hash_table_new_full(g_str_hash, g_str_equal, NULL,
                                       (GDestroyNotify)opc_table_free);
  state.log = g_string_new(NULL);
  state.paths = g_ptr_array_new_with_free_func(g_free);
  atexit(remove_folder);
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

static int take_table(const opc_host *host, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n_columns,
                      size_t column_size, opc_error *error) {
  (void)host;
  opc_table *table =
      opc_table_new(name, flags, rows, columns, n_columns, column_size, error);
  if (!table) return error->code;
  g_hash_table_replace(state.tables, table->name, table);
  return OPC_OK;
}

static int take_metric(const opc_host *host, const char *name, double value,
                       opc_error *error) {
  const opc_binding *b = host->data;
  if (b && !opc_metric_check(b->plugin, name, value, error)) return error->code;
  g_hash_table_replace(state.metrics, g_strdup(name),
                       g_memdup2(&value, sizeof value));
  return OPC_OK;
}

static const char *give_path(const opc_host *host, const char *name,
                             opc_error *error) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_autofree char *folder = g_path_get_dirname(path);
  (void)host;
  g_ptr_array_add(state.paths, path);
  if (!opc_name_is_inside(name))
    opc_fail(error, OPC_INVALID, NULL, "'%s' leaves the run folder", name);
  else if (g_mkdir_with_parents(folder, 0777))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  else
    return path;
  return NULL;
}

static const opc_watch watch = {.log = take_log, .cancelled = is_cancelled};

static const opc_host publisher = {.table = take_table,
                                   .metric = take_metric,
                                   .output_path = give_path,
                                   .service = opc_results_service};

const opc_host *opc_test_host(void) {
  static opc_host *host;
  if (!host) host = opc_host_new("test", &watch, &publisher);
  return host;
}

const char *opc_test_folder(void) {
  if (!state.folder) state.folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  return state.folder;
}

/* ---- modules ---- */

static opc_binding *binding_of(opc_module *module) {
  return (opc_binding *)((char *)module - offsetof(opc_binding, module));
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
  if (b) g_ptr_array_add(b->presets, g_steal_pointer(&map)); /* lives as long */
  if (!problems->list->len) opc_binding_create(b, &watch, &publisher, problems);
  if (!problems->list->len) return &g_steal_pointer(&b)->module;
  g_autofree char *text = opc_problems_text(problems);
  opc_fail(error, opc_problems_code(problems), NULL, "%s", text);
  return NULL;
}

void opc_test_module_free(opc_module *module) {
  if (module) opc_binding_free(binding_of(module));
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

/* ---- what it said ---- */

double opc_test_metric(const char *name) {
  const double *value = g_hash_table_lookup(state.metrics, name);
  return value ? *value : NAN;
}

const opc_table *opc_test_table(const char *name) {
  return g_hash_table_lookup(state.tables, name);
}

const char *opc_test_log(void) { return state.log->str; }

void opc_test_forget(void) {
  g_hash_table_remove_all(state.metrics);
  g_hash_table_remove_all(state.tables);
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
