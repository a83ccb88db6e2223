/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers for the tests of all plugin kinds: sample masks and images of
   eda_gates_sample, and reports of faults. */
#pragma once

#include <eda/check.h>
#include <eda/memory.h>
#include <opcflow/kind.h>

/* Frame of simulated images, nm: the transistors with a margin. */
extern const eda_frame try_frame;

/* A second frame, with another size and origin. */
extern const eda_frame try_other_frame;

/* Return whether a call of the plugin, `what`, succeeded; otherwise report the
   error code or the message to `in`. */
int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error);

/* A module for functions of the library that check results (eda_call_...). The
   functions of `module` forward all calls to `plugin`, and store the code that
   `plugin` returns in *code. */
typedef struct try_shim {
  const opc_module *plugin;
  int *code;
} try_shim;

/* Return whether a call by such a function succeeded. `code` is the result of
   the library, `own` that of the plugin. If both differ, the library rejected a
   result. Report failures as try_went_well or try_is_sound does. */
int try_call(opc_inspector *in, const char *what, int own, int code,
             opc_error *error);

/* Return whether a check of the library returned no error; otherwise report the
   message as a fault. */
int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error);

/* Compute the spectrum of a drawn layer of the sample. A layer that is missing
   in the sample has the shapes of poly; TRY_EMPTY: no shape; TRY_FULL: one
   shape that covers the frame. Returns 0 and reports a fault on failure. */
enum { TRY_EMPTY = -1, TRY_FULL = -2 };
int try_mask(opc_inspector *in, int layer, const eda_frame *frame, double band,
             eda_spectrum *mask);

/* Return a litho model of one coherent kernel with a smooth transfer
   function. */
opc_module try_litho(const opc_inspector *in);

/* Compute the intensity of a layer of the sample by the model of try_litho;
   free with eda_field_clear. Returns 0 and reports a fault on failure. */
int try_print(opc_inspector *in, int layer, eda_field *intensity);

/* Compute the level set of the image of try_print, positive in dark areas. */
int try_develop(opc_inspector *in, int layer, eda_field *print);

/* Compute the performance of transistors printed as drawn: currents
   proportional to W / L. */
void try_performance(const eda_gates *gates, eda_performance *out);

/* Return whether task(data, i) returns 1 for each i below n, in repeated
   concurrent calls, one thread per i. Tests functions tagged [any], whose
   results must not depend on other callers. Only the first call in a process
   tests; later calls return 1, because the test takes a fixed time. */
int try_at_once(size_t n, int (*task)(void *data, size_t i), void *data);

/* Check a field returned by `function`, named `what`, against the frame. Adds
   the bytes of a valid field to `in`; reports a fault otherwise. */
void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame);
