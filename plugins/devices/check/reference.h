/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of devices.check. */
#pragma once

#include <eda/curves.h>
#include <eda/extractor.h>

/* With 1000 equal slices, the error of a printed gate is below 1e-5. */
enum { REFERENCE_SLICES = 1000 };

/* An extractor for the currents of a table of several widths. Wide transistors
   carry the current per width of the widest transistor. In narrow transistors,
   the edges of the active remove a strip from the channel, so that the current
   of a rectangle equals that of the table. If the edges add current, the
   outermost slices are instead widened until they carry the added current. */
typedef struct reference {
  const eda_curves *curves;
  double place[REFERENCE_SLICES], share[REFERENCE_SLICES];
} reference;

/* Initialise a reference with its curves, which must outlive it. */
void reference_init(reference *r, const eda_curves *curves);
/* Return the functions of a reference, which must not move in memory. */
opc_module reference_module(reference *r);
