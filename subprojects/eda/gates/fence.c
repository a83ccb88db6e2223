/* SPDX-License-Identifier: BSD-3-Clause */
/* Guard words around arrays. */
#include "gates/fence.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/values.h"

enum {
  /* Bytes on each side; out-of-bounds writes within FENCE damage no other
     data. */
  FENCE = EDA_VALUES_SPARE,
  WORD = 0xA5 /* as int32_t a large negative number, as double a tiny negative
                 number */
};

/* Header before the array. The size precedes the guard words, so that a short
   write before the array does not change the size. */
typedef struct fence {
  size_t bytes;
  char words[FENCE - sizeof(size_t)];
} fence;

void *fence_new(size_t count, size_t size, const void *from) {
  size_t bytes = count * size;
  fence *f = eda_alloc(1, sizeof *f + bytes + FENCE);
  char *array = (char *)(f + 1);
  memset(f->words, WORD, sizeof f->words);
  memset(array + bytes, WORD, FENCE);
  f->bytes = bytes;
  if (from && bytes) memcpy(array, from, bytes);
  return array;
}

void fence_free(void *array) {
  if (array) free((fence *)array - 1);
}

static int is_whole(const char *words, size_t n) {
  size_t i = 0;
  while (i < n && (unsigned char)words[i] == WORD) i++;
  return i == n;
}

static int fence_overrun(const char *side, const char *what, opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "writes %s the array of %s", side,
                  what);
}

int fence_check(const void *array, const char *what, opc_error *error) {
  const fence *f = (const fence *)array - 1;
  const char *after = (const char *)array + f->bytes;
  /* Test the words before the array first: if they are damaged, `bytes` may be
     wrong. */
  if (!is_whole(f->words, sizeof f->words))
    return fence_overrun("before", what, error);
  return is_whole(after, FENCE) ? OPC_OK : fence_overrun("beyond", what, error);
}

void fence_field(eda_field *field) {
  size_t bytes = (size_t)field->nx * (size_t)field->ny * sizeof(float);
  size_t capacity = 0;
  char *values = (char *)field->coefficients;
  eda_grow_to(&values, &capacity, bytes + FENCE, 1);
  memset(values + bytes, WORD, FENCE);
  field->coefficients = (float *)values;
}

int fence_check_field(const float *values, size_t n, const char *what,
                      opc_error *error) {
  return is_whole((const char *)(values + n), FENCE)
             ? OPC_OK
             : fence_overrun("beyond", what, error);
}
