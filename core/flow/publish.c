/* SPDX-License-Identifier: BSD-3-Clause */
/* What the instances of a run say and publish. */
#include <errno.h>
#include <string.h>

#include "core/flow/files.h"
#include "core/flow/run.h"
#include "core/text/value.h"
#include "core/plugin/declaration.h"

/* ---- passing on ---- */

static void take_log(void *data, int level, const char *message) {
  const opc_binding *b = data;
  const opc_watch *watch = ((const opc_run *)b->listener)->watch;
  if (watch->log) watch->log(watch->data, b->path, level, message);
}

static void take_progress(void *data, const opc_progress *progress) {
  const opc_binding *b = data;
  const opc_watch *watch = ((const opc_run *)b->listener)->watch;
  if (watch->progress) watch->progress(watch->data, b->path, progress);
}

static int is_cancelled(void *data) {
  const opc_binding *b = data;
  const opc_watch *watch = ((const opc_run *)b->listener)->watch;
  return watch->cancelled && watch->cancelled(watch->data);
}

/* ---- publishing ---- */

/* A refusal stands, whether or not the plugin passes it on. */
static int refuse(opc_run *run, const opc_error *error) {
  if (!run->refusal.code) run->refusal = *error;
  return error->code;
}

/* Take a name in the run folder: FALSE if it is taken or leaves the folder. */
static gboolean claim(opc_run *run, const opc_binding *b, const char *name,
                      opc_error *error) {
  if (!run->work) {
    opc_fail(error, OPC_FAILED, NULL, "'%s': no step is running", name);
    return FALSE;
  }
  if (!opc_name_is_inside(name)) {
    opc_fail(error, OPC_INVALID, NULL, "'%s' leaves the run folder", name);
    return FALSE;
  }
  const char *owner = g_hash_table_lookup(run->claims, name);
  if (owner) {
    opc_fail(error, OPC_INVALID, NULL, "'%s' is already written by '%s'", name,
             owner);
    return FALSE;
  }
  g_hash_table_insert(run->claims, g_strdup(name), g_strdup(b->path));
  return TRUE;
}

static const char *give_path(void *data, const char *name, opc_error *error) {
  const opc_binding *b = data;
  opc_run *run = b->listener;
  if (!claim(run, b, name, error)) {
    refuse(run, error);
    return NULL;
  }
  char *path = g_build_filename(run->work, name, NULL);
  g_ptr_array_add(run->paths, path);
  g_autofree char *folder = g_path_get_dirname(path);
  if (!g_mkdir_with_parents(folder, 0777)) return path;
  opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  refuse(run, error);
  return NULL;
}

/* NAME.csv; where an earlier step has that, STEP.NAME.csv. */
static char *table_file(const opc_run *run, const opc_binding *b,
                        const char *name) {
  char *file = g_strdup_printf("%s.csv", name);
  const char *owner = g_hash_table_lookup(run->claims, file);
  if (!owner || !strcmp(owner, b->path)) return file;
  g_free(file);
  return g_strdup_printf("%s.%s.csv", b->path, name);
}

static int keep_table(opc_run *run, const opc_binding *b, opc_table *table,
                      opc_error *error) {
  g_autofree char *file = table_file(run, b, table->name);
  if (strchr(table->name, '/') || !claim(run, b, file, error)) {
    if (!error->code)
      opc_fail(error, OPC_FAILED, NULL, "'%s' is no name of a table",
               table->name);
    opc_table_free(table);
    return refuse(run, error);
  }
  opc_run_table *kept = g_new0(opc_run_table, 1);
  kept->step = g_strdup(b->path);
  kept->file = g_strdup(file);
  kept->table = table;
  g_ptr_array_add(run->tables, kept);
  g_autofree char *path = g_build_filename(run->work, file, NULL);
  g_autofree char *csv = opc_table_csv(table);
  int code = opc_write_file(path, csv, error);
  return code ? refuse(run, error) : OPC_OK;
}

static int take_table(void *data, const char *name, uint32_t flags, size_t rows,
                      const opc_column *columns, size_t n_columns,
                      opc_error *error) {
  const opc_binding *b = data;
  opc_run *run = b->listener;
  error->code = OPC_OK;
  opc_table *table =
      opc_table_new(name, flags, rows, columns, n_columns, error);
  if (!table) return refuse(run, error);
  return keep_table(run, b, table, error);
}

static int take_metric(void *data, const char *name, double value,
                       opc_error *error) {
  const opc_binding *b = data;
  opc_run *run = b->listener;
  opc_inner_metric entry = {
      b->path, opc_metric_check(b->plugin, name, value, error), value};
  if (!entry.metric) return refuse(run, error);
  for (guint i = 0; i < run->metrics->len; i++) {
    opc_inner_metric *old = &g_array_index(run->metrics, opc_inner_metric, i);
    if (old->path == b->path && old->metric == entry.metric) {
      old->value = value;
      return OPC_OK;
    }
  }
  g_array_append_val(run->metrics, entry);
  return OPC_OK;
}

const opc_sink opc_run_sink = {
    .log = take_log,
    .progress = take_progress,
    .cancelled = is_cancelled,
    .table = take_table,
    .metric = take_metric,
    .output_path = give_path,
};
