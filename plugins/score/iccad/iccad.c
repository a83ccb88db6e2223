/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements score.iccad: the figures of the ICCAD 2013 contest on mask
   optimization (S. Banerjee, Z. Li, S. R. Nassif, ICCAD 2013, 271). Figures are
   counted on pixels of 1 nm, as in the programs that report these figures. */
#include "iccad.h"

#include <eda/memory.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct score {
  const opc_host *host;
  const eda_mask *mask;
  const opc_module *litho, *resist;
  double tile, dose, defocus, epe, spacing;
} score;

enum { TARGET, NOMINAL, OUTER, INNER, RASTERS };

typedef struct figures {
  int64_t inner; /* sites whose printed edge is too far inside */
  int64_t outer; /* sites whose printed edge is too far outside */
  int64_t sites, l2, pvb, shots;
  iccad_features features; /* sums over the three images */
} figures;

/* ---- work ---- */

/* Set the tile. Its centre is the centre of the layout, except that its lower
   left corner is rounded down to 1 nm. Return OPC_OK or an error. */
static int place_tile(const score *s, const eda_gates *g, iccad_tile *tile,
                      opc_error *error) {
  double side = s->tile;
  double w = ((double)g->extent.x1 - g->extent.x0) * g->grid;
  double h = ((double)g->extent.y1 - g->extent.y0) * g->grid;
  if (side != floor(side))
    return opc_fail(error, OPC_INVALID, "tile",
                    "%g nm is not an integer number of pixels of 1 nm", side);
  if (w > side || h > side)
    return opc_fail(error, OPC_INVALID, "tile",
                    "the layout is %g x %g nm, too large for %g nm", w, h,
                    side);
  tile->side = (int32_t)side;
  tile->x0 = (int32_t)floor(g->extent.x0 * g->grid - (side - w) / 2);
  tile->y0 = (int32_t)floor(g->extent.y0 * g->grid - (side - h) / 2);
  return OPC_OK;
}

/* Compute the pixels that print at nominal dose in focus, and at the outermost
   and innermost process corner. */
static int score_expose(const score *s, const eda_mask *mask,
                        const iccad_tile *tile, uint8_t *const raster[RASTERS],
                        opc_error *error) {
  const opc_context *context = s->host->context;
  iccad_print p = {context, s->litho, s->resist, tile};
  const eda_litho *litho = p.litho->functions;
  const eda_resist *resist = p.resist->functions;
  double more = 1 + s->dose / 100, less = 1 - s->dose / 100;
  /* The nodes of fields are at the centres of pixels. */
  eda_frame frame = {tile->x0 + 0.5, tile->y0 + 0.5, tile->side, tile->side};
  eda_spectrum spectrum;
  int code = litho->prepare(p.litho->self, error);
  if (!code) code = resist->prepare(p.resist->self, p.litho, error);
  if (code) return code;
  code = eda_mask_spectrum(context, &mask->shapes[EDA_POLY], mask->gates->grid,
                           frame, litho->band(p.litho->self), &spectrum, error);
  if (code) return code;
  code = iccad_expose(&p, &spectrum, 1, 0, raster[NOMINAL], error);
  if (!code)
    code = iccad_expose(&p, &spectrum, more * more, 0, raster[OUTER], error);
  if (!code)
    code = iccad_expose(&p, &spectrum, less * less, s->defocus, raster[INNER],
                        error);
  eda_spectrum_clear(&spectrum);
  return code;
}

static void count_sites(const score *s, const iccad_tile *t,
                        const uint8_t *nominal, const iccad_site *sites,
                        size_t n, figures *f) {
  int32_t off = (int32_t)s->epe;
  for (size_t i = 0; i < n; i++) {
    iccad_site p = sites[i];
    f->inner += !iccad_at(t, nominal, p.x - off * p.dx, p.y - off * p.dy);
    f->outer += iccad_at(t, nominal, p.x + off * p.dx, p.y + off * p.dy);
  }
  f->sites = (int64_t)n;
}

static void count_features(const iccad_tile *tile,
                           uint8_t *const raster[RASTERS], figures *f) {
  for (int k = NOMINAL; k < RASTERS; k++) {
    iccad_features one = iccad_compare(tile, raster[TARGET], raster[k]);
    f->features.lost += one.lost;
    f->features.broken += one.broken;
    f->features.bridged += one.bridged;
    f->features.extra += one.extra;
  }
}

static int count_all(const score *s, const iccad_tile *tile,
                     uint8_t *const raster[RASTERS], figures *f,
                     opc_error *error) {
  const eda_mask *mask = s->mask;
  const eda_gates *g = mask->gates;
  iccad_site *sites;
  eda_box *boxes;
  size_t n;
  int code =
      iccad_fill(&g->drawn[EDA_POLY], g->grid, tile, raster[TARGET], error);
  if (!code) code = score_expose(s, mask, tile, raster, error);
  if (code) return code;
  n = iccad_sites(&g->drawn[EDA_POLY], g->grid, (int32_t)s->spacing, &sites);
  count_sites(s, tile, raster[NOMINAL], sites, n, f);
  free(sites);
  size_t pixels = (size_t)tile->side * (size_t)tile->side;
  for (size_t i = 0; i < pixels; i++) {
    f->l2 += raster[TARGET][i] != raster[NOMINAL][i];
    f->pvb += raster[OUTER][i] != raster[INNER][i];
  }
  count_features(tile, raster, f);
  code = eda_fracture(&mask->shapes[EDA_POLY], &boxes, &n, error);
  if (code) return code;
  f->shots = (int64_t)n;
  free(boxes);
  return OPC_OK;
}

static int score_publish(const score *s, const figures *f, opc_error *error) {
  int64_t epe = f->inner + f->outer;
  const opc_column columns[] = {
      {"epe", NULL, OPC_INT, 0, &epe},
      {"epe_inner", NULL, OPC_INT, 0, &f->inner},
      {"epe_outer", NULL, OPC_INT, 0, &f->outer},
      {"sites", NULL, OPC_INT, 0, &f->sites},
      {"l2", "nm^2", OPC_INT, 0, &f->l2},
      {"pvb", "nm^2", OPC_INT, 0, &f->pvb},
      {"shots", NULL, OPC_INT, 0, &f->shots},
      {"bridged", NULL, OPC_INT, 0, &f->features.bridged},
      {"broken", NULL, OPC_INT, 0, &f->features.broken},
      {"lost", NULL, OPC_INT, 0, &f->features.lost},
      {"extra", NULL, OPC_INT, 0, &f->features.extra},
  };
  const opc_metric_value values[] = {{"epe", (double)epe},
                                     {"l2", (double)f->l2},
                                     {"pvb", (double)f->pvb},
                                     {"shots", (double)f->shots},
                                     {"bridged", (double)f->features.bridged},
                                     {"broken", (double)f->features.broken},
                                     {"lost", (double)f->features.lost},
                                     {"extra", (double)f->features.extra}};
  int code = opc_put_table(s->host, "iccad", OPC_TABLE_PRINT, 1,
                           OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(s->host, OPC_ARRAY(values), error);
}

static int score_run(void *self, void **outputs, opc_error *error) {
  score *s = self;
  (void)outputs;
  iccad_tile tile;
  if (eda_mask_flat(s->mask, &s->mask, error)) return error->code;
  int code = place_tile(s, s->mask->gates, &tile, error);
  if (code) return code;
  uint8_t *raster[RASTERS];
  size_t n = (size_t)tile.side * (size_t)tile.side;
  for (int k = 0; k < RASTERS; k++) raster[k] = eda_alloc(n, 1);
  figures f = {0};
  code = count_all(s, &tile, raster, &f, error);
  for (int k = 0; k < RASTERS; k++) free(raster[k]);
  return code ? code : score_publish(s, &f, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(score, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask",
                  .summary = "mask of a layer of segment.edges"),
    OPC_PARAMETER(score, litho, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "litho", .summary = "imaging model"),
    OPC_PARAMETER(score, resist, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "resist", .summary = "resist model"),
    OPC_PARAMETER(score, tile, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                  .preset = "2048 nm", .min = 64, .max = 16384,
                  .summary = "side of the square around the clip"),
    OPC_PARAMETER(score, dose, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "%",
                  .preset = "2 %", .min = 0, .max = 50,
                  .summary = "dose variation up and down; the mask's "
                             "transmission is multiplied by 1 + or - dose"),
    OPC_PARAMETER(
        score, defocus, .type = OPC_REAL, .unit = "nm", .preset = "25 nm",
        .summary = "defocus of the innermost contour; with litho.kernels, all "
                   "values but 0 select the second set"),
    OPC_PARAMETER(score, epe, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                  .preset = "15 nm", .min = 1, .max = 1000,
                  .summary = "smallest placement error that counts"),
    OPC_PARAMETER(
        score, spacing, .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_AT_MOST,
        .unit = "nm", .preset = "40 nm", .min = 1, .max = 1000,
        .summary =
            "distance between sites, and from corners to the first site"),
};

static const opc_metric metrics[] = {
    {"epe", NULL, OPC_LOWER, 0,
     "number of sites whose edge error is `epe` or more"},
    {"l2", "nm^2", OPC_LOWER, 0,
     "area of difference between nominal contour and target"},
    {"pvb", "nm^2", OPC_LOWER, 0,
     "area between the outermost and the innermost contour"},
    {"shots", NULL, OPC_LOWER, 0, "number of rectangles of the mask"},
    {"bridged", NULL, OPC_LOWER, 0,
     "number of bridges between features, in all three images"},
    {"broken", NULL, OPC_LOWER, 0,
     "number of printed pieces beyond one per feature, in all three images"},
    {"lost", NULL, OPC_LOWER, 0,
     "number of features that do not print, in all three images"},
    {"extra", NULL, OPC_LOWER, 0,
     "number of printed pieces outside of all features, in all three images"},
};

/* ---- entry ---- */

static const opc_step functions = {.run = score_run};

OPC_PLUGIN(
    score, .id = "score.iccad", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary =
        "compute the scores of the ICCAD 2013 contest: EPE, L2, PV band, shots",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), OPC_FUNCTIONS(functions));
