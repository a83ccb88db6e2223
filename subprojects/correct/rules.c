/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the count of mask rule violations and the search for the worst
   violation of each rule. */
#include <correct/rules.h>

#include <eda/memory.h>
#include <glib.h>
#include <inttypes.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

static void count_layer(const eda_gates *g, size_t layer,
                        const eda_shapes *mask, const double limit[EDA_RULES],
                        rules_row out[EDA_RULES]) {
  eda_rule_fault *fault;
  for (int i = 0; i < EDA_RULES; i++)
    out[i] = (rules_row){.layer = g->layer[layer],
                         .rule = eda_rule_name(i),
                         .limit = limit[i],
                         .least = NAN,
                         .x = NAN,
                         .y = NAN};
  size_t n = eda_rules_check(&g->drawn[layer], g->grid, limit, &fault);
  for (size_t i = 0; i < n; i++) out[fault[i].rule].drawn++;
  free(fault);
  n = eda_rules_check(mask, g->grid, limit, &fault);
  for (size_t i = 0; i < n; i++) {
    rules_row *r = &out[fault[i].rule];
    if (r->count++ && fault[i].value >= r->least) continue;
    r->least = fault[i].value;
    r->x = fault[i].x;
    r->y = fault[i].y;
  }
  free(fault);
}

/* Log the rules that the mask violates and the places of the worst violations.
   The message is a finding if the mask violates any rule more often than the
   drawn layout. */
static void table_findings(const opc_host *host, const rules_row *rows,
                           size_t n, double added) {
  g_autoptr(GString) text = g_string_new(NULL);
  for (size_t i = 0; i < n; i++) {
    const rules_row *r = &rows[i];
    if (!r->count) continue;
    g_string_append_printf(text,
                           "%s %s of '%s' below %g nm in %" PRId64
                           " places (%" PRId64
                           " as drawn), smallest %.3g nm at (%g, %g) nm",
                           text->len ? ";" : "", r->rule, r->layer, r->limit,
                           r->count, r->drawn, r->least, r->x, r->y);
  }
  if (text->len)
    host->log(host, added > 0 ? OPC_LOG_FINDING : OPC_LOG_INFO,
              "the mask violates mask rules:%s", text->str);
}

int correct_rules_table(const opc_host *host, const rules_row *rows, size_t n,
                        opc_error *error) {
  double all = 0, added = 0, sum[EDA_RULES] = {0};
  for (size_t i = 0; i < n; i++) {
    sum[i % EDA_RULES] += (double)rows[i].count;
    all += (double)rows[i].count;
    added += (double)MAX(rows[i].count - rows[i].drawn, 0);
  }
  const opc_column columns[] = {
      {"layer", NULL, OPC_TEXT, 0, &rows->layer},
      {"rule", NULL, OPC_TEXT, 0, &rows->rule},
      {"limit", "nm", OPC_REAL, 1, &rows->limit},
      {"drawn", NULL, OPC_INT, 0, &rows->drawn},
      {"mask", NULL, OPC_INT, 0, &rows->count},
      {"least", "nm", OPC_REAL, 2, &rows->least},
      {"x", "nm", OPC_REAL, 1, &rows->x},
      {"y", "nm", OPC_REAL, 1, &rows->y},
  };
  int code = opc_put_rows(host, "mask_rules", 0, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  if (code) return code;
  table_findings(host, rows, n, added);
  const opc_metric_value values[] = {{"mask_violations", all},
                                     {"mask_violations_added", added},
                                     {"mask_space", sum[EDA_RULE_SPACE]},
                                     {"mask_width", sum[EDA_RULE_WIDTH]},
                                     {"mask_edge", sum[EDA_RULE_EDGE]},
                                     {"mask_jog", sum[EDA_RULE_JOG]}};
  return opc_put_metrics(host, OPC_ARRAY(values), error);
}

/* State of the counting of rows, computed in parallel for all corrected
   layers. */
typedef struct counting {
  const eda_gates *gates;
  const eda_shapes *mask;
  const double *limit;
  rules_row *rows;
  size_t *layer;
} counting;

static void count_one(void *data, size_t i) {
  const counting *c = data;
  size_t k = c->layer[i];
  count_layer(c->gates, k, &c->mask[k], c->limit, c->rows + i * EDA_RULES);
}

int correct_rules_report(const opc_host *host, const eda_gates *gates,
                         const eda_shapes *mask, const double limit[EDA_RULES],
                         opc_error *error) {
  counting c = {gates, mask, limit,
                eda_alloc(gates->layers * EDA_RULES, sizeof *c.rows),
                eda_alloc(gates->layers, sizeof *c.layer)};
  size_t n = 0;
  for (size_t k = 0; k < gates->layers; k++)
    if (gates->corrected[k]) c.layer[n++] = k;
  opc_parallel(host->context, n, count_one, &c);
  int code = correct_rules_table(host, c.rows, n * EDA_RULES, error);
  free(c.rows);
  free(c.layer);
  return code;
}
