/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables, metrics and findings of a calibration. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>

#include "calibrate.h"

static int parameters_table(const calibrate *c, opc_error *error) {
  typedef struct row {
    const char *name, *unit, *state;
    double value, low, high, sd, from, to;
  } row;
  row rows[TERMS];
  size_t n = 0;
  const fitted *b = &c->best;
  for (size_t t = 0; t < TERMS; t++)
    if (!isnan(b->value[t]))
      rows[n++] = (row){.name = term_name[t],
                        .unit = term_unit[t] ? term_unit[t] : "",
                        .state = !c->fit.is_free[t] ? "fixed"
                                 : b->at_bound[t]   ? "at bound"
                                 : b->open[t]       ? "undetermined"
                                                    : "fitted",
                        .value = b->value[t],
                        .low = b->low[t],
                        .high = b->high[t],
                        .sd = b->sd[t],
                        .from = c->fit.from[t],
                        .to = c->fit.to[t]};
  const opc_column columns[] = {
      {"parameter", NULL, OPC_TEXT, 0, &rows->name},
      {"unit", NULL, OPC_TEXT, 0, &rows->unit},
      {"value", NULL, OPC_REAL, 5, &rows->value},
      {"low_95", NULL, OPC_REAL, 5, &rows->low},
      {"high_95", NULL, OPC_REAL, 5, &rows->high},
      {"sd", NULL, OPC_REAL, 5, &rows->sd},
      {"from", NULL, OPC_REAL, 3, &rows->from},
      {"to", NULL, OPC_REAL, 3, &rows->to},
      {"state", NULL, OPC_TEXT, 0, &rows->state},
  };
  return opc_put_rows(c->host, "calibration", OPC_TABLE_PRINT, n, sizeof *rows,
                      OPC_ARRAY(columns), error);
}

static int correlations_table(const calibrate *c, opc_error *error) {
  typedef struct row {
    const char *first, *second;
    double value;
  } row;
  row rows[TERMS * TERMS];
  size_t n = 0;
  for (size_t a = 0; a < TERMS; a++)
    for (size_t b = a + 1; b < TERMS; b++)
      if (c->best.sd[a] > 0 && c->best.sd[b] > 0)
        rows[n++] =
            (row){term_name[a], term_name[b], c->best.correlation[a][b]};
  const opc_column columns[] = {
      {"first", NULL, OPC_TEXT, 0, &rows->first},
      {"second", NULL, OPC_TEXT, 0, &rows->second},
      {"correlation", NULL, OPC_REAL, 3, &rows->value},
  };
  return opc_put_rows(c->host, "correlations", n ? OPC_TABLE_PRINT : 0, n,
                      sizeof *rows, OPC_ARRAY(columns), error);
}

static int gauges_table(const calibrate *c, opc_error *error) {
  static const char *const axis[] = {"x", "y"}, *const feature[] = {"line",
                                                                    "space"};
  typedef struct row {
    const char *layer, *axis, *feature;
    int64_t mask;
    double x, y, measured, residual, left, weight, density;
  } row;
  row *rows = eda_alloc(c->count, sizeof *rows);
  for (size_t i = 0; i < c->count; i++) {
    const gauge *g = &c->gauges[i];
    rows[i] = (row){.layer = c->mask[g->mask]->gates->layer[g->layer],
                    .mask = g->mask + 1,
                    .density = g->density,
                    .axis = axis[g->axis],
                    .feature = feature[g->space],
                    .x = g->x,
                    .y = g->y,
                    .measured = g->width,
                    .residual = c->residual[i],
                    .left = c->left[i],
                    .weight = c->weight[i]};
  }
  const opc_column columns[] = {
      {"mask", NULL, OPC_INT, 0, &rows->mask},
      {"layer", NULL, OPC_TEXT, 0, &rows->layer},
      {"x", "nm", OPC_REAL, 1, &rows->x},
      {"y", "nm", OPC_REAL, 1, &rows->y},
      {"axis", NULL, OPC_TEXT, 0, &rows->axis},
      {"feature", NULL, OPC_TEXT, 0, &rows->feature},
      {"measured", "nm", OPC_REAL, 2, &rows->measured},
      {"residual", "nm", OPC_REAL, 3, &rows->residual},
      {"left_out", "nm", OPC_REAL, 3, &rows->left},
      {"weight", NULL, OPC_REAL, 3, &rows->weight},
      {"density", NULL, OPC_REAL, 3, &rows->density},
  };
  int code = opc_put_rows(c->host, "gauges", 0, c->count, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static double rms_of(const double *values, size_t n) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < n; i++)
    if (!isnan(values[i])) {
      sum += values[i] * values[i];
      count++;
    }
  return count > 0 ? sqrt(sum / count) : NAN;
}

/* Publish the errors of each layer of each mask. */
static int masks_table(const calibrate *c, opc_error *error) {
  typedef struct row {
    int64_t mask, gauges;
    const char *layer;
    double mean, rms, left;
  } row;
  size_t n = 0, count = 0;
  for (size_t m = 0; m < c->n_masks; m++) count += c->mask[m]->layers;
  row *rows = eda_alloc(count, sizeof *rows);
  double *left = eda_alloc(2 * c->count, sizeof *left), *off = left + c->count;
  for (size_t m = 0; m < c->n_masks; m++)
    for (size_t layer = 0; layer < c->mask[m]->layers; layer++) {
      double sum = 0;
      size_t k = 0;
      for (size_t i = 0; i < c->count; i++) {
        if ((size_t)c->gauges[i].mask != m ||
            (size_t)c->gauges[i].layer != layer)
          continue;
        sum += c->residual[i];
        left[k] = c->left[i];
        off[k++] = c->residual[i];
      }
      if (k)
        rows[n++] = (row){.mask = (int64_t)m + 1,
                          .layer = c->mask[m]->gates->layer[layer],
                          .gauges = (int64_t)k,
                          .mean = sum / (double)k,
                          .rms = rms_of(off, k),
                          .left = rms_of(left, k)};
    }
  const opc_column columns[] = {
      {"mask", NULL, OPC_INT, 0, &rows->mask},
      {"layer", NULL, OPC_TEXT, 0, &rows->layer},
      {"gauges", NULL, OPC_INT, 0, &rows->gauges},
      {"mean", "nm", OPC_REAL, 3, &rows->mean},
      {"rms", "nm", OPC_REAL, 3, &rows->rms},
      {"rms_left_out", "nm", OPC_REAL, 3, &rows->left},
  };
  int code = opc_put_rows(c->host, "masks", OPC_TABLE_PRINT, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(left);
  free(rows);
  return code;
}

/* Log parameters at a bound, and the combination of parameters that the gauges
   determine least if any parameter is undetermined. */
static void report_findings(const calibrate *c, size_t *undetermined) {
  const fitted *b = &c->best;
  char weak[300] = "";
  size_t n = 0, open = 0;
  *undetermined = 0;
  for (size_t t = 0; t < TERMS; t++) {
    if (b->at_bound[t])
      c->host->log(c->host, OPC_LOG_FINDING,
                   "%s ends at a bound of its range, %g %s; its interval is "
                   "unknown",
                   term_name[t], b->value[t], term_unit[t] ? term_unit[t] : "");
    open += b->open[t];
    *undetermined += b->open[t] || b->at_bound[t];
    if (fabs(b->weak[t]) > 0.1)
      n += (size_t)snprintf(weak + n, sizeof weak - n, "%s%s %+.2f",
                            n ? ", " : "", term_name[t], b->weak[t]);
  }
  if (open)
    c->host->log(c->host, OPC_LOG_FINDING,
                 "the gauges do not determine %zu parameters; the least "
                 "determined direction, in parts of the ranges, is %s",
                 open, weak);
}

int calibrate_report(calibrate *c, opc_error *error) {
  size_t undetermined, equal = 0;
  double worst = 0, down = 0, left = rms_of(c->left, c->count);
  for (size_t i = 0; i < c->count; i++) {
    worst = fmax(worst, fabs(c->residual[i]));
    down += c->weight[i] < 0.5;
  }
  for (size_t k = 0; k < (size_t)c->starts; k++)
    equal += c->start_cost[k] <= 1.01 * c->best.cost;
  report_findings(c, &undetermined);
  opc_metric_value values[] = {
      {"gauges", (double)c->count},
      {"rms", rms_of(c->residual, c->count)},
      {"worst", worst},
      {isnan(left) ? NULL : "rms_left_out", left},
      {isnan(c->interpolation) ? NULL : "interpolation", c->interpolation},
      {"downweighted", down},
      {"undetermined", (double)undetermined},
      {"starts_equal", (double)equal}};
  int code = opc_put_metrics(c->host, OPC_ARRAY(values), error);
  for (size_t t = 0; t < TERMS && !code; t++)
    if (!isnan(c->best.value[t]))
      code = c->host->metric(c->host, term_name[t], c->best.value[t], error);
  if (!code) code = parameters_table(c, error);
  if (!code) code = masks_table(c, error);
  if (!code) code = correlations_table(c, error);
  return code ? code : gauges_table(c, error);
}
