/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements a process-wide cache of kernels for instances with equal
   optics. */
#include "cache.h"

#include <eda/memory.h>
#include <pthread.h>
#include <string.h>

/* Number of unused kernel sets that are kept, at most 5 MB each. A correction
   uses two sets, for fast and for accurate simulations; process corners use
   more. */
enum { MOST_IDLE = 16 };

struct cache_entry {
  cache_key key;
  kernels *kernels;
  double error;
  int users;
  cache_entry *next; /* list of all entries, last used first */
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static cache_entry *all;

/* Return 1 if two keys are bit-identical. */
static int key_is_same(const cache_key *a, const cache_key *b) {
  uint64_t x[sizeof *a / sizeof(uint64_t)], y[sizeof *a / sizeof(uint64_t)];
  memcpy(x, a, sizeof x);
  memcpy(y, b, sizeof y);
  return !memcmp(x, y, sizeof x);
}

/* Return the entry of a key with a user added, and move the entry to the front
   of the list. The caller holds the lock. */
static cache_entry *entries_find(const cache_key *key) {
  for (cache_entry **at = &all; *at; at = &(*at)->next) {
    cache_entry *k = *at;
    if (!key_is_same(&k->key, key)) continue;
    *at = k->next;
    k->next = all;
    all = k;
    k->users++;
    return k;
  }
  return NULL;
}

/* Free all unused kernels except the first `most`. The caller holds the
   lock. */
static void entries_prune(int most) {
  for (cache_entry **at = &all; *at;) {
    cache_entry *k = *at;
    if (k->users || most-- > 0) {
      at = &k->next;
      continue;
    }
    *at = k->next;
    k->kernels->free(k->kernels);
    free(k);
  }
}

cache_entry *cache_find(const cache_key *key) {
  pthread_mutex_lock(&lock);
  cache_entry *k = entries_find(key);
  pthread_mutex_unlock(&lock);
  return k;
}

cache_entry *cache_add(const cache_key *key, kernels *made, double error) {
  pthread_mutex_lock(&lock);
  cache_entry *k = entries_find(key);
  if (k) {
    made->free(made);
  } else {
    k = eda_alloc(1, sizeof *k);
    *k = (cache_entry){*key, made, error, 1, all};
    all = k;
  }
  pthread_mutex_unlock(&lock);
  return k;
}

kernels *cache_kernels(const cache_entry *k, double *error) {
  *error = k->error;
  return k->kernels;
}

void cache_release(cache_entry *k) {
  pthread_mutex_lock(&lock);
  k->users--;
  entries_prune(MOST_IDLE);
  pthread_mutex_unlock(&lock);
}

/* Free the cache when the plugin is unloaded. */
__attribute__((destructor)) static void cache_clear(void) { entries_prune(0); }
