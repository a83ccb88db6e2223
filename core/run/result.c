/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs the effects of a step besides its outputs (files, tables, metrics and
   warnings) as one value, to repeat the effects without the step. */
#include <string.h>

#include <store/pack.h>
#include "core/run/result.h"

/* Format of the effects: seconds; processor seconds; metrics: path, name,
   value; warnings: level, path, text; tables: name, flags, rows, columns of
   name, unit, type, decimals, data; files, whose contents follow the value.
   Paths are relative to the step. */
const char opc_result_type[] = "(dda(ssd)a(uss)a(suta(smsuiv))a(ayt))";

/* ---- from a run ---- */

/* Return the path relative to the step. */
static const char *path_below_step(const char *path,
                                   const opc_flow_step *step) {
  path += strlen(step->name);
  return path + (*path == '.');
}

static gboolean is_of(const char *path, const opc_flow_step *step) {
  size_t n = strlen(step->name);
  return !strncmp(path, step->name, n) && (!path[n] || path[n] == '.');
}

static void pack_metrics(GVariantBuilder *all, const opc_run *run,
                         const opc_flow_step *step) {
  for (guint i = 0; i < run->out.metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->out.metrics, opc_inner_metric, i);
    if (is_of(m->path, step))
      g_variant_builder_add(all, "(ssd)", path_below_step(m->path, step),
                            m->metric->name, m->value);
  }
}

static GVariant *pack_data(const opc_column *c, size_t rows) {
  if (c->type == OPC_TEXT)
    return g_variant_new_bytestring_array(c->data, (gssize)rows);
  return g_variant_new_fixed_array(
      c->type == OPC_INT ? G_VARIANT_TYPE_INT64 : G_VARIANT_TYPE_DOUBLE,
      c->data, rows, 8);
}

static void pack_table(GVariantBuilder *all, const opc_table *t) {
  GVariantBuilder columns;
  g_variant_builder_init(&columns, G_VARIANT_TYPE("a(smsuiv)"));
  for (size_t i = 0; i < t->n_columns; i++) {
    const opc_column *c = &t->columns[i];
    g_variant_builder_add(&columns, "(smsuiv)", c->name, c->unit, c->type,
                          c->decimals, pack_data(c, t->rows));
  }
  g_variant_builder_add(all, "(suta(smsuiv))", t->name, t->flags,
                        (guint64)t->rows, &columns);
}

gboolean opc_messages_pack(GVariantBuilder *all, const GPtrArray *messages,
                           const opc_flow_step *step) {
  gboolean good = TRUE;
  g_variant_builder_init(all, G_VARIANT_TYPE("a(uss)"));
  for (guint i = 0; messages && i < messages->len; i++) {
    const opc_message *s = messages->pdata[i];
    gboolean own = is_of(s->path, step);
    g_variant_builder_add(all, "(uss)", s->level,
                          own ? path_below_step(s->path, step) : "", s->text);
    good &= own;
  }
  return good;
}

GVariant *opc_result_new(const opc_run *run, const opc_flow_step *step,
                         guint tables) {
  GVariantBuilder metrics, messages, kept, files;
  gboolean good = opc_messages_pack(&messages, run->listener.messages, step) &&
                  run->listener.messages;
  g_variant_builder_init(&metrics, G_VARIANT_TYPE("a(ssd)"));
  g_variant_builder_init(&kept, G_VARIANT_TYPE("a(suta(smsuiv))"));
  g_variant_builder_init(&files, OPC_FILES_TYPE);
  pack_metrics(&metrics, run, step);
  for (guint i = tables; i < run->out.tables->len; i++)
    pack_table(&kept, run->out.tables->pdata[i]);
  for (guint i = 0; good && i < run->written.given->len; i++) {
    const char *path = run->written.given->pdata[i];
    good = opc_files_add(&files, path, path + strlen(run->written.work) + 1);
  }
  GVariant *all = g_variant_new(opc_result_type, run->out.seconds[step->number],
                                run->out.processor[step->number], &metrics,
                                &messages, &kept, &files);
  if (good) return all;
  g_variant_unref(g_variant_ref_sink(all));
  return NULL;
}

/* ---- to a run ---- */

/* Return the host of the instance at a path relative to the step, or that of
   the step if no instance has the path. */
static const opc_host *host_of(const opc_flow_step *step, const char *rest) {
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  opc_binding_list(step->binding, all);
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (!strcmp(path_below_step(b->path, step), rest)) return b->host;
  }
  return step->binding->host;
}

static int publish_metrics(const opc_flow_step *step, GVariant *metrics,
                           opc_error *error) {
  GVariantIter all;
  const char *rest, *name;
  double value;
  int code = OPC_OK;
  g_variant_iter_init(&all, metrics);
  while (!code && g_variant_iter_next(&all, "(&s&sd)", &rest, &name, &value)) {
    const opc_host *host = host_of(step, rest);
    code = host->metric(host, name, value, error);
  }
  return code;
}

/* Return the data of a column, owned by `data`; an array of texts is added to
   `owned`. */
static const void *unpack_data(GVariant *data, uint32_t type, guint64 rows,
                               GPtrArray *owned) {
  gsize n = 0;
  if (type == OPC_TEXT) {
    const char **texts = g_variant_get_bytestring_array(data, &n);
    g_ptr_array_add(owned, texts);
    return n == rows ? texts : NULL;
  }
  const void *numbers = g_variant_get_fixed_array(data, &n, 8);
  return n == rows ? numbers : NULL;
}

static int publish_table(const opc_flow_step *step, const char *name,
                         uint32_t flags, guint64 rows, GVariant *columns,
                         opc_error *error) {
  size_t n = g_variant_n_children(columns);
  g_autofree opc_column *list = g_new0(opc_column, n + 1);
  g_autoptr(GPtrArray) texts = g_ptr_array_new_with_free_func(g_free);
  g_autoptr(GPtrArray) held =
      g_ptr_array_new_with_free_func((GDestroyNotify)g_variant_unref);
  for (size_t i = 0; i < n; i++) {
    opc_column *c = &list[i];
    GVariant *data;
    g_variant_get_child(columns, i, "(&sm&suiv)", &c->name, &c->unit, &c->type,
                        &c->decimals, &data);
    g_ptr_array_add(held, data);
    c->data = unpack_data(data, c->type, rows, texts);
  }
  const opc_host *host = step->binding->host;
  return host->table(host, name, flags, rows, list, n, sizeof *list, error);
}

static int publish_tables(const opc_flow_step *step, GVariant *tables,
                          opc_error *error) {
  GVariantIter all;
  const char *name;
  uint32_t flags;
  guint64 rows;
  GVariant *columns;
  int code = OPC_OK;
  g_variant_iter_init(&all, tables);
  while (!code && g_variant_iter_next(&all, "(&sut@a(smsuiv))", &name, &flags,
                                      &rows, &columns)) {
    code = publish_table(step, name, flags, rows, columns, error);
    g_variant_unref(columns);
  }
  return code;
}

static int publish_files(const opc_flow_step *step, GVariant *files,
                         int contents, opc_error *error) {
  const opc_host *host = step->binding->host;
  GVariantIter all;
  const char *name;
  guint64 size;
  int code = OPC_OK;
  g_variant_iter_init(&all, files);
  while (!code && g_variant_iter_next(&all, "(^&ayt)", &name, &size)) {
    const char *path = host->output_path(host, name, error);
    code = path ? opc_file_unpack(path, contents, size, error) : error->code;
  }
  return code;
}

void opc_messages_replay(opc_run *run, const opc_flow_step *step,
                         GVariant *messages) {
  GVariantIter all;
  guint level;
  const char *rest, *text;
  g_variant_iter_init(&all, messages);
  while (g_variant_iter_next(&all, "(u&s&s)", &level, &rest, &text)) {
    g_autofree char *path =
        g_strdup_printf("%s%s%s", step->name, *rest ? "." : "", rest);
    run->listener.watch.log(run, path, (int)level, text);
  }
}

int opc_result_publish(opc_run *run, const opc_flow_step *step,
                       GVariant *result, int contents, opc_error *error) {
  g_autoptr(GVariant) metrics = g_variant_get_child_value(result, 2);
  g_autoptr(GVariant) messages = g_variant_get_child_value(result, 3);
  g_autoptr(GVariant) tables = g_variant_get_child_value(result, 4);
  g_autoptr(GVariant) files = g_variant_get_child_value(result, 5);
  g_variant_get_child(result, 0, "d", &run->out.seconds[step->number]);
  g_variant_get_child(result, 1, "d", &run->out.processor[step->number]);
  opc_messages_replay(run, step, messages);
  int code = publish_files(step, files, contents, error);
  if (!code) code = publish_tables(step, tables, error);
  return code ? code : publish_metrics(step, metrics, error);
}
