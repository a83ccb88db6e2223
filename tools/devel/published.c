/* SPDX-License-Identifier: BSD-3-Clause */
/* Hears what a plugin publishes. */
#include "tools/devel/published.h"

#include <errno.h>
#include <string.h>

#include <store/files.h>
#include "core/binding/binding.h"
#include "core/plugin/declaration.h"
#include "core/report/table.h"
#include "core/run/services.h"

static opc_published *of(const opc_host *host) {
  return ((const opc_binding *)host->data)->run;
}

static void add_text(opc_published *p, const char *text) {
  g_checksum_update(p->digest, (const guchar *)text, (gssize)strlen(text) + 1);
}

static int take_table(const opc_host *host, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n_columns,
                      size_t column_size, opc_error *error) {
  opc_table *table =
      opc_table_new(name, flags, rows, columns, n_columns, column_size, error);
  if (!table) return error->code;
  g_autofree char *text = opc_table_csv(table);
  add_text(of(host), table->name);
  add_text(of(host), text);
  opc_table_free(table);
  return OPC_OK;
}

static int take_metric(const opc_host *host, const char *name, double value,
                       opc_error *error) {
  const opc_binding *b = host->data;
  if (!opc_metric_check(b->plugin, name, value, error)) return error->code;
  g_checksum_update(of(host)->digest, (const guchar *)&value, sizeof value);
  return OPC_OK;
}

static const char *give_path(const opc_host *host, const char *name,
                             opc_error *error) {
  opc_published *p = of(host);
  char *path = g_build_filename(p->folder, name, NULL);
  g_autofree char *folder = g_path_get_dirname(path);
  g_ptr_array_add(p->paths, path);
  if (!opc_name_is_inside(name))
    opc_fail(error, OPC_INVALID, NULL, "'%s' leaves the run folder", name);
  else if (g_mkdir_with_parents(folder, 0777))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  else
    return path;
  return NULL;
}

void opc_published_init(opc_published *p, const char *inside) {
  *p = (opc_published){.host = {.data = p,
                                .table = take_table,
                                .metric = take_metric,
                                .output_path = give_path,
                                .service = opc_results_service},
                       .folder = g_build_filename(inside, "out-XXXXXX", NULL),
                       .digest = g_checksum_new(G_CHECKSUM_SHA256),
                       .paths = g_ptr_array_new_with_free_func(g_free)};
  if (!g_mkdtemp(p->folder)) g_error("'%s': %s", p->folder, g_strerror(errno));
}

char *opc_published_clear(opc_published *p) {
  for (guint i = 0; i < p->paths->len; i++) {
    opc_error none;
    g_autofree char *sum = opc_file_sha256(p->paths->pdata[i], NULL, &none);
    add_text(p, sum ? sum : "");
  }
  char *digest = g_strdup(g_checksum_get_string(p->digest));
  opc_remove_tree(p->folder);
  g_checksum_free(p->digest);
  g_ptr_array_free(p->paths, TRUE);
  g_free(p->folder);
  return digest;
}
