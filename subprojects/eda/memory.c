/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory allocation of the library by GLib, which calls malloc and ends the
   program if memory is exhausted. Large arrays can be in files that other
   processes map. */
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

void *eda_alloc(size_t count, size_t size) {
  return g_malloc0_n(MAX(count, 1), MAX(size, 1));
}

void eda_grow_to(void *array, size_t *capacity, size_t need, size_t size) {
  void **at = array;
  *capacity = MAX(*capacity + *capacity / 2 + 4, need);
  *at = g_realloc_n(*at, *capacity, size);
}

/* ---- shared blocks ---- */

typedef struct block {
  char *start;
  eda_shared place; /* offset 0 */
} block;

static GMutex blocks_lock;
static GArray *blocks; /* block */
static uint64_t blocks_last;
enum { MOST_BLOCKS = 128 }; /* each has a descriptor */

/* Return the block that contains an address, NULL if none does. The lock is
   held. */
static block *block_at(const void *address) {
  const char *at = address;
  for (guint i = 0; blocks && i < blocks->len; i++) {
    block *b = &g_array_index(blocks, block, i);
    if (at >= b->start && at < b->start + b->place.size) return b;
  }
  return NULL;
}

static block *block_of(uint64_t id) {
  for (guint i = 0; blocks && i < blocks->len; i++) {
    block *b = &g_array_index(blocks, block, i);
    if (b->place.id == id) return b;
  }
  return NULL;
}

/* Map a new file of `size` bytes. Returns NULL on failure. */
static char *block_map(size_t size, int *file) {
  *file = memfd_create("opcflow-block", MFD_CLOEXEC);
  if (*file < 0) return NULL;
  void *start =
      ftruncate(*file, (off_t)size)
          ? MAP_FAILED
          : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, *file, 0);
  if (start != MAP_FAILED) return start;
  close(*file);
  return NULL;
}

void *eda_alloc_shared(size_t count, size_t size) {
  size_t bytes;
  if (!g_size_checked_mul(&bytes, count, size) || bytes < EDA_SHARED)
    return eda_alloc(count, size);
  block b = {.place.size = bytes};
  g_mutex_lock(&blocks_lock);
  if (!blocks) blocks = g_array_new(FALSE, FALSE, sizeof b);
  if (blocks->len < MOST_BLOCKS) b.start = block_map(bytes, &b.place.file);
  b.place.id = ++blocks_last;
  if (b.start) g_array_append_val(blocks, b);
  g_mutex_unlock(&blocks_lock);
  return b.start ? b.start : eda_alloc(count, size);
}

void eda_free(void *memory) {
  enum { PAGE = 4096 }; /* blocks begin at a page, arrays of malloc do not */
  block b = {0};
  if ((uintptr_t)memory % PAGE == 0) {
    g_mutex_lock(&blocks_lock);
    block *found = block_at(memory);
    if (found) {
      b = *found;
      g_array_remove_index_fast(
          blocks, (guint)(found - &g_array_index(blocks, block, 0)));
    }
    g_mutex_unlock(&blocks_lock);
  }
  if (!b.start) {
    free(memory);
    return;
  }
  munmap(b.start, b.place.size);
  close(b.place.file);
}

int eda_shared_find(const void *data, size_t bytes, eda_shared *place) {
  g_mutex_lock(&blocks_lock);
  const block *b = block_at(data);
  *place = b ? b->place : (eda_shared){0};
  if (b) place->offset = (size_t)((const char *)data - b->start);
  g_mutex_unlock(&blocks_lock);
  return b && bytes <= place->size - place->offset;
}

int eda_shared_exists(uint64_t id) {
  g_mutex_lock(&blocks_lock);
  int found = block_of(id) != NULL;
  g_mutex_unlock(&blocks_lock);
  return found;
}

int eda_shared_renew(uint64_t id) {
  int done = 0, file;
  g_mutex_lock(&blocks_lock);
  block *b = block_of(id);
  char *copy = b ? block_map(b->place.size, &file) : NULL;
  if (copy) {
    size_t size = b->place.size;
    memcpy(copy, b->start, size);
    done = mremap(copy, size, size, MREMAP_MAYMOVE | MREMAP_FIXED, b->start) ==
           b->start;
    if (!done) munmap(copy, size);
    close(done ? b->place.file : file);
    if (done) b->place.file = file;
    if (done) b->place.id = ++blocks_last;
  }
  g_mutex_unlock(&blocks_lock);
  return done;
}

/* ---- comparisons ---- */

#define NUMBERS_RISE(name, type)                     \
  int name(const void *a, const void *b) {           \
    type x = *(const type *)a, y = *(const type *)b; \
    return (x > y) - (x < y);                        \
  }

NUMBERS_RISE(eda_doubles_rise, double)
NUMBERS_RISE(eda_int32s_rise, int32_t)
NUMBERS_RISE(eda_int64s_rise, int64_t)
NUMBERS_RISE(eda_uint32s_rise, uint32_t)
