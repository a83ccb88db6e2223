/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory that is freed all at once, and maps from names to numbers in it. Names
   are equal in any case, as those of netlists are. A pool is for one thread. */
#ifndef EDA_POOL_H
#define EDA_POOL_H

#include <eda/memory.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All zeros is an empty one. */
typedef struct eda_pool {
  struct eda_pool_block *last;
  struct _GSList *tables; /* of all eda_names */
} eda_pool;

/* Zeroed memory, never NULL; it lives until the pool is cleared. */
OPC_EXPORT void *eda_pool_alloc(eda_pool *pool, size_t count, size_t size);
/* A copy of n bytes with a zero behind them. */
OPC_EXPORT char *eda_pool_text(eda_pool *pool, const char *text, size_t n);
/* "b" or, if a is not empty, "a/b". */
OPC_EXPORT char *eda_pool_path(eda_pool *pool, const char *a, const char *b);
/* Room for `need` elements in *array, which comes from the pool and has *room;
   what is new is zeroed. */
OPC_EXPORT void eda_pool_grow(eda_pool *pool, void *array, size_t *room,
                              size_t need, size_t size);
OPC_EXPORT void eda_pool_clear(eda_pool *pool);

/* Names to numbers. All zeros but the pool is an empty one. Keys are not
   copied. */
typedef struct eda_names {
  eda_pool *pool;
  struct _GHashTable *table;
} eda_names;

/* The value of a key, NULL if it is not there. It stays at its place. */
OPC_EXPORT uint32_t *eda_names_find(const eda_names *names, const char *key);
/* That of a key that is put in if it is not there, with the value UINT32_MAX.
 */
OPC_EXPORT uint32_t *eda_names_add(eda_names *names, const char *key);

/* A name's number, which is that of all equal names and hardly of others. */
OPC_EXPORT uint64_t eda_name_hash(const char *name);
OPC_EXPORT int eda_same_name(const char *a, const char *b);
/* Whether a list with blanks or commas between (NULL: empty) has that name. */
OPC_EXPORT int eda_in_list(const char *list, const char *name);

#ifdef __cplusplus
}
#endif
#endif
