/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns lists and ranges into the values of axes and numbers their points. */
#include "core/binding/sweep.h"

#include <base/layers.h>
#include <base/range.h>
#include <string.h>

#include "core/binding/flow.h"

static const double most_points = OPC_RANGE_MOST;

/* ---- axes ---- */

static void axis_free(gpointer item) {
  opc_axis *axis = item;
  g_free((char *)axis->info.path);
  g_free((double *)axis->info.values);
  g_strfreev((char **)axis->info.texts);
  g_strfreev(axis->variants);
  g_ptr_array_free(axis->values, TRUE);
  opc_source_free(axis->source);
  g_free(axis);
}

static void axis_describe(opc_axis *axis) {
  guint n = axis->values->len;
  char **texts = g_new0(char *, n + 1);
  for (guint i = 0; i < n; i++)
    texts[i] = opc_node_line(axis->values->pdata[i]);
  axis->info.count = n;
  axis->info.texts = (const char *const *)texts;
  axis->info.values = opc_range_numbers(axis->values, &axis->info.unit);
}

/* Return a new axis; takes ownership of the source. */
static opc_axis *axis_new(const char *path, const opc_place *at,
                          opc_source *source, const opc_node *values,
                          opc_problems *problems) {
  opc_axis *axis = g_new0(opc_axis, 1);
  axis->info.path = g_strdup(path);
  axis->source = source;
  axis->at = *at;
  axis->at.file = source->name;
  gboolean range = strchr(path, '.') && values->type == OPC_NODE_MAP;
  axis->values =
      range ? opc_range_values(values, source, problems)
            : g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  if (!strchr(path, '.'))
    opc_problem_add(problems, OPC_INVALID, at,
                    "'%s' is a step, but a sweep requires 'step.parameter'",
                    path);
  else if (range)
    ;
  else if (values->type == OPC_NODE_LIST && values->items->len)
    for (guint i = 0; i < values->items->len; i++)
      g_ptr_array_add(axis->values,
                      opc_node_copy(values->items->pdata[i], source));
  else
    opc_wrong(
        problems, values,
        "a sweep must be a list of values, or '{ from: A, to: B, step: C }'");
  axis_describe(axis);
  return axis;
}

static gboolean is_fixed(const char *path, const char *const *sets,
                         const opc_node *over) {
  size_t n = strlen(path);
  for (; sets && *sets; sets++)
    if (!strncmp(*sets, path, n) && (*sets)[n] == '=') return TRUE;
  return over && opc_node_find(over, path) >= 0;
}

/* Replace the axis of the same path, or append the axis; takes ownership. An
   axis without values is dropped, because axis_new reported the problem. */
static void put_axis(opc_sweep *sweep, opc_axis *axis) {
  if (!axis->values->len) {
    axis_free(axis);
    return;
  }
  for (guint i = 0; i < sweep->axes->len; i++) {
    const opc_axis *old = sweep->axes->pdata[i];
    if (strcmp(old->info.path, axis->info.path) != 0) continue;
    axis_free(sweep->axes->pdata[i]);
    sweep->axes->pdata[i] = axis;
    return;
  }
  g_ptr_array_add(sweep->axes, axis);
}

/* Add the axis `path` from item i of a map. */
static void add_axis(opc_sweep *sweep, const char *path, const opc_node *map,
                     guint i, opc_problems *problems) {
  const opc_node *key = map->keys->pdata[i], *value = map->items->pdata[i];
  opc_source *source = opc_source_layer(value->source, "sweep");
  put_axis(sweep, axis_new(path, &key->at, source, value, problems));
}

static void add_argument(opc_sweep *sweep, const char *text,
                         opc_problems *problems) {
  g_autofree char *path = NULL;
  opc_source *source;
  g_autoptr(opc_node) values =
      opc_argument_parse("--sweep", text, &path, &source, problems);
  if (values)
    put_axis(sweep, axis_new(path, &values->at, source, values, problems));
  else
    opc_source_free(source);
}

static void count_points(opc_sweep *sweep, opc_problems *problems) {
  double points = 1;
  for (guint i = 0; i < sweep->axes->len; i++)
    points *= ((opc_axis *)sweep->axes->pdata[i])->values->len;
  sweep->points = points <= most_points ? (size_t)points : 1;
  if (points <= most_points) return;
  const opc_axis *first = sweep->axes->pdata[0];
  opc_problem_add(problems, OPC_INVALID, &first->at,
                  "the sweep has %.0f points, expected at most %.0f", points,
                  most_points);
}

opc_sweep *opc_sweep_none(void) {
  opc_sweep *sweep = g_new0(opc_sweep, 1);
  sweep->axes = g_ptr_array_new_with_free_func(axis_free);
  sweep->points = 1;
  return sweep;
}

opc_sweep *opc_sweep_new(const opc_recipe *recipe, const char *const *sets,
                         const opc_node *over, const char *const *sweeps,
                         opc_problems *problems) {
  opc_sweep *sweep = opc_sweep_none();
  for (guint i = 0; i < recipe->sweep->items->len; i++) {
    const char *path = opc_node_key(recipe->sweep, i);
    if (!is_fixed(path, sets, over))
      add_axis(sweep, path, recipe->sweep, i, problems);
  }
  for (; sweeps && *sweeps; sweeps++) add_argument(sweep, *sweeps, problems);
  count_points(sweep, problems);
  return sweep;
}

/* Add the axes of a map, and of nested maps other than ranges. */
static void add_axes(opc_sweep *sweep, const char *prefix, const opc_node *map,
                     opc_problems *problems) {
  for (guint i = 0; i < map->items->len; i++) {
    const opc_node *value = map->items->pdata[i];
    g_autofree char *path = g_strconcat(prefix, opc_node_key(map, i), NULL);
    g_autofree char *deeper = g_strconcat(path, ".", NULL);
    if (value->type == OPC_NODE_MAP && !opc_node_get(value, "from") &&
        !opc_node_get(value, "to") && !opc_node_get(value, "step"))
      add_axes(sweep, deeper, value, problems);
    else
      add_axis(sweep, path, map, i, problems);
  }
}

void opc_sweep_lay_over(opc_sweep *sweep, const opc_node *map,
                        opc_problems *problems) {
  add_axes(sweep, "", map, problems);
  count_points(sweep, problems);
}

/* Return the number of axes of layers, which come first. */
static guint count_layers(const opc_sweep *sweep) {
  guint n = 0;
  while (n < sweep->axes->len &&
         ((const opc_axis *)sweep->axes->pdata[n])->variants)
    n++;
  return n;
}

void opc_sweep_add_layers(opc_sweep *sweep, const char *path,
                          const opc_place *at, opc_source *source,
                          GPtrArray *layers, char **names, char **variants,
                          opc_problems *problems) {
  opc_axis *axis = g_new0(opc_axis, 1);
  axis->info.path = g_strdup(path);
  axis->info.count = layers->len;
  axis->info.texts = (const char *const *)names;
  axis->at = *at;
  axis->at.file = source->name;
  axis->source = source;
  axis->values = layers;
  axis->variants = variants;
  g_ptr_array_insert(sweep->axes, (gint)count_layers(sweep), axis);
  count_points(sweep, problems);
}

void opc_sweep_free(opc_sweep *sweep) {
  if (!sweep) return;
  g_ptr_array_free(sweep->axes, TRUE);
  g_free(sweep);
}

/* ---- dependent steps ---- */

static gboolean begins_with(const char *path, const char *step) {
  size_t n = strcspn(path, ".");
  return strlen(step) == n && !strncmp(path, step, n);
}

static gboolean map_touches(const opc_node *map, const char *step) {
  for (guint i = 0; map && i < map->keys->len; i++)
    if (begins_with(opc_node_key(map, i), step)) return TRUE;
  return FALSE;
}

gboolean opc_axis_touches(const opc_axis *axis, const opc_recipe *recipe,
                          const char *step) {
  if (!axis->variants) return begins_with(axis->info.path, step);
  for (guint i = 0; i < axis->values->len; i++)
    if (map_touches(axis->values->pdata[i], step) ||
        map_touches(opc_node_get(recipe->variants, axis->variants[i]), step))
      return TRUE;
  return FALSE;
}

unsigned opc_sweep_depth(const opc_sweep *sweep) {
  guint layers = count_layers(sweep);
  return layers + (sweep->axes->len > layers);
}

unsigned *opc_sweep_levels(const opc_sweep *sweep, const opc_flow *flow) {
  unsigned *levels = g_new0(unsigned, flow->steps->len + 1);
  unsigned deepest = opc_sweep_depth(sweep);
  for (guint i = 0; i < flow->order->len; i++) {
    const opc_flow_step *step = flow->order->pdata[i];
    unsigned *level = &levels[step->number];
    for (guint a = 0; a < sweep->axes->len; a++)
      if (opc_axis_touches(sweep->axes->pdata[a], flow->recipe, step->name))
        *level = MIN(a + 1, deepest);
    for (guint k = 0; k < step->inputs->len; k++)
      *level = MAX(
          *level,
          levels[g_array_index(step->inputs, opc_flow_input, k).from->number]);
  }
  return levels;
}

/* ---- points ---- */

guint opc_sweep_index(const opc_sweep *sweep, guint a, size_t point) {
  for (guint i = sweep->axes->len - 1; i > a; i--)
    point /= ((const opc_axis *)sweep->axes->pdata[i])->values->len;
  return point % ((const opc_axis *)sweep->axes->pdata[a])->values->len;
}

size_t opc_sweep_point(const opc_sweep *sweep, guint a, guint value) {
  size_t point = value;
  for (guint i = a + 1; i < sweep->axes->len; i++)
    point *= ((opc_axis *)sweep->axes->pdata[i])->values->len;
  return point;
}
