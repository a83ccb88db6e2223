/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays between guard words, for output of plugins. Writes slightly out of
   bounds are detected and damage no other data. OPCFLOW_GUARD=pages adds 1 MB
   of inaccessible pages on each side and makes freed arrays inaccessible. A
   write far out of bounds, or by a pointer kept from an earlier call, then
   crashes the plugin. */
#pragma once

#include <eda/imaging.h>

/* Return an array of `count` elements of `size` bytes: a copy of `from`, or
   zeros if `from` is NULL. Free the array with fence_free. [any] */
void *fence_new(size_t count, size_t size, const void *from);
void fence_free(void *array);

/* Return OPC_OK if the guard words are intact. Otherwise set *error and return
   OPC_FAILED; `what` names the array in the message. [any] */
int fence_check(const void *array, const char *what, opc_error *error);

/* Write guard words behind the values of a field, reallocating the values. The
   field is still freed with eda_field_clear. [any] */
void fence_field(eda_field *field);

/* Check the guard words behind `n` values of a field; results as of
   fence_check. */
int fence_check_field(const float *values, size_t n, const char *what,
                      opc_error *error);

/* Values lent to a plugin: the n values of the caller (`own`), or a copy
   between guard pages. */
typedef struct fence_loan {
  float *own, *values;
  size_t n;
  struct fence_loan *next;
} fence_loan;

/* Lend the values of a field to a plugin, which may change the values in place,
   or free them by eda_field_clear and replace them. The loan remains valid
   until fence_return. [any] */
void fence_lend(eda_field *field, fence_loan *loan);

/* Take the values back and check their guard words; results as of
   fence_check. The values of the field are freed by eda_field_clear. [any] */
int fence_return(eda_field *field, const fence_loan *loan, const char *what,
                 opc_error *error);
