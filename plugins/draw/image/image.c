/* SPDX-License-Identifier: BSD-3-Clause */
/* draw.image: one place of a layout under several models of optics and resist:
   the aerial image of the first, the contours that each prints, and how far
   they are apart. */
#include <stdio.h>
#include <string.h>

#include "../mask/paper.h"
#include "image.h"

/* ---- state ---- */

enum { LABEL, LITHO, RESIST, MODEL_PARAMETERS };

enum {
  MASK,
  GATES,
  LAYER,
  MODELS,
  WINDOW = MODELS + IMAGE_MODELS * MODEL_PARAMETERS,
  WIDTH,
  MARGIN,
  FILE_NAME,
  PARAMETERS
};

static const char *const groups[IMAGE_MODELS] = {"first", "second", "third",
                                                 "fourth"};

typedef struct drawer {
  const opc_host *host;
  const opc_value *values;
  int format; /* PAPER_PNG and so on */
} drawer;

/* ---- work ---- */

static int choose_mask(const drawer *d, image_run *r, opc_error *error) {
  const opc_host *host = d->host;
  const opc_mask *mask = d->values[MASK].object;
  const opc_gates *gates = d->values[GATES].object;
  if (!mask == !gates)
    return host->fail(host, error, OPC_INVALID, "mask",
                      "one of 'mask' and 'gates' is needed, and not both");
  r->layer = (int)d->values[LAYER].integer;
  r->gates = mask ? mask->gates : gates;
  r->mask = mask ? &mask->shapes[r->layer] : &gates->drawn[r->layer];
  r->corrected = mask != NULL;
  r->margin = d->values[MARGIN].real;
  if (r->mask->count)
    return view_make(&r->view, host, r->gates, &d->values[WINDOW],
                     d->values[WIDTH].integer, mask ? "mask" : "gates", error);
  return host->fail(host, error, OPC_INVALID, "layer",
                    "there is no %s in the layout", d->values[LAYER].text);
}

/* What comes behind the family of a plugin's id. */
static const char *short_name(const opc_module *m) {
  const char *dot = strchr(m->plugin->id, '.');
  return dot ? dot + 1 : m->plugin->id;
}

static void choose_models(const drawer *d, image_run *r) {
  for (size_t k = 0; k < IMAGE_MODELS; k++) {
    const opc_value *v = &d->values[MODELS + k * MODEL_PARAMETERS];
    if (v[LITHO].type == OPC_ABSENT) continue;
    image_model *m = &r->model[r->n++];
    m->litho = v[LITHO].object;
    m->resist = v[RESIST].object;
    if (v[LABEL].type != OPC_ABSENT)
      (void)snprintf(m->label, sizeof m->label, "%s", v[LABEL].text);
    else
      (void)snprintf(m->label, sizeof m->label, "%s, %s", short_name(m->litho),
                     short_name(m->resist));
  }
}

static int run(void *self, void **outputs, opc_error *error) {
  const drawer *d = self;
  const opc_host *host = d->host;
  (void)outputs;
  image_run r = {.n = 0};
  if (choose_mask(d, &r, error)) return error->code;
  choose_models(d, &r);
  const char *path = host->output_path(host, d->values[FILE_NAME].text, error);
  int code = path ? image_simulate(&r, error) : error->code;
  if (!code) code = image_measure_contours(&r, error);
  if (!code) code = image_report(&r, error);
  if (!code) code = image_draw(&r, d->format, path, error);
  for (size_t k = 0; k < r.n; k++) {
    host->imaging->release_field(host, &r.model[k].image);
    host->imaging->release_field(host, &r.model[k].print);
  }
  return code;
}

/* ---- parameters ---- */

#define MODEL(group, required)                                            \
  {.name = group ".label",                                                \
   .type = OPC_TEXT,                                                      \
   .summary = "what the legend calls it; by default its plugins' names"}, \
      {.name = group ".litho",                                            \
       .type = OPC_SLOT,                                                  \
       .flags = required,                                                 \
       .choices = "litho",                                                \
       .summary = "the " group " model of the optics"},                   \
  {                                                                       \
    .name = group ".resist", .type = OPC_SLOT, .flags = required,         \
    .choices = "resist",                                                  \
    .summary = "the resist that goes with it, calibrated through it"      \
  }

static const opc_parameter parameters[PARAMETERS] = {
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .choices = "mask",
              .summary = "a corrected mask that is printed"},
    [GATES] = {.name = "gates",
               .type = OPC_INPUT,
               .choices = "gates",
               .summary = "in its place: the mask as drawn"},
    [LAYER] = {.name = "layer",
               .type = OPC_CHOICE,
               .preset = "poly",
               .choices = "poly|active",
               .summary = "which of its layers"},
    [MODELS] = MODEL("first", OPC_REQUIRED),
    MODEL("second", 0),
    MODEL("third", 0),
    MODEL("fourth", 0),
    [WINDOW] = VIEW_WINDOW,
    [WIDTH] = VIEW_WIDTH,
    [MARGIN] = {.name = "margin",
                .type = OPC_REAL,
                .flags = OPC_AT_LEAST,
                .unit = "nm",
                .preset = "1000 nm",
                .min = 0,
                .summary =
                    "clear field around the layout, which repeats beyond"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "image.png",
                   .summary = "The picture, .png, .svg or .pdf"},
};

static const opc_metric metrics[] = {
    {.name = "rms",
     .unit = "nm",
     .better = OPC_LOWER,
     .tolerance = 0.001,
     .summary = "root of the mean square distance of contours from the "
                "first's, of the model with most"},
    {.name = "max",
     .unit = "nm",
     .better = OPC_LOWER,
     .tolerance = 0.001,
     .summary = "largest distance of a contour from the first's"},
};

static int check_models(const opc_host *host, const opc_value *values,
                        opc_error *error) {
  static const char *const names[] = {[LITHO] = "litho", [RESIST] = "resist"};
  for (size_t k = 0; k < IMAGE_MODELS; k++) {
    const opc_value *v = &values[MODELS + k * MODEL_PARAMETERS];
    int litho = v[LITHO].type != OPC_ABSENT;
    int resist = v[RESIST].type != OPC_ABSENT;
    int label = v[LABEL].type != OPC_ABSENT;
    if (litho == resist && litho >= label) continue;
    int missing = litho ? RESIST : LITHO;
    char name[32];
    (void)snprintf(name, sizeof name, "%s.%s", groups[k],
                   litho    ? "litho"
                   : resist ? "resist"
                            : "label");
    return host->fail(host, error, OPC_INVALID, name,
                      "'%s' needs '%s.%s' beside it", name, groups[k],
                      names[missing]);
  }
  return OPC_OK;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const char *file = values[FILE_NAME].text;
  int format = paper_format(file);
  if (format < 0) {
    host->fail(host, error, OPC_INVALID, "file",
               "'%s': a picture is a .png, .svg or .pdf file", file);
    return NULL;
  }
  if (view_check_window(host, &values[WINDOW], error) ||
      check_models(host, values, error))
    return NULL;
  drawer *d = host->alloc(host, 1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  *d = (drawer){.host = host, .values = values, .format = format};
  return d;
}

static void destroy(void *self) {
  drawer *d = self;
  d->host->free(d->host, d);
}

/* ---- entry ---- */

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "draw.image",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Draw the image of a mask and what several models print of it",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
