/* SPDX-License-Identifier: BSD-3-Clause */
/* A corrected cell: transistors, displacements of the mask edges, and
   electrical figures. Coordinates are in grid steps, relative to the cell. */
#pragma once

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
  double *length, *width; /* drawn sizes, nm */
  double *design;         /* Ion of the drawn gate, A */
  eda_performance after;  /* figures of the transistors after the correction of
                             the cell */
  uint32_t *flags;
  eda_moved *moved;
} entry;

/* Return a floating GVariant of ENTRY_TYPE with the cell's own transistors, and
   the added shapes and cut-outs whose centres are in the cell's box. */
OPC_EXPORT GVariant *correct_entry_pack(const cut_out *cell,
                                        const eda_performance *design,
                                        const eda_performance *after,
                                        const uint32_t *flags,
                                        const eda_moved *moved);

/* Return the entry packed in `data`, or NULL if the data are not valid. Free
   with correct_entry_free(). */
OPC_EXPORT entry *correct_entry_unpack(GVariant *data);
OPC_EXPORT void correct_entry_free(entry *entry);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(entry, correct_entry_free)
