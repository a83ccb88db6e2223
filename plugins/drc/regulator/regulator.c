/* SPDX-License-Identifier: BSD-3-Clause */
/* drc.regulator: the DRC compliance regulator (thesis 3.2.2 (3), figure 3.7).
   It takes back lengths that bridge or open a gate, lengthens line ends whose
   print does not reach far enough past the active, enlarges what must cover a
   contact, and lists what is left. */
#include <math.h>
#include <stdlib.h>

#include "ends.h"
#include "mrc.h"
#include "repairs.h"
#include "smooth.h"

/* ---- state ---- */

typedef struct regulator {
  const opc_host *host;
  limits rules;
  /* Of these gates; NULL before the first print. */
  const opc_gates *gates;
  uint32_t iteration;   /* the last one seen */
  drawing drawing;
  ends ends;
  sites sites;
  repairs repairs;
  smoothing smoothing;
  box_list patch[OPC_MASKS], bite[OPC_MASKS];   /* of the last ruling */
} regulator;

/* ---- work: the drawing ---- */

static void forget(regulator *r) {
  r->gates = NULL;
  ends_clear(&r->ends);
  drawing_clear(&r->drawing);
  sites_clear(&r->sites);
  repairs_clear(&r->repairs);
  smoothing_clear(&r->smoothing);
}

static int look_around(regulator *r, const opc_printed *p, opc_error *error) {
  const opc_gates *g = p->gates;
  if (r->gates == g && p->iteration >= r->iteration) {
    r->iteration = p->iteration;
    return OPC_OK;
  }
  forget(r);
  int code =
      drawing_make(&r->drawing, r->host, g, &r->rules, &r->sites, error);
  if (code) return code;
  if (!ends_make(&r->ends, g, &r->drawing, &r->rules))
    return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  r->gates = g;
  r->iteration = p->iteration;
  return OPC_OK;
}

/* ---- work: gates and line ends ---- */

static uint32_t vetoes(const regulator *r, const opc_printed *p, size_t i) {
  const opc_gates *g = p->gates;
  uint32_t v = 0;
  if (p->flags[i] & OPC_PRINT_MERGED) v |= OPC_VETO_LONGER;
  if (p->flags[i] & (OPC_PRINT_OPEN | OPC_PRINT_NO_ACTIVE))
    v |= OPC_VETO_SHORTER | OPC_VETO_NARROWER;
  /* Mask space, should the neighbour grow as much. */
  double growth = p->l[i] * g->grid;
  if (fmin(g->room[2 * i], g->room[2 * i + 1]) - growth - g->grid <
      r->rules.min_space)
    v |= OPC_VETO_LONGER;
  return v;
}

/* Hosts of 1.0 do not give it. */
static const opc_field *print_of(const opc_printed *p) {
  return p->size >= sizeof *p ? p->print : NULL;
}

static int is_transistor(uint32_t flags) {
  return !(flags & (OPC_PRINT_OPEN | OPC_PRINT_NO_ACTIVE | OPC_PRINT_MERGED |
                    OPC_PRINT_ISLAND));
}

/* ---- work: the print ---- */

/* All patches and bites. 0 if there is no memory. */
static int gather(regulator *r, const opc_printed *p) {
  for (int layer = 0; layer < OPC_MASKS; layer++)
    r->patch[layer].n = r->bite[layer].n = 0;
  return repairs_patches(p, &r->rules, &r->sites, &r->repairs, r->patch) &&
         ends_heads(&r->ends, &r->patch[OPC_POLY]) &&
         trims_bites(&r->repairs.trims, &r->bite[OPC_POLY]) &&
         smoothing_follow(&r->smoothing, p, &r->rules) &&
         smoothing_boxes(&r->smoothing, r->patch, r->bite);
}

static int judge_print(regulator *r, const opc_printed *p, opc_ruling *ruling,
                       opc_error *error) {
  if (repairs_look(r->host, p, &r->rules, &r->drawing, &r->sites, &r->repairs,
                   error) ||
      repairs_grow(r->host, p, &r->rules, &r->drawing, &r->sites, &r->repairs,
                   error))
    return error->code;
  for (size_t i = 0; i < r->sites.n; i++) {
    const site *s = &r->sites.at[i];
    if (!s->failing || s->gate < 0 || s->layer != OPC_POLY ||
        (s->kind != SITE_CONTACT && s->kind != SITE_GAP))
      continue;
    if (!ends_back(&r->ends, p, s, ruling->end))
      ruling->vetoes[s->gate] |= OPC_VETO_LONGER;
  }
  if (!gather(r, p))
    return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  if (ruling->size < offsetof(opc_ruling, bites)) return OPC_OK;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    ruling->patches[layer] = r->patch[layer].at;
    ruling->patch_count[layer] = r->patch[layer].n;
  }
  if (ruling->size < sizeof *ruling) return OPC_OK;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    ruling->bites[layer] = r->bite[layer].at;
    ruling->bite_count[layer] = r->bite[layer].n;
  }
  return OPC_OK;
}

static int rule(void *self, const opc_printed *p, opc_ruling *ruling,
                opc_error *error) {
  regulator *r = self;
  int code = look_around(r, p, error);
  if (code) return code;
  ruling->transistors = 0;
  for (size_t i = 0; i < p->gates->count; i++) {
    ruling->vetoes[i] = vetoes(r, p, i);
    ruling->transistors += (size_t)is_transistor(p->flags[i]);
    for (size_t end = 2 * i; end < 2 * i + 2; end++)
      ends_advance(&r->ends, print_of(p) ? r->host : NULL, p, &r->rules, end,
                   &ruling->end[end]);
  }
  return print_of(p) ? judge_print(r, p, ruling, error) : OPC_OK;
}

/* ---- work: violations ---- */

static opc_violation at_gate(const opc_gates *g, size_t i, const char *name) {
  opc_box b = g->box[i];
  return (opc_violation){.rule = name,
                         .gate = (int32_t)i,
                         .x = ((double)b.x0 + b.x1) / 2 * g->grid,
                         .y = ((double)b.y0 + b.y1) / 2 * g->grid};
}

static void report_extension(const regulator *r, const opc_printed *p,
                             size_t end, violations *out) {
  const opc_gates *g = p->gates;
  size_t i = end / 2;
  int high = end % 2;
  opc_violation v =
      at_gate(g, i, ends_reason(&r->ends, &r->rules, g->grid, end));
  opc_box b = g->box[i];   /* the place is where the gate ends */
  if (g->axis[i] == OPC_Y) v.x = (high ? b.x1 : b.x0) * g->grid;
  else v.y = (high ? b.y1 : b.y0) * g->grid;
  v.value = p->extension[end];
  v.limit = r->rules.min_extension;
  violations_add(out, v);
}

static void report_gates(const regulator *r, const opc_printed *p,
                         violations *out) {
  const opc_gates *g = p->gates;
  for (size_t i = 0; i < g->count; i++) {
    uint32_t f = p->flags[i];
    if (f & OPC_PRINT_MERGED) violations_add(out, at_gate(g, i, "bridging"));
    if (f & OPC_PRINT_OPEN) violations_add(out, at_gate(g, i, "open gate"));
    if (f & OPC_PRINT_NO_ACTIVE)
      violations_add(out, at_gate(g, i, "open active"));
    for (size_t end = 2 * i; end < 2 * i + 2; end++)
      if (p->extension[end] < r->rules.min_extension)
        report_extension(r, p, end, out);
  }
}

static int violations_of(void *self, const opc_printed *p, opc_violation *v,
                         size_t room, size_t *count, opc_error *error) {
  regulator *r = self;
  violations list = {v, room, 0};
  int code = look_around(r, p, error);
  if (code) return code;
  report_gates(r, p, &list);
  if (print_of(p)) {
    code = repairs_look(r->host, p, &r->rules, &r->drawing, &r->sites,
                        &r->repairs, error);
    if (code) return code;
    repairs_report(r->host, p, &r->rules, &r->sites, &r->repairs, &list);
    for (int layer = 0; layer < OPC_MASKS && p->mask; layer++)
      if (!mrc_check(&p->mask[layer], p->gates->grid, r->rules.mask_width,
                     r->rules.min_space, &list))
        return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  }
  *count = list.count;
  return OPC_OK;
}

/* ---- parameters ---- */

enum {
  OVERLAY, MIN_EXTENSION, WANT_EXTENSION, MAX_GROWTH, MAX_HEAD, MIN_SPACE,
  MIN_WIDTH, MIN_MASK_WIDTH, PARAMETERS
};

static const opc_parameter parameters[PARAMETERS] = {
    [OVERLAY] = {.name = "overlay", .type = OPC_REAL,
                 .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                 .preset = "10 nm", .max = 100,
                 .summary = "how far layers may lie off each other"},
    [MIN_EXTENSION] =
        {.name = "min_extension", .type = OPC_REAL, .flags = OPC_AT_LEAST,
         .unit = "nm",
         .summary = "printed poly past the printed active; default: twice overlay"},
    [WANT_EXTENSION] =
        {.name = "want_extension", .type = OPC_REAL, .flags = OPC_AT_LEAST,
         .unit = "nm",
         .summary = "the same where there is room for it; default: min_extension"},
    [MAX_GROWTH] = {.name = "max_growth", .type = OPC_REAL,
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                    .preset = "60 nm", .max = 10000,
                    .summary = "how far a line end or a patch goes past the drawn"},
    [MAX_HEAD] = {.name = "max_head", .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                  .preset = "0 nm", .max = 1000,
                  .summary = "how much wider a line end gets, on each side, that "
                             "may not be long enough"},
    [MIN_SPACE] = {.name = "min_space", .type = OPC_REAL,
                   .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                   .preset = "40 nm", .max = 10000,
                   .summary = "least space of the mask"},
    [MIN_WIDTH] = {.name = "min_width", .type = OPC_REAL,
                   .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                   .preset = "30 nm", .max = 10000,
                   .summary = "least printed width of poly outside of gates"},
    [MIN_MASK_WIDTH] = {.name = "min_mask_width", .type = OPC_REAL,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                        .preset = "40 nm", .max = 10000,
                        .summary = "least width of the mask"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  regulator *r = calloc(1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  r->rules = (limits){.overlay = values[OVERLAY].real,
                     .min_extension = values[MIN_EXTENSION].type == OPC_ABSENT
                                          ? 2 * values[OVERLAY].real
                                          : values[MIN_EXTENSION].real,
                     .want_extension =
                         values[WANT_EXTENSION].type == OPC_ABSENT
                             ? 0 : values[WANT_EXTENSION].real,
                     .max_growth = values[MAX_GROWTH].real,
                     .max_head = values[MAX_HEAD].real,
                     .min_space = values[MIN_SPACE].real,
                     .min_width = values[MIN_WIDTH].real,
                     .mask_width = values[MIN_MASK_WIDTH].real};
  return r;
}

static void destroy(void *self) {
  regulator *r = self;
  forget(r);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    free(r->patch[layer].at);
    free(r->bite[layer].at);
  }
  free(r);
}

/* ---- entry ---- */

static const opc_regulator operations = {
    .size = sizeof operations, .rule = rule, .violations = violations_of};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "drc.regulator",
      .version = "0.2.0",
      .licence = "BSD-3-Clause",
      .summary = "bridging, pinching, line ends and contacts of the print",
      .kind = OPC_KIND_DRC,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
