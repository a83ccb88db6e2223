/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays between guard words, for plugins to write: who writes beyond them is
   found, and does no harm if it is not far. */
#ifndef EDA_GATES_FENCE_H
#define EDA_GATES_FENCE_H

#include <eda/imaging.h>

/* Zeroed, or a copy of `from` if that is not NULL. [any] */
void *fence_new(size_t count, size_t size, const void *from);
void fence_free(void *array);

/* Whether the guard words are as they were; else OPC_FAILED and *error, in
   which `what` is the name of the array. [any] */
int fence_check(const void *array, const char *what, opc_error *error);

/* Guard words behind the values of a field, which is freed as before. [any] */
void fence_field(eda_field *field);

/* The same check, of a field of `n` values whose words these were. */
int fence_check_field(const float *values, size_t n, const char *what,
                      opc_error *error);

#endif
