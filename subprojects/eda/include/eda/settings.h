/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kind "settings": a figure at each combination of the
   values of some parameters, as the step `search` looks for its best. */
#ifndef EDA_SETTINGS_H
#define EDA_SETTINGS_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A parameter that is varied. */
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
  size_t count;            /* combinations; the last parameter changes first */
  const double *figure;    /* of each; NAN where there is none */
  const char *name, *unit; /* of the figure; unit may be NULL */
  size_t best;             /* which one */
} eda_settings;

/* Settings of so many parameters.*/
OPC_EXPORT eda_settings *eda_settings_new(size_t n_parameters);

/* Say what parameter i is; all is copied. `values` may be NULL. */
OPC_EXPORT void eda_settings_parameter(eda_settings *settings, size_t i,
                                       const char *name, const char *unit,
                                       size_t count, const double *values,
                                       const char *const *texts);

/* Say what the figure is, once all parameters are there; copied. */
OPC_EXPORT void eda_settings_figure(eda_settings *settings, const char *name,
                                    const char *unit, const double *figure,
                                    size_t best);

/* Frees it with all arrays; an object of the data kind "settings". */
OPC_EXPORT void eda_settings_free(void *settings);
OPC_EXPORT int eda_settings_check(const void *settings, opc_error *error);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_SETTINGS(port)                                    \
  {                                                                \
    .name = port, .kind = "settings", .check = eda_settings_check, \
    .release = eda_settings_free                                   \
  }

#ifdef __cplusplus
}
#endif
#endif
