/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels that instances with the same optics share, one after another, too: a
   process that makes many (an experiment, a search, a sweep of something else)
   finds them once. Only of radial kernels without aberrations, which follow
   from a few numbers. All functions are [any]. */
#ifndef OPCFLOW_HOPKINS_KEPT_H
#define OPCFLOW_HOPKINS_KEPT_H

#include "kernels.h"

/* All that kernels and their error follow from; made from zeros, as it is
   compared by its bytes. */
typedef struct kept_key {
  double wavelength, na, index, resist_index, sigma, sigma_in;
  double defocus, aside; /* nm: of the optics, and of the cut */
  double wanted;
  int64_t fixed;
  int64_t source, polarisation, real;
} kept_key;

typedef struct kept kept;

/* Those of a key, for one user more; NULL: nobody made them. */
kept *kept_find(const kept_key *key);

/* Let others use kernels that are settled, with their measured error. If
   somebody was faster, these are freed: they are the same. */
kept *kept_put(const kept_key *key, kernels *made, double error);

kernels *kept_kernels(const kept *k, double *error);

/* One user less. */
void kept_drop(kept *k);

#endif
