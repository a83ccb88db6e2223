/* SPDX-License-Identifier: BSD-3-Clause */
/* Pseudo-random numbers, equal on all machines: splitmix64 (Steele, Lea, Flood,
   "Fast splittable pseudorandom number generators", OOPSLA 2014). */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

#define EDA_RANDOM_STEP 0x9e3779b97f4a7c15u /* the golden ratio times 2^64 */

/* Return a bijective hash of a number. [any]: see opcflow/plugin.h. */
OPC_UNUSED static inline uint64_t eda_random_mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* Return 64 random bits and advance *state, at first the seed. [any] */
OPC_UNUSED static inline uint64_t eda_random_draw(uint64_t *state) {
  return eda_random_mix(*state += EDA_RANDOM_STEP);
}

/* Return a uniform random number in [0, 1) and advance *state. [any] */
OPC_UNUSED static inline double eda_random_unit(uint64_t *state) {
  return (double)(eda_random_draw(state) >> 11) / 9007199254740992.0;
}

OPC_C_END
