/* SPDX-License-Identifier: BSD-3-Clause */
/* A corrected cell: its transistors, how their mask's edges were moved, and
   what came of it. Coordinates are grid steps of the cell's own. */
#ifndef CORRECT_LIBRARY_ENTRY_H
#define CORRECT_LIBRARY_ENTRY_H

#include <eda/gates.h>
#include <glib.h>

#include <correct/cut.h>

#define ENTRY_TYPE \
  G_VARIANT_TYPE("(asa(iiiiyydddddddddyuiiiiiia(iii)ds)aa(iiii)aa(iiii))")

typedef struct entry {
  size_t gates, layers;
  char **layer; /* names, NULL-terminated */
  eda_box *box;
  uint8_t *type, *axis;
  char **flavour;         /* NULL-terminated */
  double *length, *width; /* nm, as drawn */
  double *design;         /* Ion as drawn, A */
  eda_performance after;  /* of the cell alone */
  uint32_t *flags;
  eda_moved *moved;
} entry;

/* Of the transistors that are the cell's own, and of what is added to the mask
   within its box; floating. */
OPC_EXPORT GVariant *correct_entry_pack(const cut_out *cell,
                                        const eda_performance *design,
                                        const eda_performance *after,
                                        const uint32_t *flags,
                                        const eda_moved *moved);

/* NULL if a figure is none that can have been packed. */
OPC_EXPORT entry *correct_entry_unpack(GVariant *data);
OPC_EXPORT void correct_entry_free(entry *entry);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(entry, correct_entry_free)

#endif
