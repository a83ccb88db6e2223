/* SPDX-License-Identifier: BSD-3-Clause */
/* Edge placement errors: from the site of each fragment along its normal, to
   where the print has its edge. Where the site is printed, that edge lies
   outwards, else inwards: the edge of a neighbour is not taken for it. */
#include "core/correct/loop.h"
#include "core/imaging/edge.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 64 };

/* How far from a site an edge is looked for, nm; mask.h. */
static const double reach = 100;

int opc_sites_make(const opc_host *host, const opc_cuts *cuts,
                   opc_sites *out) {
  size_t n = cuts->start[cuts->polygons];
  out->count = n;
  out->place = host->alloc(host, 2 * n, sizeof *out->place);
  out->axis = host->alloc(host, n, sizeof *out->axis);
  out->out = host->alloc(host, n, sizeof *out->out);
  out->epe = host->alloc(host, n, sizeof *out->epe);
  if (!out->place || !out->axis || !out->out || !out->epe) return 0;
  memcpy(out->place, cuts->site, 2 * n * sizeof *out->place);
  for (size_t p = 0; p < cuts->polygons; p++) {
    uint32_t first = cuts->start[p], end = cuts->start[p + 1];
    for (uint32_t i = first; i < end; i++) {
      opc_point a = cuts->from[i], b = cuts->from[i + 1 < end ? i + 1 : first];
      /* The inside is on the left. */
      out->axis[i] = a.y == b.y ? OPC_Y : OPC_X;
      out->out[i] = a.y == b.y ? (b.x > a.x ? -1 : 1) : (b.y > a.y ? 1 : -1);
    }
  }
  return 1;
}

void opc_sites_clear(const opc_host *host, opc_sites *sites) {
  host->free(host, sites->place);
  host->free(host, sites->axis);
  host->free(host, sites->out);
  host->free(host, sites->epe);
  *sites = (opc_sites){0};
}

static double error_at(const opc_field *print, double x, double y, int axis,
                       int out) {
  opc_line line;
  opc_walk walk[2];   /* down, up */
  opc_line_make(print, axis, axis == OPC_X ? y : x, &line);
  double value =
      opc_line_start(&line, axis == OPC_X ? x : y, &walk[0], &walk[1]);
  int sign = value > 0 ? 1 : -1;
  return sign * opc_walk_to(&walk[sign * out > 0], reach);
}

typedef struct job {
  const opc_sites *sites;
  const opc_field *print;
} job;

static void measure_block(void *data, size_t block) {
  const job *j = data;
  const opc_sites *s = j->sites;
  size_t last = (block + 1) * BLOCK < s->count ? (block + 1) * BLOCK : s->count;
  for (size_t i = block * BLOCK; i < last; i++)
    s->epe[i] = error_at(j->print, s->place[2 * i], s->place[2 * i + 1],
                         s->axis[i], s->out[i]);
}

void opc_sites_measure(const opc_host *host, const opc_sites *sites,
                       const opc_field *print) {
  job j = {sites, print};
  host->parallel(host, (sites->count + BLOCK - 1) / BLOCK, measure_block, &j);
}
