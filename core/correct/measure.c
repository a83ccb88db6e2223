/* SPDX-License-Identifier: BSD-3-Clause */
/* Cut lines through the printed poly and active of each transistor: how wide
   the active prints, how long the poly prints at each slice, and how far it
   goes past the active. */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/imaging/spline.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>

/* How far beyond the drawn gate a print is looked for, nm. */
static const double reach = 300;

/* A cut line and the room for its coefficients. */
typedef struct cut {
  opc_line line;
  double *room;
  int capacity;
} cut;

static int cut_at(cut *c, const opc_field *field, int axis, double at,
                  double from, double to) {
  int need = opc_line_room(field, axis, from, to);
  if (need > c->capacity) {
    free(c->room);
    c->capacity = 2 * need;
    c->room = malloc(sizeof *c->room * (size_t)c->capacity);
    if (!c->room) return 0;
  }
  c->line.coefficient = c->room;
  opc_line_cut(field, axis, at, from, to, &c->line);
  return 1;
}

/* Where, going from `start` (where the value has the sign of `inside`) to
   `limit`, the value first changes sign: 1, and *place; 0 if it does not. */
static int first_edge(const opc_line *line, double start, double limit,
                      int inside, double *place) {
  double step = line->step / 2 * (limit < start ? -1 : 1);
  double a = start, fa = opc_line_value(line, a), b, fb;
  for (;;) {
    if (fabs(limit - a) < 1e-9) return 0;
    b = fabs(limit - a) > fabs(step) ? a + step : limit;
    fb = opc_line_value(line, b);
    if ((fb > 0) != inside) break;
    a = b;
    fa = fb;
  }
  /* Regula falsi, Illinois variant: `b` is the newest point. */
  for (int i = 0; i < 40 && fabs(b - a) > 1e-7; i++) {
    double x = (a * fb - b * fa) / (fb - fa);
    double f = opc_line_value(line, x);
    if ((f > 0) == (fb > 0)) fa /= 2;
    else a = b, fa = fb;
    b = x;
    fb = f;
    if (fabs(f) < 1e-10) break;
  }
  *place = b;
  return 1;
}

/* A gate in its own terms: along its L and W axes, nm. */
typedef struct frame {
  int l_axis, w_axis;
  double low[2], high[2];   /* [L, W] */
  double middle[2];
  const double *room, *drawn_extension;
} frame;

static frame frame_of(const opc_gates *g, size_t i) {
  opc_box b = g->box[i];
  double x[2] = {b.x0 * g->grid, b.x1 * g->grid};
  double y[2] = {b.y0 * g->grid, b.y1 * g->grid};
  int across = g->axis[i] == OPC_Y;
  frame f = {.l_axis = across ? OPC_Y : OPC_X, .w_axis = across ? OPC_X : OPC_Y,
             .low = {across ? y[0] : x[0], across ? x[0] : y[0]},
             .high = {across ? y[1] : x[1], across ? x[1] : y[1]},
             .room = g->room + 2 * i,
             .drawn_extension = g->extension + 2 * i};
  for (int k = 0; k < 2; k++) f.middle[k] = (f.low[k] + f.high[k]) / 2;
  return f;
}

/* The printed width, between from and to along W. 0 if there is no memory. */
static int measure_width(const frame *f, const opc_field *active, cut *c,
                         double *from, double *to, uint32_t *flags) {
  double low = f->low[1] - reach, high = f->high[1] + reach;
  if (!cut_at(c, active, f->w_axis, f->middle[0], low, high)) return 0;
  *from = *to = f->middle[1];
  if (!(opc_line_value(&c->line, f->middle[1]) > 0)) {
    *flags |= OPC_PRINT_NO_ACTIVE;
    return 1;
  }
  if (!first_edge(&c->line, f->middle[1], low, 1, from)) {
    *from = low;
    *flags |= OPC_PRINT_MERGED;
  }
  if (!first_edge(&c->line, f->middle[1], high, 1, to)) {
    *to = high;
    *flags |= OPC_PRINT_MERGED;
  }
  return 1;
}

/* The printed length of a slice at `at` along W. */
static int measure_slice(const frame *f, const opc_field *poly, cut *c,
                         double at, double *length, uint32_t *flags) {
  double low = f->low[0] - fmin(reach, f->room[0] / 2);
  double high = f->high[0] + fmin(reach, f->room[1] / 2);
  double from = low, to = high;
  *length = 0;
  if (!cut_at(c, poly, f->l_axis, at, low, high)) return 0;
  if (!(opc_line_value(&c->line, f->middle[0]) > 0)) {
    *flags |= OPC_PRINT_OPEN;
    return 1;
  }
  if (!first_edge(&c->line, f->middle[0], low, 1, &from))
    *flags |= OPC_PRINT_MERGED;
  if (!first_edge(&c->line, f->middle[0], high, 1, &to))
    *flags |= OPC_PRINT_MERGED;
  *length = to - from;
  return 1;
}

/* The printed poly past the printed active edge `edge`, on `side`. */
static int measure_extension(const frame *f, const opc_field *poly, cut *c,
                             double edge, int side, double *extension,
                             uint32_t *flags) {
  double drawn = f->drawn_extension[side], out = side ? 1 : -1, place;
  *extension = INFINITY;
  if (isinf(drawn)) return 1;
  double limit = (side ? f->high[1] : f->low[1]) + out * (drawn + reach);
  double from = fmin(f->middle[1], limit), to = fmax(f->middle[1], limit);
  if (!cut_at(c, poly, f->w_axis, f->middle[0], from, to)) return 0;
  if (opc_line_value(&c->line, edge) > 0) {
    if (first_edge(&c->line, edge, limit, 1, &place))
      *extension = out * (place - edge);
  } else {
    *flags |= OPC_PRINT_SHORT;
    *extension = first_edge(&c->line, edge, f->middle[1], 0, &place)
                     ? out * (place - edge)
                     : -(f->high[1] - f->low[1]) / 2;
  }
  return 1;
}

static opc_performance part(const opc_performance *p, size_t first, size_t n) {
  return (opc_performance){.count = n,
                           .ion = p->ion + first,
                           .ioff = p->ioff + first,
                           .leq_ion = p->leq_ion + first,
                           .leq_ioff = p->leq_ioff + first,
                           .weq = p->weq + first,
                           .area = p->area + first};
}

/* The slices of a range of gates; the arrays are its own. */
typedef struct slices {
  const double *place, *share;
  size_t n;
  double *width, *length, *edge;
} slices;

static int slices_make(slices *s, const opc_module *extract, size_t gates,
                       opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  const char *before = opc_call(extract, error);
  s->n = model->slicing(extract->self, &s->place, &s->share);
  opc_leave(before);
  int code = opc_check_slicing(s->n, s->place, s->share, error);
  if (code) return opc_blame(error, code, "extract");
  s->width = calloc(3 * s->n * gates + 1, sizeof *s->width);
  s->length = s->width + s->n * gates;
  s->edge = s->length + s->n * gates;
  return s->width ? OPC_OK
                  : opc_fail(error, OPC_FAILED, NULL, "out of memory");
}

static void slices_set(slices *s, size_t k, size_t i, double width) {
  double t = s->place[i];
  s->width[k * s->n + i] = s->share[i] * width;
  s->edge[k * s->n + i] = width * (t < 0.5 ? t : 1 - t);
}

/* The performance of the gates from `first` on; `flags` of each as in
   opc_check_performance. */
static int slices_extract(const slices *s, const opc_module *extract,
                          const opc_gates *gates, size_t first,
                          const uint32_t *flags, opc_performance *out,
                          opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  opc_slices in = {.size = sizeof in, .count = out->count, .slices = s->n,
                   .type = gates->type + first, .width = s->width,
                   .length = s->length, .edge = s->edge};
  const char *before = opc_call(extract, error);
  int code = model->extract(extract->self, &in, out, error);
  opc_leave(before);
  if (!code) code = opc_check_performance(gates, first, flags, out, error);
  return opc_blame(error, code, "extract");
}

int opc_measure(const opc_host *host, const opc_gates *gates,
                const opc_field print[OPC_MASKS], const opc_module *extract,
                size_t first, size_t last, opc_measurement *out,
                opc_error *error) {
  slices s;
  cut c = {0};
  int code = slices_make(&s, extract, last - first, error), ok = 1;
  if (code) return code;
  for (size_t i = first; i < last && ok; i++) {
    frame f = frame_of(gates, i);
    double from, to;
    uint32_t flags = 0;
    ok = measure_width(&f, &print[OPC_ACTIVE], &c, &from, &to, &flags);
    for (size_t k = 0; k < s.n && ok; k++) {
      slices_set(&s, i - first, k, to - from);
      ok = measure_slice(&f, &print[OPC_POLY], &c,
                         from + s.place[k] * (to - from),
                         &s.length[(i - first) * s.n + k], &flags);
    }
    for (int side = 0; side < 2 && ok; side++)
      ok = measure_extension(&f, &print[OPC_POLY], &c, side ? to : from, side,
                             &out->extension[2 * i + side], &flags);
    out->flags[i] = flags;
  }
  if (ok) {
    opc_performance p = part(&out->performance, first, last - first);
    code = slices_extract(&s, extract, gates, first, out->flags + first, &p,
                          error);
  } else {
    code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  }
  free(c.room);
  free(s.width);
  return code;
}

int opc_measure_drawn(const opc_gates *gates, const opc_module *extract,
                      opc_performance *out, opc_error *error) {
  slices s;
  int code = slices_make(&s, extract, gates->count, error);
  if (code) return code;
  for (size_t i = 0; i < gates->count; i++)
    for (size_t k = 0; k < s.n; k++) {
      slices_set(&s, i, k, gates->width[i]);
      s.length[i * s.n + k] = gates->length[i];
    }
  code = slices_extract(&s, extract, gates, 0, NULL, out, error);
  free(s.width);
  return code;
}
