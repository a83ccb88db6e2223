/* SPDX-License-Identifier: BSD-3-Clause */
/* draw.surface: a figure over the settings of parameters, as in thesis figures
   2.6 and 3.8, with the best one marked. */
#include <math.h>

#include "../mask/paper.h"
#include "plot.h"

/* ---- state ---- */

enum { SETTINGS, FILE_NAME, SCALE, WIDTH };

typedef struct drawer {
  const opc_host *host;
  const opc_value *values;
  int format;
} drawer;

/* ---- work ---- */

static int check(const drawer *d, const opc_settings *s, const scale *of,
                 opc_error *error) {
  size_t count = 1;
  for (size_t a = 0; a < s->n_parameters; a++) count *= s->parameters[a].count;
  if (count != s->count)
    return d->host->fail(d->host, error, OPC_INVALID, "settings",
                         "%zu figures for %zu settings", s->count, count);
  if (!(of->low <= of->high) || !s->n_parameters || s->best >= s->count)
    return d->host->fail(d->host, error, OPC_INVALID, "settings",
                         "no setting has a figure: nothing to draw");
  if (!isfinite(of->low) || !isfinite(of->high))
    return d->host->fail(d->host, error, OPC_INVALID, "settings",
                         "a figure of '%s' is not finite", s->name);
  if (of->log && of->low <= 0)
    return d->host->fail(d->host, error, OPC_INVALID, "scale",
                         "a 'log' scale needs figures above 0, one of '%s' is "
                         "%g",
                         s->name, of->low);
  return OPC_OK;
}

static int run(void *self, void **outputs, opc_error *error) {
  const drawer *d = self;
  (void)outputs;
  const opc_settings *s = d->values[SETTINGS].object;
  double width = (double)d->values[WIDTH].integer;
  plot p = {.settings = s,
            .scale = scale_of(s, d->values[SCALE].integer == 1),
            .width = width,
            .height = plot_height(width),
            .font = fmax(9, width / 60)};
  int code = check(d, s, &p.scale, error);
  if (code) return code;
  p.block = s->count / s->parameters[0].count;
  p.last = s->parameters[s->n_parameters - 1].count;
  const char *path =
      d->host->output_path(d->host, d->values[FILE_NAME].text, error);
  if (!path) return error->code;
  paper sheet;
  code = paper_open(&sheet, d->host, d->format, path, p.width, p.height, error);
  if (code) return code;
  p.cairo = sheet.cairo;
  plot_draw(&p);
  return paper_close(&sheet, OPC_OK, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    [SETTINGS] = {.name = "settings",
                  .type = OPC_INPUT,
                  .flags = OPC_REQUIRED,
                  .choices = "settings",
                  .summary = "what a search has found"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "surface.png",
                   .summary = "the picture, .png, .svg or .pdf"},
    [SCALE] = {.name = "scale",
               .type = OPC_CHOICE,
               .preset = "linear",
               .choices = "linear|log",
               .summary = "of the figure"},
    [WIDTH] = {.name = "width",
               .type = OPC_INT,
               .flags = OPC_AT_LEAST | OPC_AT_MOST,
               .preset = "1000",
               .min = 300,
               .max = 8000,
               .summary = "of the picture in pixels (.pdf: points)"},
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
  drawer *d = host->alloc(host, 1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  *d = (drawer){host, values, format};
  return d;
}

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "draw.surface",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "draw the figure of a search over the settings it has tried",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
