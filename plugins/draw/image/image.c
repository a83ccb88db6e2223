/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `draw.image`: a part of a layout simulated by several
   models of optics and resist. The picture shows the aerial image of the first
   model, the contours of all models, and the distances between contours. */
#include "image.h"

#include <correct/fine.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- state: image.h ---- */

static const char *const groups[IMAGE_MODELS] = {"first", "second", "third",
                                                 "fourth"};

/* ---- work ---- */

/* Make the flat mask of the window of a mask by classes, with all shapes within
   `margin`. */
static int take_window(image_run *r, opc_error *error) {
  const eda_mask *mask = r->asked.mask;
  int code = view_init(&r->view, r->host, mask->gates, "mask", error);
  if (code) return code;
  eda_box core = eda_box_grown(view_clip(&r->view),
                               (int32_t)ceil(r->asked.margin / r->view.grid));
  return mask->access->window(mask, core, &r->part, error);
}

static int choose_mask(image_run *r, opc_error *error) {
  const eda_mask *mask = r->asked.mask;
  if (!mask == !r->asked.gates)
    return opc_fail(error, OPC_INVALID, "mask", "set either 'mask' or 'gates'");
  if (mask && mask->chip) {
    if (take_window(r, error)) return error->code;
    mask = r->part;
  }
  r->gates = mask ? mask->gates : r->asked.gates;
  int layer = eda_gates_layer(r->gates, r->asked.layer);
  const eda_shapes *all = mask ? mask->shapes : r->gates->drawn;
  if (layer < 0 || !all[layer].count)
    return opc_fail(error, OPC_INVALID, "layer", "the layout has no %s",
                    r->asked.layer);
  r->layer = (size_t)layer;
  r->shapes = &all[layer];
  r->corrected = mask != NULL;
  return r->part ? OPC_OK
                 : view_init(&r->view, r->host, r->gates,
                             mask ? "mask" : "gates", error);
}

/* Return the part of a plugin's id after the family name. */
static const char *short_name(const opc_module *m) {
  const char *dot = strchr(m->id, '.');
  return dot ? dot + 1 : m->id;
}

static void choose_models(image_run *r) {
  for (size_t k = 0; k < IMAGE_MODELS; k++) {
    const char *label = r->asked.model[k].label;
    image_model m = {.group = groups[k],
                     .litho = r->asked.model[k].litho,
                     .resist = r->asked.model[k].resist};
    if (!m.litho) continue;
    m.label = label ? g_strdup(label)
                    : g_strdup_printf("%s, %s", short_name(m.litho),
                                      short_name(m.resist));
    r->model[r->n++] = m;
  }
}

/* Compute the image and the print of the mask with a calibrated model. */
static int print_mask(const image_run *r, image_model *m, eda_printer *p,
                      opc_error *error) {
  const eda_litho *litho = &p->litho.functions;
  eda_spectrum mask;
  int code = eda_printer_spectrum(p, r->shapes, &mask, error);
  if (code) return code;
  code = litho->image(&p->litho, (int)r->layer, &mask, &m->image, error);
  eda_spectrum_clear(&mask);
  if (code) return code;
  m->print = eda_field_scaled(&m->image, 1);
  return eda_printer_develop(p, (int)r->layer, &m->print, error);
}

static int model_simulate(image_run *r, size_t k, opc_error *error) {
  image_model *m = &r->model[k];
  opc_progress progress = {
      .done = (double)k, .total = (double)r->n, .worst = NAN};
  r->host->progress(r->host, &progress);
  if (opc_cancelled(r->host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  eda_printer printer;
  eda_printer_init(&printer, r->host->context, r->gates, m->litho, m->resist,
                   r->asked.margin);
  int code = eda_printer_prepare(&printer, error);
  if (!code) code = print_mask(r, m, &printer, error);
  eda_printer_clear(&printer);
  return eda_blame(error, code, m->group);
}

/* Check the margin with the optics of each model. A margin of 0 is not checked:
   the layout is then one period of a pattern. */
static int image_check_margin(image_run *r, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code && r->asked.margin > 0; k++)
    code = correct_fine_margin(r->host, r->model[k].litho, 0, &r->asked.margin,
                               error);
  return code;
}

static void image_release(image_run *r) {
  for (size_t k = 0; k < r->n; k++) {
    g_free(r->model[k].label);
    eda_field_clear(&r->model[k].image);
    eda_field_clear(&r->model[k].print);
  }
  r->n = 0;
  eda_mask_free(r->part);
  r->part = NULL;
}

static int image_run_step(void *self, void **outputs, opc_error *error) {
  image_run *r = self;
  (void)outputs;
  int code = choose_mask(r, error);
  if (!code) choose_models(r);
  if (!code) code = image_check_margin(r, error);
  for (size_t k = 0; k < r->n && !code; k++) code = model_simulate(r, k, error);
  if (!code) code = image_measure_contours(r, error);
  if (!code) code = image_report(r, error);
  if (!code) code = image_draw(r, error);
  image_release(r);
  return code;
}

/* Return a copy of the gates whose extent is that of the simulated part: the
   window for a mask by classes, otherwise the whole layout. */
static eda_gates image_outline(const image_run *r) {
  const eda_mask *mask = r->asked.mask;
  const double *w = r->view.asked.window.values;
  eda_gates g = mask ? *mask->gates : *r->asked.gates;
  if (mask && mask->chip && r->view.asked.window.count)
    g.extent = (eda_box){(int32_t)(w[0] / g.grid), (int32_t)(w[1] / g.grid),
                         (int32_t)(w[2] / g.grid), (int32_t)(w[3] / g.grid)};
  return g;
}

/* Forecast the largest memory of any model: models run one after another. */
static int image_forecast(void *self, opc_forecast *out, opc_error *error) {
  image_run *r = self;
  eda_image_size most = {0};
  (void)error;
  if (!r->asked.mask && !r->asked.gates)
    return OPC_OK; /* `run` reports the
                      missing input */
  const eda_gates gates = image_outline(r);
  choose_models(r);
  for (size_t k = 0; k < r->n; k++) {
    eda_printer printer;
    eda_printer_init(&printer, r->host->context, &gates, r->model[k].litho,
                     r->model[k].resist, r->asked.margin);
    eda_image_size size = eda_printer_forecast(&printer, 1);
    if (size.bytes > most.bytes) most = size;
    eda_printer_clear(&printer);
  }
  out->memory = most.bytes;
  (void)snprintf(out->work, sizeof out->work,
                 "%zu images of about %.0f x %.0f points", r->n, most.columns,
                 most.rows);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'margin' or part of the layout");
  image_release(r);
  return OPC_OK;
}

/* ---- parameters ---- */

#define MODEL(group, i, required)                                              \
  OPC_PARAMETER_NAMED(                                                         \
      group ".label", image_run, asked.model[i].label, .type = OPC_TEXT,       \
      .summary = "Name in the legend (default: names of the plugins)"),        \
      OPC_PARAMETER_NAMED(group ".litho", image_run, asked.model[i].litho,     \
                          .type = OPC_SLOT, .flags = required,                 \
                          .choices = "litho",                                  \
                          .summary = "the " group " model of the optics"),     \
      OPC_PARAMETER_NAMED(                                                     \
          group ".resist", image_run, asked.model[i].resist, .type = OPC_SLOT, \
          .flags = required, .choices = "resist",                              \
          .summary =                                                           \
              "Resist of this model, calibrated with the optics of the model")

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("mask", image_run, asked.mask, .type = OPC_INPUT,
                        .choices = "mask",
                        .summary = "Corrected mask to simulate"),
    OPC_PARAMETER_NAMED(
        "gates", image_run, asked.gates, .type = OPC_INPUT, .choices = "gates",
        .summary = "Gates whose drawn mask is simulated instead of 'mask'"),
    OPC_PARAMETER_NAMED("layer", image_run, asked.layer, .type = OPC_TEXT,
                        .preset = "poly", .summary = "Layer of the mask"),
    MODEL("first", 0, OPC_REQUIRED),
    MODEL("second", 1, 0),
    MODEL("third", 2, 0),
    MODEL("fourth", 3, 0),
    OPC_PARAMETER_NAMED(
        "margin", image_run, asked.margin, .type = OPC_REAL,
        .flags = OPC_AT_LEAST, .unit = "nm", .follows = "3.886 lambda/NA",
        .min = 0,
        .summary = "clear field around the layout; the image is periodic"),
    VIEW_PARAMETERS(image_run, "image.png"),
};

static const opc_metric metrics[] = {
    {"rms", "nm", OPC_LOWER, 0.001,
     "largest rms distance of a model's contours from those of the first "
     "model"},
    {"max", "nm", OPC_LOWER, 0.001,
     "largest distance of a contour from that of the first model"},
};

static int image_check(void *self, opc_error *error) {
  image_run *r = self;
  EDA_FOLLOW(r->host, "draw.image", r, parameters,
             eda_scanner_of(r->asked.model[0].litho));
  if (view_check(&r->view, error)) return error->code;
  for (size_t k = 0; k < IMAGE_MODELS; k++) {
    int litho = r->asked.model[k].litho != NULL;
    int resist = r->asked.model[k].resist != NULL;
    if (litho == resist && (litho || !r->asked.model[k].label)) continue;
    const char *has = litho ? "litho" : resist ? "resist" : "label";
    char name[32];
    snprintf(name, sizeof name, "%s.%s", groups[k], has);
    return opc_fail(error, OPC_INVALID, name, "'%s' requires '%s.%s'", name,
                    groups[k], litho ? "resist" : "litho");
  }
  return OPC_OK;
}

/* ---- entry ---- */

static const opc_step functions = {.run = image_run_step,
                                   .forecast = image_forecast};

OPC_PLUGIN(
    image_run, .id = "draw.image", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "Draw the image of a mask and the contours by several models",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = image_check, OPC_FUNCTIONS(functions));
