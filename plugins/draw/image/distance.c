/* SPDX-License-Identifier: BSD-3-Clause */
/* How far the contours of two models are apart. From every point of one, the
   nearest of the other's points is looked up, and from there the foot of the
   perpendicular is found on its level set, which is exact between points as
   well. That is done both ways, so that what only one of them prints counts. */
#include <math.h>

#include "image.h"

enum { MAX_NODES = 4000000, BLOCK = 256 };
static const double finest = 2;   /* nm between points of a contour */
static const double beyond = 200; /* nm around the window: nearest points */
static const double cell = 40;    /* of the index, nm */

/* ---- the points of a contour ---- */

/* `place` are x, y; `weight` is the length of contour that a point stands for,
   0 outside of the window. Points of cell c of the index are order[first[c]] ..
   order[first[c + 1] - 1]. */
typedef struct line {
  const opc_field *print;
  size_t n;
  double *place, *weight;
  opc_frame frame;
  size_t columns, rows;
  uint32_t *first, *order;
} line;

static void release(const opc_host *host, line *l) {
  host->free(host, l->place);
  host->free(host, l->weight);
  host->free(host, l->first);
  host->free(host, l->order);
}

/* The window and something around it, as far as there is a print. */
static opc_frame frame_of(const view *v, opc_frame f) {
  double x0 = fmax(v->x0 - beyond, f.x0), y0 = fmax(v->y0 - beyond, f.y0);
  return (opc_frame){x0, y0, fmin(v->x1 + beyond, f.x0 + f.width) - x0,
                     fmin(v->y1 + beyond, f.y0 + f.height) - y0};
}

/* Contours are closed along the border of the frame; that is none of theirs. */
static int on_border(opc_frame f, const double *p) {
  const double slack = 1e-6;
  return p[0] - f.x0 < slack || f.x0 + f.width - p[0] < slack ||
         p[1] - f.y0 < slack || f.y0 + f.height - p[1] < slack;
}

static int in_window(const view *v, const double *p) {
  return p[0] >= v->x0 && p[0] <= v->x1 && p[1] >= v->y0 && p[1] <= v->y1;
}

static double apart(const double *a, const double *b) {
  return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Take the closed line of n points at p. */
static void take(const view *v, line *l, const double *p, size_t n) {
  for (size_t i = 0; i < n; i++) {
    const double *at = p + 2 * i;
    const double *last = p + 2 * ((i + n - 1) % n);
    const double *next = p + 2 * ((i + 1) % n);
    if (on_border(l->frame, at)) continue;
    double length = 0;
    if (!on_border(l->frame, last)) length += apart(at, last) / 2;
    if (!on_border(l->frame, next)) length += apart(at, next) / 2;
    l->place[2 * l->n] = at[0];
    l->place[2 * l->n + 1] = at[1];
    l->weight[l->n++] = in_window(v, at) ? length : 0;
  }
}

static size_t column_of(const line *l, double x) {
  double c = floor((x - l->frame.x0) / cell);
  return (size_t)fmin(fmax(c, 0), (double)(l->columns - 1));
}

static size_t row_of(const line *l, double y) {
  double c = floor((y - l->frame.y0) / cell);
  return (size_t)fmin(fmax(c, 0), (double)(l->rows - 1));
}

static size_t cell_of(const line *l, const double *p) {
  return row_of(l, p[1]) * l->columns + column_of(l, p[0]);
}

static int make_index(const opc_host *host, line *l, opc_error *error) {
  l->columns = (size_t)(l->frame.width / cell) + 1;
  l->rows = (size_t)(l->frame.height / cell) + 1;
  size_t cells = l->columns * l->rows;
  l->first = host->alloc(host, cells + 2, sizeof *l->first);
  l->order = host->alloc(host, l->n + 1, sizeof *l->order);
  if (!l->first || !l->order)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  /* Counted two further on, each cell is filled from one further on, which
     leaves the beginnings where they belong. */
  for (size_t i = 0; i < l->n; i++)
    l->first[cell_of(l, l->place + 2 * i) + 2]++;
  for (size_t c = 2; c < cells + 2; c++) l->first[c] += l->first[c - 1];
  for (size_t i = 0; i < l->n; i++)
    l->order[l->first[cell_of(l, l->place + 2 * i) + 1]++] = (uint32_t)i;
  return OPC_OK;
}

static int make_line(const view *v, const opc_field *print, line *l,
                     opc_error *error) {
  const opc_host *host = v->host;
  double *points = NULL;
  uint32_t *start = NULL;
  size_t count = 0;
  *l = (line){.print = print, .frame = frame_of(v, print->frame)};
  if (!(l->frame.width > 0 && l->frame.height > 0)) return OPC_OK;
  double step =
      fmax(finest, sqrt(l->frame.width * l->frame.height / MAX_NODES));
  int code = host->imaging->contours(host, print, l->frame, step, &points,
                                     &start, &count, error);
  if (code) return code;
  size_t n = count ? start[count] : 0;
  l->place = host->alloc(host, 2 * n + 1, sizeof *l->place);
  l->weight = host->alloc(host, n + 1, sizeof *l->weight);
  if (!l->place || !l->weight)
    code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < count && !code; i++)
    take(v, l, points + 2 * (size_t)start[i], start[i + 1] - start[i]);
  host->free(host, points);
  host->free(host, start);
  return code ? code : make_index(host, l, error);
}

/* ---- the nearest place ---- */

/* The nearest of the points within a cell. */
static void nearest_in(const line *l, size_t c, const double *p, double *least,
                       uint32_t *best) {
  for (uint32_t k = l->first[c]; k < l->first[c + 1]; k++) {
    double d = apart(l->place + 2 * (size_t)l->order[k], p);
    if (d < *least) {
      *least = d;
      *best = l->order[k];
    }
  }
}

/* Cells in squares around p, until no further one can hold a nearer point. */
static double nearest_point(const line *l, const double *p, uint32_t *best) {
  double least = INFINITY;
  long column = (long)column_of(l, p[0]), row = (long)row_of(l, p[1]);
  long columns = (long)l->columns, rows = (long)l->rows;
  long last = columns > rows ? columns : rows;
  for (long ring = 0; ring <= last && (double)(ring - 1) * cell <= least;
       ring++)
    for (long y = row - ring; y <= row + ring; y++) {
      if (y < 0 || y >= rows) continue;
      int edge = y == row - ring || y == row + ring;
      for (long x = column - ring; x <= column + ring;
           x += edge || !ring ? 1 : 2 * ring)
        if (x >= 0 && x < columns)
          nearest_in(l, (size_t)(y * columns + x), p, &least, best);
    }
  return least;
}

/* From a point of the line to the foot of the perpendicular from p: onto the
   level set along its gradient, then along it towards p. */
static double foot(const opc_imaging_service *imaging, const line *l,
                   const double *p, const double *from) {
  double x = from[0], y = from[1];
  for (int i = 0; i < 30; i++) {
    double value, gx, gy;
    imaging->gradient(l->print, &x, &y, 1, &value, &gx, &gy);
    double square = gx * gx + gy * gy;
    if (!(square > 0)) break;
    double along = ((p[0] - x) * gx + (p[1] - y) * gy + value) / square;
    double dx = p[0] - x - along * gx, dy = p[1] - y - along * gy;
    x += dx;
    y += dy;
    if (fabs(dx) + fabs(dy) < 1e-6) break;
  }
  const double at[] = {x, y};
  return apart(p, at);
}

/* ---- from one line to another ---- */

typedef struct walk {
  const opc_imaging_service *imaging;
  const line *from, *to;
  double *distance; /* of the points of `from`; positive outside of `to` */
} walk;

static void walk_block(void *data, size_t block) {
  const walk *w = data;
  size_t last = (block + 1) * BLOCK;
  if (last > w->from->n) last = w->from->n;
  for (size_t i = block * BLOCK; i < last; i++) {
    if (w->from->weight[i] == 0) continue;
    const double *p = w->from->place + 2 * i;
    uint32_t best = 0;
    double d = nearest_point(w->to, p, &best), value;
    /* What is beyond the curve's centre may lead elsewhere. */
    if (d > 0)
      d = fmin(d, foot(w->imaging, w->to, p, w->to->place + 2 * (size_t)best));
    w->imaging->sample(w->to->print, p, p + 1, 1, &value);
    w->distance[i] = value > 0 ? -d : d;
  }
}

typedef struct sums {
  double length, first, second; /* weights; times distance; times its square */
} sums;

/* Add the distances from one line to the other; `sign` is that of a place of
   `from` outside of `to`. */
static int add(const opc_host *host, const line *from, const line *to,
               double sign, sums *s, image_distance *out, opc_error *error) {
  walk w = {host->imaging, from, to, NULL};
  w.distance = host->alloc(host, from->n + 1, sizeof *w.distance);
  if (!w.distance)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  host->parallel(host, (from->n + BLOCK - 1) / BLOCK, walk_block, &w);
  for (size_t i = 0; i < from->n; i++) {
    double d = sign * w.distance[i], weight = from->weight[i];
    s->length += weight;
    s->first += weight * d;
    s->second += weight * d * d;
    if (weight == 0 || fabs(d) <= out->max) continue;
    out->max = fabs(d);
    out->x = from->place[2 * i];
    out->y = from->place[2 * i + 1];
  }
  host->free(host, w.distance);
  return OPC_OK;
}

static int compare(const opc_host *host, const line *first, const line *other,
                   image_distance *out, opc_error *error) {
  sums s = {0};
  *out = (image_distance){NAN, NAN, NAN, NAN, NAN};
  if (!first->n || !other->n) return OPC_OK;
  image_distance d = {0, 0, 0, NAN, NAN};
  int code = add(host, other, first, 1, &s, &d, error);
  if (!code) code = add(host, first, other, -1, &s, &d, error);
  if (code || !(s.length > 0)) return code;
  d.mean = s.first / s.length;
  d.rms = sqrt(s.second / s.length);
  *out = d;
  return OPC_OK;
}

/* The intensities along a line. */
static void find_levels(const opc_host *host, image_model *m, const line *l) {
  m->low = m->high = NAN;
  for (size_t i = 0; i < l->n; i++) {
    const double *p = l->place + 2 * i;
    double value;
    if (l->weight[i] == 0) continue;
    host->imaging->sample(&m->image, p, p + 1, 1, &value);
    m->low = fmin(m->low, value); /* value if it is NAN */
    m->high = fmax(m->high, value);
  }
}

int image_measure_contours(image_run *r, opc_error *error) {
  const opc_host *host = r->view.host;
  line first;
  int code = make_line(&r->view, &r->model[0].print, &first, error);
  for (size_t k = 0; k < r->n && !code; k++) {
    line other;
    image_model *m = &r->model[k];
    code = make_line(&r->view, &m->print, &other, error);
    if (!code) find_levels(host, m, &other);
    if (!code) code = compare(host, &first, &other, &m->distance, error);
    release(host, &other);
  }
  release(host, &first);
  return code;
}
