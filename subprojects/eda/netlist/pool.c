/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory pools: objects are allocated in sequence within blocks. Name maps:
   hash tables that are freed with their pool. */
#include <eda/pool.h>

#include <glib.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct eda_pool_block eda_pool_block;
struct eda_pool_block {
  eda_pool_block *before;
  size_t used, capacity;
};

enum { BLOCK = 1 << 16, ALIGN = 16 };

static size_t size_aligned(size_t n) { return (n + ALIGN - 1) / ALIGN * ALIGN; }

void *eda_pool_alloc(eda_pool *pool, size_t count, size_t size) {
  size_t bytes, head = size_aligned(sizeof(eda_pool_block));
  /* eda_alloc ends the program for an allocation of this size. */
  if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 4)
    bytes = SIZE_MAX / 4;
  bytes = size_aligned(bytes + !bytes);
  if (!pool->last || pool->last->capacity - pool->last->used < bytes) {
    size_t capacity = bytes > BLOCK / 4 ? bytes : BLOCK;
    eda_pool_block *block = eda_alloc(1, head + capacity);
    block->capacity = capacity;
    block->before = pool->last;
    pool->last = block;
  }
  char *at = (char *)pool->last + head + pool->last->used;
  pool->last->used += bytes;
  return at;
}

char *eda_pool_text(eda_pool *pool, const char *text, size_t n) {
  char *copy = eda_pool_alloc(pool, n + 1, 1);
  if (n) memcpy(copy, text, n);
  return copy;
}

char *eda_pool_path(eda_pool *pool, const char *a, const char *b) {
  size_t na = strlen(a), nb = strlen(b);
  char *path = eda_pool_alloc(pool, na + nb + 2, 1);
  memcpy(path, a, na);
  if (na) path[na++] = '/';
  memcpy(path + na, b, nb);
  return path;
}

void eda_pool_clear(eda_pool *pool) {
  g_slist_free_full(pool->tables, (GDestroyNotify)g_hash_table_unref);
  pool->tables = NULL;
  while (pool->last) {
    eda_pool_block *block = pool->last;
    pool->last = block->before;
    free(block);
  }
}

void eda_pool_grow(eda_pool *pool, void *array, size_t *capacity, size_t need,
                   size_t size) {
  if (need <= *capacity) return;
  size_t wanted = need + need / 2 + 8;
  void *more = eda_pool_alloc(pool, wanted, size);
  if (*capacity) memcpy(more, *(void **)array, *capacity * size);
  *(void **)array = more;
  *capacity = wanted;
}

/* ---- names ---- */

uint64_t eda_name_hash(const char *name) {
  uint64_t h = 14695981039346656037u;
  for (; *name; name++)
    h = (h ^ (uint64_t)g_ascii_tolower(*name)) * 1099511628211u;
  return h;
}

static guint name_fold(const void *name) {
  uint64_t h = eda_name_hash(name);
  return (guint)(h ^ h >> 29);
}

static gboolean name_same(const void *a, const void *b) {
  return eda_same_name(a, b);
}

uint32_t *eda_names_find(const eda_names *names, const char *key) {
  return names->table ? g_hash_table_lookup(names->table, key) : NULL;
}

uint32_t *eda_names_add(eda_names *names, const char *key) {
  uint32_t *value = eda_names_find(names, key);
  if (value) return value;
  if (!names->table) {
    names->table = g_hash_table_new(name_fold, name_same);
    names->pool->tables = g_slist_prepend(names->pool->tables, names->table);
  }
  value = eda_pool_alloc(names->pool, 1, sizeof *value);
  *value = UINT32_MAX;
  g_hash_table_insert(names->table, (void *)(uintptr_t)key, value);
  return value;
}

int eda_same_name(const char *a, const char *b) { return !strcasecmp(a, b); }

int eda_in_list(const char *list, const char *name) {
  size_t n = strlen(name);
  while (list && *list) {
    size_t m = strcspn(list, " ,");
    if (m == n && !strncasecmp(list, name, n)) return 1;
    list += m + (list[m] != '\0');
  }
  return 0;
}
