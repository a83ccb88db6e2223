/* SPDX-License-Identifier: BSD-3-Clause */
/* Pools of memory, which are freed as a whole, and maps from names to numbers.
   Names are compared without case, as in netlists. Only one thread at a time
   may use a pool and its maps. */
#pragma once

#include <eda/memory.h>

OPC_C_BEGIN

/* A pool; initialise it to zeros. */
typedef struct eda_pool {
  struct eda_pool_block *last;
  struct _GSList *tables; /* hash tables of the eda_names of this pool */
} eda_pool;

/* Return zeroed memory of count * size bytes, never NULL, valid until
   eda_pool_clear. */
OPC_EXPORT void *eda_pool_alloc(eda_pool *pool, size_t count, size_t size);
/* Return a copy of n bytes with a terminating zero. */
OPC_EXPORT char *eda_pool_text(eda_pool *pool, const char *text, size_t n);
/* Return the path "A/B" of the texts `a` and `b`; "B" if `a` is empty. */
OPC_EXPORT char *eda_pool_path(eda_pool *pool, const char *a, const char *b);
/* Enlarge *array, allocated from the pool, to at least `need` elements of
   `size` bytes and set *capacity. New elements are zeroed. */
OPC_EXPORT void eda_pool_grow(eda_pool *pool, void *array, size_t *capacity,
                              size_t need, size_t size);
/* Free all memory of a pool, and the tables of its maps. */
OPC_EXPORT void eda_pool_clear(eda_pool *pool);

/* A map from names to numbers. Before use, set `pool`, and set `table` to NULL.
   Keys are not copied and must outlive the map. */
typedef struct eda_names {
  eda_pool *pool;
  struct _GHashTable *table;
} eda_names;

/* Return the address of a key's value, which stays valid until the pool is
   cleared; NULL if the key is missing. */
OPC_EXPORT uint32_t *eda_names_find(const eda_names *names, const char *key);
/* Return the address of a key's value; add a missing key with the value
   UINT32_MAX. */
OPC_EXPORT uint32_t *eda_names_add(eda_names *names, const char *key);

/* Return a hash of a name; upper and lower case are equal. */
OPC_EXPORT uint64_t eda_name_hash(const char *name);
/* Return 1 if two names are equal apart from case, otherwise 0. */
OPC_EXPORT int eda_same_name(const char *a, const char *b);
/* Return 1 if a list separated by blanks or commas (NULL: empty) contains the
   name, otherwise 0. */
OPC_EXPORT int eda_in_list(const char *list, const char *name);

OPC_C_END
