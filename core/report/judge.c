/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares metrics with requirements. */
#include <base/unit.h>
#include <math.h>
#include <string.h>

#include "core/binding/lookup.h"
#include "core/report/judge.h"

static void verdict_free(gpointer item) {
  opc_verdict *v = item;
  g_free(v->path);
  g_free(v->required);
  g_free(v->unit);
  g_free((char *)v->at.file);
  g_free(v);
}

GPtrArray *opc_verdicts_new(void) {
  return g_ptr_array_new_with_free_func(verdict_free);
}

/* Return the value of the metric; NAN if not published. */
static double find_value(const GArray *metrics, const opc_requirement *r) {
  for (guint i = 0; i < metrics->len; i++) {
    const opc_inner_metric *m = &g_array_index(metrics, opc_inner_metric, i);
    if (m->metric == r->metric && !strcmp(m->path, r->binding->path))
      return m->value;
  }
  return NAN;
}

/* Return whether the value meets the requirement; FALSE for NAN. */
static gboolean is_kept(const opc_requirement *r, double value) {
  return r->open ? value > r->least && value < r->most
                 : value >= r->least && value <= r->most;
}

static void requirement_judge(GPtrArray *verdicts, const GArray *metrics,
                              const opc_requirement *r) {
  double value = find_value(metrics, r);
  opc_verdict *v = g_new(opc_verdict, 1);
  *v = (opc_verdict){.path = g_strdup(r->path),
                     .required = g_strdup(r->text),
                     .unit = g_strdup(r->metric->unit),
                     .least = r->least,
                     .most = r->most,
                     .value = value,
                     .kept = is_kept(r, value),
                     .at = r->at};
  v->at.file = g_strdup(r->at.file);
  g_ptr_array_add(verdicts, v);
}

void opc_verdicts_judge(GPtrArray *verdicts, const opc_flow *flow,
                        const GArray *metrics, const gboolean *left_out) {
  for (guint i = 0; i < flow->requirements->len; i++) {
    const opc_requirement *r = flow->requirements->pdata[i];
    if (!left_out || !left_out[opc_flow_find(flow, r->path)->number])
      requirement_judge(verdicts, metrics, r);
  }
}

/* Limit of failed requirements in a list; sweep.csv reports every point. */
enum { MOST_VERDICTS = 1000 };

void opc_verdicts_take(GPtrArray *verdicts, const GPtrArray *from, size_t point,
                       const char *prefix) {
  for (guint i = 0; i < from->len; i++) {
    const opc_verdict *v = from->pdata[i];
    if (v->kept || verdicts->len >= MOST_VERDICTS) continue;
    opc_verdict *copy = g_memdup2(v, sizeof *v);
    copy->path = g_strconcat(prefix, v->path, NULL);
    copy->required = g_strdup(v->required);
    copy->unit = g_strdup(v->unit);
    copy->at.file = g_strdup(v->at.file);
    if (point) copy->point = point;
    g_ptr_array_add(verdicts, copy);
  }
}

/* Return the value with six digits (g_free), or with all digits if the rounded
   value would falsely meet the requirement. */
static char *value_text(const opc_verdict *v) {
  char digits[40];
  g_ascii_formatd(digits, sizeof digits, "%.6g", v->value);
  double rounded = g_ascii_strtod(digits, NULL);
  gboolean misleads = rounded >= v->least && rounded <= v->most;
  g_autofree char *exact = opc_number_text(v->value);
  return g_strdup_printf("%s%s%s", misleads ? exact : digits,
                         v->unit ? " " : "", v->unit ? v->unit : "");
}

void opc_verdicts_add_broken(const GPtrArray *verdicts,
                             opc_problems *problems) {
  for (guint i = 0; i < verdicts->len; i++) {
    const opc_verdict *v = verdicts->pdata[i];
    if (v->kept) continue;
    g_autofree char *point =
        v->point ? g_strdup_printf("point %zu: ", v->point) : g_strdup("");
    g_autofree char *value = value_text(v);
    if (isnan(v->value))
      opc_problem_add(problems, OPC_LIMIT, &v->at,
                      "%s'%s' has no value, expected %s", point, v->path,
                      v->required);
    else
      opc_problem_add(problems, OPC_LIMIT, &v->at, "%s'%s' is %s, expected %s",
                      point, v->path, value, v->required);
  }
}
