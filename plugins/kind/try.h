/* SPDX-License-Identifier: BSD-3-Clause */
/* What the exercises of all kinds need: made-up masks and prints of
   eda_gates_sample, and telling what is wrong. */
#ifndef OPCFLOW_KIND_TRY_H
#define OPCFLOW_KIND_TRY_H

#include <eda/check.h>
#include <eda/memory.h>
#include <opcflow/kind.h>

/* The period that prints are made in, nm: the transistors and some space. */
extern const eda_frame try_frame;

/* Whether a call of the plugin went well; a failure is noted with its reason.
 */
int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error);

/* Whether a check of the library that gave `code` found nothing. */
int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error);

/* The spectrum of a layer of the sample as drawn; what there is no layer for
   has the shapes of the poly. 0 and a finding if it cannot be made. */
int try_mask(opc_inspector *in, int layer, double band, eda_spectrum *mask);

/* A litho model of one coherent system without edges. */
opc_module try_litho(const opc_inspector *in);

/* The intensity that a layer of the sample gives through that model; cleared
   with eda_field_clear. 0 and a finding if it cannot be made. */
int try_print(opc_inspector *in, int layer, eda_field *intensity);

/* If a field that a function gave, a `what` of that frame, is sound, its bytes
   are added. */
void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame);

#endif
