/* SPDX-License-Identifier: BSD-3-Clause */
#include "cells.h"

#include <stdlib.h>
#include <string.h>

#define CONTEXT_CELL "$$$CONTEXT_INFO$$$"

void cell_list_clear(cell_list *cells) {
  free(cells->defined);
  *cells = (cell_list){0};
}

/* Room for `n` cells in all. */
static int reach(cell_list *cells, size_t n) {
  if (n > cells->room) {
    size_t wanted = n + n / 2 + 16;
    uint8_t *memory = realloc(cells->defined, wanted);
    if (!memory) return 0;
    cells->defined = memory;
    cells->room = wanted;
  }
  if (n > cells->n) {
    memset(cells->defined + cells->n, 0, n - cells->n);
    cells->n = n;
  }
  return 1;
}

int32_t cell_list_begin(cell_list *cells, const opc_host *host,
                        opc_layout *layout, const char *name, int *left_out,
                        opc_error *error) {
  *left_out = !strcmp(name, CONTEXT_CELL);
  if (*left_out) return 0;
  int32_t cell = host->layout->cell(layout, name, error);
  if (cell < 0) return -1;
  if (!reach(cells, (size_t)cell + 1)) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return -1;
  }
  if (cells->defined[cell]) {
    host->fail(host, error, OPC_INVALID, NULL, "cell '%.200s' a second time",
               name);
    return -1;
  }
  cells->defined[cell] = 1;
  return cell;
}

void cell_list_warn(const cell_list *cells, const opc_host *host,
                    const opc_layout *layout, const char *path) {
  const opc_layout_service *l = host->layout;
  size_t missing = 0;
  int32_t first = -1;
  for (size_t i = l->cells(layout); i-- > 0;)
    if (i >= cells->n || !cells->defined[i]) {
      missing++;
      first = (int32_t)i;
    }
  if (missing)
    host->log(host, OPC_LOG_WARNING,
              "'%s': %zu placed cells are not there and taken as empty, "
              "the first '%.200s'",
              path, missing, l->cell_name(layout, first));
}

int cell_list_keep(const cell_list *cells, const opc_host *host,
                   opc_layout *layout, const opc_value *top, const char *path,
                   opc_error *error) {
  if (top->type == OPC_ABSENT) return OPC_OK;
  int32_t cell = host->layout->find_cell(layout, top->text);
  if (cell < 0 || (size_t)cell >= cells->n || !cells->defined[cell])
    return host->fail(host, error, OPC_INVALID, "top",
                      "'%s': there is no cell '%s'", path, top->text);
  return host->layout->keep(layout, cell, error);
}

void cell_list_string(const uint8_t *bytes, size_t n, char *out) {
  static const char hex[] = "0123456789ABCDEF";
  for (size_t i = 0; i < n; i++) {
    if (bytes[i] >= 0x20 && bytes[i] < 0x7f) {
      *out++ = (char)bytes[i];
      continue;
    }
    *out++ = '\\';
    *out++ = 'x';
    *out++ = hex[bytes[i] >> 4];
    *out++ = hex[bytes[i] & 15];
  }
  *out = '\0';
}
