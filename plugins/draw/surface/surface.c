/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `draw.surface`: a figure over the values of parameters,
   as in thesis figures 2.6 and 3.8, with the best setting marked. One parameter
   results in a curve; more parameters result in a heat map over the first and
   the last one. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <eda/settings.h>
#include <glib.h>
#include <math.h>
#include <opcflow/step.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

typedef struct drawer {
  const opc_host *host;
  const eda_settings *settings;
  const char *file;
  int log;
  int64_t width;
} drawer;

/* ---- work: settings ---- */

static int check_settings(const eda_settings *s, const eda_axis *scale,
                          opc_error *error) {
  size_t count = 1;
  for (size_t a = 0; a < s->n_parameters; a++) count *= s->parameters[a].count;
  if (count != s->count)
    return opc_fail(error, OPC_INVALID, "settings",
                    "%zu values for %zu settings", s->count, count);
  if (!(scale->low <= scale->high) || !s->n_parameters || s->best >= s->count)
    return opc_fail(error, OPC_INVALID, "settings",
                    "no setting has a value to draw");
  if (!isfinite(scale->low) || !isfinite(scale->high))
    return opc_fail(error, OPC_INVALID, "settings",
                    "a value of '%s' is not finite", s->name);
  if (scale->log && scale->low <= 0)
    return opc_fail(error, OPC_INVALID, "scale",
                    "a 'log' scale requires values above 0, one of '%s' is %g",
                    s->name, scale->low);
  return OPC_OK;
}

static char *with_unit(const char *name, const char *unit) {
  return unit ? g_strdup_printf("%s (%s)", name, unit) : g_strdup(name);
}

/* Set up an axis with a label for each value of a parameter. */
static void label_axis(eda_axis *axis, const eda_setting *p) {
  char **label = g_new0(char *, p->count + 1);
  for (size_t i = 0; i < p->count; i++)
    label[i] =
        p->values ? g_strdup_printf("%g", p->values[i]) : g_strdup(p->texts[i]);
  axis->title = with_unit(p->name, p->unit);
  eda_axis_label(axis, (const char *const *)label, p->count);
}

static void clear_axis(eda_axis *axis) {
  g_free((char *)axis->title);
  g_strfreev((char **)axis->label);
}

/* Return a text such as "0.54 %, fragment 22 nm, max_iterations 19". */
static char *name_best(const eda_settings *s) {
  GString *out = g_string_new(NULL);
  g_string_printf(out, "%.4g%s%s", s->figure[s->best], s->unit ? " " : "",
                  s->unit ? s->unit : "");
  size_t stride = s->count;
  for (size_t a = 0; a < s->n_parameters; a++) {
    const eda_setting *p = &s->parameters[a];
    const char *dot = strrchr(p->name, '.');
    stride /= p->count;
    g_string_append_printf(out, ", %s %s", dot ? dot + 1 : p->name,
                           p->texts[s->best / stride % p->count]);
  }
  return g_string_free(out, FALSE);
}

/* ---- work: the picture ---- */

/* Draw the title, and the best setting below the title. */
static void draw_title(const eda_paper *paper, const eda_settings *s) {
  g_autofree char *name = with_unit(s->name, s->unit);
  g_autofree char *best = name_best(s);
  eda_legend l;
  eda_legend_init(&l, paper,
                  paper->margin + eda_heading(paper, paper->margin, name));
  eda_legend_add(&l, &(eda_sign){.kind = EDA_SIGN_RING}, "best: %s", best);
}

/* Place the chart between the y axis and the right margin. */
static void place_chart(eda_chart *c, double right) {
  c->left = floor(eda_axis_width(c->paper, &c->y));
  c->width = floor(c->paper->width - c->left - right);
}

/* Draw the heat map. Parameters between the first and the last one have their
   best values. */
static void draw_map(eda_chart *c, const eda_settings *s,
                     const eda_axis *scale) {
  size_t columns = s->parameters[0].count, block = s->count / columns;
  size_t rows = s->parameters[s->n_parameters - 1].count;
  size_t between = s->best % block / rows * rows;
  double *figure = eda_alloc(columns * rows, sizeof *figure);
  for (size_t i = 0; i < columns; i++)
    memcpy(figure + i * rows, s->figure + i * block + between,
           rows * sizeof *figure);
  label_axis(&c->y, &s->parameters[s->n_parameters - 1]);
  place_chart(c, 7 * c->paper->font);
  eda_chart_field(c, scale, figure);
  eda_chart_axes(c);
  const size_t column = s->best / block, row = s->best % rows;
  eda_ring(c->paper, eda_chart_x(c, (double)column),
           eda_chart_y(c, (double)row));
  clear_axis(&c->y);
  free(figure);
}

static void draw_curve(eda_chart *c, const eda_settings *s,
                       const eda_axis *scale) {
  g_autofree char *title = with_unit(s->name, s->unit);
  eda_colour colour = eda_sequential(0.3);
  double *x = eda_alloc(s->count, sizeof *x);
  for (size_t i = 0; i < s->count; i++) x[i] = (double)i;
  c->y = *scale;
  c->y.title = title;
  eda_axis_widen(&c->y, 0.04, 0);
  place_chart(c, 1.5 * c->paper->font);
  eda_chart_axes(c);
  eda_chart_line(c, colour, 2, 0, x, s->figure, s->count);
  eda_chart_dots(c, colour, 0.2 * c->paper->font, x, s->figure, s->count);
  eda_ring(c->paper, eda_chart_x(c, (double)s->best),
           eda_chart_y(c, s->figure[s->best]));
  free(x);
}

static int surface_run(void *self, void **outputs, opc_error *error) {
  const drawer *d = self;
  const eda_settings *s = d->settings;
  double width = (double)d->width, font = fmax(9, width / 60);
  eda_axis scale = {.log = d->log};
  (void)outputs;
  eda_axis_fit(&scale, s->figure, s->count);
  if (check_settings(s, &scale, error)) return error->code;
  const char *path = d->host->output_path(d->host, d->file, error);
  if (!path) return error->code;
  eda_paper *paper =
      eda_paper_open(path, width, ceil(0.68 * width), font, error);
  if (!paper) return error->code;
  eda_chart c = {.paper = paper,
                 .top = floor(5 * font),
                 .height = floor(paper->height - 9 * font)};
  draw_title(paper, s);
  label_axis(&c.x, &s->parameters[0]);
  if (s->n_parameters > 1)
    draw_map(&c, s, &scale);
  else
    draw_curve(&c, s, &scale);
  clear_axis(&c.x);
  return eda_paper_close(paper, OPC_OK, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(drawer, settings, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "settings", .summary = "Result of a search"),
    OPC_PARAMETER(drawer, file, .type = OPC_OUTPUT, .preset = "surface.png",
                  .summary = "Picture, .png, .svg or .pdf"),
    OPC_PARAMETER_NAMED("scale", drawer, log, .type = OPC_CHOICE,
                        .preset = "linear", .choices = "linear|log",
                        .summary = "Scale of the figure"),
    OPC_PARAMETER(drawer, width, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1000",
                  .min = 300, .max = 8000,
                  .summary = "Width of the picture in pixels (.pdf: points)"),
};

static int surface_check(void *self, opc_error *error) {
  return eda_paper_check(((drawer *)self)->file, "file", error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = surface_run};

OPC_PLUGIN(drawer, .id = "draw.surface", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "draw the metric of a search over the settings",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = surface_check,
           OPC_FUNCTIONS(functions));
