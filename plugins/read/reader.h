/* SPDX-License-Identifier: BSD-3-Clause */
/* Common part of the readers of layouts: parameters, bytes of a file, first
   failure, and the layers and cells of the layout. */
#pragma once

#include <eda/layout.h>
#include <glib.h>
#include <opcflow/choices.h>
#include <opcflow/step.h>

/* The instance of a reading plugin. */
typedef struct reader {
  const opc_host *host;
  const char *file;
  opc_map layers; /* name of the layer -> layer in the file */
  double scale;
  const char *top;
  const char *optional; /* names of `layers` that the file may lack, separated
                           by blanks, or NULL */
} reader;

/* Parameters of a reader, with the summaries of the file and the layer map. */
#define READ_PARAMETERS(file_summary, layers_summary)                     \
  OPC_PARAMETER(reader, file, .type = OPC_FILE, .flags = OPC_REQUIRED,    \
                .summary = (file_summary)),                               \
      OPC_PARAMETER(reader, layers, .type = OPC_MAP,                      \
                    .summary = (layers_summary)),                         \
      OPC_PARAMETER(reader, optional, .type = OPC_TEXT,                   \
                    .summary =                                            \
                        "Names of `layers` that the file may lack, "      \
                        "separated by blanks"),                           \
      OPC_PARAMETER(reader, scale, .type = OPC_REAL, .flags = OPC_ABOVE,  \
                    .preset = "1", .min = 0,                              \
                    .summary = "Factor by which the unit is multiplied"), \
      OPC_PARAMETER(                                                      \
          reader, top, .type = OPC_TEXT, .flags = OPC_LISTED,             \
          .summary =                                                      \
              "Top cell; cells not reachable from the top cell are dropped")

/* Check the map of layers, as `check` of a reader. `most` is the largest layer
   number of the format, or 0 if the format has layer names. Return OPC_OK or an
   error. */
int reader_check(const reader *r, uint32_t most, opc_error *error);

/* Read the file with `run` and pass the name of each cell to `take`, as
   `choices` of a reader. */
int reader_choices(void *self,
                   int (*run)(void *self, void **outputs, opc_error *error),
                   void (*take)(void *data, const char *value), void *data,
                   opc_error *error);

/* Define the parameters and functions of a reader whose step runs `run_`.
   `most` as in reader_check. */
#define READER_FUNCTIONS(run_, most, file_summary, layers_summary)         \
  static const opc_parameter parameters[] = {                              \
      READ_PARAMETERS(file_summary, layers_summary)};                      \
  static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};        \
  static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run_, \
                                     .flags = OPC_STEP_LIGHT};             \
  static int format_check(void *self, opc_error *error) {                  \
    return reader_check(self, most, error);                                \
  }                                                                        \
  static int format_choices(void *self, const char *parameter,             \
                            void (*take)(void *data, const char *value),   \
                            void *data, opc_error *error) {                \
    (void)parameter;                                                       \
    return reader_choices(self, run_, take, data, error);                  \
  }                                                                        \
  static const void *format_extension(const char *name) {                  \
    static const opc_choices listed = {format_choices};                    \
    return strcmp(name, OPC_CHOICES) ? NULL : &listed;                     \
  }

/* The fields of a reader's OPC_PLUGIN besides its id and summary. */
#define READER_ENTRY                                                      \
  .kind = "step", .version = "0.2.0", .licence = "BSD-3-Clause",          \
  .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters), \
  .check = format_check, OPC_FUNCTIONS(functions),                        \
  .extension = format_extension

/* Return n bytes as a string. Bytes that are not printable ASCII become "\xE4",
   so that different names stay different. Free with g_free. */
char *reader_string(const void *bytes, size_t n);

/* A layer of a numbered format. */
typedef struct layer_node {
  uint64_t code;  /* key: layer << 32 | datatype */
  int32_t number; /* layer of the layout */
} layer_node;

/* State of a file being read: the first member of the state of each reader. The
   first failure is kept; later calls change neither the error nor the result.
   Only loops over counts from the file must check `failed`. */
typedef struct reading {
  const reader *r;
  opc_error *error;
  int failed;         /* code of the first failure */
  const char *format; /* format of the reader */
  /* Fail with OPC_IO and the place in the file, unless a failure exists. */
  void (*refuse)(void *reading, const char *what);

  int file;         /* descriptor, or -1 if `bytes` contains the whole file */
  char *bytes;      /* `held` bytes of the file from `start` on */
  const char *text; /* all bytes, after reading_text */
  size_t start, held, capacity;
  size_t n, next_progress; /* size; place of the next progress update */

  eda_layout *layout;
  opc_error layout_error; /* error set by functions of the layout */
  int32_t cell;           /* cell to which elements are added, or -1 */
  int32_t top;            /* top cell if the parameter `top` is not given; -1 to
                             keep all cells */
  GArray *there; /* for each cell, 1 if the file defines the cell; NULL in
                    formats that always define cells before their use */

  uint8_t *seen; /* for each pair of the map of layers, 1 if the file has the
                    layer */
  GHashTable *layers;     /* layer_node of each layer, for numbered formats */
  const layer_node *last; /* layer of the last element */
} reading;

/* Open the file, call `read`, and apply the parameters to the layout, as `run`
   of a reader. Return OPC_OK or an error. */
int reading_run(void *state, void *self, void **outputs, opc_error *error,
                void (*read)(void *state));

/* Check for cancellation and, if `show` is set, report progress up to byte
   `at`. Return 0 after a failure or cancellation. */
int reading_goes_on(reading *b, size_t at, int show);

/* reading_check: if `code` is not OPC_OK, fail with b->layout_error at the
   current place of the file; return 0 after a failure. reading_number: do the
   same if `number` is negative, and return `number`. */
int reading_check(reading *b, int code);
int32_t reading_number(reading *b, int32_t number);

/* Return the layout's layer for a layer of the file, created if necessary; -1
   after a failure. */
int32_t reading_named_layer(reading *b, const char *name);
int32_t reading_numbered_layer(reading *b, uint32_t layer, uint32_t datatype);

/* bytes.c: open the file; a gzip stream is decompressed into memory.
   reading_close frees the bytes. */
void reading_open(reading *b);
void reading_close(reading *b);

/* Return a second reading of the same bytes; valid until the first one is
   closed. Free `bytes` unless `file` is -1. */
reading reading_again(const reading *from, opc_error *error);

/* Move the window so that it begins at byte `at` and contains `want` bytes, or
   all up to the end of the file. */
void reading_load(reading *b, size_t at, size_t want);

/* Return the *got bytes from byte `at` on that are in memory: at least `want`,
   or all up to the end of the file; none after a failure. Valid until the next
   call. */
static inline const uint8_t *reading_view(reading *b, size_t at, size_t want,
                                          size_t *got) {
  size_t end = b->start + b->held;
  if (b->file >= 0 &&
      (at < b->start || at > end || (end - at < want && end < b->n)))
    reading_load(b, at, want);
  *got = b->start + b->held - at;
  if (b->failed) *got = 0;
  return (const uint8_t *)b->bytes + (at - b->start);
}

/* Set `text` to all bytes of the file. Return 0 after a failure. */
int reading_text(reading *b);

/* Start the definition of a cell, in formats that may place cells without
   definition. Sets b->cell; -1 for a cell that is not part of the layout
   (metadata of KLayout). */
void reading_begin_cell(reading *b, const char *name);
