/* SPDX-License-Identifier: BSD-3-Clause */
/* What the readers of layouts share: their parameters, the text of a file, its
   strings, and which of its cells are kept. */
#ifndef OPCFLOW_READ_READER_H
#define OPCFLOW_READ_READER_H

#include <eda/layout.h>
#include <opcflow/step.h>

/* The instance of a reader. */
typedef struct reader {
  const opc_host *host;
  const char *file;
  opc_map layers; /* name: what the file calls it */
  double scale;
  const char *top;
} reader;

/* The array's content, with what the file and the map of layers are. */
#define READ_PARAMETERS(file_summary, layers_summary)                 \
  {.name = "file",                                                    \
   .type = OPC_FILE,                                                  \
   .flags = OPC_REQUIRED,                                             \
   .summary = (file_summary),                                         \
   OPC_FIELD(reader, file)},                                          \
      {.name = "layers",                                              \
       .type = OPC_MAP,                                               \
       .summary = (layers_summary),                                   \
       OPC_FIELD(reader, layers)},                                    \
      {.name = "scale",                                               \
       .type = OPC_REAL,                                              \
       .flags = OPC_ABOVE,                                            \
       .preset = "1",                                                 \
       .min = 0,                                                      \
       .summary = "A factor on the unit of the file",                 \
       OPC_FIELD(reader, scale)},                                     \
  {                                                                   \
    .name = "top", .type = OPC_TEXT,                                  \
    .summary = "The top cell; those it does not lead to are dropped", \
    OPC_FIELD(reader, top)                                            \
  }

/* The text of the file, with a zero after its n bytes, freed with free(). */
int reader_load(const reader *r, char **text, size_t *n, opc_error *error);

/* n bytes as a string at `out`, which has room for 4 n + 1; bytes that are not
   printable ASCII as "\xE4", so that names stay different and harmless. */
void reader_string(const void *bytes, size_t n, char *out);

/* Of a file whose cells may be placed without being there. */
typedef struct cell_list {
  uint8_t *defined; /* of each cell of the layout */
  size_t n, room;
} cell_list;

/* A cell's definition begins: its number, *left_out where it is no part of the
   layout (KLayout's notes to itself). -1 and *error on failure; if there was
   one already, error->code is OPC_INVALID, with a message that lacks the
   place. */
int32_t cell_list_begin(cell_list *cells, eda_layout *layout, const char *name,
                        int *left_out, opc_error *error);

/* Once all is read: tell which cells are placed and not there; they stay
   empty, as in other readers. */
void cell_list_warn(const cell_list *cells, const reader *r,
                    const eda_layout *layout);

/* Keep what the cell `top` leads to, which is one of `cells` if these are not
   NULL; where it is not given, what `otherwise` leads to (-1: all). */
int reader_keep(const reader *r, eda_layout *layout, const cell_list *cells,
                int32_t otherwise, opc_error *error);

#endif
