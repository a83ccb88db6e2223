/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory allocation of the library by GLib, which calls malloc and ends the
   program if memory is exhausted. */
#include <eda/memory.h>
#include <glib.h>

void *eda_alloc(size_t count, size_t size) {
  return g_malloc0_n(MAX(count, 1), MAX(size, 1));
}

void eda_grow_to(void *array, size_t *capacity, size_t need, size_t size) {
  void **at = array;
  *capacity = MAX(*capacity + *capacity / 2 + 4, need);
  *at = g_realloc_n(*at, *capacity, size);
}

#define NUMBERS_RISE(name, type)                     \
  int name(const void *a, const void *b) {           \
    type x = *(const type *)a, y = *(const type *)b; \
    return (x > y) - (x < y);                        \
  }

NUMBERS_RISE(eda_doubles_rise, double)
NUMBERS_RISE(eda_int32s_rise, int32_t)
NUMBERS_RISE(eda_int64s_rise, int64_t)
NUMBERS_RISE(eda_uint32s_rise, uint32_t)
