/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kind "settings": a figure for each combination of the values of
   some parameters, produced by the step `search`. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* A varied parameter. */
typedef struct eda_setting {
  const char *name; /* "mask.synthesizer.fragment" */
  const char *unit; /* NULL: plain numbers, or texts */
  size_t count;
  const double *values;     /* in that unit; NULL: not numbers */
  const char *const *texts; /* as written */
} eda_setting;

typedef struct eda_settings {
  size_t n_parameters;
  const eda_setting *parameters;
  size_t count;            /* number of combinations; the last parameter changes
                              first */
  const double *figure;    /* figure of each combination; NAN: none */
  const char *name, *unit; /* name and unit of the figure; unit may be NULL */
  size_t best;             /* number of the best combination */
} eda_settings;

/* Return settings of so many parameters. */
OPC_EXPORT eda_settings *eda_settings_new(size_t n_parameters);

/* Set parameter i; everything is copied. `values` may be NULL. */
OPC_EXPORT void eda_settings_parameter(eda_settings *settings, size_t i,
                                       const char *name, const char *unit,
                                       size_t count, const double *values,
                                       const char *const *texts);

/* Set the figure, after all parameters; copied. */
OPC_EXPORT void eda_settings_figure(eda_settings *settings, const char *name,
                                    const char *unit, const double *figure,
                                    size_t best);

/* Free settings with all arrays. An object of the data kind "settings". */
OPC_EXPORT void eda_settings_free(void *settings);
OPC_EXPORT int eda_settings_check(const void *settings, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_SETTINGS(port)                                    \
  {                                                                \
    .name = port, .kind = "settings", .check = eda_settings_check, \
    .release = eda_settings_free                                   \
  }

OPC_C_END
