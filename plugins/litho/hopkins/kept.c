/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps kernels for the next instance with the same optics. */
#include "kept.h"

#include <eda/memory.h>
#include <pthread.h>
#include <string.h>

/* Kernels that nobody uses at the moment: at most 5 MB each. A correction has
   two, of its cheap prints and of its fine ones; with corners some more. */
enum { MOST_IDLE = 16 };

struct kept {
  kept_key key;
  kernels *kernels;
  double error;
  int users;
  kept *next; /* of all, the last one that was used first */
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

/* With the lock held: the entry of a key, which comes to be the first. */
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

/* With the lock held: free all that nobody uses but the first so many. */
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

/* When the plugin is unloaded. */
__attribute__((destructor)) static void forget(void) { prune(0); }
