/* SPDX-License-Identifier: BSD-3-Clause */
#include "pool.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct pool_block {
  pool_block *before;
  size_t used, room;
};

enum { BLOCK = 1 << 16, ALIGN = 16 };

static size_t aligned(size_t n) { return (n + ALIGN - 1) / ALIGN * ALIGN; }

void *pool_alloc(pool *p, size_t count, size_t size) {
  size_t bytes;
  if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2)
    return NULL;
  bytes = aligned(bytes + !bytes);
  size_t head = aligned(sizeof(pool_block));
  if (!p->last || p->last->room - p->last->used < bytes) {
    size_t room = bytes > BLOCK / 4 ? bytes : BLOCK;
    pool_block *b = calloc(1, head + room);
    if (!b) return NULL;
    b->room = room;
    b->before = p->last;
    p->last = b;
  }
  char *at = (char *)p->last + head + p->last->used;
  p->last->used += bytes;
  return at;
}

char *pool_text(pool *p, const char *text, size_t n) {
  char *copy = pool_alloc(p, n + 1, 1);
  if (copy && n) memcpy(copy, text, n);
  return copy;
}

char *pool_path(pool *p, const char *a, const char *b) {
  size_t na = strlen(a), nb = strlen(b);
  char *path = pool_alloc(p, na + nb + 2, 1);
  if (!path) return NULL;
  memcpy(path, a, na);
  if (na) path[na++] = '/';
  memcpy(path + na, b, nb);
  return path;
}

void pool_clear(pool *p) {
  while (p->last) {
    pool_block *b = p->last;
    p->last = b->before;
    free(b);
  }
}

int pool_grow(pool *p, void *array, size_t *room, size_t need, size_t size) {
  if (need <= *room) return 1;
  size_t wanted = need + need / 2 + 8;
  void *more = pool_alloc(p, wanted, size);
  if (!more) return 0;
  if (*room) memcpy(more, *(void **)array, *room * size);
  *(void **)array = more;
  *room = wanted;
  return 1;
}

/* ---- maps ---- */

static size_t hash(const char *key, size_t n) {
  uint64_t h = 14695981039346656037u;
  for (size_t i = 0; i < n; i++)
    h = (h ^ (uint64_t)tolower((unsigned char)key[i])) * 1099511628211u;
  return (size_t)(h ^ h >> 29);
}

/* Where the key is or would be. */
static size_t slot(const name_map *m, const char *key, size_t n) {
  size_t i = hash(key, n) & (m->room - 1);
  while (m->key[i] && (strncasecmp(m->key[i], key, n) || m->key[i][n] != '\0'))
    i = (i + 1) & (m->room - 1);
  return i;
}

uint32_t *map_find(const name_map *m, const char *key, size_t n) {
  if (!m->room) return NULL;
  size_t i = slot(m, key, n);
  return m->key[i] ? &m->value[i] : NULL;
}

static int map_widen(name_map *m) {
  name_map wider = {.pool = m->pool, .room = m->room ? 2 * m->room : 32};
  wider.key = pool_alloc(m->pool, wider.room, sizeof *wider.key);
  wider.value = pool_alloc(m->pool, wider.room, sizeof *wider.value);
  if (!wider.key || !wider.value) return 0;
  for (size_t i = 0; i < m->room; i++) {
    if (!m->key[i]) continue;
    size_t at = slot(&wider, m->key[i], strlen(m->key[i]));
    wider.key[at] = m->key[i];
    wider.value[at] = m->value[i];
  }
  wider.count = m->count;
  *m = wider;
  return 1;
}

uint32_t *map_add(name_map *m, const char *key) {
  if (m->count >= m->room / 2 && !map_widen(m)) return NULL;
  size_t i = slot(m, key, strlen(key));
  if (!m->key[i]) {
    m->key[i] = key;
    m->value[i] = UINT32_MAX;
    m->count++;
  }
  return &m->value[i];
}

int same_name(const char *a, const char *b) { return !strcasecmp(a, b); }

int in_list(const char *list, const char *name) {
  size_t n = strlen(name);
  while (list && *list) {
    size_t m = strcspn(list, " ,");
    if (m == n && !strncasecmp(list, name, n)) return 1;
    list += m + (list[m] != '\0');
  }
  return 0;
}
