/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements edge placement errors: distances from each fragment's site along
   its normal to the printed edge. The search runs outwards if the site prints,
   otherwise inwards, so that the search does not find edges of neighbouring
   shapes. */
#include <correct/sites.h>

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* Largest distance of an edge from its site; see eda_feedback.epe. */
static const char reach[] = "0.389 lambda/NA";

void correct_sites_init(sites *s, const eda_cuts *cuts) {
  size_t n = cuts->start[cuts->polygons];
  s->count = n;
  s->place = eda_alloc(2 * n, sizeof *s->place);
  s->axis = eda_alloc(n, sizeof *s->axis);
  s->out = eda_alloc(n, sizeof *s->out);
  s->epe = eda_alloc(n, sizeof *s->epe);
  memcpy(s->place, cuts->site, 2 * n * sizeof *s->place);
  for (size_t p = 0; p < cuts->polygons; p++) {
    uint32_t first = cuts->start[p], end = cuts->start[p + 1];
    for (uint32_t i = first; i < end; i++) {
      eda_point a = cuts->from[i], b = cuts->from[i + 1 < end ? i + 1 : first];
      /* The inside is on the left of an edge. */
      s->axis[i] = a.y == b.y ? EDA_Y : EDA_X;
      s->out[i] = a.y == b.y ? (b.x > a.x ? -1 : 1) : (b.y > a.y ? 1 : -1);
    }
  }
}

void correct_sites_clear(sites *s) {
  free(s->place);
  free(s->axis);
  free(s->out);
  free(s->epe);
  *s = (sites){0};
}

/* ---- measuring ---- */

typedef struct site_search {
  const sites *sites;
  const eda_field *print;
  double reach; /* nm */
} site_search;

static void measure_site(void *data, size_t i) {
  const site_search *j = data;
  const sites *s = j->sites;
  s->epe[i] = eda_field_epe(j->print, s->axis[i], s->out[i], s->place[2 * i],
                            s->place[2 * i + 1], j->reach);
}

void correct_sites_measure(const opc_context *context, const sites *s,
                           const eda_field *print, eda_scanner scanner) {
  site_search j = {s, print, eda_natural(&scanner, reach)};
  opc_parallel(context, s->count, measure_site, &j);
}
