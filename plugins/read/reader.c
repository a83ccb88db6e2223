/* SPDX-License-Identifier: BSD-3-Clause */
/* What the readers of layouts share; compiled into each of them. */
#include "reader.h"

#include <eda/memory.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define CONTEXT_CELL "$$$CONTEXT_INFO$$$"

int reader_load(const reader *r, char **text, size_t *n, opc_error *error) {
  FILE *file = fopen(r->file, "rb");
  size_t room = 0, got;
  if (!file)
    return opc_fail(error, OPC_IO, NULL, "'%s': %s", r->file, strerror(errno));
  *n = 0;
  do {
    eda_grow(text, &room, *n + 65536, 1);
    got = fread(*text + *n, 1, room - *n - 1, file);
    *n += got;
  } while (got);
  (*text)[*n] = '\0';
  int code = OPC_OK;
  if (ferror(file))
    code = opc_fail(error, OPC_IO, NULL, "'%s': %s", r->file, strerror(errno));
  fclose(file);
  return code;
}

void reader_string(const void *bytes, size_t n, char *out) {
  static const char hex[] = "0123456789ABCDEF";
  const uint8_t *from = bytes;
  for (size_t i = 0; i < n; i++) {
    if (from[i] >= 0x20 && from[i] < 0x7f) {
      *out++ = (char)from[i];
      continue;
    }
    *out++ = '\\';
    *out++ = 'x';
    *out++ = hex[from[i] >> 4];
    *out++ = hex[from[i] & 15];
  }
  *out = '\0';
}

/* Room for `n` cells in all. */
static void reach(cell_list *cells, size_t n) {
  eda_grow(&cells->defined, &cells->room, n, 1);
  if (n > cells->n) {
    memset(cells->defined + cells->n, 0, n - cells->n);
    cells->n = n;
  }
}

int32_t cell_list_begin(cell_list *cells, eda_layout *layout, const char *name,
                        int *left_out, opc_error *error) {
  *left_out = !strcmp(name, CONTEXT_CELL);
  if (*left_out) return 0;
  int32_t cell = eda_layout_cell(layout, name, error);
  if (cell < 0) return -1;
  reach(cells, (size_t)cell + 1);
  if (cells->defined[cell]) {
    opc_fail(error, OPC_INVALID, NULL, "cell '%.200s' a second time", name);
    return -1;
  }
  cells->defined[cell] = 1;
  return cell;
}

void cell_list_warn(const cell_list *cells, const reader *r,
                    const eda_layout *layout) {
  size_t missing = 0;
  int32_t first = -1;
  for (size_t i = eda_layout_cells(layout); i-- > 0;)
    if (i >= cells->n || !cells->defined[i]) {
      missing++;
      first = (int32_t)i;
    }
  if (missing)
    r->host->log(r->host, OPC_LOG_WARNING,
                 "'%s': %zu placed cells are not there and taken as empty, "
                 "the first '%.200s'",
                 r->file, missing, eda_layout_cell_name(layout, first));
}

int reader_keep(const reader *r, eda_layout *layout, const cell_list *cells,
                int32_t otherwise, opc_error *error) {
  int32_t cell = r->top ? eda_layout_find_cell(layout, r->top) : otherwise;
  if (r->top && (cell < 0 || (cells && ((size_t)cell >= cells->n ||
                                        !cells->defined[cell]))))
    return opc_fail(error, OPC_INVALID, "top", "'%s': there is no cell '%s'",
                    r->file, r->top);
  return cell < 0 ? OPC_OK : eda_layout_keep(layout, cell, error);
}
