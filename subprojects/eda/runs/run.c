/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of a run folder: manifest, metrics and resolved flow. */
#include <glib.h>
#include <string.h>

#include "runs/parameters.h"

/* ---- state ---- */

struct eda_run {
  runs_tree manifest, metrics, flow;
  eda_run_facts facts;
  GPtrArray *texts;   /* strings not owned by a tree, char * */
  GHashTable *tables; /* name to eda_table */
};

/* A tree that is being read. */
typedef struct reading {
  eda_run *run;
  runs_tree *tree;
  opc_error *error;
} reading;

/* ---- lists ---- */

/* Return an array with an element of `size` bytes for each node of the list
   `key` (g_free); `read` sets each element. Write the number of elements to *n.
   Return NULL if the list is missing or on error. */
static void *read_list(reading *r, const char *key, size_t size, size_t *n,
                       int (*read)(reading *r, const opc_node *node,
                                   void *to)) {
  const opc_node *list = opc_node_get(runs_root(r->tree), key);
  r->error->code = OPC_OK;
  *n = 0;
  if (!list) return NULL;
  if (list->type != OPC_NODE_LIST) {
    runs_fail(list, r->error, "'%s' is not a list", key);
    return NULL;
  }
  size_t count = list->items->len;
  char *all = g_malloc0_n(MAX(count, 1), size);
  for (size_t i = 0; i < count && !r->error->code; i++)
    read(r, list->items->pdata[i], all + i * size);
  *n = count;
  return all;
}

/* Write the text of the required member `key` to *text. */
static int text_required(reading *r, const opc_node *map, const char *key,
                         const char **text) {
  *text = runs_word(opc_node_get(map, key));
  return *text ? OPC_OK : runs_fail(map, r->error, "text '%s' is missing", key);
}

static int read_file(reading *r, const opc_node *node, void *to) {
  eda_run_file *f = to;
  double bytes = runs_number(opc_node_get(node, "bytes"));
  f->bytes = bytes >= 0 && bytes < 9e15 ? (int64_t)bytes : -1;
  return text_required(r, node, "path", &f->path) ||
                 text_required(r, node, "sha256", &f->sha256)
             ? r->error->code
             : OPC_OK;
}

static int read_plugin(reading *r, const opc_node *node, void *to) {
  eda_run_plugin *p = to;
  return text_required(r, node, "id", &p->id) ||
                 text_required(r, node, "version", &p->version) ||
                 text_required(r, node, "sha256", &p->sha256)
             ? r->error->code
             : OPC_OK;
}

static int read_finding(reading *r, const opc_node *node, void *to) {
  eda_run_finding *f = to;
  return text_required(r, node, "step", &f->step) ||
                 text_required(r, node, "text", &f->text)
             ? r->error->code
             : OPC_OK;
}

static int read_requirement(reading *r, const opc_node *node, void *to) {
  eda_run_requirement *q = to;
  const char *kept;
  if (text_required(r, node, "metric", &q->metric) ||
      text_required(r, node, "required", &q->required) ||
      text_required(r, node, "kept", &kept))
    return r->error->code;
  q->unit = runs_word(opc_node_get(node, "unit"));
  q->value = runs_number(opc_node_get(node, "value"));
  q->kept = !strcmp(kept, "true");
  return OPC_OK;
}

/* ---- metrics ---- */

static int read_metric(reading *r, const char *step, const char *name,
                       const opc_node *node, GArray *out) {
  static const char *const words[] = {"neutral", "lower", "higher", NULL};
  const char *better;
  if (node->type != OPC_NODE_MAP)
    return runs_fail(node, r->error, "is not a metric");
  if (text_required(r, node, "better", &better)) return r->error->code;
  eda_run_metric m = {
      .name = g_strdup_printf("%s.%s", step, name),
      .unit = runs_word(opc_node_get(node, "unit")),
      .value = runs_number(opc_node_get(node, "value")),
      .tolerance = runs_number(opc_node_get(node, "tolerance"))};
  g_ptr_array_add(r->run->texts, (char *)m.name);
  while (words[m.better] && strcmp(words[m.better], better) != 0) m.better++;
  if (!words[m.better])
    return runs_fail(node, r->error,
                     "'better' must be neutral, lower or higher, found '%.40s'",
                     better);
  if (!(m.tolerance >= 0)) /* true for NAN */
    return runs_fail(node, r->error, "'tolerance' is not a number");
  g_array_append_val(out, m);
  return OPC_OK;
}

/* Read the metrics of all steps. Members of the root that are not maps are not
   steps. */
static int read_metrics(reading *r) {
  GArray *out = g_array_new(FALSE, FALSE, sizeof(eda_run_metric));
  const opc_node *root = runs_root(r->tree);
  int code = OPC_OK;
  for (guint i = 0; !code && i < root->items->len; i++) {
    const opc_node *map = root->items->pdata[i];
    for (guint k = 0; map->keys && !code && k < map->items->len; k++)
      code = read_metric(r, opc_node_key(root, i), opc_node_key(map, k),
                         map->items->pdata[k], out);
  }
  eda_run_facts *f = &r->run->facts;
  f->n_metrics = out->len;
  f->metrics = (eda_run_metric *)(void *)g_array_free(out, FALSE);
  if (code) return code;
  f->findings = read_list(r, "findings", sizeof *f->findings, &f->n_findings,
                          read_finding);
  if (!r->error->code)
    f->requirements = read_list(r, "require", sizeof *f->requirements,
                                &f->n_requirements, read_requirement);
  return r->error->code;
}

/* ---- manifest ---- */

static void read_steps(reading *r) {
  const opc_node *map = opc_node_get(runs_root(r->tree), "steps");
  if (!map || map->type != OPC_NODE_MAP) return;
  size_t n = map->items->len;
  eda_run_step *steps = g_new0(eda_run_step, n);
  for (guint i = 0; i < n; i++)
    steps[i] =
        (eda_run_step){opc_node_key(map, i), runs_number(map->items->pdata[i])};
  r->run->facts.steps = steps;
  r->run->facts.n_steps = n;
}

static int64_t whole_number(reading *r, const char *key) {
  double n = runs_number(opc_node_get(runs_root(r->tree), key));
  return n >= 0 && n < 9e15 ? (int64_t)n : 0;
}

static int read_manifest(reading *r) {
  eda_run_facts *f = &r->run->facts;
  const opc_node *root = runs_root(r->tree);
  const char *result;
  if (text_required(r, root, "opcflow", &f->version) ||
      text_required(r, root, "result", &result))
    return r->error->code;
  f->variant = runs_word(opc_node_get(root, "variant"));
  f->started = runs_word(opc_node_get(root, "started"));
  f->failure = runs_word(opc_node_get(root, "failure"));
  if (!f->started) f->started = "";
  if (!f->failure && strcmp(result, "complete") != 0) f->failure = result;
  f->seconds = runs_number(opc_node_get(root, "seconds"));
  f->threads = whole_number(r, "threads");
  f->points = whole_number(r, "points");
  read_steps(r);
  f->inputs =
      read_list(r, "inputs", sizeof *f->inputs, &f->n_inputs, read_file);
  if (!r->error->code)
    f->files = read_list(r, "files", sizeof *f->files, &f->n_files, read_file);
  if (!r->error->code)
    f->plugins =
        read_list(r, "plugins", sizeof *f->plugins, &f->n_plugins, read_plugin);
  return r->error->code;
}

/* ---- the flow ---- */

static int read_flow(reading *r) {
  eda_run_facts *f = &r->run->facts;
  const opc_node *root = runs_root(r->tree);
  const opc_node *format = opc_node_get(root, "opcflow");
  if (!format || g_strcmp0(runs_word(format), "1") != 0)
    return runs_fail(format ? format : root, r->error,
                     "is a flow of the format '%.20s', expected '1'",
                     format && runs_word(format) ? runs_word(format) : "");
  if (text_required(r, root, "name", &f->name)) return r->error->code;
  GArray *all = g_array_new(FALSE, FALSE, sizeof(eda_run_parameter));
  int code = runs_parameters(r->tree, all, r->run->texts, r->error);
  f->n_parameters = all->len;
  f->parameters = (eda_run_parameter *)(void *)g_array_free(all, FALSE);
  return code;
}

/* ---- open and close ---- */

static int open_all(eda_run *run, opc_error *error) {
  const struct {
    const char *file;
    runs_tree *tree;
    int (*read)(reading *r);
  } parts[] = {{"manifest.json", &run->manifest, read_manifest},
               {"metrics.json", &run->metrics, read_metrics},
               {"flow.yaml", &run->flow, read_flow}};
  const char *folder = run->facts.folder;
  int code = OPC_OK;
  if (!g_file_test(folder, G_FILE_TEST_EXISTS))
    return opc_fail(error, OPC_IO, NULL, "'%s': no such run folder", folder);
  for (size_t i = 0; i < G_N_ELEMENTS(parts) && !code; i++) {
    g_autofree char *path = g_build_filename(folder, parts[i].file, NULL);
    reading r = {run, parts[i].tree, error};
    if (!g_file_test(path, G_FILE_TEST_EXISTS))
      return opc_fail(error, OPC_IO, NULL,
                      "'%s' is not a run folder: %s is missing", folder,
                      parts[i].file);
    code = runs_tree_open(r.tree, path, error);
    if (!code) code = parts[i].read(&r);
  }
  return code;
}

eda_run *eda_run_open(const char *folder, opc_error *error) {
  eda_run *run = g_new0(eda_run, 1);
  run->texts = g_ptr_array_new_with_free_func(g_free);
  run->tables = g_hash_table_new_full(g_str_hash, g_str_equal, g_free,
                                      (GDestroyNotify)eda_table_free);
  run->facts.folder = g_strdup(folder);
  if (!open_all(run, error)) return run;
  eda_run_free(run);
  return NULL;
}

void eda_run_free(eda_run *run) {
  if (!run) return;
  eda_run_facts *f = &run->facts;
  g_free((char *)f->folder);
  g_free((void *)f->metrics);
  g_free((void *)f->parameters);
  g_free((void *)f->inputs);
  g_free((void *)f->files);
  g_free((void *)f->plugins);
  g_free((void *)f->steps);
  g_free((void *)f->findings);
  g_free((void *)f->requirements);
  runs_tree_close(&run->manifest);
  runs_tree_close(&run->metrics);
  runs_tree_close(&run->flow);
  g_ptr_array_free(run->texts, TRUE);
  g_hash_table_unref(run->tables);
  g_free(run);
}

/* ---- queries ---- */

const eda_run_facts *eda_run_info(const eda_run *run) { return &run->facts; }

double eda_run_time(const eda_run *run) {
  const eda_run_facts *f = eda_run_info(run);
  double sum = 0;
  for (size_t i = 0; i < f->n_steps; i++) sum += f->steps[i].seconds;
  return f->n_steps ? sum : f->seconds;
}

const eda_run_metric *eda_run_metric_of(const eda_run *run, const char *name) {
  for (size_t i = 0; i < run->facts.n_metrics; i++)
    if (!strcmp(run->facts.metrics[i].name, name))
      return &run->facts.metrics[i];
  return NULL;
}

const eda_run_parameter *eda_run_parameter_of(const eda_run *run,
                                              const char *name) {
  for (size_t i = 0; i < run->facts.n_parameters; i++)
    if (!strcmp(run->facts.parameters[i].name, name))
      return &run->facts.parameters[i];
  return NULL;
}

static char *table_path(const eda_run *run, const char *name) {
  g_autofree char *file = g_strconcat(name, ".csv", NULL);
  return g_build_filename(run->facts.folder, file, NULL);
}

int eda_run_has_table(const eda_run *run, const char *name) {
  g_autofree char *path = table_path(run, name);
  return g_file_test(path, G_FILE_TEST_IS_REGULAR);
}

eda_table *eda_run_table(eda_run *run, const char *name, opc_error *error) {
  eda_table *table = g_hash_table_lookup(run->tables, name);
  if (table) return table;
  g_autofree char *path = table_path(run, name);
  table = eda_table_read(path, error);
  if (table) g_hash_table_insert(run->tables, g_strdup(name), table);
  return table;
}
