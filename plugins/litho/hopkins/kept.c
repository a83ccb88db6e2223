/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements a process-wide cache of kernels for instances with equal
   optics. */
#include "kept.h"

#include <eda/memory.h>
#include <pthread.h>
#include <string.h>

/* Number of unused kernels kept, at most 5 MB each. A correction uses two, for
   its fast and its accurate simulations; process corners use more. */
enum { MOST_IDLE = 16 };

struct kept {
  kept_key key;
  kernels *kernels;
  double error;
  int users;
  kept *next; /* list of all entries, last used first */
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static kept *all;

/* Return whether two keys are equal to the bit. */
static int kept_is_same(const kept_key *a, const kept_key *b) {
  uint64_t x[sizeof *a / sizeof(uint64_t)], y[sizeof *a / sizeof(uint64_t)];
  memcpy(x, a, sizeof x);
  memcpy(y, b, sizeof y);
  return !memcmp(x, y, sizeof x);
}

/* Return the entry of a key and move the entry to the front of the list. The
   caller holds the lock. */
static kept *find(const kept_key *key) {
  for (kept **at = &all; *at; at = &(*at)->next) {
    kept *k = *at;
    if (!kept_is_same(&k->key, key)) continue;
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
static void prune(int most) {
  for (kept **at = &all; *at;) {
    kept *k = *at;
    if (k->users || most-- > 0) {
      at = &k->next;
      continue;
    }
    *at = k->next;
    k->kernels->free(k->kernels);
    free(k);
  }
}

kept *kept_find(const kept_key *key) {
  pthread_mutex_lock(&lock);
  kept *k = find(key);
  pthread_mutex_unlock(&lock);
  return k;
}

kept *kept_put(const kept_key *key, kernels *made, double error) {
  pthread_mutex_lock(&lock);
  kept *k = find(key);
  if (k) {
    made->free(made);
  } else {
    k = eda_alloc(1, sizeof *k);
    *k = (kept){*key, made, error, 1, all};
    all = k;
  }
  pthread_mutex_unlock(&lock);
  return k;
}

kernels *kept_kernels(const kept *k, double *error) {
  *error = k->error;
  return k->kernels;
}

void kept_drop(kept *k) {
  pthread_mutex_lock(&lock);
  k->users--;
  prune(MOST_IDLE);
  pthread_mutex_unlock(&lock);
}

/* Free the cache when the plugin is unloaded. */
__attribute__((destructor)) static void forget(void) { prune(0); }
