/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory: one rule for all of the library. */
#ifndef EDA_MEMORY_H
#define EDA_MEMORY_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zeroed memory of count * size bytes, never NULL, also for none; freed with
   free(). Running out of memory ends the program, as GLib does it: there is
   nothing that a correction could do about it half way. [any] */
OPC_EXPORT void *eda_alloc(size_t count, size_t size);

/* Make room for more than *room elements of `size` bytes in *array (the address
   of a pointer): `need`, or half as many again as there was. What is new is not
   zeroed. Freed with free(). [any] */
OPC_EXPORT void eda_grow_to(void *array, size_t *room, size_t need,
                            size_t size);

/* eda_grow_to, if there is less room than `need`. */
OPC_UNUSED static inline void eda_grow(void *array, size_t *room, size_t need,
                                       size_t size) {
  if (need > *room) eda_grow_to(array, room, need, size);
}

/* Add an element at the end of an array of `count` with room for `room`; after
   the array, the count and the room comes the new element. */
#define EDA_PUSH(array, count, room, ...)                     \
  (eda_grow(&(array), &(room), (count) + 1, sizeof *(array)), \
   (void)((array)[(count)++] = __VA_ARGS__))

#ifdef __cplusplus
}
#endif
#endif
