/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.tell: a step that looks at a mask through every service it can. */
#include "compat.h"

#include <stdio.h>

enum { MASK, FILE_OUT, WORDS, LAYERS, LOUD, STYLE, PARAMETERS };

typedef struct sums {
  const opc_mask *mask;
  double ion[2];
} sums;

static void add(void *data, size_t i) {
  sums *s = data;
  s->ion[i] = s->mask->after.ion[i] / s->mask->design.ion[i];
}

static int64_t absolute(int64_t x) { return x < 0 ? -x : x; }

/* Shapes of the corrected poly that the drawn one has not, in nm^2. */
static int added_area(const compat *c, const opc_mask *m, double *area,
                      opc_error *error) {
  const opc_geometry_service *g = c->host->geometry;
  opc_shapes more;
  opc_box *boxes;
  size_t n;
  int code = g->boolean(c->host, OPC_NOT, &m->shapes[OPC_POLY],
                        &m->gates->drawn[OPC_POLY], &more, error);
  if (code) return code;
  code = g->fracture(c->host, &more, &boxes, &n, error);
  if (!code) {
    int64_t sum = 0;
    for (size_t i = 0; i < n; i++)
      sum += 2 * ((int64_t)boxes[i].x1 - boxes[i].x0) *
             ((int64_t)boxes[i].y1 - boxes[i].y0);
    c->host->free(c->host, boxes);
    *area = absolute(g->area2(&more)) == absolute(sum)
                ? (double)sum / 2 * m->gates->grid * m->gates->grid
                : -1;
  }
  g->release(&more);
  return code;
}

/* The printed length of gate 0 in its middle, from where the contours cross
   the middle of its width. */
static int printed_length(const compat *c, const opc_mask *m, double *length,
                          opc_error *error) {
  const opc_gates *g = m->gates;
  opc_box b = g->box[0];
  double y = (b.y0 + b.y1) / 2.0 * g->grid;
  const opc_frame window = {b.x0 * g->grid - 100, y - 40,
                            (b.x1 - b.x0) * g->grid + 200, 80};
  double *points, low = 1e9, high = -1e9;
  uint32_t *start;
  size_t n;
  int code = c->host->imaging->contours(c->host, &m->print[OPC_POLY], window,
                                        10, &points, &start, &n, error);
  if (code) return code;
  for (uint32_t i = 0; n && i < start[n]; i++) {
    double dy = points[2 * i + 1] - y;
    if (dy < -12 || dy > 12) continue;
    if (points[2 * i] < low) low = points[2 * i];
    if (points[2 * i] > high) high = points[2 * i];
  }
  c->host->free(c->host, points);
  c->host->free(c->host, start);
  *length = high - low;
  return OPC_OK;
}

static int write_file(const compat *c, opc_error *error) {
  const char *path =
      c->host->output_path(c->host, c->values[FILE_OUT].text, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  if (!file || fputs("kept\n", file) < 0 || fclose(file))
    return c->host->fail(c->host, error, OPC_IO, "file", "'%s': not written",
                         path);
  return OPC_OK;
}

static int publish(const compat *c, const sums *s, double area, double length,
                   opc_error *error) {
  const opc_host *host = c->host;
  const char *names[2] = {"n", "p"};
  int64_t numbers[2] = {1, 2};
  const opc_column columns[3] = {{"name", NULL, OPC_TEXT, 0, names},
                                 {"number", NULL, OPC_INT, 0, numbers},
                                 {"ion", "%", OPC_REAL, 2, s->ion}};
  int code = host->table(host, "kept", OPC_TABLE_PRINT, 2, columns, 3, error);
  if (!code) code = host->metric(host, "ion", s->ion[0], error);
  if (!code) code = host->metric(host, "area", area, error);
  if (!code) code = host->metric(host, "length", length, error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const compat *c = self;
  const opc_host *host = c->host;
  const opc_value *v = c->values;
  sums s = {v[MASK].object, {0, 0}};
  double area = 0, length = 0;
  opc_progress progress = {.size = sizeof progress, .total = 1};
  (void)outputs;
  if (host->abi_major != 1 || host->cancelled(host) ||
      s.mask->gates->count != 2 || v[WORDS].count != 2 ||
      v[WORDS].reals[1] != 65 || v[LAYERS].count != 1 ||
      v[LAYERS].pairs[0].value[0] != 'P' || v[LOUD].integer != 1 ||
      v[STYLE].integer != 1)
    return host->fail(host, error, OPC_FAILED, "mask", "not as it was");
  host->progress(host, &progress);
  host->log(host, OPC_LOG_INFO, "%d transistors", 2);
  host->parallel(host, 2, add, &s);
  int code = added_area(c, s.mask, &area, error);
  if (!code) code = printed_length(c, s.mask, &length, error);
  if (!code) code = write_file(c, error);
  return code ? code : publish(c, &s, area, length, error);
}

static const opc_parameter parameters[PARAMETERS] = {
    {"mask", OPC_INPUT, OPC_REQUIRED, NULL, NULL, 0, 0, "mask", "a mask"},
    {"file", OPC_OUTPUT, 0, NULL, "kept.txt", 0, 0, NULL, "a file"},
    {"words", OPC_REALS, 0, "nm", "[1 nm, 0.065 um]", 0, 0, NULL, "lengths"},
    {"layers", OPC_MAP, 0, NULL, "{ poly: P }", 0, 0, "poly|active",
     "names of layers"},
    {"loud", OPC_BOOL, OPC_NO_EFFECT, NULL, "true", 0, 0, NULL, "yes or no"},
    {"style", OPC_CHOICE, 0, NULL, "new", 0, 0, "old|new", "a word"},
};

static const opc_metric metrics[] = {
    {"ion", NULL, OPC_NEUTRAL, 0, 0, "printed over drawn current"},
    {"area", "nm^2", OPC_LOWER, 0, 0, "of poly that was added"},
    {"length", "nm", OPC_NEUTRAL, 0, 0, "printed"},
};

static const opc_step operations = {.size = sizeof operations, .run = run};

COMPAT_PLUGIN("compat.tell", OPC_KIND_STEP, OPC_PARAMETERS(parameters),
              OPC_METRICS(metrics));
