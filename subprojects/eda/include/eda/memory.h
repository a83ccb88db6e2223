/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory allocation of the library. [any]: see opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Return zeroed memory of count * size bytes, never NULL, even for 0 bytes;
   free with free(). If memory is exhausted, the program aborts. [any] */
OPC_EXPORT void *eda_alloc(size_t count, size_t size);

/* Return zeroed memory of count * size bytes, as eda_alloc does; the caller
   frees the memory with eda_free. A block of at least EDA_SHARED bytes is a
   file in memory (memfd), which other processes can map instead of receiving
   copies. Smaller blocks, further blocks beside 128 such files, and blocks
   without a free descriptor are memory of eda_alloc. [any] */
enum { EDA_SHARED = 1 << 18 };
OPC_EXPORT void *eda_alloc_shared(size_t count, size_t size);
/* Free a block of eda_alloc_shared; `memory` may be NULL. [any] */
OPC_EXPORT void eda_free(void *memory);

/* Place of data in a block of eda_alloc_shared. The block has the number `id`,
   unique in the process, and `size` bytes; `file` is the descriptor of its
   file, owned by the library. The data begin `offset` bytes behind the start.
 */
typedef struct eda_shared {
  uint64_t id;
  int file;
  size_t size, offset;
} eda_shared;

/* Find the block that contains the `bytes` bytes from `data` on. Return 1 and
   fill *place, or 0 if no block contains them. [any] */
OPC_EXPORT int eda_shared_find(const void *data, size_t bytes,
                               eda_shared *place);

/* Return whether the block `id` exists. [any] */
OPC_EXPORT int eda_shared_exists(uint64_t id);

/* Move the block `id` to a new file with a new number; address and contents do
   not change. Processes that map the former file keep the former contents. No
   thread may write to the block meanwhile. Return 0 if there is no block `id`
   or no memory. [any] */
OPC_EXPORT int eda_shared_renew(uint64_t id);

/* Enlarge *array (the address of a pointer) to a capacity of at least `need`
   elements of `size` bytes, and at least 1.5 times the old capacity; set
   *capacity. New elements are not zeroed. Free with free(). [any] */
OPC_EXPORT void eda_grow_to(void *array, size_t *capacity, size_t need,
                            size_t size);

/* Call eda_grow_to if the capacity is below `need`. */
OPC_UNUSED static inline void eda_grow(void *array, size_t *capacity,
                                       size_t need, size_t size) {
  if (need > *capacity) eda_grow_to(array, capacity, need, size);
}

/* Append the element in the last argument to an array with `count` elements and
   the capacity `capacity`. */
#define EDA_PUSH(array, count, capacity, ...)                     \
  (eda_grow(&(array), &(capacity), (count) + 1, sizeof *(array)), \
   (void)((array)[(count)++] = __VA_ARGS__))

/* Compare two numbers for qsort, the smaller one first: double, int32_t,
   int64_t and uint32_t. [any] */
OPC_EXPORT int eda_doubles_rise(const void *a, const void *b);
OPC_EXPORT int eda_int32s_rise(const void *a, const void *b);
OPC_EXPORT int eda_int64s_rise(const void *a, const void *b);
OPC_EXPORT int eda_uint32s_rise(const void *a, const void *b);

/* Define a function `name` that compares two structs for qsort by the member
   `first`, rising or falling, and equal ones by `second`, rising. */
#define EDA_COMPARE_RISING(name, type, first, second) \
  EDA_COMPARE(name, type, first, second, <)
#define EDA_COMPARE_FALLING(name, type, first, second) \
  EDA_COMPARE(name, type, first, second, >)
#define EDA_COMPARE(name, type, first, second, before)                  \
  static int name(const void *a, const void *b) {                       \
    const type *p = (const type *)a, *q = (const type *)b;              \
    if (p->first != q->first) return p->first before q->first ? -1 : 1; \
    return (p->second > q->second) - (p->second < q->second);           \
  }                                                                     \
  static int name(const void *a, const void *b)

OPC_C_END
