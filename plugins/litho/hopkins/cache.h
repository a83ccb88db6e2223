/* SPDX-License-Identifier: BSD-3-Clause */
/* Cache of kernels for instances with equal optics, also across the lifetime of
   instances: a process that makes many instances (experiment, search, sweep)
   computes kernels once. Holds only radial kernels without aberrations, which
   follow from a few numbers. All functions are [any]. */
#pragma once

#include "kernels.h"

/* All inputs of kernels and of their error. Zero the struct first: keys are
   compared by bytes. */
typedef struct cache_key {
  double wavelength, na, index, resist_index, sigma, sigma_in;
  double defocus, aside; /* nm: of the optics, and of the image */
  double wanted;
  int64_t fixed;
  int64_t source, polarisation, real;
} cache_key;

typedef struct cache_entry cache_entry;

/* Return the entry of a key and add a user; NULL if there is none. */
cache_entry *cache_find(const cache_key *key);

/* Add settled kernels with their measured error to the cache and return the
   entry with one user. If another thread was faster, `made` is freed and the
   existing, equal entry returned. */
cache_entry *cache_add(const cache_key *key, kernels *made, double error);

kernels *cache_kernels(const cache_entry *k, double *error);

/* Remove a user from an entry. */
void cache_release(cache_entry *k);
