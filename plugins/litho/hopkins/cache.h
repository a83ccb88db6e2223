/* SPDX-License-Identifier: BSD-3-Clause */
/* Cache of kernels for instances with equal optics. Entries outlive instances:
   a process that makes many instances (experiment, search, sweep) computes
   kernels once. The cache contains only radial kernels without aberrations,
   because a few numbers determine them. All functions are [any]. */
#pragma once

#include "kernels.h"

/* All inputs of kernels and of their error. Zero the struct first: keys are
   compared by bytes. */
typedef struct cache_key {
  double wavelength, na, index, resist_index, sigma, sigma_in;
  double defocus, aside; /* defocus of the optics, and additional defocus, nm */
  double wanted;         /* requested error */
  int64_t fixed;         /* fixed number of kernels */
  int64_t source, polarisation, real;
} cache_key;

/* Kernels in the cache. */
typedef struct cache_entry cache_entry;

/* Return the entry of a key and add a user. Return NULL if the key has no
   entry. */
cache_entry *cache_find(const cache_key *key);

/* Add settled kernels (kernels.settle) and their measured error to the cache,
   and return the entry with one user. If another thread has added the key, free
   `made` and return the existing, equal entry. */
cache_entry *cache_add(const cache_key *key, kernels *made, double error);

/* Return the kernels of an entry, and in *error their image error. */
kernels *cache_kernels(const cache_entry *k, double *error);

/* Remove a user from an entry. */
void cache_release(cache_entry *k);
