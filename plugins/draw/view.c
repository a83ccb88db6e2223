/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the selection of a layout window and its placement on paper with
   title and legend. */
#include "view.h"

#include <math.h>

static const double around = 100;      /* margin around all shapes, nm */
static const double max_place = 1e9;   /* largest coordinate of a window, nm */
static const double smallest_font = 9; /* pixels */

/* ---- the window ---- */

int view_check(const view *v, opc_error *error) {
  const double *w = v->asked.window.values;
  if (eda_paper_check(v->asked.file, "file", error)) return error->code;
  if (!v->asked.window.count) return OPC_OK;
  if (v->asked.window.count != 4)
    return opc_fail(error, OPC_INVALID, "window",
                    "'window' must be 4 lengths, [x0, y0, x1, y1], found %zu",
                    v->asked.window.count);
  for (int i = 0; i < 4; i++)
    if (!(fabs(w[i]) <= max_place))
      return opc_fail(error, OPC_INVALID, "window",
                      "'window': %g nm is outside of the range of coordinates",
                      w[i]);
  if (!(w[2] - w[0] >= 1 && w[3] - w[1] >= 1))
    return opc_fail(error, OPC_INVALID, "window",
                    "'window': x1 and y1 must be at least 1 nm above "
                    "x0 and y0");
  return OPC_OK;
}

/* Show the whole layout, with extra space beside a tall or flat layout. */
static void show_all(view *v, const double all[4]) {
  double width = all[2] - all[0] + 2 * around;
  double height = all[3] - all[1] + 2 * around;
  double more_x = fmax(0, height / 1.5 - width) / 2;
  double more_y = fmax(0, (width + 2 * more_x) / 4 - height) / 2;
  v->x0 = all[0] - around - more_x, v->x1 = all[2] + around + more_x;
  v->y0 = all[1] - around - more_y, v->y1 = all[3] + around + more_y;
}

int view_init(view *v, const opc_host *host, const eda_gates *gates,
              const char *source, opc_error *error) {
  eda_box e = gates->extent;
  const double all[] = {e.x0 * gates->grid, e.y0 * gates->grid,
                        e.x1 * gates->grid, e.y1 * gates->grid};
  const double *w = v->asked.window.values;
  v->context = host->context;
  v->grid = gates->grid;
  if (e.x0 >= e.x1 || e.y0 >= e.y1)
    return opc_fail(error, OPC_INVALID, source,
                    "the layout is empty and cannot be drawn");
  if (!v->asked.window.count) {
    show_all(v, all);
  } else if (w[0] >= all[2] + around || w[2] <= all[0] - around ||
             w[1] >= all[3] + around || w[3] <= all[1] - around) {
    return opc_fail(error, OPC_INVALID, "window",
                    "'window' is outside of the layout, which extends from "
                    "(%g, %g) to (%g, %g) nm",
                    all[0], all[1], all[2], all[3]);
  } else {
    v->x0 = w[0], v->y0 = w[1], v->x1 = w[2], v->y1 = w[3];
  }
  v->path = host->output_path(host, v->asked.file, error);
  return v->path ? OPC_OK : error->code;
}

/* ---- the paper ---- */

/* Compute the positions on paper of the requested width. Returns the height. */
static double lay_out(view *v, const view_parts *parts, const void *picture) {
  double margin = v->paper->margin, space = v->paper->width - 2 * margin;
  double aspect = (v->y1 - v->y0) / (v->x1 - v->x0);
  double fit = fmin(space, 1.5 * space / aspect);
  v->scale = fit / (v->x1 - v->x0);
  v->width = fmax(1, round(fit));
  v->height = fmax(1, round(fit * aspect));
  v->left = floor((v->paper->width - v->width) / 2);
  v->top = ceil(margin + parts->title(picture, 0));
  double bottom = v->top + v->height;
  return ceil(bottom + parts->legend(picture, bottom) + margin);
}

static void draw_border(const view *v) {
  eda_use(v->paper->cairo, eda_faint);
  cairo_set_line_width(v->paper->cairo, 1);
  cairo_rectangle(v->paper->cairo, v->left - 0.5, v->top - 0.5, v->width + 1,
                  v->height + 1);
  cairo_stroke(v->paper->cairo);
  eda_use(v->paper->cairo, eda_ink);
}

static int view_paint(const view *v, const view_parts *parts,
                      const void *picture, opc_error *error) {
  cairo_t *cairo = v->paper->cairo;
  cairo_save(cairo);
  cairo_rectangle(cairo, v->left, v->top, v->width, v->height);
  cairo_clip(cairo);
  int code = parts->content(picture, error);
  cairo_restore(cairo);
  if (code) return code;
  draw_border(v);
  parts->title(picture, v->paper->margin);
  parts->legend(picture, v->top + v->height);
  return OPC_OK;
}

int view_write(view *v, const view_parts *parts, const void *picture,
               opc_error *error) {
  double width = (double)v->asked.width;
  v->paper =
      eda_paper_open(v->path, width, 0, fmax(smallest_font, width / 72), error);
  if (!v->paper) return error->code;
  eda_paper_cut(v->paper, lay_out(v, parts, picture));
  return eda_paper_close(v->paper, view_paint(v, parts, picture, error), error);
}

void view_add_scale_bar(const view *v, eda_legend *legend) {
  double space = (v->x1 - v->x0) / 6;
  double unit = pow(10, floor(log10(space))), nm = unit;
  if (space >= 2 * unit) nm = 2 * unit;
  if (space >= 5 * unit) nm = 5 * unit;
  eda_legend_add(legend,
                 &(eda_sign){.kind = EDA_SIGN_BAR, .size = nm * v->scale},
                 "%g %s", nm < 1000 ? nm : nm / 1000, nm < 1000 ? "nm" : "um");
}
