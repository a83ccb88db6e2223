/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory of the library, allocated by GLib: malloc, but the program ends if
   none is left. */
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

int eda_doubles_rise(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
