/* SPDX-License-Identifier: BSD-3-Clause */
/* score.iccad: the figures of the ICCAD 2013 contest on mask optimization
   (S. Banerjee, Z. Li, S. R. Nassif, ICCAD 2013, 271), on pixels of 1 nm as the
   programs count them that are compared by them. */
#include "iccad.h"

#include <math.h>

/* ---- state ---- */

enum { MASK, LITHO, RESIST, TILE, DOSE, DEFOCUS, EPE, SPACING, PARAMETERS };

typedef struct score {
  const opc_host *host;
  const opc_value *values;
} score;

enum { TARGET, NOMINAL, OUTER, INNER, RASTERS };

typedef struct figures {
  int64_t inner, outer;   /* sites whose print ends too early, goes too far */
  int64_t sites, l2, pvb, shots;
} figures;

/* ---- work ---- */

/* The tile, with the target in its middle. */
static int place_tile(const score *s, const opc_gates *g, iccad_tile *tile,
                      opc_error *error) {
  double side = s->values[TILE].real;
  double w = ((double)g->extent.x1 - g->extent.x0) * g->grid;
  double h = ((double)g->extent.y1 - g->extent.y0) * g->grid;
  if (side != floor(side))
    return s->host->fail(s->host, error, OPC_INVALID, "tile",
                         "%g nm is no whole number of pixels of 1 nm", side);
  if (w > side || h > side)
    return s->host->fail(s->host, error, OPC_INVALID, "tile",
                         "the layout is %g x %g nm, too large for %g nm", w, h,
                         side);
  tile->side = (int32_t)side;
  tile->x0 = (int32_t)floor(g->extent.x0 * g->grid - (side - w) / 2);
  tile->y0 = (int32_t)floor(g->extent.y0 * g->grid - (side - h) / 2);
  return OPC_OK;
}

/* Nominal dose in focus, the outermost and the innermost print. */
static int expose(const score *s, const opc_mask *mask, const iccad_tile *tile,
                  uint8_t *const raster[RASTERS], opc_error *error) {
  const opc_host *host = s->host;
  const opc_value *v = s->values;
  iccad_print p = {host, v[LITHO].object, v[RESIST].object, tile};
  const opc_litho *litho = p.litho->plugin->operations;
  const opc_resist *resist = p.resist->plugin->operations;
  double more = 1 + v[DOSE].real / 100, less = 1 - v[DOSE].real / 100;
  /* Nodes of fields are the middles of pixels. */
  opc_frame frame = {tile->x0 + 0.5, tile->y0 + 0.5, tile->side, tile->side};
  opc_spectrum spectrum;
  int code = litho->prepare(p.litho->self, error);
  if (!code) code = resist->prepare(p.resist->self, p.litho, error);
  if (code) return code;
  code = host->imaging->mask_spectrum(host, &mask->shapes[OPC_POLY],
                                      mask->gates->grid, frame,
                                      litho->band(p.litho->self), &spectrum,
                                      error);
  if (code) return code;
  code = iccad_expose(&p, &spectrum, 1, 0, raster[NOMINAL], error);
  if (!code)
    code = iccad_expose(&p, &spectrum, more * more, 0, raster[OUTER], error);
  if (!code)
    code = iccad_expose(&p, &spectrum, less * less, v[DEFOCUS].real,
                        raster[INNER], error);
  host->imaging->release_spectrum(host, &spectrum);
  return code;
}

static void count_sites(const score *s, const iccad_tile *t,
                        const uint8_t *nominal, const iccad_site *sites,
                        size_t n, figures *f) {
  int32_t off = (int32_t)s->values[EPE].real;
  for (size_t i = 0; i < n; i++) {
    iccad_site p = sites[i];
    f->inner += !iccad_at(t, nominal, p.x - off * p.dx, p.y - off * p.dy);
    f->outer += iccad_at(t, nominal, p.x + off * p.dx, p.y + off * p.dy);
  }
  f->sites = (int64_t)n;
}

static int count_all(const score *s, const opc_mask *mask,
                     const iccad_tile *tile, uint8_t *const raster[RASTERS],
                     figures *f, opc_error *error) {
  const opc_host *host = s->host;
  const opc_gates *g = mask->gates;
  iccad_site *sites;
  opc_box *boxes;
  size_t n;
  int code = iccad_fill(host, &g->drawn[OPC_POLY], g->grid, tile,
                        raster[TARGET], error);
  if (!code) code = expose(s, mask, tile, raster, error);
  if (!code)
    code = iccad_sites(host, &g->drawn[OPC_POLY], g->grid,
                       (int32_t)s->values[SPACING].real, &sites, &n, error);
  if (code) return code;
  count_sites(s, tile, raster[NOMINAL], sites, n, f);
  host->free(host, sites);
  size_t pixels = (size_t)tile->side * (size_t)tile->side;
  for (size_t i = 0; i < pixels; i++) {
    f->l2 += raster[TARGET][i] != raster[NOMINAL][i];
    f->pvb += raster[OUTER][i] != raster[INNER][i];
  }
  code = host->geometry->fracture(host, &mask->shapes[OPC_POLY], &boxes, &n,
                                  error);
  if (code) return code;
  f->shots = (int64_t)n;
  host->free(host, boxes);
  return OPC_OK;
}

static int publish(const score *s, const figures *f, opc_error *error) {
  const opc_host *host = s->host;
  int64_t epe = f->inner + f->outer;
  const opc_column columns[] = {
      {"epe", NULL, OPC_INT, 0, &epe},
      {"epe_inner", NULL, OPC_INT, 0, &f->inner},
      {"epe_outer", NULL, OPC_INT, 0, &f->outer},
      {"sites", NULL, OPC_INT, 0, &f->sites},
      {"l2", "nm^2", OPC_INT, 0, &f->l2},
      {"pvb", "nm^2", OPC_INT, 0, &f->pvb},
      {"shots", NULL, OPC_INT, 0, &f->shots},
  };
  int code = host->table(host, "iccad", OPC_TABLE_PRINT, 1, columns,
                         sizeof columns / sizeof *columns, error);
  if (!code) code = host->metric(host, "epe", (double)epe, error);
  if (!code) code = host->metric(host, "l2", (double)f->l2, error);
  if (!code) code = host->metric(host, "pvb", (double)f->pvb, error);
  if (!code) code = host->metric(host, "shots", (double)f->shots, error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const score *s = self;
  const opc_mask *mask = s->values[MASK].object;
  (void)outputs;
  iccad_tile tile;
  int code = place_tile(s, mask->gates, &tile, error);
  if (code) return code;
  uint8_t *raster[RASTERS];
  size_t n = (size_t)tile.side * (size_t)tile.side;
  for (int k = 0; k < RASTERS; k++) {
    raster[k] = s->host->alloc(s->host, n, 1);
    if (!raster[k])
      code = s->host->fail(s->host, error, OPC_FAILED, NULL, "out of memory");
  }
  figures f = {0};
  if (!code) code = count_all(s, mask, &tile, raster, &f, error);
  for (int k = 0; k < RASTERS; k++) s->host->free(s->host, raster[k]);
  return code ? code : publish(s, &f, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [MASK] = {.name = "mask", .type = OPC_INPUT, .flags = OPC_REQUIRED,
              .choices = "mask",
              .summary = "the mask, of what segment.edges has found"},
    [LITHO] = {.name = "litho", .type = OPC_SLOT, .flags = OPC_REQUIRED,
               .choices = "litho", .summary = "model of the optics"},
    [RESIST] = {.name = "resist", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                .choices = "resist", .summary = "model of the resist"},
    [TILE] = {.name = "tile", .type = OPC_REAL,
              .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
              .preset = "2048 nm", .min = 64, .max = 16384,
              .summary = "side of the square that the clip lies in"},
    [DOSE] = {.name = "dose", .type = OPC_REAL,
              .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "%",
              .preset = "2 %", .min = 0, .max = 50,
              .summary = "how far the dose goes up and down, as a factor on "
                         "the mask's transmission"},
    [DEFOCUS] = {.name = "defocus", .type = OPC_REAL, .unit = "nm",
                 .preset = "25 nm",
                 .summary = "of the innermost print; with litho.kernels, "
                            "whatever is not 0 is its second set"},
    [EPE] = {.name = "epe", .type = OPC_REAL,
             .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
             .preset = "15 nm", .min = 1, .max = 1000,
             .summary = "from here on a placement error counts"},
    [SPACING] = {.name = "spacing", .type = OPC_REAL,
                 .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                 .preset = "40 nm", .min = 1, .max = 1000,
                 .summary = "between sites, and from corners to the first"},
};

static const opc_metric metrics[] = {
    {.name = "epe", .better = OPC_LOWER,
     .summary = "sites whose edge is not within the limit"},
    {.name = "l2", .unit = "nm^2", .better = OPC_LOWER,
     .summary = "where nominal print and target differ"},
    {.name = "pvb", .unit = "nm^2", .better = OPC_LOWER,
     .summary = "between the outermost and the innermost print"},
    {.name = "shots", .better = OPC_LOWER, .summary = "rectangles of the mask"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  score *s = host->alloc(host, 1, sizeof *s);
  if (!s) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  s->host = host;
  s->values = values;
  return s;
}

static void destroy(void *self) {
  score *s = self;
  s->host->free(s->host, s);
}

/* ---- entry ---- */

static const opc_step operations = {.size = sizeof operations, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "score.iccad",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "the figures of the ICCAD 2013 contest: EPE, L2, PV band, shots",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
