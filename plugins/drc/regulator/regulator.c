/* SPDX-License-Identifier: BSD-3-Clause */
/* drc.regulator: the DRC compliance regulator (thesis 3.2.2 (3), figure 3.7).
   It takes back lengths that bridge or open a gate, lengthens line ends whose
   print does not reach far enough past the active, enlarges what must cover a
   contact, and lists what is left. */
#include <math.h>
#include <stdlib.h>

#include "clearance.h"
#include "mrc.h"
#include "repairs.h"

/* ---- state ---- */

typedef struct regulator {
  const opc_host *host;
  limits rules;
  /* Of these gates; NULL before the first print. */
  const opc_gates *gates;
  uint32_t iteration;   /* the last one seen */
  int32_t *most;        /* how far each line end may go, grid steps */
  int32_t *end;         /* where it was sent */
  response *response;
  drawing drawing;
  sites sites;
  uint64_t moves;           /* of the print before, as a sum */
  repairs repairs;
} regulator;

/* ---- work: the drawing ---- */

static void forget(regulator *r) {
  r->gates = NULL;
  free(r->most);
  free(r->end);
  free(r->response);
  r->most = r->end = NULL;
  r->response = NULL;
  drawing_clear(&r->drawing);
  sites_clear(&r->sites);
  repairs_clear(&r->repairs);
}

/* How far each line end may go: half of what is free before it, as another line
   end may come from there; contacts that poly must not touch stay. */
static void find_room(regulator *r, const opc_gates *g) {
  const limits *rules = &r->rules;
  int32_t range =
      (int32_t)ceil((2 * rules->max_growth + rules->min_space) / g->grid) + 1;
  int32_t beside = (int32_t)ceil(rules->min_space / g->grid);
  line_end_clearance(g, &r->drawing.edges[OPC_POLY], range, beside, r->most);
  line_end_clearance(g, &r->drawing.contacts, range, beside, r->end);
  for (size_t i = 0; i < 2 * g->count; i++) {
    double most = fmin((r->most[i] * g->grid - rules->min_space) / 2,
                       r->end[i] * g->grid - rules->min_space);
    r->most[i] = (int32_t)floor(
        fmax(0, fmin(rules->max_growth, most)) / g->grid + 1e-9);
    r->end[i] = 0;
  }
}

static int look_around(regulator *r, const opc_printed *p, opc_error *error) {
  const opc_gates *g = p->gates;
  if (r->gates == g && p->iteration >= r->iteration) {
    r->iteration = p->iteration;
    return OPC_OK;
  }
  forget(r);
  r->most = calloc(2 * g->count + 1, sizeof *r->most);
  r->end = calloc(2 * g->count + 1, sizeof *r->end);
  r->response = calloc(2 * g->count + 1, sizeof *r->response);
  if (!r->most || !r->end || !r->response)
    return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  int code =
      drawing_make(&r->drawing, r->host, g, &r->rules, &r->sites, error);
  if (code) return code;
  find_room(r, g);
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

static void lengthen(regulator *r, const opc_printed *p, size_t end,
                     int32_t *bias) {
  double grid = p->gates->grid, extension = p->extension[end];
  if (extension < r->rules.min_extension) {
    int32_t to = rules_advance(&r->response[end], *bias, extension,
                               r->rules.min_extension, grid);
    if (to > r->most[end]) to = r->most[end];
    if (to > *bias) *bias = to;
  } else {
    r->response[end] = (response){*bias, extension, 1};
  }
  r->end[end] = *bias;
}

static int is_transistor(uint32_t flags) {
  return !(flags & (OPC_PRINT_OPEN | OPC_PRINT_NO_ACTIVE | OPC_PRINT_MERGED |
                    OPC_PRINT_ISLAND));
}

/* ---- work: the print ---- */

/* Hosts of 1.0 do not give it. */
static const opc_field *print_of(const opc_printed *p) {
  return p->size >= sizeof *p ? p->print : NULL;
}

/* The line end of the nearest gate that may have closed a gap goes back, and
   stays there. */
static void draw_back(regulator *r, const opc_printed *p, const site *s,
                      opc_ruling *ruling) {
  const opc_gates *g = p->gates;
  opc_box b = g->box[s->gate];
  int across = g->axis[s->gate] == OPC_Y;
  int32_t at = across ? s->box.x0 : s->box.y0;
  int32_t low = across ? b.x0 : b.y0, high = across ? b.x1 : b.y1;
  if (at > low && at < high) return;
  size_t end = 2 * (size_t)s->gate + (at >= high);
  int32_t to = r->response[end].bias - (int32_t)ceil(rules_back / g->grid);
  if (r->response[end].bias <= 0) return;
  r->most[end] = to > 0 ? to : 0;
  if (ruling->end[end] > r->most[end]) ruling->end[end] = r->most[end];
  r->end[end] = ruling->end[end];
}

/* Whether the synthesizer rests: it moved no gate with the last print. */
static int is_quiet(regulator *r, const opc_printed *p) {
  uint64_t sum = 14695981039346656037u;   /* FNV-1a */
  for (size_t i = 0; i < p->gates->count; i++) {
    sum = (sum ^ (uint32_t)p->l[i]) * 1099511628211u;
    sum = (sum ^ (uint32_t)p->w[i]) * 1099511628211u;
  }
  int quiet = sum == r->moves;
  r->moves = sum;
  return quiet;
}

static int judge_print(regulator *r, const opc_printed *p, opc_ruling *ruling,
                       opc_error *error) {
  /* All while the first moves are made and when the synthesizer rests, otherwise
     each within some iterations. */
  int whole = is_quiet(r, p) || p->iteration < 3;
  int share = whole ? -1 : (int)(p->iteration % REPAIRS_SHARES);
  if (repairs_look(r->host, p, &r->rules, &r->drawing, &r->sites, &r->repairs,
                   share, error) ||
      repairs_grow(r->host, p, &r->rules, &r->sites, &r->repairs, error))
    return error->code;
  for (size_t i = 0; i < r->sites.n; i++) {
    const site *s = &r->sites.at[i];
    if (!s->failing || s->gate < 0 ||
        (s->kind != SITE_CONTACT && s->kind != SITE_GAP))
      continue;
    ruling->vetoes[s->gate] |= OPC_VETO_LONGER;
    draw_back(r, p, s, ruling);
  }
  if (ruling->size < sizeof *ruling) return OPC_OK;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    ruling->patches[layer] = r->repairs.patch[layer];
    ruling->patch_count[layer] = r->repairs.patches[layer];
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
      lengthen(r, p, end, &ruling->end[end]);
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
  int32_t wanted = (int32_t)floor(r->rules.max_growth / g->grid + 1e-9);
  opc_violation v =
      at_gate(g, i, r->end[end] < r->most[end] ? "extension: could still move"
                    : r->most[end] < wanted
                        ? "extension: no room before the line end"
                        : "extension: max_growth reached");
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
                        &r->repairs, -1, error);
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
  OVERLAY, MIN_EXTENSION, MAX_GROWTH, MIN_SPACE, MIN_WIDTH, MIN_MASK_WIDTH,
  PARAMETERS
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
    [MAX_GROWTH] = {.name = "max_growth", .type = OPC_REAL,
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                    .preset = "60 nm", .max = 10000,
                    .summary = "how far a line end or a patch goes past the drawn"},
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
                     .max_growth = values[MAX_GROWTH].real,
                     .min_space = values[MIN_SPACE].real,
                     .min_width = values[MIN_WIDTH].real,
                     .mask_width = values[MIN_MASK_WIDTH].real};
  return r;
}

static void destroy(void *self) {
  regulator *r = self;
  forget(r);
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
