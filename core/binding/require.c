/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads required ranges of metrics, as bounds in the unit of each metric. */
#include <math.h>
#include <string.h>

#include "core/binding/lookup.h"
#include "core/binding/require.h"
#include "core/plugin/value.h"

/* State of reading one flow's requirements. */
typedef struct reader {
  const opc_flow *flow;
  opc_problems *problems;
} reader;

static void requirement_free(gpointer item) {
  opc_requirement *r = item;
  g_free(r->path);
  g_free(r->text);
  g_free(r);
}

/* Read a number with its unit into the unit of the metric. */
static gboolean read_bound(const reader *in, const opc_requirement *r,
                           const opc_node *node, const char *text,
                           double *bound) {
  const opc_parameter like = {
      .name = r->path, .type = OPC_REAL, .unit = r->metric->unit};
  g_autoptr(opc_node) number = opc_node_text_new(node->source, text);
  g_autoptr(GPtrArray) owned = g_ptr_array_new_with_free_func(g_free);
  opc_setting value;
  number->at = node->at;
  gboolean good =
      opc_setting_convert(&like, number, FALSE, owned, in->problems, &value);
  *bound = value.field.real;
  return good;
}

static char *bound_text(const opc_requirement *r, const char *before,
                        double bound) {
  const opc_parameter like = {.type = OPC_REAL, .unit = r->metric->unit};
  g_autofree char *text = opc_quantity_text(&like, bound);
  return g_strconcat(before, text, NULL);
}

/* Read a range [from, to]. */
static gboolean read_range(const reader *in, opc_requirement *r,
                           const opc_node *list) {
  gpointer *items = list->items->pdata;
  gboolean good = list->items->len == 2;
  for (guint i = 0; good && i < 2; i++)
    good = ((const opc_node *)items[i])->type == OPC_NODE_TEXT;
  if (!good)
    return opc_wrong(in->problems, list,
                     "a range of '%s' must be two numbers, as in '[FROM, TO]'",
                     r->path);
  const opc_node *from = items[0], *to = items[1];
  good = read_bound(in, r, from, from->text, &r->least) &&
         read_bound(in, r, to, to->text, &r->most);
  if (!good) return FALSE;
  if (r->least > r->most)
    return opc_wrong(in->problems, list,
                     "the range of '%s' must start at the smaller number",
                     r->path);
  g_autofree char *left = bound_text(r, "from ", r->least);
  g_autofree char *right = bound_text(r, " to ", r->most);
  r->text = g_strconcat(left, right, NULL);
  return TRUE;
}

/* Signs before a number. Longer signs precede: "<" is a prefix of "<=". */
static const struct {
  const char *sign, *text;
  gboolean upper, lower, open;
} relations[] = {{"<=", "at most ", TRUE, FALSE, FALSE},
                 {">=", "at least ", FALSE, TRUE, FALSE},
                 {"<", "less than ", TRUE, FALSE, TRUE},
                 {">", "more than ", FALSE, TRUE, TRUE},
                 {"=", "", TRUE, TRUE, FALSE}};

/* Index in `relations` of the relation for a number without a sign, by
   opc_metric.better: "=" for a metric without direction, "<=" if lower is
   better, ">=" if higher is better. */
static const guint by_direction[] = {
    [OPC_NEUTRAL] = 4, [OPC_LOWER] = 0, [OPC_HIGHER] = 1};

static gboolean read_text(const reader *in, opc_requirement *r,
                          const opc_node *node) {
  const char *text = node->text;
  guint i = 0;
  double bound;
  while (i < G_N_ELEMENTS(relations) &&
         !g_str_has_prefix(text, relations[i].sign))
    i++;
  if (i == G_N_ELEMENTS(relations))
    i = by_direction[r->metric->better];
  else
    text += strlen(relations[i].sign);
  text += strspn(text, " ");
  if (!read_bound(in, r, node, text, &bound)) return FALSE;
  /* Equality means a difference within the tolerance of the metric. */
  double slack =
      relations[i].upper && relations[i].lower ? r->metric->tolerance : 0;
  if (relations[i].upper) r->most = bound + slack;
  if (relations[i].lower) r->least = bound - slack;
  r->open = relations[i].open;
  r->text = bound_text(r, relations[i].text, bound);
  return TRUE;
}

static void read_one(const reader *in, const char *path, const opc_node *key,
                     const opc_node *value) {
  opc_error error;
  opc_requirement *r = g_new0(opc_requirement, 1);
  r->path = g_strdup(path);
  r->value = value;
  r->at = key->at;
  r->least = -INFINITY;
  r->most = INFINITY;
  r->metric = opc_flow_metric(in->flow, path, &r->binding, &error);
  gboolean good = FALSE;
  if (!r->metric)
    opc_wrong(in->problems, key, "%s", error.message);
  else if (value->type == OPC_NODE_LIST)
    good = read_range(in, r, value);
  else
    good = read_text(in, r, value);
  if (good)
    g_ptr_array_add(in->flow->requirements, r);
  else
    requirement_free(r);
}

/* Read a map of requirements recursively; `prefix` is NULL at the root. */
static void read_map(const reader *in, const char *prefix,
                     const opc_node *map) {
  for (guint i = 0; i < map->items->len; i++) {
    const opc_node *key = map->keys->pdata[i], *value = map->items->pdata[i];
    g_autofree char *path = prefix ? g_strconcat(prefix, ".", key->text, NULL)
                                   : g_strdup(key->text);
    if (value->type == OPC_NODE_MAP)
      read_map(in, path, value);
    else
      read_one(in, path, key, value);
  }
}

void opc_flow_require(opc_flow *flow, opc_problems *problems) {
  const reader in = {flow, problems};
  const opc_node *given = opc_node_get(flow->demands, "require");
  flow->requirements = g_ptr_array_new_with_free_func(requirement_free);
  if (!given) return;
  if (given->type != OPC_NODE_MAP) {
    opc_wrong(problems, given,
              "'require' must be a map, as in '{ STEP.METRIC: BOUND }'");
    return;
  }
  read_map(&in, NULL, given);
}
