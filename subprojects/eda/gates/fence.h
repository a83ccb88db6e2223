/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays between guard words, written by plugins: writes slightly out of bounds
   are detected and do no harm. */
#pragma once

#include <eda/imaging.h>

/* Return an array, zeroed or a copy of `from` if not NULL. [any] */
void *fence_new(size_t count, size_t size, const void *from);
void fence_free(void *array);

/* Return OPC_OK if the guard words are intact; otherwise OPC_FAILED and *error,
   which calls the array `what`. [any] */
int fence_check(const void *array, const char *what, opc_error *error);

/* Write guard words behind the values of a field; release of the field is
   unchanged. [any] */
void fence_field(eda_field *field);

/* Check the guard words of a field of `n` values, as fence_check. */
int fence_check_field(const float *values, size_t n, const char *what,
                      opc_error *error);
