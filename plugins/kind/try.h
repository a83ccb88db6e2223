/* SPDX-License-Identifier: BSD-3-Clause */
/* What the exercises of all kinds need: made-up masks and prints of
   eda_gates_sample, and telling what is wrong. */
#pragma once

#include <eda/check.h>
#include <eda/memory.h>
#include <opcflow/kind.h>

/* The period that prints are made in, nm: the transistors and some space. */
extern const eda_frame try_frame;

/* Another one, of another size and place. */
extern const eda_frame try_other_frame;

/* Whether a call of the plugin went well; a failure is noted with its reason.
 */
int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error);

/* Whether a check of the library that gave `code` found nothing. */
int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error);

/* The spectrum of a layer of the sample as drawn; what there is no layer for
   has the shapes of the poly; TRY_EMPTY: no shape, TRY_FULL: one over all of
   the frame. 0 and a finding if it cannot be made. */
enum { TRY_EMPTY = -1, TRY_FULL = -2 };
int try_mask(opc_inspector *in, int layer, const eda_frame *frame, double band,
             eda_spectrum *mask);

/* A litho model of one coherent system without edges. */
opc_module try_litho(const opc_inspector *in);

/* The intensity that a layer of the sample gives through that model; cleared
   with eda_field_clear. 0 and a finding if it cannot be made. */
int try_print(opc_inspector *in, int layer, eda_field *intensity);

/* The level set of that print: positive where it is dark. */
int try_develop(opc_inspector *in, int layer, eda_field *print);

/* Performance of transistors that print as drawn: currents of W / L. */
void try_performance(const eda_gates *gates, eda_performance *out);

/* Whether task(data, i) gives 1 for each i below n, called by a thread each,
   all at the same time and again and again for a moment. For functions that are
   [any]: what they give to one caller must not depend on others. Only once in
   a process, then 1: a moment is long where an instance is tried over and over.
 */
int try_at_once(size_t n, int (*task)(void *data, size_t i), void *data);

/* If a field that a function gave, a `what` of that frame, is sound, its bytes
   are added. */
void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame);
