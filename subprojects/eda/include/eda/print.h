/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulation of the masks of a layout by a litho and a resist model, and
   measurement of the printed transistors. Thesis: docs/background/physics.md.
   [any], [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/check.h>

OPC_C_BEGIN

/* ---- simulation ------------------------------------------------------- */

/* A litho model (`litho`) with checks of all calls and results. A resist calls
   the litho model during calibration; if `failed` is set, `fault` is the first
   error of the litho model itself. If `fine` > 0, accurate images are computed
   with an error of at most `fine`, so that calibration and accurate simulations
   share kernels. */
typedef struct eda_model {
  opc_module module; /* checked module; call it instead of `litho` */
  eda_litho functions;
  const opc_context *context;
  const opc_module *litho;
  opc_error fault;
  int failed;
  double fine;
} eda_model;

/* Initialise a model. The model must not move in memory, because `module`
   points to its fields. [main] */
OPC_EXPORT void eda_model_init(eda_model *model, const opc_context *context,
                               const opc_module *litho);

/* The state of simulations of the masks of one layout. */
typedef struct eda_printer {
  const opc_context *context;
  eda_model litho;
  const opc_module *resist;
  eda_frame frame;
  double grid; /* mask grid, nm */
  size_t layers;
  eda_field *print; /* [layers]: level sets, positive where the resist prints */
  uint32_t simulations; /* number of fast simulations, each of one layer */

  /* Largest intensity error of accurate simulations (clear field: 1); 0: no
     accurate simulations. The caller sets `fine` between eda_printer_init and
     eda_printer_prepare, which sets 0 if the model has no function
     image_fine. */
  double fine;
  eda_field *image; /* [layers]: last intensity passed to the resist; used if
                       `fine` > 0 or `keeps` is 1 */
  eda_field *difference; /* [layers]: accurate minus fast intensity of the same
                            mask; used if `fine` > 0 */
  uint8_t *is_fine; /* [layers]: 1 if print[] is from an accurate simulation */
  uint32_t
      fine_simulations; /* number of accurate simulations, each of one layer */

  /* The caller may set these at the same time as `fine`. `defocus`, nm: defocus
     of all images, for a model with image_at. `keeps` = 1: keep `image` even if
     `fine` is 0. */
  double defocus;
  int keeps;

  /* Transistors passed to the resist: by default those simulated. The caller
     may set NULL for a part of a layout, so that defaults derived from the
     transistors do not differ between parts. */
  const eda_gates *drawn;

  /* [layers]: largest intensity error of accurate simulations of a layer; 0:
     the value of `fine`. The caller may change the array at any time. */
  double *fine_of;
} eda_printer;

/* Initialise a printer without accurate simulations. Its frame is gates->extent
   and a margin of `margin` nm. The printer must not move in memory. [main] */
OPC_EXPORT void eda_printer_init(eda_printer *printer,
                                 const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *litho,
                                 const opc_module *resist, double margin);
/* Free all fields of a printer. */
OPC_EXPORT void eda_printer_clear(eda_printer *printer);

/* Prepare both models. Errors name the parameter "litho" or "resist". [main] */
OPC_EXPORT int eda_printer_prepare(eda_printer *printer, opc_error *error);

/* Estimate the memory of simulating `layers` layers at once, without the level
   sets that already exist: the size of each Fourier transform, and bytes. May
   be called before eda_printer_prepare; all figures are 0 if the model's band
   is unknown. [any] */
OPC_EXPORT eda_image_size eda_printer_forecast(const eda_printer *printer,
                                               size_t layers);

/* eda_printer_spectrum: compute the spectrum of a mask (merged), the input of
   the image functions of printer->litho. eda_printer_develop: convert an
   intensity, in place, to the level set. [any] */
OPC_EXPORT int eda_printer_spectrum(const eda_printer *printer,
                                    const eda_shapes *mask, eda_spectrum *out,
                                    opc_error *error);
OPC_EXPORT int eda_printer_develop(const eda_printer *printer, int layer,
                                   eda_field *field, opc_error *error);

/* Simulate the masks (merged) of the layers with layers[i] = 1 in parallel and
   replace printer->print. `difference`, found by the last accurate simulation
   of a layer, is added to later fast images: truncated kernels lack a smooth
   field, which is nearly equal for similar masks. [main] */
OPC_EXPORT int eda_printer_print(eda_printer *printer, const uint8_t *layers,
                                 const eda_shapes *mask, opc_error *error);

/* Simulate the layers with layers[i] = 1 accurately, unless their level set is
   already accurate. `mask` must equal the masks last passed to
   eda_printer_print, if any. Do nothing if `fine` is 0. [main] */
OPC_EXPORT int eda_printer_refine(eda_printer *printer, const uint8_t *layers,
                                  const eda_shapes *mask, opc_error *error);

/* Add the present `difference` to an earlier intensity of a layer and convert
   it, in place, to the level set. [any] */
OPC_EXPORT int eda_printer_correct(const eda_printer *printer, int layer,
                                   eda_field *image, opc_error *error);

/* Compute the level set of a layer at `factor` times the dose from `image` of
   the last simulation, which exists if `fine` > 0 or `keeps` is 1. The caller
   clears *out. [any] */
OPC_EXPORT int eda_printer_at_dose(const eda_printer *printer, int layer,
                                   double factor, eda_field *out,
                                   opc_error *error);

/* ---- measurement ------------------------------------------------------ */

/* Measurements of printed gates. */
typedef struct eda_measurement {
  uint32_t *flags;   /* EDA_PRINT_* */
  double *extension; /* [2 * i + side], nm: see eda_printed.extension */
  eda_performance performance;
} eda_measurement;

/* Allocate zeroed arrays for n gates; free the arrays. [any] */
OPC_EXPORT void eda_measurement_init(eda_measurement *measurement, size_t n);
OPC_EXPORT void eda_measurement_clear(eda_measurement *measurement);

/* Prepare an extractor; errors name the parameter "extractor". [main] */
OPC_EXPORT int eda_extractor_prepare(const opc_context *context,
                                     const opc_module *extractor,
                                     opc_error *error);

/* Measure all gates in the level sets print[layers] on all threads, with the
   slices of the extractor (thesis 2.2.2 and 3.2.1). [main] */
OPC_EXPORT int eda_measure(const opc_context *context, const eda_gates *gates,
                           const eda_field *print, const opc_module *extractor,
                           eda_measurement *out, opc_error *error);

/* Receive the slices of in->count gates from gate `first` on, before the
   extraction. [any] */
typedef int eda_slices_visit(void *data, size_t first, const eda_slices *in,
                             opc_error *error);

/* Measure as eda_measure, and pass the slices of all gates, in blocks, to
   `visit`. [main] */
OPC_EXPORT int eda_measure_slices(const opc_context *context,
                                  const eda_gates *gates,
                                  const eda_field *print,
                                  const opc_module *extractor,
                                  eda_slices_visit *visit, void *data,
                                  eda_measurement *out, opc_error *error);

/* Slices of the transistors that print: numbers of all slices, of slices
   shorter than the device model covers (`modelled` of eda_extractor), and of
   transistors with these. The shortest of these, and the shortest length that
   its model covers, nm. */
typedef struct eda_short_slices {
  double slices, below, gates, shortest, modelled;
} eda_short_slices;

/* Measure as eda_measure, and add the slices to *sum. `count`: number of
   transistors that each gate represents; NULL: one. [main] */
OPC_EXPORT int eda_measure_short(const opc_context *context,
                                 const eda_gates *gates, const eda_field *print,
                                 const opc_module *extractor,
                                 const uint32_t *count, eda_measurement *out,
                                 eda_short_slices *sum, opc_error *error);

/* Write the text of a finding, about 250 characters; "": no slice is short.
   [any] */
OPC_EXPORT void eda_short_slices_text(const eda_short_slices *slices,
                                      char *text, size_t size);

/* Compute the performance of the gates as drawn. [main] */
OPC_EXPORT int eda_measure_drawn(const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *extractor,
                                 eda_performance *out, opc_error *error);

/* Deviations of printed transistors from the design, without failed
   transistors; NAN if none remains. Arrays: EDA_NMOS, EDA_PMOS, both. */
typedef struct eda_spread {
  double ion_mean[3], ion_sd[3]; /* mean and standard deviation of the Ion
                                    deviation, % */
  double ion_worst;              /* Ion deviation with the largest absolute
                                    value, % */
  double leakage[3]; /* total Ioff, relative to the same transistors as drawn */
  size_t failed, outside; /* numbers of transistors that do not print, and with
                             figures beyond the device table */
} eda_spread;

/* Sums from which deviations are computed; zero the struct before the first
   eda_spread_add. */
typedef struct eda_spread_sums {
  struct {
    double n;              /* number of transistors */
    double off, square;    /* sums of the Ion deviation, %, and of its square */
    double printed, drawn; /* sums of Ioff, A, printed and drawn */
  } of[3];                 /* EDA_NMOS, EDA_PMOS, both */
  double worst;           /* Ion deviation with the largest absolute value, % */
  size_t failed, outside; /* numbers of transistors */
} eda_spread_sums;

/* Add the deviations of gates. `count`: number of transistors that each gate
   represents; NULL: one. [any] */
OPC_EXPORT void eda_spread_add(eda_spread_sums *sums, const eda_gates *gates,
                               const uint32_t *count,
                               const eda_performance *design,
                               const eda_performance *printed,
                               const uint32_t *flags);
/* Compute the deviations from the sums. [any] */
OPC_EXPORT eda_spread eda_spread_end(const eda_spread_sums *sums);

/* Compute the deviations of one list of gates. [any] */
OPC_EXPORT eda_spread eda_spread_of(const eda_gates *gates,
                                    const eda_performance *design,
                                    const eda_performance *printed,
                                    const uint32_t *flags);

/* A section through the middle of a gate. */
typedef struct eda_section {
  double length;    /* printed length or width, nm; NAN (as `low` and `high`) if
                       the middle does not print or an edge is missing */
  double low, high; /* image log slope |dI/dl| / I at the ends, 1/nm */
} eda_section;

/* Return the section of EDA_POLY along L, or of EDA_ACTIVE along W, from the
   level set `print` and the intensity `image` of the layer. [any] */
OPC_EXPORT eda_section eda_gate_section(const eda_gates *gates, size_t gate,
                                        int layer, const eda_field *print,
                                        const eda_field *image);

/* Return the deviation of a from b, % (thesis eq. 3.1). */
static inline double eda_deviation(double a, double b) {
  return 100 * (a - b) / b;
}

OPC_C_END
