/* SPDX-License-Identifier: BSD-3-Clause */
/* Functions that publish several metrics, or a table from an array of structs,
   in one call. [main]: see plugin.h. */
#ifndef OPCFLOW_TABLE_H
#define OPCFLOW_TABLE_H

#include <opcflow/plugin.h>
#include <stdlib.h>
#include <string.h>

OPC_C_BEGIN

/* Expands to an array and the number of its elements. */
#define OPC_ARRAY(array) (array), sizeof(array) / sizeof((array)[0])

/* ---- metrics ---- */

/* A metric with its value. If the name is NULL, the element is skipped. */
typedef struct opc_metric_value {
  const char *name;
  double value; /* in the unit of the declaration */
} opc_metric_value;

/* Publish metrics. Returns 0, or an error code with *error filled. Use: `return
   opc_put_metrics(host, OPC_ARRAY(values), error);` [main] */
OPC_UNUSED static int opc_put_metrics(const opc_host *host,
                                      const opc_metric_value *values, size_t n,
                                      opc_error *error) {
  int code = OPC_OK;
  size_t i;
  for (i = 0; i < n && !code; i++)
    if (values[i].name)
      code = host->metric(host, values[i].name, values[i].value, error);
  return code;
}

/* ---- tables ---- */

/* Publish a table by opc_host.table and return the status. [main] */
OPC_UNUSED static int opc_put_table(const opc_host *host, const char *name,
                                    uint32_t flags, size_t rows,
                                    const opc_column *columns, size_t n,
                                    opc_error *error) {
  return host->table(host, name, flags, rows, columns, n, sizeof *columns,
                     error);
}

/* Publish a table of `rows` structs of `size` bytes each and return the status.
   `data` of a column points to the member in the first struct. [main] */
OPC_UNUSED static int opc_put_rows(const opc_host *host, const char *name,
                                   uint32_t flags, size_t rows, size_t size,
                                   const opc_column *columns, size_t n,
                                   opc_error *error) {
  enum { CELL = 8 }; /* bytes of the largest cell type */
  opc_column *all = (opc_column *)malloc((n + 1) * sizeof *all);
  char *cells = (char *)malloc((n * rows + 1) * CELL);
  int code = OPC_FAILED;
  size_t k, i;
  for (k = 0; k < n && all && cells; k++) {
    const char *from = (const char *)columns[k].data;
    size_t bytes = columns[k].type == OPC_TEXT ? sizeof from : (size_t)CELL;
    char *to = cells + k * rows * CELL;
    for (i = 0; i < rows; i++) memcpy(to + i * bytes, from + i * size, bytes);
    all[k] = columns[k];
    all[k].data = to;
  }
  if (all && cells)
    code = opc_put_table(host, name, flags, rows, all, n, error);
  else
    opc_fail(error, OPC_FAILED, NULL, "table '%s': out of memory", name);
  free(all);
  free(cells);
  return code;
}

OPC_C_END
#endif
