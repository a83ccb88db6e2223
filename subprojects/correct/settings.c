/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements simulation, measurement and the set-up of the loop from a step's
   settings. */
#include <correct/settings.h>

#include <eda/check.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include <correct/fine.h>
#include <correct/loop.h>

static int settings_check_overlay(opc_reals overlay, opc_error *error) {
  static const double most = 1e3; /* nm */
  if (overlay.count && overlay.count != 2)
    return opc_fail(error, OPC_INVALID, "overlay",
                    "'overlay' has %zu values, expected 2: along x and y",
                    overlay.count);
  for (size_t i = 0; i < overlay.count; i++)
    if (!(fabs(overlay.values[i]) <= most))
      return opc_fail(error, OPC_INVALID, "overlay",
                      "'overlay' is %g nm, expected at most %g nm",
                      overlay.values[i], most);
  return OPC_OK;
}

int correct_settings_check(correct_settings *with, const opc_host *host,
                           opc_error *error) {
  int code = settings_check_overlay(with->overlay, error);
  if (!code)
    code = correct_fine_error(with->fine_text, with->ion_limit, &with->fine,
                              error);
  return code ? code
              : correct_fine_margin(host, with->litho, with->fine,
                                    &with->margin, error);
}

/* Measured constants of the forecast of memory (plugins/correct/README.md),
   bytes. */
static const struct {
  double start, start_fine; /* memory of libraries and kernels */
  double gate, fragments;   /* memory of a transistor, and of its edge
                               fragments */
  double prints;            /* number of stored level sets in addition to the
                               last one */
} memory = {16e6, 30e6, 12e3, 17e3, 2};

void correct_forecast(const correct_settings *with, const opc_host *host,
                      const eda_gates *g, const char *prints,
                      const char *fine_prints, opc_forecast *out) {
  eda_printer printer;
  size_t layers = 0;
  for (size_t k = 0; k < g->layers; k++) layers += g->corrected[k] != 0;
  eda_printer_init(&printer, host->context, g, with->litho, with->resist,
                   with->margin);
  printer.fine = with->fine;
  int finely = with->fine > 0 && printer.litho.functions.image_fine;
  eda_image_size size = eda_printer_forecast(&printer, layers);
  eda_printer_clear(&printer);
  const eda_synthesizer *s =
      with->synthesizer ? with->synthesizer->functions : NULL;
  out->memory =
      (finely ? memory.start_fine : memory.start) + size.bytes +
      memory.prints * size.field +
      (double)g->count * (memory.gate + (s && s->cut ? memory.fragments : 0));
  (void)snprintf(out->work, sizeof out->work,
                 "%s of %zu layer%s, about %.0f x %.0f points each",
                 finely ? fine_prints : prints, layers, layers == 1 ? "" : "s",
                 size.columns, size.rows);
  (void)snprintf(out->help, sizeof out->help,
                 "part of the layout, a smaller 'margin', or 'layout' for "
                 "'gates', with 'divide: environments'");
}

/* ---- printing ---- */

/* Simulate and measure shapes and move the level sets to *print, that of active
   displaced by the overlay. Discard cached images of the printer first. */
static int print_shapes(const correct_settings *with, eda_printer *p,
                        const eda_gates *g, const eda_shapes *shapes,
                        eda_measurement *measured, eda_field *print,
                        opc_error *error) {
  eda_measurement_init(measured, g->count);
  for (size_t k = 0; k < g->layers; k++) {
    eda_field_clear(&p->image[k]);
    p->is_fine[k] = 0;
  }
  int code = (p->fine > 0 ? eda_printer_refine : eda_printer_print)(
      p, g->corrected, shapes, error);
  if (!code && with->overlay.count && g->layers > EDA_ACTIVE)
    eda_field_shift(&p->print[EDA_ACTIVE], with->overlay.values[0],
                    with->overlay.values[1]);
  if (!code)
    code =
        eda_measure(p->context, g, p->print, with->extractor, measured, error);
  for (size_t k = 0; k < g->layers; k++) {
    print[k] = p->print[k];
    p->print[k] = (eda_field){0};
  }
  return code;
}

static int measure_design(const correct_settings *with,
                          const opc_context *context, eda_mask *m,
                          opc_error *error) {
  if (m->design.ion) return OPC_OK;
  eda_performance_init(&m->design, m->gates->count);
  int code = eda_extractor_prepare(context, with->extractor, error);
  return code ? code
              : eda_measure_drawn(context, m->gates, with->extractor,
                                  &m->design, error);
}

int correct_print(const correct_settings *with, const opc_host *host, int sized,
                  eda_mask *m, uint32_t **flags_before, double **extension,
                  opc_error *error) {
  const eda_gates *g = m->gates;
  eda_measurement measured = {0};
  eda_printer printer;
  eda_printer_init(&printer, host->context, g, with->litho, with->resist,
                   with->margin);
  printer.fine = with->fine;
  if (!sized) printer.drawn = NULL;
  int code = eda_printer_prepare(&printer, error);
  if (!code) code = measure_design(with, host->context, m, error);
  if (!code)
    code = correct_fine_by_drawn(
        &printer, host, g, with->extractor,
        correct_fine_change(with->fine_text, with->ion_limit), error);
  if (!code && flags_before) {
    code = print_shapes(with, &printer, g, g->drawn, &measured, m->drawn_print,
                        error);
    m->before = measured.performance;
    *flags_before = measured.flags;
    free(measured.extension);
    measured = (eda_measurement){0};
  }
  if (!code)
    code =
        print_shapes(with, &printer, g, m->shapes, &measured, m->print, error);
  m->after = measured.performance;
  m->flags = measured.flags;
  *extension = measured.extension;
  m->simulations = printer.simulations;
  m->fine_simulations = printer.fine_simulations;
  eda_printer_clear(&printer);
  return code;
}

/* ---- rules of the print ---- */

/* Initial capacity of the list of violations, rarely exceeded. */
enum { CAPACITY = 10000, CAPACITY_OF_GATE = 16 };

int correct_violations(const opc_context *context, const opc_module *regulator,
                       const eda_printed *printed, eda_violation **out,
                       size_t *count, opc_error *error) {
  size_t capacity = 0;
  int code = OPC_OK;
  *out = NULL;
  *count = CAPACITY + CAPACITY_OF_GATE * printed->gates->count;
  while (!code && *count > capacity) {
    free(*out);
    capacity = *count;
    *out = eda_alloc(capacity, sizeof **out);
    code = eda_call_violations(context, regulator, printed, *out, capacity,
                               count, error);
  }
  return eda_blame(error, code, "regulator");
}

int correct_sketch_mask(const eda_gates *gates, void **outputs) {
  eda_mask *m = outputs[0] = eda_mask_new(gates);
  eda_performance_init(&m->design, gates->count);
  eda_performance_init(&m->before, gates->count);
  eda_performance_init(&m->after, gates->count);
  m->flags = eda_alloc(gates->count, sizeof *m->flags);
  return OPC_OK;
}

int correct_save_mask(void *self, void *const *outputs, const char *folder,
                      opc_error *error) {
  (void)self;
  return eda_mask_save(outputs[0], folder, error);
}

static int guard_is_on(const correct_settings *with) {
  if (with->guard != CORRECT_GUARD_AUTO) return with->guard == CORRECT_GUARD_ON;
  const eda_synthesizer *s = with->synthesizer->functions;
  return !s->cut;
}

void correct_loop_init(loop *l, const opc_host *host, const eda_gates *gates,
                       const correct_settings *with) {
  *l = (loop){
      .host = host,
      .gates = gates,
      .extractor = with->extractor,
      .regulator = with->regulator,
      .max_iterations = with->max_iterations,
      .hold = guard_is_on(with),
      .ion_limit = with->ion_limit,
      .rules = with->rules,
      .fine_change = correct_fine_change(with->fine_text, with->ion_limit),
      .drivers = {[MAIN].module = with->synthesizer}};
  eda_printer_init(&l->printer, host->context, gates, with->litho, with->resist,
                   with->margin);
  l->printer.fine = with->fine;
}
