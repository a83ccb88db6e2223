/* SPDX-License-Identifier: BSD-3-Clause */
/* A foundry's library of models: sections (corners) of subcircuits and model
   cards, often binned, cut down to what one device needs, so that a deck of it
   is small. */
#ifndef EDA_MODELS_H
#define EDA_MODELS_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_models eda_models;

/* Sizes, nm. */
typedef struct eda_sizes {
  double length[2], width[2]; /* from, to */
} eda_sizes;

enum { EDA_MODEL_CARD = 1, EDA_MODEL_SUBCIRCUIT = 2 };

/* Read a file and what it includes, which must lie in its folder or below;
   `section` NULL: what stands outside of all sections. `osdi`: a file of
   compiled models (a shared object of the Open Source Device Interface) that
   its cards are of; NULL: none. What is no part of a circuit is refused as
   eda_spice_run does, and a name that no deck can have. Statistical functions
   (agauss, gauss, aunif, unif) have their nominal value: nothing is drawn by
   lot. NULL and *error on failure. [any] */
OPC_EXPORT eda_models *eda_models_read(const char *path, const char *section,
                                       const char *osdi, opc_error *error);
OPC_EXPORT void eda_models_free(eda_models *models);

/* What a name is: one of the kinds above, 0 if it is not there. [any] */
OPC_EXPORT int eda_models_kind(const eda_models *models, const char *name);

/* What the number 1 means as a length of its devices, nm, by `.option scale`:
   1e9 where there is none. [any] */
OPC_EXPORT double eda_models_unit(const eda_models *models);

/* Of the next two, `name` may be several with blanks between. */

/* The sizes that a device's model cards hold for, from the smallest bin to the
   largest: 1; 0 if they are not binned. [any] */
OPC_EXPORT int eda_models_bins(const eda_models *models, const char *name,
                               eda_sizes *out);

/* The statements that a device of some sizes needs, one a line, for a deck of
   eda_spice_run, with the file of compiled models; of binned models those whose
   bins touch the sizes, the outermost ones made to reach as far if `extend`. To
   be freed with free(). [any] */
OPC_EXPORT char *eda_models_cut(const eda_models *models, const char *name,
                                const eda_sizes *sizes, int extend);

#ifdef __cplusplus
}
#endif
#endif
