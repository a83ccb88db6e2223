/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory that is freed all at once, and maps from names to numbers in it. */
#ifndef OPCFLOW_NETLIST_POOL_H
#define OPCFLOW_NETLIST_POOL_H

#include <stddef.h>
#include <stdint.h>

typedef struct pool_block pool_block;
typedef struct pool {
  pool_block *last;
} pool;

/* Zeroed; NULL if there is no memory. Memory for 0 things is there, too. */
void *pool_alloc(pool *p, size_t count, size_t size);
/* A copy of n bytes with a zero behind them. */
char *pool_text(pool *p, const char *text, size_t n);
/* "ab" or, if a is not empty, "a/b". */
char *pool_path(pool *p, const char *a, const char *b);
void pool_clear(pool *p);

/* Room for `need` things in *array, which comes from the pool. */
int pool_grow(pool *p, void *array, size_t *room, size_t need, size_t size);

/* Names in any case to numbers. Keys are not copied. */
typedef struct name_map {
  pool *pool;
  const char **key;
  uint32_t *value;
  size_t room, count; /* room is a power of two, or 0 */
} name_map;

/* The value of a key, NULL if it is not there. */
uint32_t *map_find(const name_map *m, const char *key, size_t n);
/* The same, made with the value UINT32_MAX; NULL only without memory. */
uint32_t *map_add(name_map *m, const char *key);

/* Whether two names are equal, in any case. */
int same_name(const char *a, const char *b);
/* Whether a list with blanks between has that name, in any case. */
int in_list(const char *list, const char *name);

#endif
