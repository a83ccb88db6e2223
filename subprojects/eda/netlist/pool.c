/* SPDX-License-Identifier: BSD-3-Clause */
/* Pools: blocks that things are cut from one after another. Maps of names: open
   addressing. */
#include <eda/pool.h>

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct eda_pool_block eda_pool_block;
struct eda_pool_block {
  eda_pool_block *before;
  size_t used, room;
};

enum { BLOCK = 1 << 16, ALIGN = 16 };

static size_t aligned(size_t n) { return (n + ALIGN - 1) / ALIGN * ALIGN; }

void *eda_pool_alloc(eda_pool *pool, size_t count, size_t size) {
  size_t bytes, head = aligned(sizeof(eda_pool_block));
  /* So much is never there, and eda_alloc ends the program. */
  if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 4)
    bytes = SIZE_MAX / 4;
  bytes = aligned(bytes + !bytes);
  if (!pool->last || pool->last->room - pool->last->used < bytes) {
    size_t room = bytes > BLOCK / 4 ? bytes : BLOCK;
    eda_pool_block *block = eda_alloc(1, head + room);
    block->room = room;
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
  while (pool->last) {
    eda_pool_block *block = pool->last;
    pool->last = block->before;
    free(block);
  }
}

void eda_pool_grow(eda_pool *pool, void *array, size_t *room, size_t need,
                   size_t size) {
  if (need <= *room) return;
  size_t wanted = need + need / 2 + 8;
  void *more = eda_pool_alloc(pool, wanted, size);
  if (*room) memcpy(more, *(void **)array, *room * size);
  *(void **)array = more;
  *room = wanted;
}

/* ---- names ---- */

static size_t hash(const char *key, size_t n) {
  uint64_t h = 14695981039346656037u;
  for (size_t i = 0; i < n; i++)
    h = (h ^ (uint64_t)tolower((unsigned char)key[i])) * 1099511628211u;
  return (size_t)(h ^ h >> 29);
}

/* Where the key is or would be. */
static size_t slot(const eda_names *m, const char *key, size_t n) {
  size_t i = hash(key, n) & (m->room - 1);
  while (m->key[i] && (strncasecmp(m->key[i], key, n) || m->key[i][n] != '\0'))
    i = (i + 1) & (m->room - 1);
  return i;
}

uint32_t *eda_names_find(const eda_names *names, const char *key, size_t n) {
  if (!names->room) return NULL;
  size_t i = slot(names, key, n);
  return names->key[i] ? &names->value[i] : NULL;
}

static void widen(eda_names *m) {
  eda_names wider = {.pool = m->pool, .room = m->room ? 2 * m->room : 32};
  wider.key = eda_pool_alloc(m->pool, wider.room, sizeof *wider.key);
  wider.value = eda_pool_alloc(m->pool, wider.room, sizeof *wider.value);
  for (size_t i = 0; i < m->room; i++) {
    if (!m->key[i]) continue;
    size_t at = slot(&wider, m->key[i], strlen(m->key[i]));
    wider.key[at] = m->key[i];
    wider.value[at] = m->value[i];
  }
  wider.count = m->count;
  *m = wider;
}

uint32_t *eda_names_add(eda_names *names, const char *key) {
  if (names->count >= names->room / 2) widen(names);
  size_t i = slot(names, key, strlen(key));
  if (!names->key[i]) {
    names->key[i] = key;
    names->value[i] = UINT32_MAX;
    names->count++;
  }
  return &names->value[i];
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
