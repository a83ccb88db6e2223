/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements regulator.drc: the DRC compliance regulator (thesis 3.2.2 (3),
   figure 3.7). The regulator vetoes changes of gates that bridge, open or
   violate a mask space, and extends line ends whose printed extension past the
   active is too short. The regulator enlarges shapes that must cover a contact,
   and reports the remaining violations. */
#include "drc.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- work: drawn shapes ---- */

static void drc_follow(drc *r, eda_scanner scanner);

/* Free all data of the gates; keep the parameters. */
static void drc_clear(void *self) {
  drc *r = self;
  for (size_t k = 0; k < r->layers; k++) {
    if (r->edges) places_clear(&r->edges[k]);
    if (r->bridging) free(r->bridging[k]);
    free(r->smoothings[k].at);
    free(r->added[k].box);
    free(r->cutouts[k].box);
  }
  free(r->edges);
  free(r->bridging);
  free(r->smoothings);
  free(r->added);
  free(r->cutouts);
  places_clear(&r->boxes);
  places_clear(&r->contacts);
  places_clear(&r->pads);
  places_clear(&r->widths);
  places_clear(&r->mask);
  free(r->width);
  free(r->sites);
  free(r->ends);
  free(r->repairs);
  free(r->trims);
  free(r->pairs);
  memset(&r->gates, 0, sizeof *r - offsetof(drc, gates));
}

/* Find the sites of the drawn shapes, if the gates or the run have changed. */
static int drc_find_sites(drc *r, const eda_printed *p, opc_error *error) {
  const eda_gates *g = p->gates;
  if (r->gates == g && r->serial == g->serial && p->iteration >= r->iteration) {
    r->iteration = p->iteration;
    return OPC_OK;
  }
  drc_clear(r);
  drc_follow(r, p->scanner);
  r->gates = g;
  r->serial = g->serial;
  r->grid = g->grid;
  r->layers = g->layers;
  r->smoothings = eda_alloc(r->layers, sizeof *r->smoothings);
  r->added = eda_alloc(r->layers, sizeof *r->added);
  r->cutouts = eda_alloc(r->layers, sizeof *r->cutouts);
  r->iteration = p->iteration;
  int code = sites_find(r, error);
  if (code)
    drc_clear(r);
  else
    ends_find(r);
  return code;
}

/* ---- work: gates and line ends ---- */

static uint32_t gate_vetoes(const drc *r, const eda_printed *p, size_t i) {
  const eda_gates *g = p->gates;
  uint32_t v = 0;
  if (p->flags[i] & EDA_PRINT_MERGED) v |= EDA_VETO_LONGER;
  if (p->flags[i] & (EDA_PRINT_OPEN | EDA_PRINT_NO_ACTIVE))
    v |= EDA_VETO_SHORTER | EDA_VETO_NARROWER;
  /* Assume that the neighbour has the same bias: the space on the mask then
     shrinks by the bias. */
  double growth = p->l[i] * g->grid;
  if (fmin(g->space[2 * i], g->space[2 * i + 1]) - growth - g->grid <
      r->min_space)
    v |= EDA_VETO_LONGER;
  return v;
}

static int is_transistor(uint32_t flags) {
  return !(flags & (EDA_PRINT_OPEN | EDA_PRINT_NO_ACTIVE | EDA_PRINT_MERGED |
                    EDA_PRINT_ISLAND));
}

/* ---- work: the printed image ---- */

/* Write the added shapes and cut-outs of the next mask. */
static void drc_add_shapes(drc *r, const eda_printed *p, eda_ruling *ruling) {
  for (size_t k = 0; k < r->layers; k++)
    r->added[k].count = r->cutouts[k].count = 0;
  repairs_add_shapes(r, p);
  ends_add_heads(r);
  trims_add_cutouts(r);
  smooth_masks(r, p);
  smooth_add_boxes(r);
  for (size_t k = 0; k < r->layers; k++) {
    ruling->added[k] = (eda_boxes){r->added[k].box, r->added[k].count};
    ruling->cutouts[k] = (eda_boxes){r->cutouts[k].box, r->cutouts[k].count};
  }
}

static void drc_check_print(drc *r, const eda_printed *p, eda_ruling *ruling) {
  repairs_check(r, p);
  repairs_grow(r, p);
  for (size_t i = 0; i < r->n_sites; i++) {
    const site *s = &r->sites[i];
    if (!s->failing || s->gate < 0 || s->layer != EDA_POLY ||
        (s->kind != SITE_CONTACT && s->kind != SITE_GAP))
      continue;
    if (!ends_revert(r, s, ruling->end))
      ruling->vetoes[s->gate] |= EDA_VETO_LONGER;
  }
  for (size_t i = 0; i < r->n_repairs; i++)
    repair_veto(r, p, &r->repairs[i], ruling->vetoes);
  drc_add_shapes(r, p, ruling);
}

static int drc_rule(void *self, const eda_printed *p, eda_ruling *ruling,
                    opc_error *error) {
  drc *r = self;
  int code = drc_find_sites(r, p, error);
  if (code) return code;
  places_clear(&r->mask);
  ruling->transistors = 0;
  for (size_t i = 0; i < p->gates->count; i++) {
    ruling->vetoes[i] = gate_vetoes(r, p, i);
    ruling->transistors += (size_t)is_transistor(p->flags[i]);
    for (size_t end = 2 * i; end < 2 * i + 2; end++)
      ends_advance(r, p, end, &ruling->end[end]);
  }
  if (p->print) drc_check_print(r, p, ruling);
  return OPC_OK;
}

static int drc_smooth(void *self, const eda_printed *p, eda_ruling *ruling,
                      opc_error *error) {
  drc *r = self;
  int code = drc_find_sites(r, p, error);
  if (code) return code;
  places_clear(&r->mask);
  if (p->print) drc_add_shapes(r, p, ruling);
  return OPC_OK;
}

/* ---- work: violations ---- */

static eda_violation at_gate(const eda_gates *g, size_t i, const char *name) {
  eda_box b = g->box[i];
  return (eda_violation){.rule = name,
                         .gate = (int32_t)i,
                         .x = ((double)b.x0 + b.x1) / 2 * g->grid,
                         .y = ((double)b.y0 + b.y1) / 2 * g->grid};
}

static void report_extension(const drc *r, const eda_printed *p, size_t end,
                             violations *out) {
  const eda_gates *g = p->gates;
  size_t i = end / 2;
  int high = end % 2;
  eda_violation v = at_gate(g, i, ends_reason(r, end));
  eda_box b = g->box[i]; /* locate the violation at the end of the gate */
  if (g->axis[i] == EDA_Y)
    v.x = (high ? b.x1 : b.x0) * g->grid;
  else
    v.y = (high ? b.y1 : b.y0) * g->grid;
  v.value = p->extension[end];
  v.limit = r->min_extension;
  violations_add(out, v);
}

static void report_gates(const drc *r, const eda_printed *p, violations *out) {
  const eda_gates *g = p->gates;
  for (size_t i = 0; i < g->count; i++) {
    uint32_t f = p->flags[i];
    if (f & EDA_PRINT_MERGED) violations_add(out, at_gate(g, i, "bridging"));
    if (f & EDA_PRINT_OPEN) violations_add(out, at_gate(g, i, "open gate"));
    if (f & EDA_PRINT_NO_ACTIVE)
      violations_add(out, at_gate(g, i, "open active"));
    for (size_t end = 2 * i; end < 2 * i + 2; end++)
      if (p->extension[end] < r->min_extension)
        report_extension(r, p, end, out);
  }
}

static int violations_of(void *self, const eda_printed *p, eda_violation *v,
                         size_t capacity, size_t *count, opc_error *error) {
  drc *r = self;
  violations list = {v, capacity, 0};
  int code = drc_find_sites(r, p, error);
  if (code) return code;
  report_gates(r, p, &list);
  if (p->print) {
    repairs_check(r, p);
    repairs_report(r, p, &list);
    mrc_check(r, p->shapes, &list);
  }
  *count = list.count;
  return OPC_OK;
}

/* ---- parameters ---- */

#define LENGTH(NAME, MAX, FOLLOWS, SUMMARY)                                 \
  {                                                                         \
    .name = #NAME, .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_AT_MOST,   \
    .unit = "nm", .follows = (FOLLOWS), .max = (MAX), .summary = (SUMMARY), \
    OPC_FIELD(drc, NAME)                                                    \
  }

static const opc_parameter parameters[] = {
    LENGTH(overlay, 1000, "0.039 lambda/NA",
           "largest overlay error (misalignment) between layers"),
    LENGTH(min_extension, 10000, "2 overlay",
           "smallest printed extension of poly past the active"),
    LENGTH(want_extension, 10000, "min_extension",
           "desired printed extension of poly if the spacing permits"),
    LENGTH(
        max_growth, 10000, "0.233 lambda/NA",
        "largest extension of a line end or repair shape past the drawn edge"),
    OPC_PARAMETER(drc, max_head, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                  .preset = "0 nm", .max = 1000,
                  .summary = "largest widening, per side, of a line end that "
                             "cannot be extended enough"),
    LENGTH(min_space, 10000, "0.155 lambda/NA", "smallest space of the mask"),
    LENGTH(min_width, 10000, "0.117 lambda/NA",
           "smallest printed width of poly outside of gates"),
    LENGTH(min_mask_width, 10000, "0.155 lambda/NA",
           "smallest width of the mask"),
    LENGTH(min_edge, 10000, "0.078 lambda/NA",
           "smallest length of a mask edge at a repair shape, unless both "
           "adjacent edges are longer"),
};

/* Compute the defaults of parameters that are not set. */
static void drc_follow(drc *r, eda_scanner scanner) {
  EDA_FOLLOW(r->host, "regulator.drc", r, parameters, scanner);
  if (isnan(r->min_extension)) r->min_extension = 2 * r->overlay;
  if (isnan(r->want_extension)) r->want_extension = r->min_extension;
}

/* ---- entry ---- */

static const eda_regulator functions = {
    .rule = drc_rule, .violations = violations_of, .smooth = drc_smooth};

OPC_PLUGIN(drc, .id = "regulator.drc", .kind = "regulator", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary =
               "checks and repairs of bridging, pinching, line ends and "
               "contacts on the printed image",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .clear = drc_clear,
           OPC_FUNCTIONS(functions));
