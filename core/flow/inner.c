/* SPDX-License-Identifier: BSD-3-Clause */
/* Flows that steps run inside of them: reading and checking one, and running it
   at points of its sweep. */
#include "core/flow/inner.h"

#include <math.h>
#include <string.h>

#include "core/flow/run.h"
#include "core/plugin/declaration.h"
#include "core/text/suggest.h"

struct opc_inner {
  const opc_binding *binding; /* whose flow it is */
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_choice choice; /* of the first point */
  opc_flow *flow;    /* there */
  opc_registry *registry;
  opc_inner_axis *axes;
  gboolean *wanted; /* steps that were asked for, by number */

  opc_watch watch; /* while the step runs, from here on */
  char *folder;
  opc_run *trunk, *run; /* what all points share; the last one */
  size_t runs, done, share;
  gboolean telling; /* messages are passed on */
};

/* ---- reading: what is laid over it ---- */

/* The number of such a parameter, -1 if there is none. */
static int find_parameter(const opc_plugin *plugin, const char *name,
                          uint32_t type) {
  int i = opc_parameter_find(plugin, name);
  return i >= 0 && plugin->parameters[i].type == type ? i : -1;
}

static const opc_node *find_map(const opc_binding *b, const char *name) {
  int i = find_parameter(b->plugin, name, OPC_MAP);
  return i < 0 ? NULL : b->origin[i];
}

static void choose_variant(opc_inner *inner, const opc_binding *b,
                           opc_problems *problems) {
  int i = find_parameter(b->plugin, "variant", OPC_TEXT);
  if (i < 0 || !b->values[i].present) return;
  inner->choice.variant = b->values[i].field.text;
  opc_recipe_has(inner->recipe, inner->choice.variant,
                 opc_binding_origin(b, (size_t)i), problems);
}

/* ---- reading: files ---- */

/* Of a value, of those of a list, and of what is in a map. As deep as files
   may nest. */
static void make_files_absolute(const opc_flow *flow, const char *path,
                                opc_node *node) {
  if (node->type == OPC_NODE_TEXT) {
    const opc_parameter *p = opc_flow_parameter(flow, path);
    if (!p || p->type != OPC_FILE || g_path_is_absolute(node->text)) return;
    g_autofree char *file = opc_node_path(node);
    g_free(node->text);
    node->text = g_canonicalize_filename(file, NULL);
    return;
  }
  for (guint i = 0; i < node->items->len; i++) {
    g_autofree char *deeper =
        node->keys ? g_strdup_printf("%s%s%s", path, *path ? "." : "",
                                     opc_node_key(node, i))
                   : g_strdup(path);
    make_files_absolute(flow, deeper, node->items->pdata[i]);
  }
}

/* ---- reading: all of it ---- */

static void open_recipe(opc_inner *inner, const opc_binding *b,
                        opc_problems *problems) {
  guint before = problems->list->len;
  const opc_node *set = find_map(b, "set"), *sweep = find_map(b, "sweep");
  /* What is set is not swept by the flow itself. */
  inner->sweep = opc_sweep_new(inner->recipe, NULL, set, NULL, problems);
  if (sweep) opc_sweep_lay_over(inner->sweep, sweep, problems);
  inner->choice =
      (opc_choice){.over = set, .sweep = inner->sweep, .bind = OPC_BIND_INNER};
  choose_variant(inner, b, problems);
  if (problems->list->len > before) return;
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, NULL,
                 problems);
  if (problems->list->len > before) return;
  g_autoptr(opc_problems) told = opc_problems_new();
  inner->flow =
      opc_flow_make(inner->recipe, &inner->choice, inner->registry, told);
  if (set) make_files_absolute(inner->flow, "", (opc_node *)set);
  if (sweep) make_files_absolute(inner->flow, "", (opc_node *)sweep);
  inner->wanted = g_new0(gboolean, inner->flow->steps->len);
  const GPtrArray *axes = inner->sweep->axes;
  inner->axes = g_new0(opc_inner_axis, axes->len + 1);
  for (guint i = 0; i < axes->len; i++)
    inner->axes[i] = ((const opc_axis *)axes->pdata[i])->told;
}

void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems) {
  const opc_plugin *plugin = binding->plugin;
  size_t i = 0;
  while (i < plugin->n_parameters &&
         !(plugin->parameters[i].flags & OPC_INNER_FLOW))
    i++;
  if (i == plugin->n_parameters || !binding->values[i].present) return;
  if (flags & OPC_BIND_INNER) {
    opc_problem_add(problems, OPC_INVALID, &binding->at,
                    "'%s' cannot stand in a flow that a step runs", plugin->id);
    return;
  }
  opc_inner *inner = binding->inner = g_new0(opc_inner, 1);
  inner->binding = binding;
  inner->registry = registry;
  inner->recipe = opc_recipe_read(binding->values[i].field.text, problems);
  if (inner->recipe) open_recipe(inner, binding, problems);
}

void opc_inner_free(opc_inner *inner) {
  if (!inner) return;
  opc_run_free(inner->run);
  opc_run_free(inner->trunk);
  opc_flow_free(inner->flow);
  opc_sweep_free(inner->sweep);
  opc_recipe_free(inner->recipe);
  g_free(inner->axes);
  g_free(inner->wanted);
  g_free(inner->folder);
  g_free(inner);
}

int opc_inner_check(const opc_inner *inner, opc_error *error) {
  static const opc_watch nowhere = {.data = NULL};
  if (!inner) return OPC_OK;
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, &nowhere,
                 problems);
  return opc_problems_error(problems, error);
}

const opc_flow *opc_inner_flow(const opc_inner *inner) { return inner->flow; }

void opc_inner_visit(const opc_inner *inner,
                     void (*visit)(void *data, const opc_flow *flow),
                     void *data) {
  visit(data, inner->flow);
  for (guint a = 0; a < inner->sweep->axes->len; a++) {
    const opc_axis *axis = inner->sweep->axes->pdata[a];
    for (guint i = 1; i < axis->values->len; i++) {
      opc_choice choice = inner->choice;
      choice.point = opc_sweep_point(inner->sweep, a, i);
      g_autoptr(opc_problems) told = opc_problems_new();
      g_autoptr(opc_flow) flow =
          opc_flow_make(inner->recipe, &choice, inner->registry, told);
      visit(data, flow);
    }
  }
}

/* ---- asking: what there is ---- */

static opc_inner *inner_of(const opc_host *host) {
  return ((const opc_binding *)host->data)->inner;
}

static const opc_metric *get_metric(const opc_host *host, const char *path,
                                    opc_error *error) {
  opc_inner *in = inner_of(host);
  const opc_binding *b;
  const opc_metric *metric = opc_flow_metric(in->flow, path, &b, error);
  if (metric) in->wanted[opc_flow_find(in->flow, path)->number] = TRUE;
  return metric;
}

/* The port of that kind, -1 if there is none. */
static int find_port(const opc_plugin *plugin, const char *kind) {
  for (size_t i = 0; i < opc_port_count(plugin); i++)
    if (!strcmp(opc_port_at(plugin, i)->kind, kind)) return (int)i;
  return -1;
}

static const char *get_output(const opc_host *host, const char *name,
                              const char *kind, opc_error *error) {
  opc_inner *in = inner_of(host);
  const opc_binding *b = name ? opc_flow_binding(in->flow, name, error) : NULL;
  for (guint i = 0; !name && i < in->flow->steps->len; i++) {
    b = ((const opc_flow_step *)in->flow->steps->pdata[i])->binding;
    if (find_port(b->plugin, kind) >= 0) break;
  }
  if (!b) return NULL;
  in->wanted[opc_flow_find(in->flow, b->path)->number] = TRUE;
  if (find_port(b->plugin, kind) >= 0) return b->path;
  g_autofree char *label = opc_binding_label(b);
  opc_fail(error, OPC_INVALID, NULL, "%s makes no %s", label, kind);
  return NULL;
}

static const opc_inner_axis *get_axes(const opc_host *host, size_t *count) {
  opc_inner *in = inner_of(host);
  g_autofree gboolean *needed = opc_flow_needed(in->flow, in->wanted);
  *count = in->sweep->axes->len;
  for (size_t i = 0; i < *count; i++)
    in->axes[i].used =
        needed[opc_flow_find(in->flow, in->axes[i].path)->number];
  return in->axes;
}

static int find_axis(const opc_host *host, const char *path, opc_error *error) {
  const opc_inner *in = inner_of(host);
  g_autoptr(GPtrArray) paths = g_ptr_array_new();
  for (guint i = 0; i < in->sweep->axes->len; i++) {
    if (!strcmp(in->axes[i].path, path)) return (int)i;
    g_ptr_array_add(paths, (char *)in->axes[i].path);
  }
  g_autofree char *suggestion = opc_suggestion(path, paths);
  opc_fail(error, OPC_INVALID, NULL, "'%s' is not swept%s", path, suggestion);
  return -1;
}

/* ---- running: who looks on ---- */

/* Each point has the same to say: the last one says it. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  const opc_inner *in = data;
  const opc_watch *watch = &((const opc_run *)in->binding->run)->watch;
  if (!in->telling && level >= OPC_LOG_INFO) return;
  g_autofree char *whole = g_strdup_printf("%s.%s", in->binding->path, path);
  watch->log(watch->data, whole, level, message);
}

/* Points that are done, with the part that is of those of this run. */
static void tell_progress(const opc_inner *in, double part) {
  const opc_progress progress = {
      .done = (double)in->done + floor(part * (double)in->share),
      .total = (double)in->sweep->points,
      .worst = NAN};
  in->binding->host->progress(in->binding->host, &progress);
}

static void take_progress(void *data, const char *path,
                          const opc_progress *at) {
  const opc_inner *in = data;
  (void)path;
  gboolean known = at->total > 0 && at->done >= 0 && at->done < at->total;
  if (in->share) tell_progress(in, known ? at->done / at->total : 0);
}

static int is_cancelled(void *data) {
  const opc_inner *in = data;
  return opc_cancelled(in->binding->host->context);
}

/* ---- running ---- */

/* Steps without an output are needed for nothing but their metrics; which of
   the others a point needs may depend on it. What they write lies in a folder
   of the step's name. */
static int begin(const opc_host *host, opc_error *error) {
  const opc_binding *b = host->data;
  opc_inner *in = b->inner;
  opc_run *outer = b->run;
  if (!outer)
    return opc_fail(error, OPC_FAILED, NULL, "a %s runs in a flow only",
                    b->plugin->id);
  in->watch = (opc_watch){.data = in,
                          .log = take_log,
                          .progress = take_progress,
                          .cancelled = is_cancelled};
  g_autofree char *name = g_build_filename(b->path, "flow.yaml", NULL);
  const char *path = host->output_path(host, name, error);
  if (!path) return error->code;
  in->folder = g_path_get_dirname(path);
  in->trunk = opc_run_new(in->flow, in->registry, outer->options, &in->watch);
  opc_run_find_swept(in->flow, in->sweep, in->trunk->left_out);
  for (guint i = 0; i < in->flow->steps->len; i++) {
    const opc_flow_step *step = in->flow->steps->pdata[i];
    in->trunk->left_out[i] |=
        !opc_port_count(step->binding->plugin) && !in->wanted[i];
  }
  g_autoptr(opc_problems) problems = opc_problems_new();
  in->telling = TRUE;
  opc_run_in(in->trunk, outer, in->folder, problems);
  tell_progress(in, 0);
  return opc_problems_error(problems, error);
}

/* Files are called as in a run of the whole flow. */
static void copy_claim(gpointer name, gpointer owner, gpointer claims) {
  g_hash_table_insert(claims, g_strdup(name), g_strdup(owner));
}

/* Leave out what nobody asked for. */
static void prune(const opc_inner *in, opc_run *run) {
  g_autofree gboolean *needed = opc_flow_needed(run->flow, in->wanted);
  for (guint i = 0; i < run->flow->steps->len; i++)
    run->left_out[i] |= !needed[i];
}

/* What is handed on must keep what its flow requires; other points are there to
   be worse. */
static void judge(const opc_inner *in) {
  g_autofree char *prefix = g_strconcat(in->binding->path, ".", NULL);
  opc_run_judge(in->trunk);
  opc_run_judge(in->run);
  opc_run_take_verdicts(in->run, in->trunk, 0, "");
  opc_run_take_verdicts(in->binding->run, in->run, 0, prefix);
}

static int run_point(const opc_host *host, size_t point, int keep, size_t share,
                     opc_error *error) {
  opc_inner *in = inner_of(host);
  opc_choice choice = in->choice;
  choice.point = point;
  in->share = share;
  in->telling = keep;
  g_autofree char *name = g_strdup_printf("%04zu", ++in->runs);
  g_autofree char *folder =
      keep ? g_strdup(in->folder) : g_build_filename(in->folder, name, NULL);
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_run_free(in->run);
  in->run = opc_run_branch(in->trunk, &choice, problems);
  if (in->run) {
    g_hash_table_foreach(in->trunk->claims, copy_claim, in->run->claims);
    prune(in, in->run);
    opc_run_in(in->run, in->binding->run, folder, problems);
    if (keep && !problems->list->len) judge(in);
    opc_run_branch_close(in->run, keep || in->run->options->keep, problems);
  }
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return opc_fail(error, code, NULL, "stopped");
  in->done += share;
  in->share = 0;
  if (share) tell_progress(in, 0);
  g_autofree char *text = opc_problems_text(problems);
  return code ? opc_fail(error, code, NULL, "%s", text) : OPC_OK;
}

/* ---- asking: what came of it ---- */

static const opc_inner_metric *get_metrics(const opc_host *host, int shared,
                                           size_t *count) {
  const opc_inner *in = inner_of(host);
  const opc_run *run = shared ? in->trunk : in->run;
  *count = run ? run->metrics->len : 0;
  return run ? (const opc_inner_metric *)(const void *)run->metrics->data
             : NULL;
}

static const opc_table *find_table(const opc_run *run, const char *step,
                                   const char *name, opc_error *error) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_table *t = run->tables->pdata[i];
    if (strcmp(t->step, step)) continue;
    if (!strcmp(t->name, name)) return t;
    g_ptr_array_add(names, t->name);
  }
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, NULL, "'%s' published no table '%s'%s", step,
           name, suggestion);
  return NULL;
}

static const opc_column *get_column(const opc_host *host, const char *step,
                                    const char *table_name, const char *name,
                                    size_t *rows, opc_error *error) {
  const opc_table *table =
      find_table(inner_of(host)->run, step, table_name, error);
  if (!table) return NULL;
  const opc_column *column = opc_table_column(table, name);
  *rows = table->rows;
  if (column && column->type != OPC_TEXT) return column;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < table->n_columns; i++)
    g_ptr_array_add(names, (char *)table->columns[i].name);
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, NULL,
           "the table '%s' of '%s' has no numbers '%s'%s", table_name, step,
           name, suggestion);
  return NULL;
}

static void *get_object(const opc_host *host, const char *name,
                        const char *kind) {
  opc_inner *in = inner_of(host);
  opc_run *run = in->run;
  const opc_flow_step *step = opc_flow_find(run->flow, name);
  g_autoptr(opc_problems) problems = opc_problems_new();
  if (!opc_run_provide(run, step, in->binding->path, problems))
    opc_problems_error(problems, &((opc_run *)in->binding->run)->refusal);
  void **objects = run->objects[step->number];
  return objects ? objects[find_port(step->binding->plugin, kind)] : NULL;
}

const opc_inner_service opc_inner_functions = {
    .axes = get_axes,
    .axis = find_axis,
    .metric = get_metric,
    .output = get_output,
    .begin = begin,
    .run = run_point,
    .metrics = get_metrics,
    .column = get_column,
    .object = get_object,
};
