/* SPDX-License-Identifier: BSD-3-Clause */
/* A foundry's model library: sections (corners) of subcircuits and model cards,
   often binned, reduced to the statements that one device needs, so that decks
   stay small. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

typedef struct eda_models eda_models;

/* Ranges of sizes, nm. */
typedef struct eda_sizes {
  double length[2], width[2]; /* from, to */
} eda_sizes;

enum { EDA_MODEL_CARD = 1, EDA_MODEL_SUBCIRCUIT = 2 };

/* Read a file and its includes, which must be in the file's folder or below.
   `section` NULL: the part outside of all sections. `osdi`: file of compiled
   models (a shared object of the Open Source Device Interface) for the cards;
   NULL: none. Statements that are not part of a circuit are refused as in
   eda_spice_run, also names that no deck can contain. Statistical functions
   (agauss, gauss, aunif, unif) return their nominal value. Return NULL and
   *error on failure. [any] */
OPC_EXPORT eda_models *eda_models_read(const char *path, const char *section,
                                       const char *osdi, opc_error *error);
OPC_EXPORT void eda_models_free(eda_models *models);

/* Return the kind of a name: one of the kinds above, 0 for an unknown name.
   [any] */
OPC_EXPORT int eda_models_kind(const eda_models *models, const char *name);

/* Return the length (nm) of the number 1 in sizes of the devices, as set by
   `.option scale`; 1e9 without one. [any] */
OPC_EXPORT double eda_models_unit(const eda_models *models);

/* In the next two functions `name` may be several names separated by blanks. */

/* Compute the range of sizes of a device's model cards, from the smallest to
   the largest bin. Return 1, or 0 if the cards are not binned. [any] */
OPC_EXPORT int eda_models_bins(const eda_models *models, const char *name,
                               eda_sizes *out);

/* Return the statements that a device of some sizes needs, one per line, for a
   deck of eda_spice_run, with the file of compiled models. For binned models:
   the cards whose bins touch the sizes; `extend` enlarges the outermost bins to
   cover the sizes. Free with free(). [any] */
OPC_EXPORT char *eda_models_cut(const eda_models *models, const char *name,
                                const eda_sizes *sizes, int extend);

OPC_C_END
