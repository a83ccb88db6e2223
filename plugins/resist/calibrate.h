/* SPDX-License-Identifier: BSD-3-Clause */
/* Common part of resist models: the parameters of a layer, and coefficients
   that are fitted so that lines print to their widths.

   A resist has a threshold field, the sum of coefficient[k] * term[k]. Term 0
   is the constant 1; the other terms are fields computed from the image. A dark
   feature prints where the image is below the threshold, a bright feature where
   the image is above the threshold. */
#pragma once

#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <opcflow/follow.h>

/* ---- a layer ---- */

/* Number of sets of parameters: set 0 for poly and all layers after active, set
   1 for active. */
enum { RESIST_SETS = 2 };
static inline int resist_set(int layer) { return layer == EDA_ACTIVE; }

/* Drawn width, pitch (0: isolated) and printed width of a line, nm. */
typedef struct resist_line {
  double line, pitch, cd;
} resist_line;

/* Parameters of a layer, and the result of their check. */
typedef struct resist_layer {
  /* Line that must print to the width `cd`. NAN: the value is not given. */
  resist_line anchor;
  /* Gates that define values of the anchor that are not given. `gates`:
     parameter anchor.gates; `drawn`: gates of the simulating step. Both may be
     NULL. */
  const eda_gates *gates, *drawn;
  int gates_given;
  int logged; /* 1: the anchor, or a warning about the anchor, was logged */
  opc_reals table;
  int table_given;
  const char *file; /* CSV file of the table, or NULL */
  int bright;       /* 1: bright features print */

  /* The members below are set by resist_layer_check. */
  int set;
  const char *source; /* name of the parameter that defines the lines */
  resist_line *lines; /* [count], the anchor, or the rows of the table */
  size_t count;
} resist_layer;

/* First member of the instance of every resist. */
typedef struct resist_base {
  const opc_host *host;
  double diffusion; /* standard deviation of the Gaussian blur of the image,
                       nm; NAN until resist_set_diffusion: not given */
  resist_layer layer[RESIST_SETS];
} resist_base;

/* clang-format off */
/* Parameters of a set of layers. `prefix`: "" for poly, "active_" for active.
   `what`: names of the layers. line_default and pitch_default: RESIST_LINE and
   RESIST_PITCH, or RESIST_WIDE and RESIST_ALONE. */
#define RESIST_LINE .follows = "the shortest gate drawn"
#define RESIST_PITCH .follows = "the pitch of the shortest gates"
#define RESIST_WIDE .follows = "3.886 lambda/NA, a wide line"
#define RESIST_ALONE .preset = "0 nm"
#define RESIST_LAYER(set, prefix, what, line_default, pitch_default)          \
  {.name = prefix "anchor.line", .type = OPC_REAL, .flags = OPC_ABOVE,        \
   .unit = "nm", line_default,                                                \
   .summary = "drawn width of the line of " what " that prints to size",      \
   OPC_FIELD(resist_base, layer[set].anchor.line)},                           \
  {.name = prefix "anchor.pitch", .type = OPC_REAL, .flags = OPC_AT_LEAST,    \
   .unit = "nm", pitch_default,                                               \
   .summary = "pitch of the anchor line; 0 nm: isolated line",                \
   OPC_FIELD(resist_base, layer[set].anchor.pitch)},                          \
  {.name = prefix "anchor.cd", .type = OPC_REAL, .flags = OPC_ABOVE,          \
   .unit = "nm",                                                              \
   .summary = "wanted printed width; default: the drawn width",               \
   OPC_FIELD(resist_base, layer[set].anchor.cd)},                             \
  {.name = prefix "table", .type = OPC_REALS, .unit = "nm",                   \
   .summary = "pitch and printed width of each line that replaces the anchor",\
   OPC_FIELD(resist_base, layer[set].table),                                  \
   .given = offsetof(resist_base, layer[set].table_given)},                   \
  {.name = prefix "table_file", .type = OPC_FILE,                             \
   .summary = "CSV file of printed widths: columns 'pitch', 'cd' and, for "   \
              "several lines, 'line', in nm",                                 \
   OPC_FIELD(resist_base, layer[set].file)},                                  \
  {.name = prefix "tone", .type = OPC_CHOICE, .preset = "dark",               \
   .choices = "dark|bright",                                                  \
   .summary = "features of " what " that print: dark or bright features of the image",              \
   OPC_FIELD(resist_base, layer[set].bright)}
/* clang-format on */

/* Parameter of the gates that define the anchor of poly. */
#define RESIST_GATES                                                        \
  OPC_PARAMETER_NAMED("anchor.gates", resist_base, layer[0].gates,          \
                      .type = OPC_INPUT, .choices = "gates",                \
                      .given = offsetof(resist_base, layer[0].gates_given), \
                      .summary =                                            \
                          "transistors that define missing values of the "  \
                          "anchor: line and pitch of the shortest gates")

#define RESIST_DIFFUSION                                               \
  OPC_PARAMETER(                                                       \
      resist_base, diffusion, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
      .unit = "nm", .min = 0, .follows = "0 nm, with a finding",       \
      .summary =                                                       \
          "standard deviation of the Gaussian that blurs the image; "  \
          "0: no diffusion, although every resist has some")

#define RESIST_POLY "poly and layers after active"

#define RESIST_METRICS                                        \
  {"anchor_line", "nm", OPC_NEUTRAL, 0,                       \
   "drawn width of the line used for calibration"},           \
  {                                                           \
    "anchor_pitch", "nm", OPC_NEUTRAL, 0,                     \
        "pitch of the line used for calibration; 0: isolated" \
  }

/* Check the values of a layer; call from opc_plugin.check. Return OPC_OK or an
   error. */
int resist_layer_check(resist_layer *layer, int set, opc_error *error);

/* Set a diffusion that is not given to 0, and report that as a finding in the
   name of plugin `id`. Call first in eda_resist.prepare. [main] */
static inline void resist_set_diffusion(resist_base *resist, const char *id) {
  if (!isnan(resist->diffusion)) return;
  resist->diffusion = 0;
  resist->host->log(resist->host, OPC_LOG_FINDING,
                    "%s: 'diffusion' is not set, so the image is not blurred, "
                    "although every resist blurs the image: set the diffusion "
                    "of the resist, or 'diffusion: 0 nm'",
                    id);
}

/* Implement eda_resist.drawn. */
void resist_take_gates(void *self, const eda_gates *gates);

/* Implement opc_plugin.clear for resists without further data. */
void resist_clear(void *self);

/* Return 1 if a table is given. */
int resist_layer_has_table(const resist_layer *layer);

/* ---- the fit ---- */

/* Largest number of terms. */
enum { RESIST_TERMS = 4 };

/* Compute the fields of terms 1 .. n - 1 of an image. Return OPC_OK or an
   error. */
typedef int resist_terms(const resist_base *resist, const eda_field *image,
                         size_t n, eda_field *out, opc_error *error);

/* Fit coefficients of a set of layers by least squares of the errors of printed
   widths (Gauss-Newton). If fit[k], k < n, is 1, coefficient k is fitted; if it
   is 0, the coefficient keeps its value. `terms` may be NULL if n is 1. Read
   the table file. Log each line of a table in the name of plugin `id`. Return
   OPC_OK or an error. [main] */
int resist_fit(resist_base *resist, int set, const opc_module *litho,
               const char *id, resist_terms *terms, size_t n, const int *fit,
               double *coefficient, opc_error *error);

/* ---- printed image ---- */

/* Convert the blurred image of a layer in place to its level set: positive
   where a feature prints. The threshold is `constant` plus, if `variable` is
   not NULL, the values of the field `variable`, which has the same grid. */
void resist_print(const resist_base *resist, int layer, double constant,
                  const eda_field *variable, eda_field *field);
