/* SPDX-License-Identifier: BSD-3-Clause */
/* draw.mask: a picture of a corrected mask: what was drawn, the mask, what it
   prints, and how far each transistor is from its drive current. */
#include <math.h>

#include "paper.h"
#include "picture.h"

/* ---- state ---- */

enum { MASK, FILE_NAME, WINDOW, WIDTH };

typedef struct drawer {
  const opc_host *host;
  const opc_value *values;
  int format; /* PAPER_PNG and so on */
} drawer;

static const double least_range = 2; /* of the scale of deviations, % */

/* ---- work ---- */

double picture_deviation(const opc_performance *p, const opc_mask *mask,
                         size_t gate) {
  double design = mask->design.ion[gate];
  double deviation = 100 * (p->ion[gate] - design) / design;
  return isfinite(deviation) ? deviation : NAN;
}

int picture_fails(const opc_mask *mask, size_t gate) {
  return (mask->flags[gate] & ~(uint32_t)OPC_PRINT_NOTES) != 0;
}

/* The largest deviation of those that print, rounded up; what lies beyond has
   the colour of the end. */
static double deviation_range(const opc_mask *mask) {
  static const double steps[] = {2, 5, 10, 20};
  double worst = least_range;
  for (size_t i = 0; i < mask->gates->count; i++)
    if (!picture_fails(mask, i))
      worst = fmax(worst, fabs(picture_deviation(&mask->after, mask, i)));
  size_t k = 0;
  while (k + 1 < sizeof steps / sizeof steps[0] && steps[k] < worst - 1e-9) k++;
  return steps[k];
}

static int run(void *self, void **outputs, opc_error *error) {
  static const view_parts parts = {picture_title, picture_legend,
                                   picture_shapes};
  const drawer *d = self;
  (void)outputs;
  picture p = {.mask = d->values[MASK].object};
  p.range = deviation_range(p.mask);
  if (view_make(&p.view, d->host, p.mask->gates, &d->values[WINDOW],
                d->values[WIDTH].integer, "mask", error))
    return error->code;
  const char *path =
      d->host->output_path(d->host, d->values[FILE_NAME].text, error);
  if (!path) return error->code;
  return view_write(&p.view, &parts, &p, d->format, path, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .flags = OPC_REQUIRED,
              .choices = "mask",
              .summary = "The mask to draw"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "mask.png",
                   .summary = "The picture, .png, .svg or .pdf"},
    [WINDOW] = VIEW_WINDOW,
    [WIDTH] = VIEW_WIDTH,
};

/* ---- entry ---- */

static void destroy(void *self) {
  drawer *d = self;
  d->host->free(d->host, d);
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
  if (view_check_window(host, &values[WINDOW], error)) return NULL;
  drawer *d = host->alloc(host, 1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  d->host = host;
  d->values = values;
  d->format = format;
  return d;
}

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "draw.mask",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Draw a corrected mask, its print and its transistors",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
