/* SPDX-License-Identifier: BSD-3-Clause */
/* drc.regulator: the DRC compliance regulator (thesis 3.2.2 (3), figure 3.7).
   It counts the transistors of each print, so that a length that bridges or
   opens a gate is taken back, and lengthens line ends whose print does not
   reach far enough past the active to bear overlay errors. */
#include "clearance.h"

#include <opcflow/mask.h>

#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct regulator {
  const opc_host *host;
  double min_extension, max_growth, min_space;   /* nm */
  const opc_gates *gates;   /* those that `clearance` is of */
  int32_t *clearance;       /* of each line end, in grid steps */
} regulator;

/* A line end moves at most so far at a time: its response is not known. */
static const double largest_step = 10;   /* nm */

/* ---- work ---- */

static int look_around(regulator *r, const opc_gates *g, opc_error *error) {
  if (r->gates == g) return OPC_OK;
  free(r->clearance);
  r->gates = NULL;
  r->clearance = malloc((2 * g->count + 1) * sizeof *r->clearance);
  int32_t range =
      (int32_t)ceil((2 * r->max_growth + r->min_space) / g->grid) + 1;
  int32_t beside = (int32_t)ceil(r->min_space / g->grid);
  if (!r->clearance ||
      !opc_line_end_clearance(g, range, beside, r->clearance))
    return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  r->gates = g;
  return OPC_OK;
}

/* How far a line end may go: half of what is free before it, as another line
   end may come from there. */
static int32_t room(const regulator *r, double grid, size_t end) {
  double half = (r->clearance[end] * grid - r->min_space) / 2;
  return (int32_t)floor(fmax(0, fmin(r->max_growth, half)) / grid);
}

static uint32_t vetoes(const regulator *r, const opc_printed *p, size_t i) {
  const opc_gates *g = p->gates;
  uint32_t v = 0;
  if (p->flags[i] & OPC_PRINT_MERGED) v |= OPC_VETO_LONGER;
  if (p->flags[i] & (OPC_PRINT_OPEN | OPC_PRINT_NO_ACTIVE))
    v |= OPC_VETO_SHORTER | OPC_VETO_NARROWER;
  /* Mask space, should the neighbour grow as much. */
  double growth = p->l[i] * g->grid;
  if (fmin(g->room[2 * i], g->room[2 * i + 1]) - growth - g->grid < r->min_space)
    v |= OPC_VETO_LONGER;
  return v;
}

static int rule(void *self, const opc_printed *p, opc_ruling *ruling,
                opc_error *error) {
  regulator *r = self;
  int code = look_around(r, p->gates, error);
  if (code) return code;
  double grid = p->gates->grid;
  ruling->transistors = 0;
  for (size_t i = 0; i < p->gates->count; i++) {
    ruling->vetoes[i] = vetoes(r, p, i);
    ruling->transistors += !(p->flags[i] & ~(uint32_t)OPC_PRINT_SHORT);
    for (size_t end = 2 * i; end < 2 * i + 2; end++) {
      double missing = r->min_extension - p->extension[end];
      if (!(missing > 0)) continue;
      int32_t step = (int32_t)ceil(fmin(missing, largest_step) / grid);
      int32_t to = ruling->end[end] + step, most = room(r, grid, end);
      if (to > most) to = most;
      if (to > ruling->end[end]) ruling->end[end] = to;
    }
  }
  return OPC_OK;
}

typedef struct list {
  opc_violation *v;
  size_t room, count;
} list;

static void add(list *l, const opc_gates *g, size_t i, const char *rule_name,
                double value, double limit) {
  if (l->count < l->room)
    l->v[l->count] = (opc_violation){
        .rule = rule_name,
        .gate = (int32_t)i,
        .x = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
        .y = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid,
        .value = value,
        .limit = limit};
  l->count++;
}

static int violations(void *self, const opc_printed *p, opc_violation *v,
                      size_t room_for, size_t *count, opc_error *error) {
  const regulator *r = self;
  (void)error;
  list l = {v, room_for, 0};
  for (size_t i = 0; i < p->gates->count; i++) {
    uint32_t f = p->flags[i];
    if (f & OPC_PRINT_MERGED) add(&l, p->gates, i, "bridging", 0, 0);
    if (f & OPC_PRINT_OPEN) add(&l, p->gates, i, "open gate", 0, 0);
    if (f & OPC_PRINT_NO_ACTIVE) add(&l, p->gates, i, "open active", 0, 0);
    double least = fmin(p->extension[2 * i], p->extension[2 * i + 1]);
    if (least < r->min_extension)
      add(&l, p->gates, i, "extension", least, r->min_extension);
  }
  *count = l.count;
  return OPC_OK;
}

/* ---- parameters ---- */

enum { MIN_EXTENSION, MAX_GROWTH, MIN_SPACE, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [MIN_EXTENSION] =
        {.name = "min_extension", .type = OPC_REAL, .flags = OPC_AT_LEAST,
         .unit = "nm", .preset = "20 nm",
         .summary = "printed poly past the printed active, more than the overlay"},
    [MAX_GROWTH] = {.name = "max_growth", .type = OPC_REAL,
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                    .preset = "60 nm", .max = 10000,
                    .summary = "how far a line end of the mask may be moved"},
    [MIN_SPACE] = {.name = "min_space", .type = OPC_REAL,
                   .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                   .preset = "40 nm", .max = 10000,
                   .summary = "space that moved edges leave on the mask"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  regulator *r = calloc(1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  r->min_extension = values[MIN_EXTENSION].real;
  r->max_growth = values[MAX_GROWTH].real;
  r->min_space = values[MIN_SPACE].real;
  return r;
}

static void destroy(void *self) {
  regulator *r = self;
  free(r->clearance);
  free(r);
}

/* ---- entry ---- */

static const opc_regulator operations = {
    .size = sizeof operations, .rule = rule, .violations = violations};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "drc.regulator",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "transistor count and line-end extension of the print",
      .kind = OPC_KIND_DRC,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
