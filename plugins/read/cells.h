/* SPDX-License-Identifier: BSD-3-Clause */
/* The cells of a file that is being read: which are there, which are only
   placed; and its strings. Compiled into every reader of a numbered format. */
#ifndef OPCFLOW_READ_CELLS_H
#define OPCFLOW_READ_CELLS_H

#include <opcflow/opcflow.h>

typedef struct cell_list {
  uint8_t *defined; /* of each cell of the layout */
  size_t n, room;
} cell_list;

void cell_list_clear(cell_list *cells);

/* A cell's definition begins: its number, *left_out where it is no part of the
   layout (KLayout's notes to itself). -1 and *error on failure; if there was
   one already, error->code is OPC_INVALID, with a message that lacks the
   place. */
int32_t cell_list_begin(cell_list *cells, const opc_host *host,
                        opc_layout *layout, const char *name, int *left_out,
                        opc_error *error);

/* Once all is read: tell which cells are placed and not there; they stay
   empty, as in other readers. */
void cell_list_warn(const cell_list *cells, const opc_host *host,
                    const opc_layout *layout, const char *path);

/* Keep what the cell `top` leads to; all, if that is absent. */
int cell_list_keep(const cell_list *cells, const opc_host *host,
                   opc_layout *layout, const opc_value *top, const char *path,
                   opc_error *error);

/* n bytes as a string at `out`, which has room for 4 n + 1; bytes that are not
   printable ASCII as "\xE4", so that names stay different and harmless. */
void cell_list_string(const uint8_t *bytes, size_t n, char *out);

#endif
