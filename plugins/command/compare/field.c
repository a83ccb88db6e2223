/* SPDX-License-Identifier: BSD-3-Clause */
/* Selects the pairs of runs to compare from the arguments of the command
   line. */
#include "field.h"

#include <inttypes.h>
#include <string.h>

/* ---- state ---- */

static char *field_keep_text(field *f, char *text) {
  g_ptr_array_add(f->owned, text);
  return text;
}

static eda_run *open_run(field *f, const char *folder, const char *label,
                         opc_error *error) {
  eda_run *run = eda_run_open(folder, error);
  if (!run) return NULL;
  g_ptr_array_add(f->runs, run);
  g_ptr_array_add(f->labels, field_keep_text(f, g_strdup(label)));
  if (!eda_run_info(run)->points) return run;
  opc_fail(error, OPC_INVALID, NULL,
           "'%s' is a sweep of %" PRId64 " points, not one run", folder,
           eda_run_info(run)->points);
  return NULL;
}

static void add_pair(field *f, const char *name, const char *method,
                     eda_run *base, eda_run *other) {
  const pair p = {name, method, base, other};
  g_array_append_val(f->pairs, p);
}

/* ---- runs ---- */

/* Return the label of a folder: the last part of the path, or the whole path if
   several folders have the same last part. */
static char *label_of(size_t n, const char *const *folders, size_t i) {
  g_autofree char *mine = g_path_get_basename(folders[i]);
  for (size_t k = 0; k < n; k++) {
    g_autofree char *its = g_path_get_basename(folders[k]);
    if (k != i && !strcmp(mine, its)) return g_strdup(folders[i]);
  }
  return g_steal_pointer(&mine);
}

static int open_runs(field *f, size_t n, const char *const *folders,
                     opc_error *error) {
  eda_run *base = NULL;
  if (n < 2)
    return opc_fail(
        error, OPC_INVALID, NULL,
        "expected two or more runs, an experiment, or a flow and --variant");
  for (size_t i = 0; i < n; i++) {
    char *label = field_keep_text(f, label_of(n, folders, i));
    eda_run *run = open_run(f, folders[i], label, error);
    if (!run) return error->code;
    if (i)
      add_pair(f, "", label, base, run);
    else
      base = run, f->base = label;
  }
  f->cases = 1;
  f->methods = n - 1;
  return OPC_OK;
}

/* ---- variants ---- */

/* Return the name of a flow: the entry `name` of the file, or the file name
   without extension. */
static char *flow_name(const char *path, opc_error *error) {
  g_autofree char *text = NULL;
  g_autoptr(GError) trouble = NULL;
  if (!g_file_get_contents(path, &text, NULL, &trouble)) {
    opc_fail(error, OPC_IO, NULL, "%s", trouble->message);
    return NULL;
  }
  g_autoptr(GRegex) line = g_regex_new("^name:[ \\t]*[\"']?([A-Za-z0-9_.-]+)",
                                       G_REGEX_MULTILINE, 0, NULL);
  g_autoptr(GMatchInfo) match = NULL;
  if (g_regex_match(line, text, 0, &match)) return g_match_info_fetch(match, 1);
  char *name = g_path_get_basename(path);
  char *dot = strrchr(name, '.');
  if (dot) *dot = '\0';
  return name;
}

/* Return whether the name of a folder is NAME or NAME-N. */
static gboolean is_of(const char *folder, const char *name) {
  size_t n = strlen(name);
  if (strncmp(folder, name, n) != 0) return FALSE;
  const char *rest = folder + n;
  return !*rest || (*rest == '-' && rest[1] &&
                    strspn(rest + 1, "0123456789") == strlen(rest + 1));
}

/* Return the folder of the latest run of a variant in `runs`, or NULL if there
   is none. Without `variant`, runs of the flow without a variant are searched.
 */
static char *latest_run(const char *name, const char *variant) {
  g_autofree char *whole =
      variant ? g_strdup_printf("%s-%s", name, variant) : g_strdup(name);
  g_autoptr(GDir) dir = g_dir_open("runs", 0, NULL);
  g_autofree char *started = NULL;
  char *best = NULL;
  for (const char *entry; dir && (entry = g_dir_read_name(dir));) {
    opc_error error;
    g_autofree char *path = g_build_filename("runs", entry, NULL);
    eda_run *run = is_of(entry, whole) ? eda_run_open(path, &error) : NULL;
    const eda_run_facts *facts = run ? eda_run_info(run) : NULL;
    if (facts && !facts->points && !g_strcmp0(facts->variant, variant) &&
        (!started || strcmp(facts->started, started) > 0)) {
      g_free(best);
      g_free(started);
      best = g_steal_pointer(&path);
      started = g_strdup(facts->started);
    }
    eda_run_free(run);
  }
  return best;
}

static int open_variants(field *f, const char *flow, const char *variants,
                         opc_error *error) {
  g_autofree char *name = flow_name(flow, error);
  if (!name) return error->code;
  g_auto(GStrv) words = g_strsplit(variants, ",", -1);
  g_autoptr(GPtrArray) folders = g_ptr_array_new();
  for (char **word = words; *word; word++) {
    const char *variant = strcmp(g_strstrip(*word), "base") ? *word : NULL;
    char *folder = latest_run(name, variant);
    if (!folder)
      return opc_fail(
          error, OPC_INVALID, "variant",
          "runs/ has no run of '%s': start one by 'opcflow run %s%s%s'", *word,
          flow, variant ? " --variant " : "", variant ? variant : "");
    g_ptr_array_add(folders, field_keep_text(f, folder));
  }
  return open_runs(f, folders->len, (const char *const *)folders->pdata, error);
}

/* ---- experiments ---- */

static eda_run_cases *open_cases(field *f, const char *folder,
                                 opc_error *error) {
  eda_run_cases *c = eda_run_cases_open(folder, error);
  if (c) g_ptr_array_add(f->lists, c);
  return c;
}

static const eda_run_case *find_case(const eda_run_cases *in, const char *name,
                                     const char *method) {
  size_t n;
  const eda_run_case *all = eda_run_cases_all(in, &n);
  for (size_t i = 0; i < n; i++)
    if (!strcmp(all[i].name, name) && !strcmp(all[i].method, method))
      return &all[i];
  return NULL;
}

/* Find the run of a case. If there is none, or if the run failed, *run is NULL,
   and one warning is logged. `runs` caches the results by case. */
static int case_run(field *f, const opc_host *host, GHashTable *runs,
                    const eda_run_case *c, eda_run **run, opc_error *error) {
  if (g_hash_table_lookup_extended(runs, c, NULL, (void **)run)) return OPC_OK;
  const char *fault = c->folder ? NULL : *c->result ? c->result : "has no run";
  *run = NULL;
  if (!fault) {
    g_autofree char *label = g_strdup_printf("%s, %s", c->name, c->method);
    *run = open_run(f, c->folder, label, error);
    if (!*run) return error->code;
    fault = eda_run_info(*run)->failure;
  }
  if (fault) {
    host->log(host, OPC_LOG_WARNING, "%s, %s: left out: %s", c->name, c->method,
              fault);
    *run = NULL;
  }
  g_hash_table_insert(runs, (void *)c, *run);
  return OPC_OK;
}

/* Pair each run of `others` with the run of the same case in `base`. The method
   of the base run is `method`; without `method`, it is the method of the other
   run. */
static int pair_cases(field *f, const opc_host *host, const eda_run_cases *base,
                      const eda_run_cases *others, const char *method,
                      opc_error *error) {
  g_autoptr(GHashTable) runs = g_hash_table_new(NULL, NULL);
  g_autoptr(GHashTable) names = g_hash_table_new(g_str_hash, g_str_equal);
  g_autoptr(GHashTable) methods = g_hash_table_new(g_str_hash, g_str_equal);
  size_t n;
  const eda_run_case *all = eda_run_cases_all(others, &n);
  for (size_t i = 0; i < n; i++) {
    if (method && !strcmp(all[i].method, method)) continue;
    const eda_run_case *from =
        find_case(base, all[i].name, method ? method : all[i].method);
    eda_run *a, *b = NULL;
    if (!from) {
      host->log(host, OPC_LOG_WARNING,
                "%s, %s: omitted, because the base has no such run",
                all[i].name, all[i].method);
      continue;
    }
    int code = case_run(f, host, runs, from, &a, error);
    if (!code && a) code = case_run(f, host, runs, &all[i], &b, error);
    if (code) return code;
    if (!a || !b) continue;
    add_pair(f, all[i].name, all[i].method, a, b);
    g_hash_table_add(names, (char *)all[i].name);
    g_hash_table_add(methods, (char *)all[i].method);
  }
  f->cases = g_hash_table_size(names);
  f->methods = g_hash_table_size(methods);
  f->experiment = 1;
  return f->pairs->len
             ? OPC_OK
             : opc_fail(error, OPC_INVALID, NULL, "no case has two runs");
}

static int open_experiments(field *f, const opc_host *host, size_t n,
                            const char *const *folders, opc_error *error) {
  if (n > 2)
    return opc_fail(error, OPC_INVALID, NULL,
                    "expected one or two experiments, found %zu", n);
  const eda_run_cases *first = open_cases(f, folders[0], error);
  if (!first) return error->code;
  size_t count;
  const eda_run_case *all = eda_run_cases_all(first, &count);
  if (!count)
    return opc_fail(error, OPC_INVALID, NULL, "'%s' has no cases", folders[0]);
  f->base = n == 1 ? all[0].method : "";
  const eda_run_cases *second =
      n == 1 ? first : open_cases(f, folders[1], error);
  if (!second) return error->code;
  return pair_cases(f, host, first, second, n == 1 ? f->base : NULL, error);
}

/* ---- entry ---- */

int field_open(field *f, const opc_host *host, size_t n,
               const char *const *arguments, const char *variants,
               opc_error *error) {
  *f = (field){
      .base = "",
      .pairs = g_array_new(FALSE, FALSE, sizeof(pair)),
      .runs = g_ptr_array_new_with_free_func((GDestroyNotify)eda_run_free),
      .labels = g_ptr_array_new(),
      .owned = g_ptr_array_new_with_free_func(g_free),
      .lists =
          g_ptr_array_new_with_free_func((GDestroyNotify)eda_run_cases_free)};
  size_t experiments = 0;
  for (size_t i = 0; i < n; i++)
    experiments += (size_t)eda_run_is_experiment(arguments[i]);
  if (variants && n == 1)
    return open_variants(f, arguments[0], variants, error);
  if (variants)
    return opc_fail(error, OPC_INVALID, "variant",
                    "'--variant' requires exactly one flow file");
  if (experiments && experiments == n)
    return open_experiments(f, host, n, arguments, error);
  if (experiments)
    return opc_fail(error, OPC_INVALID, NULL,
                    "an experiment can be compared with another experiment "
                    "only, not with a run");
  return open_runs(f, n, arguments, error);
}

void field_clear(field *f) {
  g_array_free(f->pairs, TRUE);
  g_ptr_array_free(f->runs, TRUE);
  g_ptr_array_free(f->labels, TRUE);
  g_ptr_array_free(f->lists, TRUE);
  g_ptr_array_free(f->owned, TRUE);
}
