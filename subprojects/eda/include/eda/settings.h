/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind (opcflow/step.h) "settings", produced by the step `search`: a
   figure of merit for each combination of values of some parameters. All
   functions are [any] (opcflow/plugin.h). */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* A varied parameter. */
typedef struct eda_setting {
  const char *name;         /* "mask.synthesizer.fragment" */
  const char *unit;         /* NULL: no unit */
  size_t count;             /* number of values */
  const double *values;     /* values in this unit; NULL: the values are not
                               numbers */
  const char *const *texts; /* values as in the flow */
} eda_setting;

/* The data object: all combinations with their figures. */
typedef struct eda_settings {
  size_t n_parameters;
  const eda_setting *parameters;
  size_t count;            /* number of combinations; the last parameter varies
                              fastest */
  const double *figure;    /* figure of each combination; NAN: no result */
  const char *name, *unit; /* name and unit of the figure; unit may be NULL */
  size_t best;             /* index of the best combination */
} eda_settings;

/* Return settings with n_parameters empty parameters, which the next function
   sets. */
OPC_EXPORT eda_settings *eda_settings_new(size_t n_parameters);

/* Set parameter i to copies of these data. `values` may be NULL. */
OPC_EXPORT void eda_settings_parameter(eda_settings *settings, size_t i,
                                       const char *name, const char *unit,
                                       size_t count, const double *values,
                                       const char *const *texts);

/* Set the figure to copies of these data. Call this after all parameters. */
OPC_EXPORT void eda_settings_figure(eda_settings *settings, const char *name,
                                    const char *unit, const double *figure,
                                    size_t best);

/* Release and check functions of an output of the data kind "settings". */
OPC_EXPORT void eda_settings_free(void *settings);
OPC_EXPORT int eda_settings_check(const void *settings, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_SETTINGS(port)                                    \
  {                                                                \
    .name = port, .kind = "settings", .check = eda_settings_check, \
    .release = eda_settings_free                                   \
  }

OPC_C_END
