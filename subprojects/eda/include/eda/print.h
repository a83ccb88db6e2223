/* SPDX-License-Identifier: BSD-3-Clause */
/* Printing the masks of a layout through a litho and a resist model, and
   measuring its transistors in the print. */
#ifndef EDA_PRINT_H
#define EDA_PRINT_H

#include <eda/check.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- printing --------------------------------------------------------- */

/* A litho model whose calls are checked, as printers and resists see it: its
   faults are told from those of the resist that calls it while it calibrates.
   `fault` is its first failure, if `failed`. Fine images with an error above
   `fine` are made with that, if it is not 0: what fine prints need serves the
   calibration, too. */
typedef struct eda_model {
  opc_module module; /* to be called in place of `litho` */
  eda_litho functions;
  const opc_context *context;
  const opc_module *litho;
  opc_error fault;
  int failed;
  double fine;
} eda_model;

/* Stays where it is made: the module points into it. [main] */
OPC_EXPORT void eda_model_init(eda_model *model, const opc_context *context,
                               const opc_module *litho);

typedef struct eda_printer {
  const opc_context *context;
  eda_model litho;
  const opc_module *resist;
  eda_frame frame;
  double grid;
  size_t layers;
  eda_field *print; /* level sets, positive where it prints */
  uint32_t simulations;

  /* Fine prints. `fine` is their error (clear field 1), to be set between
     eda_printer_init and eda_printer_prepare, which makes it 0 where the model
     has none finer than its own. The rest, [layers], is empty if it is 0: the
     intensity that was developed last, fine ones less cheap ones, and whether
     the print is a fine one. */
  double fine;
  eda_field *image, *difference;
  uint8_t *is_fine;
  uint32_t fine_simulations;

  /* To be set like `fine`: how far from the focus of the model it prints, nm,
     which only a model with image_at can; and whether it keeps `image` without
     fine prints, too. */
  double defocus;
  int keeps;

  /* To be set like `fine`: the transistors that the resist is told of, those
     that are printed; NULL where these are a part of what will be, so that what
     follows from them would differ from part to part. */
  const eda_gates *drawn;

  /* [layers], to be set at any time: the error of fine prints of that layer;
     0: `fine`. */
  double *fine_of;
} eda_printer;

/* A printer of all shapes of the gates, with a clear field of `margin` nm
   around them; without fine prints. Stays where it is made. [main] */
OPC_EXPORT void eda_printer_init(eda_printer *printer,
                                 const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *litho,
                                 const opc_module *resist, double margin);
OPC_EXPORT void eda_printer_clear(eda_printer *printer);

/* Prepare both models. Errors name the slots "litho" and "resist". [main] */
OPC_EXPORT int eda_printer_prepare(eda_printer *printer, opc_error *error);

/* What a print of `layers` of them, side by side, takes at least, beside the
   prints that are there: points of each Fourier transform, and bytes. For a
   step's forecast, which may call it before eda_printer_prepare; all is 0 if
   the model does not know its band yet. [any] */
OPC_EXPORT eda_image_size eda_printer_forecast(const eda_printer *printer,
                                               size_t layers);

/* The steps of a print, for those who vary them: the spectrum of a mask
   (merged) as the model of the optics wants it, whose functions then give the
   intensity; and from that, in place, the level set. [any] */
OPC_EXPORT int eda_printer_spectrum(const eda_printer *printer,
                                    const eda_shapes *mask, eda_spectrum *out,
                                    opc_error *error);
OPC_EXPORT int eda_printer_develop(const eda_printer *printer, int layer,
                                   eda_field *field, opc_error *error);

/* Print the masks (merged) of the layers that are marked into printer->print,
   replacing what is there; side by side. What a fine print of a layer has found
   to be missing in the cheap image of its mask is added to all that follow:
   cutting off a model's smallest terms takes away a smooth field, which two
   masks that are nearly the same have in common. [main] */
OPC_EXPORT int eda_printer_print(eda_printer *printer, const uint8_t *layers,
                                 const eda_shapes *mask, opc_error *error);

/* Print again, with the fine model, those of the layers that are marked whose
   print is not a fine one; from the masks that eda_printer_print had last, or
   any if it had none of that layer. Does nothing if `fine` is 0. [main] */
OPC_EXPORT int eda_printer_refine(eda_printer *printer, const uint8_t *layers,
                                  const eda_shapes *mask, opc_error *error);

/* From an intensity that eda_printer_print had of a layer before there was a
   difference to the level set that it gives with the present one, in place.
   [any] */
OPC_EXPORT int eda_printer_correct(const eda_printer *printer, int layer,
                                   eda_field *image, opc_error *error);

/* The level set of a layer at `factor` times the dose, from `image`, which the
   last print has kept. The caller clears *out. [any] */
OPC_EXPORT int eda_printer_at_dose(const eda_printer *printer, int layer,
                                   double factor, eda_field *out,
                                   opc_error *error);

/* ---- measuring -------------------------------------------------------- */

/* What is measured of the gates of a print. */
typedef struct eda_measurement {
  uint32_t *flags;   /* EDA_PRINT_* */
  double *extension; /* [2 * i + side], nm: eda_printed.extension */
  eda_performance performance;
} eda_measurement;

OPC_EXPORT void eda_measurement_init(eda_measurement *measurement, size_t n);
OPC_EXPORT void eda_measurement_clear(eda_measurement *measurement);

/* Prepare an extractor; errors name the slot "extractor". [main] */
OPC_EXPORT int eda_extractor_prepare(const opc_context *context,
                                     const opc_module *extractor,
                                     opc_error *error);

/* Measure all gates of a print ([layers] level sets) through the slices of the
   extractor (thesis 2.2.2 and 3.2.1), by all threads. [main] */
OPC_EXPORT int eda_measure(const opc_context *context, const eda_gates *gates,
                           const eda_field *print, const opc_module *extractor,
                           eda_measurement *out, opc_error *error);

/* The performance of the gates as drawn. [main] */
OPC_EXPORT int eda_measure_drawn(const opc_context *context,
                                 const eda_gates *gates,
                                 const opc_module *extractor,
                                 eda_performance *out, opc_error *error);

/* How far transistors of a print are off the design, those that failed left
   out; NAN where none is left. Arrays: of EDA_NMOS, of EDA_PMOS, of all. */
typedef struct eda_spread {
  double ion_mean[3], ion_sd[3]; /* of the deviation, % */
  double ion_worst;              /* the largest deviation, % */
  double leakage[3]; /* sum of Ioff, over that of the same ones as drawn */
  size_t failed, outside;
} eda_spread;

/* [any] */
OPC_EXPORT eda_spread eda_spread_of(const eda_gates *gates,
                                    const eda_performance *design,
                                    const eda_performance *printed,
                                    const uint32_t *flags);

/* A section through the middle of a gate. */
typedef struct eda_section {
  double length;    /* printed, nm; NAN: open, or merged with another */
  double low, high; /* image log slope |dI/dl| / I at its ends, 1/nm */
} eda_section;

/* Through the print of EDA_POLY along the gate's length, or of EDA_ACTIVE along
   its width; `image` is the intensity that printed so. [any] */
OPC_EXPORT eda_section eda_gate_section(const eda_gates *gates, size_t gate,
                                        int layer, const eda_field *print,
                                        const eda_field *image);

/* 100 (a - b) / b: thesis eq. 3.1. */
static inline double eda_deviation(double a, double b) {
  return 100 * (a - b) / b;
}

#ifdef __cplusplus
}
#endif
#endif
