/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verb `opcflow compare A B [...]`: differences of runs with
   verdicts and confidence intervals. */
#include <math.h>
#include <opcflow/command.h>
#include <opcflow/table.h>
#include <string.h>

#include "same.h"
#include "tables.h"

/* ---- work: comparability ---- */

/* Largest number of reasons in a message; the message states the number of
   further reasons. */
enum { LISTED = 5 };

static int compare_refuse(const GPtrArray *why, opc_error *error) {
  g_autoptr(GString) text = g_string_new("not comparable: ");
  for (guint i = 0; i < MIN(why->len, LISTED); i++)
    g_string_append_printf(text, "%s%.150s", i ? "; " : "",
                           (char *)why->pdata[i]);
  if (why->len > LISTED)
    g_string_append_printf(text, "; and %u more", why->len - LISTED);
  return opc_fail(error, OPC_INVALID, NULL,
                  "%s (use --anyway to compare in spite of this)", text->str);
}

static int check_pairs(const comparison *c, opc_error *error) {
  const field *f = &c->field;
  g_autoptr(GPtrArray) all = g_ptr_array_new_with_free_func(g_free);
  g_autoptr(GHashTable) listed = g_hash_table_new(g_str_hash, g_str_equal);
  for (guint i = 0; i < f->pairs->len; i++) {
    const pair *p = &g_array_index(f->pairs, pair, i);
    g_autoptr(GPtrArray) why = g_ptr_array_new_with_free_func(g_free);
    if (same_check(p, why, error)) return error->code;
    for (guint k = 0; k < why->len; k++) {
      char *text = g_strdup_printf("%s%s%s: %s", p->name, *p->name ? ", " : "",
                                   p->method, (char *)why->pdata[k]);
      g_ptr_array_add(all, text);
      if (c->anyway && g_hash_table_add(listed, text))
        c->host->log(c->host, OPC_LOG_WARNING, "%s", text);
    }
  }
  return all->len && !c->anyway ? compare_refuse(all, error) : OPC_OK;
}

/* ---- work: limits that fail a comparison ---- */

static int check_word(const char *word, opc_error *error) {
  if (!strcmp(word, "worse") || g_str_has_prefix(word, "worse:")) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "fail_on",
                  "'%s' must be 'worse' or 'worse:METRIC'", word);
}

/* Return the fault of a row, for a message: "" if the metric is worse, " is
   missing" if the other run lacks the metric, NULL if there is no fault. */
static const char *fault_of(const metric_row *r) {
  if (r->verdict == WORSE) return "";
  return !isnan(r->base) && isnan(r->value) ? " is missing" : NULL;
}

/* Add the worse metrics that a word selects. Return whether the word selects
   any metric. */
static int add_worse(const comparison *c, const char *word, GHashTable *seen,
                     GPtrArray *worse) {
  const char *metric = strchr(word, ':');
  int meant = !metric;
  for (guint i = 0; i < c->rows->len; i++) {
    const metric_row *r = &g_array_index(c->rows, metric_row, i);
    if (metric && !is_chosen(metric + 1, r->metric)) continue;
    const char *fault = fault_of(r);
    meant = 1;
    if (fault && g_hash_table_add(seen, (gpointer)r))
      g_ptr_array_add(
          worse, g_strdup_printf("%s%s%s: %s%s", r->name, *r->name ? ", " : "",
                                 r->method, r->metric, fault));
  }
  for (guint i = 0; i < c->intervals->len; i++) {
    const transistor_row *r = &g_array_index(c->intervals, transistor_row, i);
    g_autofree char *name = g_strconcat("transistors.", r->c.name, NULL);
    if (metric && strcmp(metric + 1, name) != 0) continue;
    meant = 1;
    if (r->c.verdict == EDA_VERDICT_WORSE &&
        g_hash_table_add(seen, (gpointer)r))
      g_ptr_array_add(worse, g_strdup_printf("%s: %s", r->method, name));
  }
  return meant;
}

static int compare_judge(const comparison *c, opc_error *error) {
  if (!c->fail_on) return OPC_OK;
  g_auto(GStrv) words = g_strsplit(c->fail_on, ",", -1);
  g_autoptr(GHashTable) seen = g_hash_table_new(NULL, NULL);
  g_autoptr(GPtrArray) worse = g_ptr_array_new_with_free_func(g_free);
  for (char **word = words; *word; word++)
    if (!add_worse(c, g_strstrip(*word), seen, worse))
      return opc_fail(error, OPC_INVALID, "fail_on",
                      "'%s': metric does not exist", *word);
  if (!worse->len) return OPC_OK;
  guint shown = MIN(worse->len, LISTED);
  g_autoptr(GString) text = g_string_new(NULL);
  for (guint i = 0; i < shown; i++)
    g_string_append_printf(text, "%s%.150s", i ? "; " : "",
                           (char *)worse->pdata[i]);
  if (worse->len > shown)
    g_string_append_printf(text, "; and %u more", worse->len - shown);
  return opc_fail(error, OPC_LIMIT, NULL, "worse: %s", text->str);
}

/* ---- work ---- */

static int publish_counts(const comparison *c, opc_error *error) {
  double count[VERDICTS] = {0};
  for (guint i = 0; i < c->rows->len; i++)
    count[g_array_index(c->rows, metric_row, i).verdict]++;
  const opc_metric_value values[] = {{"better", count[BETTER]},
                                     {"worse", count[WORSE]},
                                     {"same", count[SAME]},
                                     {"differs", count[DIFFERS]},
                                     {"missing", count[MISSING]}};
  return opc_put_metrics(c->host, OPC_ARRAY(values), error);
}

static int compare_publish(comparison *c, opc_error *error) {
  int code = OPC_OK, experiment = c->field.experiment;
  if (!experiment) code = runs_publish(c, error);
  if (!code) code = parameters_publish(c, error);
  if (!code) code = metrics_collect(c, error);
  if (!code && experiment) code = cases_publish(c, error);
  if (!code && (!experiment || c->cases)) code = metrics_publish(c, error);
  if (!code) code = transistors_publish(c, error);
  if (!code) code = masks_publish(c, error);
  if (!code) code = verdicts_publish(c, error);
  return code ? code : publish_counts(c, error);
}

static int compare_run(void *self, size_t n, const char *const *arguments,
                       opc_error *error) {
  comparison *c = self;
  c->rows = g_array_new(FALSE, FALSE, sizeof(metric_row));
  c->intervals = ROWS(transistor_row);
  c->sentences = g_ptr_array_new_with_free_func(g_free);
  int code = field_open(&c->field, c->host, n, arguments, c->variant, error);
  if (!code) code = check_pairs(c, error);
  if (!code && *c->field.base)
    c->host->log(c->host, OPC_LOG_INFO, "base: %s", c->field.base);
  if (!code) code = compare_publish(c, error);
  if (!code) code = compare_judge(c, error);
  field_clear(&c->field);
  g_array_free(c->rows, TRUE);
  g_array_free(c->intervals, TRUE);
  g_ptr_array_free(c->sentences, TRUE);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(
        comparison, variant, .type = OPC_TEXT,
        .summary = "variants of a flow whose latest runs are compared ('base': "
                   "no variant); may be repeated, the first one is the base"),
    OPC_PARAMETER_NAMED(
        "metrics", comparison, chosen, .type = OPC_TEXT,
        .summary = "metrics to compare: names, last parts of names, or "
                   "patterns, separated by commas (default: all)"),
    OPC_PARAMETER(comparison, sort, .type = OPC_CHOICE, .preset = "file",
                  .choices = "file|name|change|verdict",
                  .summary = "order of the metrics"),
    OPC_PARAMETER(comparison, all, .type = OPC_BOOL, .preset = "false",
                  .summary = "also print equal values"),
    OPC_PARAMETER(
        comparison, cases, .type = OPC_BOOL, .preset = "false",
        .summary = "also print the metrics of each case of an experiment"),
    OPC_PARAMETER(
        comparison, anyway, .type = OPC_BOOL, .preset = "false",
        .summary =
            "also compare runs with different inputs, models or transistors"),
    OPC_PARAMETER(
        comparison, fail_on, .type = OPC_TEXT,
        .summary = "'worse' or 'worse:METRIC': exit code 1 if any metric, or "
                   "this metric, is worse; may be repeated"),
};

static const opc_metric metrics[] = {
    {"better", NULL, OPC_HIGHER, 0, "Number of metrics better than the base"},
    {"worse", NULL, OPC_LOWER, 0, "Number of metrics worse than the base"},
    {"same", NULL, OPC_NEUTRAL, 0, "Number of metrics equal within tolerance"},
    {"differs", NULL, OPC_NEUTRAL, 0,
     "Number of metrics without a direction that differ"},
    {"missing", NULL, OPC_NEUTRAL, 0,
     "Number of metrics that one of the runs lacks"},
};

static int compare_check(void *self, opc_error *error) {
  const comparison *c = self;
  if (!c->fail_on) return OPC_OK;
  if (!*c->fail_on) return check_word("", error);
  g_auto(GStrv) words = g_strsplit(c->fail_on, ",", -1);
  for (char **word = words; *word; word++)
    if (check_word(g_strstrip(*word), error)) return error->code;
  return OPC_OK;
}

/* ---- entry ---- */

static const opc_command functions = {
    .arguments = "RUN RUN ... | FLOW | EXPERIMENT [EXPERIMENT]",
    .run = compare_run};

OPC_PLUGIN(comparison, .id = "command.compare", .kind = "command",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "Compare runs, variants of a flow, or experiments",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = compare_check, OPC_FUNCTIONS(functions));
