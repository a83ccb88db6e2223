/* SPDX-License-Identifier: BSD-3-Clause */
/* What resist models share: the parameters of a layer, and coefficients fitted
   so that lines print to their widths. Compiled into each plugin that uses it.

   A resist here is a threshold field, sum of coefficient[k] * term[k]; term 0
   is the constant 1, the others are fields made from the image. A feature
   prints where the image lies below it (or above it, for bright features). */
#ifndef OPCFLOW_RESIST_CALIBRATE_H
#define OPCFLOW_RESIST_CALIBRATE_H

#include <opcflow/gates.h>
#include <opcflow/litho.h>

/* ---- parameters of a layer ---- */

enum {
  RESIST_LINE,
  RESIST_PITCH,
  RESIST_CD,
  RESIST_TABLE,
  RESIST_TABLE_FILE,
  RESIST_TONE,
  RESIST_LAYER_PARAMETERS
};

/* They stand together and in that order. `prefix` is "" for poly. */
#define RESIST_LAYER(prefix, layer, line, pitch)                              \
  {.name = prefix "anchor.line",                                              \
   .type = OPC_REAL,                                                          \
   .flags = OPC_ABOVE,                                                        \
   .unit = "nm",                                                              \
   .preset = line,                                                            \
   .summary = "drawn width of the " layer " line that prints to size"},       \
      {.name = prefix "anchor.pitch",                                         \
       .type = OPC_REAL,                                                      \
       .flags = OPC_AT_LEAST,                                                 \
       .unit = "nm",                                                          \
       .preset = pitch,                                                       \
       .summary = "pitch of its grating; 0 nm for an isolated line"},         \
      {.name = prefix "anchor.cd",                                            \
       .type = OPC_REAL,                                                      \
       .flags = OPC_ABOVE,                                                    \
       .unit = "nm",                                                          \
       .summary = "printed width wanted; the drawn one if not given"},        \
      {.name = prefix "table",                                                \
       .type = OPC_REALS,                                                     \
       .unit = "nm",                                                          \
       .summary =                                                             \
           "printed widths of the anchor's line through pitch, in place "     \
           "of the anchor: [pitch, cd, ...]"},                                \
      {.name = prefix "table_file",                                           \
       .type = OPC_FILE,                                                      \
       .summary =                                                             \
           "the same from a CSV file, columns 'pitch', 'cd' and, for "        \
           "several lines, 'line', in nm"},                                   \
  {                                                                           \
    .name = prefix "tone", .type = OPC_CHOICE, .preset = "dark",              \
    .choices = "dark|bright",                                                 \
    .summary = "whether dark or bright features of the " layer " image print" \
  }

#define RESIST_DIFFUSION                                                 \
  {                                                                      \
    .name = "diffusion", .type = OPC_REAL, .flags = OPC_AT_LEAST,        \
    .unit = "nm", .preset = "0 nm", .min = 0,                            \
    .summary = "standard deviation of the Gaussian that blurs the image" \
  }

/* ---- what the flow says of a layer ---- */

typedef struct resist_line {
  double line, pitch, cd; /* nm; pitch 0: isolated */
} resist_line;

typedef struct resist_layer {
  const opc_host *host;
  const char *plugin; /* its id, for messages */
  int layer;          /* OPC_POLY, OPC_ACTIVE */
  int bright;
  const char *source; /* the parameter that the lines come from */
  const char *file;   /* NULL: none */
  double width;       /* of lines of the file, where it says none */
  resist_line *lines; /* the anchor, or the rows of the table */
  size_t count;
} resist_layer;

/* Read the values of a layer; code and *error if they do not make sense.
   Clear it in any case. [main] */
int resist_layer_create(resist_layer *out, const opc_host *host,
                        const char *plugin, int layer, const opc_value *values,
                        opc_error *error);
void resist_layer_clear(resist_layer *layer);

/* Was a table given? */
int resist_layer_has_table(const resist_layer *layer);

/* ---- the fit ---- */

enum { RESIST_TERMS = 4 };

typedef struct resist_model {
  const void *self;
  double diffusion; /* of the image, before all terms */
  /* Fields of terms 1 .. n - 1 of an image, from host->alloc. NULL for a model
     that has the constant only. */
  int (*terms)(const void *self, const opc_field *image, size_t n,
               opc_field *out, opc_error *error);
} resist_model;

/* Find the coefficients k < n with fit[k], of the others as they are: those
   with the least squares of the errors of printed widths (Gauss-Newton). Reads
   the layer's file. Logs each line of a table. [main] */
int resist_fit(resist_layer *layer, const opc_module *litho,
               const resist_model *model, size_t n, const int *fit,
               double *coefficient, opc_error *error);

#endif
