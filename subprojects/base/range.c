/* SPDX-License-Identifier: BSD-3-Clause */
/* Expansion of a range to its values. */
#include <base/range.h>
#include <base/suggest.h>
#include <base/unit.h>
#include <math.h>
#include <string.h>

static const double most_values = OPC_RANGE_MOST;

static gboolean unknown_unit(const opc_node *node, const char *text,
                             const char *name, opc_problems *problems) {
  g_autoptr(GPtrArray) names = opc_unit_names();
  g_autofree char *suggestion = opc_suggestion(name, names);
  return opc_wrong(problems, node, "unknown unit '%s' in '%s'%s", name, text,
                   suggestion);
}

gboolean opc_quantity_read(const opc_node *node, const char *given,
                           const char *to, const char *name, double *number,
                           opc_problems *problems) {
  g_autofree char *text =
      g_strjoin(given ? " " : NULL, node->text, given, NULL);
  size_t length = opc_number_length(text);
  const char *unit = text + length + strspn(text + length, " ");
  const opc_unit *from = opc_unit_find(unit),
                 *in = to ? opc_unit_find(to) : NULL;
  const char *noun = in ? opc_unit_noun(in) : "a number";
  if (!length)
    return opc_wrong(problems, node, "'%s' requires %s%s, found '%s'", name,
                     noun, in ? " with a unit" : "", text);
  if (!in && *unit)
    return opc_wrong(problems, node,
                     "'%s' must be a number without a unit, found '%s'", name,
                     text);
  if (in && !*unit && opc_unit_shares_zero(in) &&
      opc_number_in(text, length, in, in) == 0)
    from = in;
  else if (in && !*unit)
    return opc_wrong(problems, node,
                     "'%s' requires %s with a unit, e.g. '%.*s %s'", name, noun,
                     (int)length, text, to);
  if (in && !from) return unknown_unit(node, text, unit, problems);
  if (in && opc_unit_noun(from) != noun)
    return opc_wrong(problems, node, "'%s' requires %s, found '%s'", name, noun,
                     text);
  *number = opc_number_in(text, length, from, in);
  return isfinite(*number) ||
         opc_wrong(problems, node, "'%s' is too large: '%s'", name, text);
}

/* A number and its unit. */
typedef struct quantity {
  double number; /* in the unit of `from` */
  const char *unit;
} quantity;

static gboolean check_range_keys(const opc_node *range,
                                 opc_problems *problems) {
  gboolean good = TRUE;
  if (!opc_node_get(range, "from") || !opc_node_get(range, "to") ||
      !opc_node_get(range, "step"))
    good = opc_wrong(problems, range,
                     "a range must be '{ from: A, to: B, step: C }'");
  return opc_node_check_keys(range, "from|to|step", " of a range", problems) &&
         good;
}

/* Read a quantity and convert the number to the unit of `from`. `from` is NULL
   for the first quantity. */
static gboolean read_quantity(const opc_node *range, const char *key,
                              const quantity *from, opc_problems *problems,
                              quantity *out) {
  const opc_node *node = opc_node_get(range, key);
  const char *text = node->type == OPC_NODE_TEXT ? node->text : "";
  size_t length = opc_number_length(text);
  if (!length)
    return opc_wrong(problems, node, "'%s' of a range must be a number", key);
  out->unit = text + length + strspn(text + length, " ");
  const opc_unit *unit = opc_unit_find(out->unit);
  if (*out->unit && !unit)
    return unknown_unit(node, node->text, out->unit, problems);
  const opc_unit *to = from ? opc_unit_find(from->unit) : unit;
  if (!unit != !to || (unit && opc_unit_noun(unit) != opc_unit_noun(to)))
    return opc_wrong(problems, node,
                     "'%s' must be of the same dimension as 'from', found '%s'",
                     key, text);
  out->number = opc_number_in(text, length, unit, to);
  return isfinite(out->number) ||
         opc_wrong(problems, node, "'%s' of a range is too large: '%s'", key,
                   text);
}

/* Return the number of values of a range; 0 and a problem if the range is
   invalid. */
static guint range_count(const opc_node *range, const quantity *from,
                         const quantity *to, const quantity *step,
                         opc_problems *problems) {
  double steps = (to->number - from->number) / step->number;
  /* The step may miss the end by the rounding error. */
  double count = floor(steps * (1 + 1e-12) + 1e-9) + 1;
  double short_of = steps - (count - 1);
  if (count >= 1 && count <= most_values && short_of <= steps * 1e-12 + 1e-9)
    return (guint)count;
  /* Show the last value before the end in the message, because the mistake may
     be in `to` or in `step`. */
  double end = from->number + (count - 1) * step->number;
  g_autofree char *last =
      count > 1 && isfinite(end)
          ? g_strdup_printf(", but to %.12g%s%s", end, *from->unit ? " " : "",
                            from->unit)
          : g_strdup("");
  if (count > most_values && isfinite(count))
    opc_wrong(problems, range,
              "the range has %.0f values, expected at most %.0f", count,
              most_values);
  else
    opc_wrong(problems, opc_node_get(range, "step"),
              "'step' does not lead from '%s' to '%s'%s",
              opc_node_get(range, "from")->text,
              opc_node_get(range, "to")->text, last);
  return 0;
}

GPtrArray *opc_range_values(const opc_node *range, const opc_source *source,
                            opc_problems *problems) {
  quantity from, to, step;
  GPtrArray *values =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  if (!check_range_keys(range, problems) ||
      !read_quantity(range, "from", NULL, problems, &from) ||
      !read_quantity(range, "to", &from, problems, &to) ||
      !read_quantity(range, "step", &from, problems, &step))
    return values;
  guint n = range_count(range, &from, &to, &step, problems);
  for (guint i = 0; i < n; i++) {
    /* 12 digits: 0.3, not 0.30000000000000004. */
    char number[40];
    g_ascii_formatd(number, sizeof number, "%.12g",
                    from.number + i * step.number);
    g_autofree char *text =
        g_strdup_printf("%s%s%s", number, *from.unit ? " " : "", from.unit);
    opc_node *node = opc_node_text_new(source, text);
    node->plain = TRUE;
    node->at = range->at;
    node->at.file = source->name;
    g_ptr_array_add(values, node);
  }
  return values;
}

double *opc_range_numbers(const GPtrArray *nodes, const char **unit) {
  g_autofree double *values = g_new(double, nodes->len);
  const char *first = "";
  *unit = NULL;
  for (guint i = 0; i < nodes->len; i++) {
    const opc_node *node = nodes->pdata[i];
    const char *text = node->type == OPC_NODE_TEXT ? node->text : "";
    size_t length = opc_number_length(text);
    const char *rest = text + length + strspn(text + length, " ");
    if (!i) first = rest;
    if (!length || strcmp(rest, first)) return NULL;
    values[i] = g_ascii_strtod(text, NULL);
  }
  if (*first && !opc_unit_find(first)) return NULL;
  if (*first) *unit = first;
  return g_steal_pointer(&values);
}
