/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps the tables, metrics and files that plugins publish. */
#include "tools/devel/published.h"

#include <base/file.h>
#include <errno.h>
#include <store/files.h>
#include <string.h>

#include "core/binding/binding.h"
#include "core/plugin/declaration.h"
#include "core/run/services.h"

static opc_published *published_of(const opc_host *host) {
  return ((const opc_binding *)host->data)->run;
}

static int take_table(const opc_host *host, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n_columns,
                      size_t column_size, opc_error *error) {
  opc_table *table =
      opc_table_new(name, flags, rows, columns, n_columns, column_size, error);
  if (!table) return error->code;
  g_ptr_array_add(published_of(host)->tables, table);
  return OPC_OK;
}

/* A host without a plugin accepts any metric. */
static int take_metric(const opc_host *host, const char *name, double value,
                       opc_error *error) {
  const opc_plugin *plugin = ((const opc_binding *)host->data)->plugin;
  const opc_metric *declared =
      plugin ? opc_metric_check(plugin, name, value, error) : NULL;
  if (plugin && !declared) return error->code;
  const opc_published_metric m = {g_intern_string(name), value, declared};
  g_array_append_val(published_of(host)->metrics, m);
  return OPC_OK;
}

static const char *give_path(const opc_host *host, const char *name,
                             opc_error *error) {
  opc_published *p = published_of(host);
  char *path = g_build_filename(opc_published_folder(p), name, NULL);
  g_autofree char *folder = g_path_get_dirname(path);
  g_ptr_array_add(p->paths, path);
  if (!opc_name_is_inside(name))
    opc_fail(error, OPC_INVALID, NULL, "'%s' is outside of the run folder",
             name);
  else if (g_mkdir_with_parents(folder, 0777))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  else
    return path;
  return NULL;
}

void opc_published_init(opc_published *p, const char *inside) {
  *p = (opc_published){
      .host = {.data = p,
               .table = take_table,
               .metric = take_metric,
               .output_path = give_path,
               .service = opc_results_service},
      .inside = inside,
      .tables = g_ptr_array_new_with_free_func((GDestroyNotify)opc_table_free),
      .paths = g_ptr_array_new_with_free_func(g_free),
      .metrics = g_array_new(FALSE, FALSE, sizeof(opc_published_metric))};
}

const char *opc_published_folder(opc_published *p) {
  if (p->folder) return p->folder;
  p->folder = g_build_filename(p->inside, "opcflow-XXXXXX", NULL);
  if (!g_mkdtemp(p->folder)) g_error("'%s': %s", p->folder, g_strerror(errno));
  return p->folder;
}

void opc_published_forget(opc_published *p) {
  g_ptr_array_set_size(p->tables, 0);
  g_array_set_size(p->metrics, 0);
}

static void add_text(GChecksum *digest, const char *text) {
  g_checksum_update(digest, (const guchar *)text, (gssize)strlen(text) + 1);
}

char *opc_published_digest(const opc_published *p) {
  g_autoptr(GChecksum) digest = g_checksum_new(G_CHECKSUM_SHA256);
  for (guint i = 0; i < p->tables->len; i++) {
    const opc_table *table = p->tables->pdata[i];
    g_autofree char *text = opc_table_csv(table);
    add_text(digest, table->name);
    add_text(digest, text);
  }
  for (guint i = 0; i < p->metrics->len; i++) {
    const opc_published_metric *m =
        &g_array_index(p->metrics, opc_published_metric, i);
    add_text(digest, m->name);
    g_checksum_update(digest, (const guchar *)&m->value, sizeof m->value);
  }
  for (guint i = 0; i < p->paths->len; i++) {
    opc_error none;
    g_autofree char *sum = opc_file_sha256(p->paths->pdata[i], NULL, &none);
    add_text(digest, sum ? sum : "");
  }
  return g_strdup(g_checksum_get_string(digest));
}

void opc_published_clear(opc_published *p) {
  if (p->folder) opc_remove_tree(p->folder);
  g_free(p->folder);
  g_ptr_array_free(p->tables, TRUE);
  g_ptr_array_free(p->paths, TRUE);
  g_array_free(p->metrics, TRUE);
}
