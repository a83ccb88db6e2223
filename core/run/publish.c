/* SPDX-License-Identifier: BSD-3-Clause */
/* Publishes files, tables and metrics of the instances of a run. */
#include <base/file.h>
#include <errno.h>
#include <store/files.h>
#include <string.h>

#include "core/plugin/declaration.h"
#include "core/run/publish.h"
#include "core/run/services.h"

/* Record a refused publication: the step fails even if the plugin continues. */
static int publication_refuse(opc_run *run, const opc_error *error) {
  if (!run->written.refusal.code) run->written.refusal = *error;
  return error->code;
}

/* Fail inside a work unit: each unit runs in only one of several processes, and
   the other processes would lack the publication. */
static gboolean in_piece(const opc_run *run, const char *name,
                         opc_error *error) {
  if (run->listener.piece)
    opc_fail(error, OPC_FAILED, NULL,
             "'%s' is published by a work unit, but work units may run in "
             "another process: publish results in the step",
             name);
  return run->listener.piece != NULL;
}

/* Return the path of the instance that has written, or will write, a file of
   the run folder; NULL if no instance does. */
static const char *owner_of(const opc_run *run, const char *name) {
  const char *owner = g_hash_table_lookup(run->written.claims, name);
  return owner ? owner : g_hash_table_lookup(run->written.outputs, name);
}

/* Claim a name in the run folder. Fails if the name is taken or outside the
   folder. */
static int output_claim(opc_run *run, const opc_binding *b, const char *name,
                        opc_error *error) {
  const char *owner = owner_of(run, name);
  gboolean taken = g_hash_table_contains(run->written.claims, name) ||
                   (owner && strcmp(owner, b->path));
  if (in_piece(run, name, error)) return error->code;
  if (!run->written.work)
    return opc_fail(error, OPC_FAILED, NULL, "'%s': no step is running", name);
  if (!opc_name_is_inside(name))
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s' is outside of the run folder", name);
  if (taken)
    return opc_fail(error, OPC_INVALID, NULL, "'%s' is already written by '%s'",
                    name, owner);
  g_hash_table_insert(run->written.claims, g_strdup(name), g_strdup(b->path));
  return OPC_OK;
}

static const char *give_path(const opc_host *host, const char *name,
                             opc_error *error) {
  const opc_binding *b = host->data;
  opc_run *run = b->run;
  int code = output_claim(run, b, name, error);
  char *path =
      g_build_filename(run->written.work ? run->written.work : "", name, NULL);
  g_autofree char *folder = g_path_get_dirname(path);
  g_ptr_array_add(b->owned, path);
  if (!code && g_mkdir_with_parents(folder, 0777))
    code = opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  if (!code) {
    g_ptr_array_add(run->written.given, g_strdup(path));
    return path;
  }
  publication_refuse(run, error);
  return NULL;
}

/* Return NAME.csv (g_free), or STEP.NAME.csv if another step has published
   a table NAME, or a parameter names an output file NAME.csv. */
static char *table_file(const opc_run *run, const opc_binding *b,
                        const char *name) {
  char *file = g_strdup_printf("%s.csv", name);
  const char *owner = owner_of(run, file);
  if (!owner || (!strcmp(owner, b->path) &&
                 !g_hash_table_contains(run->written.outputs, file)))
    return file;
  g_free(file);
  return g_strdup_printf("%s.%s.csv", b->path, name);
}

static int take_table(const opc_host *host, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n_columns,
                      size_t column_size, opc_error *error) {
  const opc_binding *b = host->data;
  opc_run *run = b->run;
  if (in_piece(run, name, error)) return publication_refuse(run, error);
  if (run->listener.silent) return OPC_OK;
  opc_table *table =
      opc_table_new(name, flags, rows, columns, n_columns, column_size, error);
  if (!table) return publication_refuse(run, error);
  g_autofree char *file = table_file(run, b, name);
  int code = strchr(name, '/')
                 ? opc_fail(error, OPC_FAILED, NULL,
                            "'%s' cannot be the name of a table", name)
                 : output_claim(run, b, file, error);
  if (code) {
    opc_table_free(table);
    return publication_refuse(run, error);
  }
  table->step = g_strdup(b->path);
  g_ptr_array_add(run->out.tables, table);
  g_autofree char *path = g_build_filename(run->written.work, file, NULL);
  g_autofree char *csv = opc_table_csv(table);
  code = opc_write_file(path, csv, error);
  return code ? publication_refuse(run, error) : OPC_OK;
}

static int take_metric(const opc_host *host, const char *name, double value,
                       opc_error *error) {
  const opc_binding *b = host->data;
  opc_run *run = b->run;
  opc_inner_metric entry = {
      b->path, opc_metric_check(b->plugin, name, value, error), value};
  if (!entry.metric || in_piece(run, name, error))
    return publication_refuse(run, error);
  if (run->listener.silent) return OPC_OK;
  for (guint i = 0; i < run->out.metrics->len; i++) {
    opc_inner_metric *old =
        &g_array_index(run->out.metrics, opc_inner_metric, i);
    if (old->path == b->path && old->metric == entry.metric) {
      old->value = value;
      return OPC_OK;
    }
  }
  g_array_append_val(run->out.metrics, entry);
  return OPC_OK;
}

const opc_host opc_run_publisher = {.table = take_table,
                                    .metric = take_metric,
                                    .output_path = give_path,
                                    .service = opc_run_service};
