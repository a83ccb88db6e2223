/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the choice of representatives. The wider environment of a
   transistor consists of the classes and positions of all transistors within
   the range of optical interaction. Its checksum is computed by prints_find,
   while the masks are still numbered by class. In a memory, the most frequent
   wider environment is the interior of an array, whereas the lowest member of a
   class is at a corner. */
#include <eda/memory.h>
#include <stdlib.h>

#include "work.h"

void representatives_choose(work *w) {
  eda_chip *c = w->chip;
  uint32_t *members = eda_alloc(w->classes, sizeof *members),
           *best = eda_alloc(w->classes, sizeof *best);
  uint8_t *flip = eda_alloc(w->classes, 1);
  for (size_t i = 0; i < c->count; i++) members[c->gate[i].mask]++;
  w->members = members;
  prints_find(w);
  w->members = NULL;
  uint32_t *size = eda_alloc(c->prints, sizeof *size);
  for (size_t i = 0; i < c->count; i++)
    if (members[c->gate[i].mask] > 1) size[c->gate[i].print]++;
  for (size_t k = 0; k < w->classes; k++) best[k] = c->gate[w->first[k]].print;
  /* Prints are numbered in the order of their first transistors, so the lowest,
     then leftmost of several equal ones is selected. */
  for (size_t k = 0; k < c->prints; k++) {
    uint32_t of = c->gate[w->print_first[k]].mask;
    if (size[k] > size[best[of]]) best[of] = (uint32_t)k;
  }
  for (size_t k = 0; k < w->classes; k++) {
    if (members[k] > 1) w->first[k] = w->print_first[best[k]];
    flip[k] = c->gate[w->first[k]].flip;
  }
  for (size_t i = 0; i < c->count; i++)
    c->gate[i].flip ^= flip[c->gate[i].mask];
  w->host->log(w->host, OPC_LOG_DEBUG,
               "%zu different wider environments in classes of several "
               "members, within %.4g nm",
               c->prints, w->margin * c->grid);
  /* These prints distinguish classes, not masks: discard them. */
  g_hash_table_remove_all(w->prints);
  g_ptr_array_set_size(w->sums, 0);
  c->prints = 0;
  free(size);
  free(members);
  free(best);
  free(flip);
}
