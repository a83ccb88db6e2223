/* SPDX-License-Identifier: BSD-3-Clause */
/* A foundry's library of device models for SPICE: sections (corners) of
   subcircuits and model cards, often in bins for ranges of sizes. The library
   is reduced to the statements that a device needs. [any]: see
   opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* A library in memory. */
typedef struct eda_models eda_models;

/* Ranges of sizes, nm. */
typedef struct eda_sizes {
  double length[2], width[2]; /* from, to */
} eda_sizes;

/* Forms of a device model in a library. */
enum { EDA_MODEL_CARD = 1, EDA_MODEL_SUBCIRCUIT = 2 };

/* Read a file and its includes, which must be in the file's folder or below.
   `section`: section to read; NULL: the part outside all sections. `osdi`: file
   of compiled models for the cards (shared object, Open Source Device
   Interface); NULL: none. Statements and names that eda_spice_run refuses are
   errors. Statistical functions (agauss, gauss, aunif, unif) receive the
   deviation 0, so that they have their nominal value. Return NULL and *error on
   failure. [any] */
OPC_EXPORT eda_models *eda_models_read(const char *path, const char *section,
                                       const char *osdi, opc_error *error);
/* Free a library (NULL: do nothing). */
OPC_EXPORT void eda_models_free(eda_models *models);

/* Return EDA_MODEL_CARD, EDA_MODEL_SUBCIRCUIT, or 0 for unknown names. [any] */
OPC_EXPORT int eda_models_kind(const eda_models *models, const char *name);

/* Return the unit of device sizes, nm, as set by `.option scale`; 1e9 (1 m)
   without that option. [any] */
OPC_EXPORT double eda_models_unit(const eda_models *models);

/* In the next two functions `name` may be several names separated by blanks. */

/* Compute the range of sizes that the bins of a device's model cards cover,
   including the cards that the device needs indirectly. Return 1, or 0 if no
   card is binned. [any] */
OPC_EXPORT int eda_models_bins(const eda_models *models, const char *name,
                               eda_sizes *out);

/* Return the statements, including `.osdi`, that a deck of eda_spice_run needs
   for devices of the given sizes, one per line. Binned models are reduced to
   the bins that touch the range of sizes; if `extend`, the outermost bins are
   enlarged to cover the range. The caller frees the text with free(). [any] */
OPC_EXPORT char *eda_models_cut(const eda_models *models, const char *name,
                                const eda_sizes *sizes, int extend);

OPC_C_END
