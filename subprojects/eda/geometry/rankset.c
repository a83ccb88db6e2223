/* SPDX-License-Identifier: BSD-3-Clause */
/* Ordered sets of ranks, stored as a hierarchy of bit arrays. */
#include <glib.h>

#include "geometry/scan.h"

void eda_rankset_init(eda_rankset *set, uint32_t n) {
  *set = (eda_rankset){0};
  size_t words = n;
  do {
    words = MAX(1, (words + 63) / 64);
    set->level[set->levels++] = g_new0(uint64_t, words);
  } while (words > 1);
}

void eda_rankset_clear(eda_rankset *set) {
  for (unsigned l = 0; l < set->levels; l++) g_free(set->level[l]);
  *set = (eda_rankset){0};
}

int eda_rankset_has(const eda_rankset *set, uint32_t r) {
  return (int)(set->level[0][r >> 6] >> (r & 63) & 1);
}

void eda_rankset_add(eda_rankset *set, uint32_t r) {
  for (unsigned l = 0; l < set->levels; l++) {
    uint64_t *word = &set->level[l][r >> 6];
    uint64_t was = *word;
    *word |= UINT64_C(1) << (r & 63);
    if (was) return;
    r >>= 6;
  }
}

void eda_rankset_remove(eda_rankset *set, uint32_t r) {
  for (unsigned l = 0; l < set->levels; l++) {
    uint64_t *word = &set->level[l][r >> 6];
    *word &= ~(UINT64_C(1) << (r & 63));
    if (*word) return;
    r >>= 6;
  }
}

/* Ascend to the first level with a later member in the same word, then descend
   to the smallest member. */
uint32_t eda_rankset_after(const eda_rankset *set, uint32_t r) {
  for (unsigned l = 0; l < set->levels; l++) {
    uint64_t word = set->level[l][r >> 6] & ~UINT64_C(1) << (r & 63);
    if (word) {
      r = (r & ~UINT32_C(63)) | (uint32_t)__builtin_ctzll(word);
      while (l--) r = r << 6 | (uint32_t)__builtin_ctzll(set->level[l][r]);
      return r;
    }
    r >>= 6;
  }
  return EDA_NO_RANK;
}

uint32_t eda_rankset_before(const eda_rankset *set, uint32_t r) {
  for (unsigned l = 0; l < set->levels; l++) {
    uint64_t word =
        set->level[l][r >> 6] & ((UINT64_C(1) << (r & 63)) - UINT64_C(1));
    if (word) {
      r = (r & ~UINT32_C(63)) | (63 - (uint32_t)__builtin_clzll(word));
      while (l--)
        r = r << 6 | (63 - (uint32_t)__builtin_clzll(set->level[l][r]));
      return r;
    }
    r >>= 6;
  }
  return EDA_NO_RANK;
}
