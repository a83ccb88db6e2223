/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulate the masks of a layout through a litho and a resist model, and
   measure the printed transistors. */
#pragma once

#include <eda/check.h>

OPC_C_BEGIN

/* ---- printing --------------------------------------------------------- */

/* A litho model with checked calls, as used by printers and resists: faults of
   the litho model are distinguished from those of the resist that calls it
   during calibration. `fault` is the first failure, if `failed` is set.
   Accurate images with an error above `fine` are computed with error `fine`, if
   that is not 0, so that calibration and accurate simulations share kernels. */
typedef struct eda_model {
  opc_module module; /* call this module in place of `litho` */
  eda_litho functions;
  const opc_context *context;
  const opc_module *litho;
  opc_error fault;
  int failed;
  double fine;
} eda_model;

/* Initialise a model, which must not move in memory afterwards: the module
   points into it. [main] */
OPC_EXPORT void eda_model_init(eda_model *model, const opc_context *context,
                               const opc_module *litho);

typedef struct eda_printer {
  const opc_context *context;
  eda_model litho;
  const opc_module *resist;
  eda_frame frame;
  double grid;
  size_t layers;
  eda_field *print; /* level sets, positive where the resist prints */
  uint32_t simulations;

  /* Accurate simulations. `fine` is their error (clear field 1), set between
     eda_printer_init and eda_printer_prepare, which clears it if the model has
     no accurate image. The following arrays, [layers], are empty if `fine` is
     0: the last developed intensity, the difference of accurate and fast
     images, and whether the print is an accurate one. */
  double fine;
  eda_field *image, *difference;
  uint8_t *is_fine;
  uint32_t fine_simulations;

  /* Set like `fine`: the defocus of the simulation, nm, which needs a model
     with image_at; and whether `image` is kept without accurate simulations,
     too. */
  double defocus;
  int keeps;

  /* Set like `fine`: the transistors that the resist receives, those that are
     simulated. NULL where these are only a part of a layout, so that values
     that follow from them would differ from part to part. */
  const eda_gates *drawn;

  /* [layers], may be set at any time: error of accurate simulations of a layer;
     0: `fine`. */
  double *fine_of;
} eda_printer;

/* Initialise a printer for all shapes of the gates, with a clear field of
   `margin` nm around them and without accurate simulations. The printer must
   not move in memory. [main] */
OPC_EXPORT void eda_printer_init(eda_printer *printer,
                                 const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *litho,
                                 const opc_module *resist, double margin);
OPC_EXPORT void eda_printer_clear(eda_printer *printer);

/* Prepare both models. Errors name the slots "litho" and "resist". [main] */
OPC_EXPORT int eda_printer_prepare(eda_printer *printer, opc_error *error);

/* Return a lower bound of the size of a simulation of `layers` layers side by
   side, besides existing prints: points of each Fourier transform, and bytes.
   For forecasts also before eda_printer_prepare; all 0 if the model does not
   know its band yet. [any] */
OPC_EXPORT eda_image_size eda_printer_forecast(const eda_printer *printer,
                                               size_t layers);

/* Single steps of a simulation, for callers that vary them: compute the
   spectrum of a mask (merged) for the litho model, whose functions then compute
   the intensity; and convert an intensity, in place, to the level set. [any] */
OPC_EXPORT int eda_printer_spectrum(const eda_printer *printer,
                                    const eda_shapes *mask, eda_spectrum *out,
                                    opc_error *error);
OPC_EXPORT int eda_printer_develop(const eda_printer *printer, int layer,
                                   eda_field *field, opc_error *error);

/* Simulate the masks (merged) of the marked layers side by side and replace
   printer->print. The difference between accurate and fast image, found by the
   last accurate simulation of a layer, is added to all later fast images:
   truncated kernels lack a smooth field, which is nearly equal for two similar
   masks. [main] */
OPC_EXPORT int eda_printer_print(eda_printer *printer, const uint8_t *layers,
                                 const eda_shapes *mask, opc_error *error);

/* Simulate accurately those marked layers whose print is not accurate: the
   masks last passed to eda_printer_print, or any if there was none for the
   layer. Does nothing if `fine` is 0. [main] */
OPC_EXPORT int eda_printer_refine(eda_printer *printer, const uint8_t *layers,
                                  const eda_shapes *mask, opc_error *error);

/* Convert, in place, an intensity of a layer from before the last accurate
   simulation to the level set with the present difference. [any] */
OPC_EXPORT int eda_printer_correct(const eda_printer *printer, int layer,
                                   eda_field *image, opc_error *error);

/* Compute the level set of a layer at `factor` times the dose, from `image`,
   kept by the last simulation. The caller clears *out. [any] */
OPC_EXPORT int eda_printer_at_dose(const eda_printer *printer, int layer,
                                   double factor, eda_field *out,
                                   opc_error *error);

/* ---- measuring -------------------------------------------------------- */

/* Measured quantities of printed gates. */
typedef struct eda_measurement {
  uint32_t *flags;   /* EDA_PRINT_* */
  double *extension; /* [2 * i + side], nm: see eda_printed.extension */
  eda_performance performance;
} eda_measurement;

OPC_EXPORT void eda_measurement_init(eda_measurement *measurement, size_t n);
OPC_EXPORT void eda_measurement_clear(eda_measurement *measurement);

/* Prepare an extractor; errors name the slot "extractor". [main] */
OPC_EXPORT int eda_extractor_prepare(const opc_context *context,
                                     const opc_module *extractor,
                                     opc_error *error);

/* Measure all gates of a print ([layers] level sets) with the slices of the
   extractor (thesis 2.2.2 and 3.2.1), on all threads. [main] */
OPC_EXPORT int eda_measure(const opc_context *context, const eda_gates *gates,
                           const eda_field *print, const opc_module *extractor,
                           eda_measurement *out, opc_error *error);

/* Compute the performance of the gates as drawn. [main] */
OPC_EXPORT int eda_measure_drawn(const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *extractor,
                                 eda_performance *out, opc_error *error);

/* Deviations of printed transistors from the design, failed ones left out; NAN
   if none remains. Arrays: EDA_NMOS, EDA_PMOS, all. */
typedef struct eda_spread {
  double ion_mean[3], ion_sd[3]; /* deviation, % */
  double ion_worst;              /* largest |deviation|, % */
  double leakage[3]; /* total Ioff, relative to the same transistors as drawn */
  size_t failed, outside;
} eda_spread;

/* Compute the deviations. [any] */
OPC_EXPORT eda_spread eda_spread_of(const eda_gates *gates,
                                    const eda_performance *design,
                                    const eda_performance *printed,
                                    const uint32_t *flags);

/* A section through the middle of a gate. */
typedef struct eda_section {
  double length;    /* printed, nm; NAN: open, or merged with a neighbour */
  double low, high; /* image log slope |dI/dl| / I at the ends, 1/nm */
} eda_section;

/* Return the section through the print of EDA_POLY along the gate's length, or
   of EDA_ACTIVE along its width; `image` is the intensity of this print.
   [any] */
OPC_EXPORT eda_section eda_gate_section(const eda_gates *gates, size_t gate,
                                        int layer, const eda_field *print,
                                        const eda_field *image);

/* Return 100 (a - b) / b: thesis eq. 3.1. */
static inline double eda_deviation(double a, double b) {
  return 100 * (a - b) / b;
}

OPC_C_END
