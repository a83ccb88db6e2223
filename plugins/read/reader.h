/* SPDX-License-Identifier: BSD-3-Clause */
/* What the readers of layouts share: their parameters, the bytes of a file, the
   first failure, and the layers and cells that the layout gets. */
#ifndef OPCFLOW_READ_READER_H
#define OPCFLOW_READ_READER_H

#include <eda/layout.h>
#include <glib.h>
#include <opcflow/choices.h>
#include <opcflow/step.h>

/* The instance of a reader. */
typedef struct reader {
  const opc_host *host;
  const char *file;
  opc_map layers; /* name: what the file calls it */
  double scale;
  const char *top;
  const char *optional; /* names of `layers` with blanks between, or NULL */
} reader;

/* The array's content, with what the file and the map of layers are. */
#define READ_PARAMETERS(file_summary, layers_summary)                    \
  OPC_PARAMETER(reader, file, .type = OPC_FILE, .flags = OPC_REQUIRED,   \
                .summary = (file_summary)),                              \
      OPC_PARAMETER(reader, layers, .type = OPC_MAP,                     \
                    .summary = (layers_summary)),                        \
      OPC_PARAMETER(reader, optional, .type = OPC_TEXT,                  \
                    .summary =                                           \
                        "those of `layers`, with blanks between, "       \
                        "that the file need not have"),                  \
      OPC_PARAMETER(reader, scale, .type = OPC_REAL, .flags = OPC_ABOVE, \
                    .preset = "1", .min = 0,                             \
                    .summary = "A factor on the unit of the file"),      \
      OPC_PARAMETER(reader, top, .type = OPC_TEXT, .flags = OPC_LISTED,  \
                    .summary =                                           \
                        "The top cell; those it does not lead to "       \
                        "are dropped")

/* Whether the map of layers can be understood: names of the file or, where
   `most` is not 0, numbers up to that. For a reader's check. */
int reader_check(const reader *r, uint32_t most, opc_error *error);

/* A reader's `choices`: the cells of its file, as `run` reads it. */
int reader_choices(void *self, const opc_step *functions,
                   void (*take)(void *data, const char *value), void *data,
                   opc_error *error);

/* n bytes as a string, freed with g_free; bytes that are not printable ASCII as
   "\xE4", so that names stay different and harmless. */
char *reader_string(const void *bytes, size_t n);

/* A layer of a numbered format. */
typedef struct layer_node {
  uint64_t code;  /* layer << 32 | datatype, the key */
  int32_t number; /* in the layout */
} layer_node;

/* A file on its way into a layout. The state of each reader begins with one.
   The first failure is kept: what comes after it changes neither the error nor
   the outcome, and only what the file counts need look at `failed`. */
typedef struct reading {
  const reader *r;
  opc_error *error;
  int failed;         /* the code of the failure */
  const char *format; /* that the reader reads */
  /* Fail, if nothing did yet: OPC_IO, with the place in the file. */
  void (*refuse)(void *reading, const char *what);

  char *bytes;      /* of the file */
  const char *text; /* the same n bytes */
  size_t n, told;   /* from which byte on there is progress to tell */

  eda_layout *layout;
  opc_error said; /* for calls of the layout */
  int32_t cell;   /* where elements go; -1: nowhere */
  int32_t top;    /* what is kept if the flow does not say; -1: all */
  GArray *there;  /* of each cell: whether it is; NULL: all are */

  uint8_t *seen;      /* of each pair of the map of layers: in the file */
  GHashTable *layers; /* of layer_node: those of a numbered format */
  const layer_node *last;
} reading;

/* The run of a reader: open the file, `read` it, and do what the parameters
   ask of the whole. */
int reading_run(void *state, void *self, void **outputs, opc_error *error,
                void (*read)(void *state));

/* The byte `at` is reached: show it to the user if `show`. 0 after a failure,
   as when the user stops the work. */
int reading_goes_on(reading *b, size_t at, int show);

/* What the layout said: a refusal, in b->said, is one of the file. Whether
   there was no failure so far; the number of a cell or layer. */
int reading_told(reading *b, int code);
int32_t reading_number(reading *b, int32_t number);

/* The layout's layer for one of the file, made if new; -1 after a failure. */
int32_t reading_named_layer(reading *b, const char *name);
int32_t reading_numbered_layer(reading *b, uint32_t layer, uint32_t datatype);

/* Unpack the bytes that were read if gzip has packed them. */
void reading_unzip(reading *b);

/* A cell's definition begins in a file whose cells may be placed without being
   there: that is b->cell, -1 for one that is no part of the layout (KLayout's
   notes to itself). */
void reading_begin_cell(reading *b, const char *name);

#endif
