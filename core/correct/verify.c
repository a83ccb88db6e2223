/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `verify`: a corrected mask printed and measured by other models
   than those of its loop. */
#include "core/correct/loop.h"
#include "core/plugin/host.h"

#include <string.h>

/* ---- state ---- */

enum { MASK, LITHO, RESIST, EXTRACT, MARGIN, PARAMETERS };

typedef struct verify {
  const opc_host *host;
  const opc_value *values;
} verify;

/* ---- work ---- */

static int no_memory(opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "out of memory");
}

/* The mask with the prints and the performance that these models give it. What
   the loop measured is its performance before. */
static int look_again(opc_printer *printer, const opc_module *extract,
                      const opc_mask *in, opc_mask *out,
                      opc_measurement *measured, opc_error *error) {
  const opc_host *host = printer->host;
  const opc_gates *gates = in->gates;
  static const int both[OPC_MASKS] = {1, 1};
  if (!opc_performance_make(host, gates->count, &out->design) ||
      !opc_performance_make(host, gates->count, &out->before) ||
      !opc_measurement_make(host, gates->count, measured))
    return no_memory(error);
  opc_performance_copy(&out->before, &in->after);
  int code = opc_printer_prepare(printer, error);
  if (!code) code = opc_extract_prepare(extract, error);
  if (!code) code = opc_measure_drawn(gates, extract, &out->design, error);
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    code = host->geometry->boolean(host, OPC_OR, &in->shapes[layer], NULL,
                                   &out->shapes[layer], error);
  if (!code) code = opc_printer_print(printer, both, out->shapes, error);
  if (!code)
    code = opc_measure_all(host, gates, printer->print, extract, measured,
                           error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const verify *c = self;
  const opc_value *v = c->values;
  const opc_host *host = c->host;
  const opc_mask *in = v[MASK].object;
  opc_mask *out = host->alloc(host, 1, sizeof *out);
  if (!out) return no_memory(error);
  *out = (opc_mask){.size = sizeof *out, .gates = in->gates,
                    .iterations = in->iterations};
  outputs[0] = out;   /* released by the host if this fails */
  opc_measurement measured = {0};
  opc_printer printer;
  opc_printer_make(&printer, host, in->gates, v[LITHO].object,
                   v[RESIST].object, v[MARGIN].real);
  int code = look_again(&printer, v[EXTRACT].object, in, out, &measured, error);
  memcpy(out->print, printer.print, sizeof out->print);
  out->after = measured.performance;
  out->flags = measured.flags;
  out->simulations = printer.simulations;
  const opc_report report = {.mask = out, .extension = measured.extension,
                             .corrected = in};
  if (!code) code = opc_report_mask(host, &report, error);
  host->free(host, measured.extension);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [MASK] = {.name = "mask", .type = OPC_INPUT, .flags = OPC_REQUIRED,
              .choices = "mask", .summary = "the corrected mask"},
    [LITHO] = {.name = "litho", .type = OPC_SLOT, .flags = OPC_REQUIRED,
               .choices = "litho", .summary = "model of the optics"},
    [RESIST] = {.name = "resist", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                .choices = "resist", .summary = "model of the resist"},
    [EXTRACT] = {.name = "extract", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                 .choices = "extract",
                 .summary = "performance of a printed transistor"},
    [MARGIN] = {.name = "margin", .type = OPC_REAL, .flags = OPC_AT_LEAST,
                .unit = "nm", .preset = "1000 nm", .min = 0,
                .summary = "clear field around the layout, which repeats beyond"},
};

static const opc_metric metrics[] = {
    {.name = "ion_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |Ion deviation|"},
    {.name = "ion_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |Ion deviation|"},
    {.name = "ion_stdv", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "standard deviation of the Ion deviation, thesis eq. 3.5"},
    {.name = "area_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |gate area deviation|"},
    {.name = "area_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |gate area deviation|"},
    {.name = "ioff_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.1,
     .summary = "mean of |Ioff deviation|"},
    {.name = "ion_change_mean", .unit = "%", .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "mean of |difference| of the Ion deviation to that in the loop"},
    {.name = "ion_change_max", .unit = "%", .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |difference| of the Ion deviation to that in the loop"},
    {.name = "failed", .better = OPC_LOWER,
     .summary = "transistors that do not print as one of their own"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  verify *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    no_memory(error);
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static void destroy(void *self) {
  verify *c = self;
  c->host->free(c->host, c);
}

/* ---- entry ---- */

static const opc_port ports[] = {{"mask", "mask", opc_mask_release}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = 1,
                                    .port_size = sizeof(opc_port),
                                    .outputs = ports,
                                    .run = run};

extern const opc_plugin opc_verify_plugin;
const opc_plugin opc_verify_plugin = {
    .size = sizeof(opc_plugin),
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "verify",
    .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "print and measure a corrected mask with other models",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};
