/* SPDX-License-Identifier: BSD-3-Clause */
/* draw.mask: a picture of a corrected mask: what was drawn, the mask, what it
   prints, and how far each transistor is from its drive current. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "paper.h"
#include "picture.h"

/* ---- state ---- */

enum { MASK, FILE_NAME, WINDOW, WIDTH };

typedef struct drawer {
  const opc_host *host;
  const opc_value *values;
  int format; /* PAPER_PNG and so on */
} drawer;

static const char *const extensions[] = {
    [PAPER_PNG] = ".png", [PAPER_SVG] = ".svg", [PAPER_PDF] = ".pdf"};
static const double margin = 100;      /* around all shapes, nm */
static const double max_place = 1e9;   /* of a window, nm */
static const double least_range = 2;   /* of the scale of deviations, % */
static const double smallest_font = 9; /* pixels */

/* ---- work: the window ---- */

double picture_deviation(const opc_performance *p, const opc_mask *mask,
                         size_t gate) {
  double design = mask->design.ion[gate];
  double deviation = 100 * (p->ion[gate] - design) / design;
  return isfinite(deviation) ? deviation : NAN;
}

/* The largest deviation of those that print, rounded up; what lies beyond has
   the colour of the end. */
static double deviation_range(const opc_mask *mask) {
  static const double steps[] = {2, 5, 10, 20};
  double worst = least_range;
  for (size_t i = 0; i < mask->gates->count; i++)
    if (!mask->flags[i])
      worst = fmax(worst, fabs(picture_deviation(&mask->after, mask, i)));
  size_t k = 0;
  while (k + 1 < sizeof steps / sizeof steps[0] && steps[k] < worst - 1e-9) k++;
  return steps[k];
}

static int choose_window(const drawer *d, picture *p, opc_error *error) {
  const opc_gates *g = p->mask->gates;
  const opc_value *window = &d->values[WINDOW];
  opc_box e = g->extent;
  if (e.x0 >= e.x1 || e.y0 >= e.y1)
    return d->host->fail(d->host, error, OPC_INVALID, "mask",
                         "the layout is empty, there is nothing to draw");
  double x0 = e.x0 * g->grid - margin, x1 = e.x1 * g->grid + margin;
  double y0 = e.y0 * g->grid - margin, y1 = e.y1 * g->grid + margin;
  if (window->type != OPC_ABSENT) {
    const double *w = window->reals;
    if (w[0] >= x1 || w[2] <= x0 || w[1] >= y1 || w[3] <= y0)
      return d->host->fail(
          d->host, error, OPC_INVALID, "window",
          "'window' lies beside the layout, which goes from (%g, %g) "
          "to (%g, %g) nm",
          x0 + margin, y0 + margin, x1 - margin, y1 - margin);
    x0 = w[0], y0 = w[1], x1 = w[2], y1 = w[3];
  } else {
    /* A tall or flat layout gets room at its sides, so that the picture does
       not become a strip. */
    double more = (y1 - y0) / 1.5 - (x1 - x0);
    if (more > 0) x0 -= more / 2, x1 += more / 2;
    more = (x1 - x0) / 4 - (y1 - y0);
    if (more > 0) y0 -= more / 2, y1 += more / 2;
  }
  p->x0 = x0, p->y0 = y0, p->x1 = x1, p->y1 = y1;
  return OPC_OK;
}

/* Where all lies on a paper of the width that was asked for; its height. */
static double lay_out(picture *p) {
  double room = p->paper - 2 * picture_margin(p);
  double aspect = (p->y1 - p->y0) / (p->x1 - p->x0);
  double fit = fmin(room, 1.5 * room / aspect);
  p->scale = fit / (p->x1 - p->x0);
  p->width = fmax(1, round(fit));
  p->height = fmax(1, round(fit * aspect));
  p->left = floor((p->paper - p->width) / 2);
  double title = picture_title(p, 0, 0);
  p->top = ceil(picture_margin(p) + title);
  double bottom = p->top + p->height;
  return ceil(bottom + picture_legend(p, bottom, 0) + picture_margin(p));
}

/* ---- work: the picture ---- */

/* The same letters on every screen. */
static void set_font(cairo_t *cairo) {
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

/* The height of the paper, from a surface that is only there to measure. */
static double measure(picture *p) {
  cairo_surface_t *s = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
  p->cairo = cairo_create(s);
  set_font(p->cairo);
  double height = lay_out(p);
  cairo_destroy(p->cairo);
  cairo_surface_destroy(s);
  return height;
}

static int paint(picture *p, opc_error *error) {
  set_font(p->cairo);
  cairo_set_source_rgb(p->cairo, 1, 1, 1);
  cairo_paint(p->cairo);
  int code = picture_shapes(p, error);
  if (code) return code;
  picture_title(p, picture_margin(p), 1);
  picture_legend(p, p->top + p->height, 1);
  return OPC_OK;
}

static int write_file(const drawer *d, picture *p, const char *path,
                      opc_error *error) {
  paper file;
  double height = measure(p);
  int code =
      paper_open(&file, d->host, d->format, path, p->paper, height, error);
  if (code) return code;
  p->cairo = file.cairo;
  return paper_close(&file, paint(p, error), error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const drawer *d = self;
  (void)outputs;
  picture p = {.host = d->host, .mask = d->values[MASK].object};
  p.paper = (double)d->values[WIDTH].integer;
  p.font = fmax(smallest_font, p.paper / 72);
  p.raster = d->format == PAPER_PNG;
  p.range = deviation_range(p.mask);
  if (choose_window(d, &p, error)) return error->code;
  const char *path =
      d->host->output_path(d->host, d->values[FILE_NAME].text, error);
  return path ? write_file(d, &p, path, error) : error->code;
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
    [WINDOW] = {.name = "window",
                .type = OPC_REALS,
                .unit = "nm",
                .summary = "What to draw, [x0, y0, x1, y1] (default: all)"},
    [WIDTH] = {.name = "width",
               .type = OPC_INT,
               .flags = OPC_AT_LEAST | OPC_AT_MOST,
               .preset = "1600",
               .min = 200,
               .max = 8000,
               .summary = "The width of the picture in pixels (.pdf: points)"},
};

/* ---- entry ---- */

static void destroy(void *self) {
  drawer *d = self;
  d->host->free(d->host, d);
}

/* PAPER_PNG and so on, -1 for neither. */
static int format_of(const char *file) {
  const char *dot = strrchr(file, '.');
  for (int i = 0; dot && i < 3; i++)
    if (!strcasecmp(dot, extensions[i])) return i;
  return -1;
}

static int check_window(const opc_host *host, const opc_value *window,
                        opc_error *error) {
  const double *w = window->reals;
  if (window->type == OPC_ABSENT) return OPC_OK;
  if (window->count != 4)
    return host->fail(host, error, OPC_INVALID, "window",
                      "'window' needs 4 lengths, [x0, y0, x1, y1], not %zu",
                      window->count);
  for (int i = 0; i < 4; i++)
    if (!(fabs(w[i]) <= max_place))
      return host->fail(host, error, OPC_INVALID, "window",
                        "'window': %g nm is too far away", w[i]);
  if (!(w[2] - w[0] >= 1 && w[3] - w[1] >= 1))
    return host->fail(host, error, OPC_INVALID, "window",
                      "'window': x1 and y1 must be at least 1 nm above "
                      "x0 and y0");
  return OPC_OK;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const char *file = values[FILE_NAME].text;
  int format = format_of(file);
  if (format < 0) {
    host->fail(host, error, OPC_INVALID, "file",
               "'%s': a picture is a .png, .svg or .pdf file", file);
    return NULL;
  }
  if (check_window(host, &values[WINDOW], error)) return NULL;
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
