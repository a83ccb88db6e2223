/* SPDX-License-Identifier: BSD-3-Clause */
/* Sites at which the edge placement errors of a layer's fragments are
   measured. */
#pragma once

#include <eda/synthesizer.h>

/* The sites of a layer, one for each fragment. */
typedef struct sites {
  size_t count;
  double *place; /* x and y of each site, nm */
  uint8_t *axis; /* axis of the normal: EDA_X, EDA_Y */
  int8_t *out;   /* outward direction along the axis, +1 or -1 */
  double *epe;   /* edge placement errors, nm; NAN: no edge within reach */
} sites;

/* Set up the sites of fragments from `cuts`, which eda_check_cuts accepted. */
OPC_EXPORT void correct_sites_init(sites *sites, const eda_cuts *cuts);
/* Free the arrays. */
OPC_EXPORT void correct_sites_clear(sites *sites);
/* Measure the edge placement errors from a level set, in parallel. `scanner`
   determines how far from a site the edge is searched. */
OPC_EXPORT void correct_sites_measure(const opc_context *context,
                                      const sites *sites,
                                      const eda_field *print,
                                      eda_scanner scanner);
