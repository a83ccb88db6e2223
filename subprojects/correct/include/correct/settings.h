/* SPDX-License-Identifier: BSD-3-Clause */
/* Models, accuracies and limits of a step that simulates, measures or corrects
   masks. The parameters below set the field `with`, of type correct_settings,
   in the state of the step. */
#pragma once

#include <eda/print.h>
#include <eda/rules.h>
#include <opcflow/step.h>

/* Whether the guard (guard.h) reverts transistors that the correction made
   worse. AUTO: yes, unless the synthesizer dissects edges (`cut`). The
   displacements of fragments around a transistor depend on each other;
   reverting only some of them makes the transistor and its neighbours worse. */
enum { CORRECT_GUARD_AUTO, CORRECT_GUARD_ON, CORRECT_GUARD_OFF };

/* Default of ion_limit for steps without that parameter, %. */
#define CORRECT_USUAL_LIMIT 0.5

/* Models, accuracies and limits. */
typedef struct correct_settings {
  const opc_module *litho, *resist, *extractor;
  const opc_module *synthesizer, *regulator; /* NULL: none */
  int64_t max_iterations;
  const char *fine_text; /* parameter `fine` */
  double fine;       /* largest image error of accurate simulations, relative
                        to the clear field; 0: no accurate simulations */
  opc_reals overlay; /* displacement of the image of active against poly
                        along x and y, nm; empty: none */
  double margin;     /* clear field around the layout, nm */
  double ion_limit;  /* largest allowed |Ion deviation|, % */
  double rules[EDA_RULES]; /* limits of the mask rules, nm */
  int guard;               /* CORRECT_GUARD_AUTO ... */
} correct_settings;

/* Compute `fine` and `margin` from the parameters. Return OPC_INVALID with the
   name of the parameter if `fine`, `margin` or `overlay` is not valid. Call on
   the main thread. */
OPC_EXPORT int correct_settings_check(correct_settings *with,
                                      const opc_host *host, opc_error *error);

/* Estimate memory and work of simulating all corrected layers in parallel.
   `prints`: text for the number of simulations, such as "at most 101 prints";
   `fine_prints` replaces `prints` if `fine` > 0 and the model has accurate
   simulations. */
OPC_EXPORT void correct_forecast(const correct_settings *with,
                                 const opc_host *host, const eda_gates *gates,
                                 const char *prints, const char *fine_prints,
                                 opc_forecast *out);

/* Simulate and measure the shapes of a mask, with accurate simulations if
   `fine` > 0 and the model has them. Set print, after, flags and the numbers of
   simulations of the mask. If mask->design (performance of the drawn
   transistors) is not set, compute the design. If it is set, the caller must
   have prepared the extractor.

   `sized`: 1: pass the gates to the resist, which may derive defaults from
   them; 0: do not, because the gates are a part of a larger layout. If
   `flags_before` is not NULL, the drawn layers are simulated first:
   *flags_before receives their EDA_PRINT_*, and the mask's fields drawn_print
   and before are set. *extension, [2 * gates], receives the printed line-end
   extensions, nm. The caller frees both arrays with free(). Call on the main
   thread. */
OPC_EXPORT int correct_print(const correct_settings *with, const opc_host *host,
                             int sized, eda_mask *mask, uint32_t **flags_before,
                             double **extension, opc_error *error);

/* Find all violations of the regulator's rules. The caller frees *violations
   with free(). Call on the main thread. */
OPC_EXPORT int correct_violations(const opc_context *context,
                                  const opc_module *regulator,
                                  const eda_printed *printed,
                                  eda_violation **violations, size_t *count,
                                  opc_error *error);

/* correct_save_mask: save a mask. Use as opc_step.save of a step that outputs a
   mask. correct_sketch_mask: make a mask without shapes. Call in
   opc_step.sketch of such a step. */
OPC_EXPORT int correct_sketch_mask(const eda_gates *gates, void **outputs);
OPC_EXPORT int correct_save_mask(void *self, void *const *outputs,
                                 const char *folder, opc_error *error);

/* ---- parameters ---- */

#define CORRECT_SLOT(state, NAME, FLAGS, SUMMARY)                \
  OPC_PARAMETER_NAMED(#NAME, state, with.NAME, .type = OPC_SLOT, \
                      .flags = (FLAGS), .choices = #NAME,        \
                      .summary = (SUMMARY))
#define CORRECT_PRINT_SLOTS(state)                                      \
  CORRECT_SLOT(state, litho, OPC_REQUIRED, "Model of the optics"),      \
      CORRECT_SLOT(state, resist, OPC_REQUIRED, "Model of the resist"), \
      CORRECT_SLOT(state, extractor, OPC_REQUIRED,                      \
                   "Model of a printed transistor's performance")
#define CORRECT_MOVE_SLOTS(state)                                 \
  CORRECT_SLOT(state, synthesizer, OPC_REQUIRED,                  \
               "Algorithm that displaces the edges of the mask"), \
      CORRECT_SLOT(state, regulator, 0,                           \
                   "Rules that prevent printing failures")

#define CORRECT_MAX_ITERATIONS(state, SUMMARY)                              \
  OPC_PARAMETER_NAMED("max_iterations", state, with.max_iterations,         \
                      .type = OPC_INT, .flags = OPC_AT_LEAST | OPC_AT_MOST, \
                      .preset = "100", .min = 0, .max = 100000,             \
                      .summary = (SUMMARY))

#define CORRECT_MARGIN(state)                                           \
  OPC_PARAMETER_NAMED("margin", state, with.margin, .type = OPC_REAL,   \
                      .flags = OPC_AT_LEAST, .unit = "nm", .min = 0,    \
                      .summary =                                        \
                          "Width of the clear field around the layout " \
                          "(default: as required by 'fine')")

#define CORRECT_FINE(state)                                                   \
  OPC_PARAMETER_NAMED(                                                        \
      "fine", state, with.fine_text, .type = OPC_TEXT,                        \
      .summary =                                                              \
          "Largest image error of the accurate simulations that produce the " \
          "reported figures, relative to the clear field; off: fast "         \
          "simulations only")

#define CORRECT_OVERLAY(state)                                                \
  OPC_PARAMETER_NAMED("overlay", state, with.overlay, .type = OPC_REALS,      \
                      .unit = "nm", .preset = "[]",                           \
                      .summary =                                              \
                          "Displacement of the image of active against poly " \
                          "along x and y")

#define CORRECT_GUARD(state)                                              \
  OPC_PARAMETER_NAMED(                                                    \
      "guard", state, with.guard, .type = OPC_CHOICE, .preset = "auto",   \
      .choices = "auto|on|off",                                           \
      .summary =                                                          \
          "Revert the correction of transistors that fail or are worse "  \
          "than drawn and than 'ion_limit'; off: keep the synthesizer's " \
          "result; auto: off for synthesizers of edge fragments, "        \
          "otherwise on")

#define CORRECT_ION_LIMIT(state, SUMMARY)                                    \
  OPC_PARAMETER_NAMED("ion_limit", state, with.ion_limit, .type = OPC_REAL,  \
                      .flags = OPC_AT_LEAST, .former = "limit", .unit = "%", \
                      .preset = "0.5 %", .summary = (SUMMARY))
