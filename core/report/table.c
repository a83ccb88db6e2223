/* SPDX-License-Identifier: BSD-3-Clause */
/* Copies tables and writes them as text. */
#include "core/report/table.h"

#include <base/sheet.h>
#include <base/unit.h>
#include <inttypes.h>
#include <string.h>

void *opc_table_add(opc_table *table, const char *name, const char *unit,
                    uint32_t type, int32_t decimals) {
  void *data = g_malloc0_n(table->rows + 1, 8);
  table->columns = g_renew(opc_column, table->columns, table->n_columns + 1);
  table->columns[table->n_columns++] =
      (opc_column){g_strdup(name), g_strdup(unit), type, decimals, data};
  return data;
}

opc_table *opc_table_new(const char *name, uint32_t flags, size_t rows,
                         const opc_column *columns, size_t n_columns,
                         size_t column_size, opc_error *error) {
  opc_table *table = g_new0(opc_table, 1);
  table->name = g_strdup(name);
  table->flags = flags;
  table->rows = rows;
  for (size_t i = 0; i < n_columns; i++) {
    opc_column own = {.name = NULL}, *c = &own;
    memcpy(c, (const char *)columns + i * column_size,
           MIN(column_size, sizeof own));
    if (!c->name || (rows && !c->data) ||
        (c->type != OPC_TEXT && c->type != OPC_REAL && c->type != OPC_INT)) {
      opc_fail(error, OPC_FAILED, NULL, "table '%s': column %zu is not valid",
               name, i + 1);
      opc_table_free(table);
      return NULL;
    }
    void *data = opc_table_add(table, c->name, c->unit, c->type, c->decimals);
    const char *const *texts = c->data;
    for (size_t k = 0; c->type == OPC_TEXT && k < rows; k++)
      ((char **)data)[k] = g_strdup(texts[k] ? texts[k] : "");
    if (c->type != OPC_TEXT && rows) memcpy(data, c->data, rows * 8);
  }
  return table;
}

void opc_table_free(opc_table *table) {
  if (!table) return;
  for (size_t i = 0; i < table->n_columns; i++) {
    opc_column *c = &table->columns[i];
    g_free((char *)c->name);
    g_free((char *)c->unit);
    if (c->type == OPC_TEXT)
      g_strfreev((char **)c->data);
    else
      g_free((void *)c->data);
  }
  g_free(table->columns);
  g_free(table->name);
  g_free(table->step);
  g_free(table);
}

const opc_column *opc_table_column(const opc_table *table, const char *name) {
  for (size_t i = 0; i < table->n_columns; i++)
    if (!strcmp(table->columns[i].name, name)) return &table->columns[i];
  return NULL;
}

char *opc_table_cell(const opc_column *c, size_t row) {
  switch (c->type) {
    case OPC_TEXT:
      return g_strdup(((const char *const *)c->data)[row]);
    case OPC_INT:
      return g_strdup_printf("%" PRId64, ((const int64_t *)c->data)[row]);
    default:
      return opc_number_fixed(((const double *)c->data)[row], c->decimals);
  }
}

static char *table_heading(const opc_column *c) {
  return c->unit && *c->unit ? g_strdup_printf("%s (%s)", c->name, c->unit)
                             : g_strdup(c->name);
}

/* Return the table as a sheet. Numbers of a column with `decimals` < 0 have all
   digits if `exact` is TRUE, else six. */
static opc_sheet *table_sheet(const opc_table *table, gboolean exact) {
  opc_sheet *s = opc_sheet_new(table->n_columns);
  for (size_t row = 0; row <= table->rows; row++)
    for (size_t i = 0; i < table->n_columns; i++) {
      const opc_column *c = &table->columns[i];
      gboolean brief = row && !exact && c->type == OPC_REAL && c->decimals < 0;
      s->left[i] = c->type == OPC_TEXT;
      g_ptr_array_add(s->cells,
                      !row ? table_heading(c)
                      : brief
                          ? opc_number_short(((const double *)c->data)[row - 1])
                          : opc_table_cell(c, row - 1));
    }
  return s;
}

char *opc_table_csv(const opc_table *table) {
  g_autoptr(opc_sheet) s = table_sheet(table, TRUE);
  return opc_sheet_csv(s);
}

char *opc_table_text(const opc_table *table, size_t width) {
  g_autoptr(opc_sheet) s = table_sheet(table, !width);
  return opc_sheet_text(s, width);
}

char *opc_table_markdown(const opc_table *table) {
  g_autoptr(opc_sheet) s = table_sheet(table, FALSE);
  return opc_sheet_markdown(s);
}
