/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the data of mask pictures: polygons, printed contours and a raster
   image of the level-set function of the poly, within size limits. */
#include <report/drawing.h>

#include <eda/chip.h>
#include <eda/index.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <report/json.h>

/* ---- state ---- */

/* Contours are computed in tiles of `tile` nm, in parallel. The grid step is
   `finest` nm, or larger, so that large areas have at most `nodes` nodes. The
   upper limit of the step is `coarsest` nm or, if larger, the grid step of the
   simulation (a quarter of the shortest period of the image). At twice this
   largest step, contours of 65 nm lines would break. */
static const double tile = 4000, finest = 10, coarsest = 30, nodes = 2e6;
static const double unit = 0.5; /* resolution of contour points, nm */
/* Largest deviation of a chord from the contour, and of omitted points from the
   line between their neighbours, nm. */
static const double straight = 0.4;
static const double around = 400; /* margin around a worst transistor, nm */
/* Limits of the pixel size, nm, and of the number of pixels. An image with NA
   0.75 at 193 nm has no period below 129 nm, and pixels larger than a third of
   this period look coarse. 6e5 pixels take 0.05 s and 0.4 MB. */
static const double finest_pixel = 16, coarsest_pixel = 48, pixels = 6e5;

/* For a mask by classes (transistors with equal environments share one
   correction): largest number of classes for which the mask around one member
   is simulated, 0.05 s each; the page shows ten. Layouts with at most
   `most_boxes` transistors are written with all boxes, about 2 bytes each,
   larger layouts with one box for each class. */
enum { MOST_SIMULATED = 40 };
static const size_t most_boxes = 4000000;

/* Growing array of numbers. */
typedef struct numbers {
  int32_t *number;
  size_t count, capacity;
} numbers;

/* Polygons or lines: point counts, and coordinates x, y. */
typedef struct outlines {
  numbers sizes, places;
} outlines;

/* Part of the layout to write: windows in nm, and an index of the windows in
   grid units. `index` is NULL for the entire layout. */
typedef struct part {
  eda_frame *window;
  size_t count;
  eda_index *index;
} part;

typedef struct drawing {
  const opc_context *context;
  const eda_mask *mask;
  part part;
  double step; /* grid step of contours */
  GString *out;
  int shapes; /* number of written shapes */
} drawing;

static void numbers_add(numbers *n, double x) {
  EDA_PUSH(n->number, n->count, n->capacity, (int32_t)lround(x));
}

static void outlines_clear(outlines *o) {
  free(o->sizes.number);
  free(o->places.number);
}

/* ---- work: written part ---- */

typedef struct ranked {
  double deviation;
  size_t gate;
} ranked;

static int by_deviation(const void *a, const void *b) {
  const ranked *p = a, *q = b;
  if (p->deviation != q->deviation) return p->deviation > q->deviation ? -1 : 1;
  return p->gate < q->gate ? -1 : 1;
}

static eda_frame frame_of(const eda_gates *g, eda_box b, double more) {
  return (eda_frame){b.x0 * g->grid - more, b.y0 * g->grid - more,
                     (b.x1 - b.x0) * g->grid + 2 * more,
                     (b.y1 - b.y0) * g->grid + 2 * more};
}

/* Return windows around the n transistors with the largest deviation,
   transistors that do not print first. `worst` receives the indices of the
   transistors, unless NULL. */
static part worst_part(const eda_mask *m, size_t n, size_t *worst) {
  const eda_gates *g = m->gates;
  ranked *all = eda_alloc(g->count, sizeof *all);
  for (size_t i = 0; i < g->count; i++) {
    double d = fabs(eda_deviation(m->after.ion[i], m->design.ion[i]));
    int fails = eda_print_failed(m->flags[i]) || !isfinite(d);
    all[i] = (ranked){fails ? INFINITY : d, i};
  }
  qsort(all, g->count, sizeof *all, by_deviation);
  part p = {.window = eda_alloc(n, sizeof *p.window), .count = n};
  eda_box *boxes = eda_alloc(n, sizeof *boxes);
  int32_t more = (int32_t)ceil(around / g->grid);
  for (size_t k = 0; k < n; k++) {
    eda_box b = g->box[all[k].gate];
    if (worst) worst[k] = all[k].gate;
    p.window[k] = frame_of(g, b, around);
    boxes[k] = eda_box_grown(b, more);
  }
  p.index = eda_index_new(boxes, n, 0);
  free(boxes);
  free(all);
  return p;
}

static part drawing_tiles(const eda_gates *g) {
  eda_frame f = frame_of(g, g->extent, around);
  size_t columns = (size_t)ceil(f.width / tile);
  size_t rows = (size_t)ceil(f.height / tile);
  double dx = f.width / (double)columns, dy = f.height / (double)rows;
  part p = {.window = eda_alloc(columns * rows, sizeof *p.window)};
  for (size_t j = 0; j < rows; j++)
    for (size_t i = 0; i < columns; i++)
      p.window[p.count++] =
          (eda_frame){f.x0 + (double)i * dx, f.y0 + (double)j * dy, dx, dy};
  return p;
}

/* Return 1 for the layers to write: transistor layers, corrected layers and
   contacts. */
static int is_shown(const eda_gates *g, size_t layer) {
  return layer <= EDA_ACTIVE || g->corrected[layer] ||
         (int)layer == eda_gates_layer(g, "contact");
}

/* Return the grid step for the contours of the shown layers. */
static double step_of(const part *p, const eda_mask *m) {
  double area = 0, layers = 0, own = INFINITY;
  for (size_t k = 0; k < m->layers; k++) {
    const eda_field *print = &m->print[k];
    if (!print->coefficients || !is_shown(m->gates, k)) continue;
    own = fmin(own, print->frame.width / print->nx);
    layers++;
  }
  for (size_t i = 0; i < p->count; i++)
    area += p->window[i].width * p->window[i].height;
  double step = fmax(finest, sqrt(area * fmax(layers, 1) / nodes));
  return fmin(step, layers > 0 ? fmax(coarsest, own) : coarsest);
}

/* ---- work: polygons ---- */

static int is_in(const part *p, eda_box b) {
  uint32_t any;
  if (!p->index) return 1;
  eda_finder f = eda_index_find(p->index, b);
  return eda_index_next(&f, &any);
}

static outlines drawing_polygons(const drawing *d, const eda_shapes *s) {
  outlines o = {0};
  for (size_t i = 0; i < s->count; i++) {
    uint32_t first = s->start[i], n = s->start[i + 1] - first;
    if (!is_in(&d->part, eda_bounds(s->points + first, n))) continue;
    numbers_add(&o.sizes, n);
    for (uint32_t k = first; k < first + n; k++) {
      numbers_add(&o.places, s->points[k].x);
      numbers_add(&o.places, s->points[k].y);
    }
  }
  return o;
}

/* ---- work: contours ---- */

static double square(double x, double y) { return x * x + y * y; }

/* Return 1 if p is on the line between a and b. */
static int is_on(const double *a, const double *b, const double *p) {
  double x = b[0] - a[0], y = b[1] - a[1], length = square(x, y);
  double px = p[0] - a[0], py = p[1] - a[1], cross = x * py - y * px;
  if (length == 0) return square(px, py) <= straight * straight;
  return cross * cross <= straight * straight * length;
}

/* Append a line without redundant points. Each segment replaces up to REACH
   points. */
static void add_line(outlines *o, const double *p, size_t n) {
  enum { REACH = 12 };
  size_t at = 0, before = o->places.count;
  if (n < 2) return;
  for (;;) {
    numbers_add(&o->places, p[2 * at] / unit);
    numbers_add(&o->places, p[2 * at + 1] / unit);
    if (at + 1 >= n) break;
    size_t to = at + 1;
    for (int good = 1; good && to + 1 < n && to + 1 - at <= REACH; to += good)
      for (size_t k = at + 1; k <= to && good; k++)
        good = is_on(p + 2 * at, p + 2 * (to + 1), p + 2 * k);
    at = to;
  }
  size_t kept = (o->places.count - before) / 2;
  numbers_add(&o->sizes, (double)kept);
}

/* Return 1 for a segment along the border of the window, where contours are
   closed artificially. */
static int on_border(eda_frame w, const double *a, const double *b) {
  const double sides[4] = {w.x0, w.x0 + w.width, w.y0, w.y0 + w.height};
  for (int k = 0; k < 4; k++)
    if (fabs(a[k / 2] - sides[k]) < 1e-6 && fabs(b[k / 2] - sides[k]) < 1e-6)
      return 1;
  return 0;
}

/* Points of a line, x and y. */
typedef struct line {
  double *place;
  size_t count, capacity;
} line;

static void line_to(line *l, const double *p) {
  eda_grow(&l->place, &l->capacity, 2 * l->count + 2, sizeof *l->place);
  memcpy(l->place + 2 * l->count++, p, 2 * sizeof *p);
}

/* Append the line from a to b, without the point a. If the chord deviates from
   the contour, insert the contour point near the middle of the chord,
   recursively. */
static void line_follow(line *l, const eda_field *print, const double *a,
                        const double *b, int depth) {
  double m[2] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2}, v, dx, dy;
  eda_field_gradient(print, &m[0], &m[1], 1, &v, &dx, &dy);
  double slope = sqrt(square(dx, dy)), shift = slope > 0 ? v / slope : 0;
  double length = sqrt(square(b[0] - a[0], b[1] - a[1]));
  if (depth && fabs(shift) > straight && fabs(shift) < length / 2) {
    m[0] -= shift * dx / slope;
    m[1] -= shift * dy / slope;
    line_follow(l, print, a, m, depth - 1);
    line_follow(l, print, m, b, depth - 1);
  } else {
    line_to(l, b);
  }
}

/* Append a closed contour without its segments along the border of the window,
   as one or more open lines. */
static void add_contour(outlines *o, const eda_field *print, eda_frame w,
                        const double *p, size_t n) {
  enum { DEPTH = 3 };
  line l = {0};
  line_to(&l, p);
  for (size_t i = 0; i < n; i++) {
    const double *a = p + 2 * i, *b = p + 2 * ((i + 1) % n);
    if (on_border(w, a, b)) {
      add_line(o, l.place, l.count);
      l.count = 0;
      line_to(&l, b);
    } else {
      line_follow(&l, print, a, b, DEPTH);
    }
  }
  add_line(o, l.place, l.count);
  free(l.place);
}

typedef struct search {
  const drawing *drawing;
  const eda_field *print;
  outlines *found; /* for each window */
  opc_error *error;
} search;

static void find_contours(void *data, size_t i) {
  search *s = data;
  eda_frame w = s->drawing->part.window[i];
  double *points;
  uint32_t *start;
  size_t count;
  if (opc_cancelled(s->drawing->context)) {
    opc_fail(&s->error[i], OPC_CANCELLED, NULL, "stopped");
    return;
  }
  if (eda_contours(s->drawing->context, s->print, w, s->drawing->step, &points,
                   &start, &count, &s->error[i]))
    return;
  for (size_t k = 0; k < count; k++)
    add_contour(&s->found[i], s->print, w, points + 2 * (size_t)start[k],
                start[k + 1] - start[k]);
  free(points);
  free(start);
}

static void numbers_append(numbers *to, const numbers *from) {
  eda_grow(&to->number, &to->capacity, to->count + from->count,
           sizeof *to->number);
  if (from->count)
    memcpy(to->number + to->count, from->number,
           from->count * sizeof *from->number);
  to->count += from->count;
}

static int drawing_contours(const drawing *d, const eda_field *print,
                            outlines *out, opc_error *error) {
  size_t n = d->part.count;
  search s = {d, print, eda_alloc(n, sizeof *s.found),
              eda_alloc(n, sizeof *s.error)};
  int code = OPC_OK;
  opc_parallel(d->context, n, find_contours, &s);
  for (size_t i = 0; i < n; i++) {
    if (!code && (code = s.error[i].code)) *error = s.error[i];
    numbers_append(&out->sizes, &s.found[i].sizes);
    numbers_append(&out->places, &s.found[i].places);
    outlines_clear(&s.found[i]);
  }
  free(s.found);
  free(s.error);
  return code;
}

/* ---- work: the image ---- */

/* Samples of the level-set function of the poly, in rows from the bottom. */
typedef struct image {
  const eda_field *print;
  double x0, y0, pixel;
  size_t columns, rows;
  double *level;
} image;

static void sample_row(void *data, size_t j) {
  const image *m = data;
  double *x = eda_alloc(2 * m->columns, sizeof *x), *y = x + m->columns;
  for (size_t i = 0; i < m->columns; i++) {
    x[i] = m->x0 + ((double)i + 0.5) * m->pixel;
    y[i] = m->y0 + ((double)j + 0.5) * m->pixel;
  }
  eda_field_sample(m->print, x, y, m->columns, m->level + j * m->columns);
  free(x);
}

/* Write a byte for each pixel: grey values 1 to 255, 128 at the printed edge.
 */
static void write_levels(const drawing *d, const image *m) {
  size_t n = m->columns * m->rows;
  uint8_t *grey = eda_alloc(n, sizeof *grey);
  double most = 0;
  for (size_t i = 0; i < n; i++) most = fmax(most, fabs(m->level[i]));
  for (size_t i = 0; i < n && most > 0; i++)
    grey[i] = (uint8_t)lround(128 + 127 * m->level[i] / most);
  const double values[] = {m->pixel, m->x0, m->y0, most};
  static const char *const names[] = {"pixel", "x", "y", "most"};
  g_string_append_printf(
      d->out, ",\n \"image\": {\"layer\": %d, \"columns\": %zu, \"rows\": %zu",
      EDA_POLY, m->columns, m->rows);
  for (int k = 0; k < 4; k++) {
    g_string_append_printf(d->out, ", \"%s\": ", names[k]);
    json_number(d->out, values[k], 9);
  }
  g_string_append(d->out, ", \"bytes\": ");
  json_bytes(d->out, grey, n);
  g_string_append_c(d->out, '}');
  free(grey);
}

/* Write the image of the poly, unless the poly was not simulated or the layout
   requires too large pixels. */
static void write_image(const drawing *d) {
  eda_frame f = frame_of(d->mask->gates, d->mask->gates->extent, around);
  image m = {.print = &d->mask->print[EDA_POLY], .x0 = f.x0, .y0 = f.y0};
  m.pixel = fmax(finest_pixel, sqrt(f.width * f.height / pixels));
  if (!m.print->coefficients || m.pixel > coarsest_pixel) return;
  m.columns = (size_t)ceil(f.width / m.pixel);
  m.rows = (size_t)ceil(f.height / m.pixel);
  m.level = eda_alloc(m.columns * m.rows, sizeof *m.level);
  opc_parallel(d->context, m.rows, sample_row, &m);
  write_levels(d, &m);
  free(m.level);
}

/* ---- work: run ---- */

static void write_outlines(drawing *d, size_t layer, const char *role,
                           double scale, const outlines *o) {
  g_string_append_printf(d->out,
                         "%s\n  {\"layer\": %zu, \"role\": \"%s\", \"unit\": ",
                         d->shapes++ ? "," : "", layer, role);
  json_number(d->out, scale, 9);
  g_string_append_printf(d->out,
                         ", \"count\": %zu, \"sizes\": ", o->sizes.count);
  json_packed(d->out, o->sizes.number, o->sizes.count, 1);
  g_string_append(d->out, ", \"points\": ");
  json_packed(d->out, o->places.number, o->places.count, 2);
  g_string_append_c(d->out, '}');
}

static void write_polygons(drawing *d, size_t layer, const char *role,
                           const eda_shapes *s) {
  outlines o = drawing_polygons(d, s);
  if (o.sizes.count) write_outlines(d, layer, role, d->mask->gates->grid, &o);
  outlines_clear(&o);
}

/* Write the contours of a layer, if the layer was simulated. */
static int write_print(drawing *d, size_t layer, const char *role,
                       const eda_field *print, opc_error *error) {
  outlines o = {0};
  if (!print->coefficients) return OPC_OK;
  int code = drawing_contours(d, print, &o, error);
  if (!code) write_outlines(d, layer, role, unit, &o);
  outlines_clear(&o);
  return code;
}

static int write_shapes(drawing *d, opc_error *error) {
  const eda_mask *m = d->mask;
  int code = OPC_OK;
  g_string_append(d->out, ",\n \"shapes\": [");
  for (size_t k = 0; k < m->layers && !code; k++) {
    if (!is_shown(m->gates, k)) continue;
    write_polygons(d, k, "drawn", &m->gates->drawn[k]);
    write_polygons(d, k, "mask", &m->shapes[k]);
    code = write_print(d, k, "print", &m->print[k], error);
    if (!code && m->drawn_print)
      code = write_print(d, k, "drawn print", &m->drawn_print[k], error);
  }
  g_string_append(d->out, "]");
  return code;
}

/* ---- work: a mask by classes ---- */

enum { ROLES = 4 };
static const char *const roles[ROLES] = {"drawn", "mask", "print",
                                         "drawn print"};

/* Append the shapes and contours of the window of one class; `found` is
   [layers * ROLES]. */
static int class_add(const drawing *all, const eda_mask *m, part one,
                     outlines *found, opc_error *error) {
  drawing d = {.context = all->context, .mask = m, .part = one};
  int code = OPC_OK;
  d.step = step_of(&one, m);
  for (size_t k = 0; k < m->layers; k++) {
    if (!is_shown(m->gates, k)) continue;
    const eda_shapes *const shapes[] = {&m->gates->drawn[k], &m->shapes[k]};
    const eda_field *const prints[] = {&m->print[k], &m->drawn_print[k]};
    for (size_t role = 0; role < ROLES && !code; role++) {
      outlines o = {0}, *to = &found[k * ROLES + role];
      if (role < 2)
        o = drawing_polygons(&d, shapes[role]);
      else if (prints[role - 2]->coefficients)
        code = drawing_contours(&d, prints[role - 2], &o, error);
      numbers_append(&to->sizes, &o.sizes);
      numbers_append(&to->places, &o.places);
      outlines_clear(&o);
    }
  }
  return code;
}

/* Write the shapes around the worst classes, which are simulated one by
   one. */
static int write_classes(drawing *d, const size_t *worst, opc_error *error) {
  const eda_mask *m = d->mask;
  outlines *found = eda_alloc(m->layers * ROLES, sizeof *found);
  int32_t more = (int32_t)ceil(around / m->gates->grid);
  int code = OPC_OK;
  for (size_t i = 0; i < d->part.count && !code; i++) {
    eda_mask *near = NULL;
    eda_box b = eda_box_grown(m->gates->box[worst[i]], more);
    part one = {&d->part.window[i], 1, eda_index_new(&b, 1, 0)};
    code = m->access->simulate(m, &worst[i], 1, around, &near, error);
    if (!code) code = class_add(d, near, one, found, error);
    eda_index_free(one.index);
    eda_mask_free(near);
  }
  g_string_append(d->out, ",\n \"shapes\": [");
  for (size_t i = 0; i < m->layers * ROLES; i++) {
    size_t role = i % ROLES;
    if (!code && found[i].sizes.count)
      write_outlines(d, i / ROLES, roles[role],
                     role < 2 ? m->gates->grid : unit, &found[i]);
    outlines_clear(&found[i]);
  }
  g_string_append(d->out, "]");
  free(found);
  return code;
}

static void write_boxes(const drawing *d, const void *boxes, size_t n,
                        size_t size) {
  numbers all = {0};
  for (size_t i = 0; i < n; i++) {
    const eda_box *b = (const void *)((const char *)boxes + i * size);
    numbers_add(&all, b->x0);
    numbers_add(&all, b->y0);
    numbers_add(&all, b->x1);
    numbers_add(&all, b->y1);
  }
  g_string_append_printf(d->out, ",\n \"transistors\": %zu,\n \"boxes\": ", n);
  json_packed(d->out, all.number, all.count, 4);
  free(all.number);
}

static void write_gates(const drawing *d) {
  const eda_gates *g = d->mask->gates;
  const eda_chip *c = d->mask->chip;
  if (!c || c->count > most_boxes) {
    write_boxes(d, g->box, g->count, sizeof *g->box);
    return;
  }
  write_boxes(d, &c->gate->box, c->count, sizeof *c->gate);
  int32_t *of = eda_alloc(c->count, sizeof *of);
  for (size_t i = 0; i < c->count; i++) of[i] = (int32_t)c->gate[i].print;
  g_string_append(d->out, ",\n \"classes\": ");
  json_packed(d->out, of, c->count, 1);
  free(of);
}

static void write_head(const drawing *d) {
  const eda_gates *g = d->mask->gates;
  g_string_append(d->out, "{\"view\": 1,\n \"cell\": ");
  json_text(d->out, g->name ? g->name : "");
  g_string_append(d->out, ",\n \"grid\": ");
  json_number(d->out, g->grid, 9);
  g_string_append_printf(d->out,
                         ",\n \"extent\": [%d, %d, %d, %d],\n \"whole\": %s,"
                         "\n \"layers\": [",
                         g->extent.x0, g->extent.y0, g->extent.x1, g->extent.y1,
                         d->part.index ? "false" : "true");
  for (size_t k = 0; k < g->layers; k++) {
    if (k) g_string_append(d->out, ", ");
    json_text(d->out, g->layer[k]);
  }
  g_string_append_c(d->out, ']');
}

static int drawing_write(const opc_context *context, const eda_mask *mask,
                         const drawing_limits *limits, GString *out,
                         opc_error *error) {
  const eda_gates *g = mask->gates;
  drawing d = {.context = context, .mask = mask, .out = out};
  if (g->extent.x0 >= g->extent.x1 || g->extent.y0 >= g->extent.y1)
    return opc_fail(error, OPC_INVALID, "mask",
                    "the layout is empty and cannot be drawn");
  size_t most = MIN(g->count, (size_t)limits->worst);
  size_t *worst = eda_alloc(most, sizeof *worst);
  if (mask->chip)
    d.part = worst_part(mask, MIN(most, MOST_SIMULATED), worst);
  else
    d.part = g->count <= (size_t)limits->whole ? drawing_tiles(g)
                                               : worst_part(mask, most, NULL);
  d.step = step_of(&d.part, mask);
  write_head(&d);
  write_gates(&d);
  int code =
      mask->chip ? write_classes(&d, worst, error) : write_shapes(&d, error);
  if (!code && !mask->chip) write_image(&d);
  free(worst);
  g_string_append(out, "}\n");
  eda_index_free(d.part.index);
  free(d.part.window);
  return code;
}

int drawing_file(const opc_context *context, const eda_mask *mask,
                 const drawing_limits *limits, const char *path,
                 opc_error *error) {
  g_autoptr(GString) out = g_string_new(NULL);
  g_autoptr(GError) fault = NULL;
  int code = drawing_write(context, mask, limits, out, error);
  if (code || g_file_set_contents(path, out->str, (gssize)out->len, &fault))
    return code;
  return opc_fail(error, OPC_IO, "file", "%s", fault->message);
}
