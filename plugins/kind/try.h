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

/* Return whether a call of the plugin, `what`, succeeded; otherwise report an
   unknown code or a missing message as a fault, any other message as a note. */
int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error);

/* Instance of a module that forwards calls to `plugin` and stores the code that
   the plugin returns in *code. The module is passed to functions of the library
   that check results (eda_call_...). */
typedef struct try_shim {
  const opc_module *plugin;
  int *code;
} try_shim;

/* Return whether a call through a try_shim succeeded. `own` is the code that
   the plugin returned, `code` that of the checking function. A failure of the
   plugin is reported as by try_went_well, a result that the check rejects as by
   try_is_sound. */
int try_call(opc_inspector *in, const char *what, int own, int code,
             opc_error *error);

/* Return whether a check of the library returned no error; otherwise report the
   message as a fault (a note if lint's time limit has expired). */
int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error);

/* Compute the spectrum of a drawn layer of the sample up to the frequency
   `band`, 1/nm; free with eda_spectrum_clear. Layers that the sample lacks have
   the shapes of poly. TRY_EMPTY is a mask without shapes, TRY_FULL a mask with
   one shape that covers the frame. On failure, report a fault (a note if lint's
   time limit has expired) and return 0. */
enum { TRY_EMPTY = -1, TRY_FULL = -2 };
int try_mask(opc_inspector *in, int layer, const eda_frame *frame, double band,
             eda_spectrum *mask);

/* Return a litho model of one coherent kernel with a smooth transfer
   function. */
opc_module try_litho(const opc_inspector *in);

/* Compute the intensity of a layer of the sample by the model of try_litho;
   free with eda_field_clear. Returns 0 and reports a fault on failure. */
int try_print(opc_inspector *in, int layer, eda_field *intensity);

/* Compute the level set of the image of try_print for the threshold 0.3,
   positive in dark areas. Return 0 and report a fault on failure. */
int try_develop(opc_inspector *in, int layer, eda_field *print);

/* Compute the performance of transistors printed as drawn: currents
   proportional to W / L. */
void try_performance(const eda_gates *gates, eda_performance *out);

/* Call task(data, i) repeatedly and concurrently, in one thread for each i
   below n, and return whether all calls return 1. This tests functions marked
   [any], whose results must not depend on other callers. The test takes a fixed
   time; therefore only the first call of this function in a process tests, and
   later calls return 1. */
int try_at_once(size_t n, int (*task)(void *data, size_t i), void *data);

/* Check the field `what` (its name in messages) returned by `function` against
   the frame. Add the bytes of a valid field to the results of `in`; otherwise
   report a fault (a note if lint's time limit has expired). */
void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame);
