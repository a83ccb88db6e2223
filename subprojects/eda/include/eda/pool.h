/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory that is freed all at once, and maps from names to numbers in such
   memory. Names are compared without case, as in netlists. A pool is for one
   thread. */
#pragma once

#include <eda/memory.h>

OPC_C_BEGIN

/* A pool; all zeros is empty. */
typedef struct eda_pool {
  struct eda_pool_block *last;
  struct _GSList *tables; /* tables of all eda_names */
} eda_pool;

/* Return zeroed memory, never NULL, which lives until the pool is cleared. */
OPC_EXPORT void *eda_pool_alloc(eda_pool *pool, size_t count, size_t size);
/* Return a copy of n bytes with a terminating zero. */
OPC_EXPORT char *eda_pool_text(eda_pool *pool, const char *text, size_t n);
/* Return "b" or, if a is not empty, "a/b". */
OPC_EXPORT char *eda_pool_path(eda_pool *pool, const char *a, const char *b);
/* Enlarge *array, from the pool, with the capacity *room, to `need` elements;
   new elements are zeroed. */
OPC_EXPORT void eda_pool_grow(eda_pool *pool, void *array, size_t *room,
                              size_t need, size_t size);
OPC_EXPORT void eda_pool_clear(eda_pool *pool);

/* A map from names to numbers. All zeros except the pool is empty. Keys are not
   copied. */
typedef struct eda_names {
  eda_pool *pool;
  struct _GHashTable *table;
} eda_names;

/* Return the address of a key's value, which never moves; NULL if the key is
   missing. */
OPC_EXPORT uint32_t *eda_names_find(const eda_names *names, const char *key);
/* Return the address of a key's value; add a missing key with the value
   UINT32_MAX. */
OPC_EXPORT uint32_t *eda_names_add(eda_names *names, const char *key);

/* Return a hash of a name, without case. */
OPC_EXPORT uint64_t eda_name_hash(const char *name);
OPC_EXPORT int eda_same_name(const char *a, const char *b);
/* Return whether a list separated by blanks or commas (NULL: empty) contains
   the name. */
OPC_EXPORT int eda_in_list(const char *list, const char *name);

OPC_C_END
