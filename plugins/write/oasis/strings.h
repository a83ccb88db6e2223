/* SPDX-License-Identifier: BSD-3-Clause */
/* Different strings, numbered from 0 in the order in which they come. */
#ifndef OPCFLOW_OASIS_STRINGS_H
#define OPCFLOW_OASIS_STRINGS_H

#include <stddef.h>
#include <stdint.h>

typedef struct strings {
  const char **text; /* by number; the caller's */
  size_t n, room;
  uint32_t *slots; /* number + 1, 0 for none */
  size_t n_slots;  /* a power of 2 */
} strings;

/* The number of a string that outlives the table; -1 without memory. */
int64_t strings_number(strings *s, const char *text);
void strings_clear(strings *s);

#endif
