/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kind "settings", since 1.1: a figure at each combination of the
   values of some parameters, as the step `search` looks for its best. */
#ifndef OPCFLOW_SETTINGS_H
#define OPCFLOW_SETTINGS_H

#include <opcflow/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A parameter that is varied. Frozen. */
typedef struct opc_setting {
  const char *name;          /* "mask.synthesizer.fragment" */
  const char *unit;          /* NULL: plain numbers, or texts */
  size_t count;
  const double *values;      /* in that unit; NULL: not numbers */
  const char *const *texts;  /* as written */
} opc_setting;

typedef struct opc_settings {
  size_t size;               /* sizeof(opc_settings) */
  size_t n_parameters;
  const opc_setting *parameters;
  size_t count;              /* combinations; the last parameter changes first */
  const double *figure;      /* of each; NAN where there is none */
  const char *name, *unit;   /* of the figure; unit may be NULL */
  size_t best;               /* which one */
} opc_settings;

#ifdef __cplusplus
}
#endif
#endif
