/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the report page: reads run folders, collects their data and
   assembles the page. */
#include <report/page.h>

#include <eda/verdicts.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <opcflow/kind.h>
#include <stdarg.h>
#include <string.h>

#include <report/json.h>
#include "page_files.h"

/* ---- state ---- */

/* Tables in the page, and the columns of the possibly long table "gates". */
static const char *const tables[] = {"gates", "history", "corners",
                                     "violations"};
static const char *const gate_columns[] = {
    "transistor", "cell",       "count",     "type",       "l",
    "w",          "ion_before", "ion_after", "ioff_after", "area_after",
    "mask_l",     "mask_w",     "print",     "verdict"};

/* ---- work: JSON elements ---- */

/* Append `, "name": `, without a comma after a bracket. */
static void append_member(GString *out, const char *name) {
  char last = out->len ? out->str[out->len - 1] : '{';
  g_string_append(out, last == '{' || last == '[' ? "" : ", ");
  json_text(out, name);
  g_string_append(out, ": ");
}

static void text_member(GString *out, const char *name, const char *text) {
  append_member(out, name);
  json_text(out, text);
}

static void number_member(GString *out, const char *name, double x) {
  append_member(out, name);
  json_number(out, x, 9);
}

static void open_member(GString *out, const char *name, char bracket) {
  append_member(out, name);
  g_string_append_c(out, bracket);
}

/* Append the next element of a list. */
static void open_element(GString *out) {
  g_string_append(out, out->str[out->len - 1] == '[' ? "{" : ",\n {");
}

/* ---- work: tables ---- */

static int is_wanted(const char *table, const char *column) {
  if (strcmp(table, "gates") != 0) return 1;
  for (size_t k = 0; k < G_N_ELEMENTS(gate_columns); k++)
    if (!strcmp(gate_columns[k], column)) return 1;
  return 0;
}

/* Append a column: numbers if all cells are numbers, else texts; null for empty
   cells. */
static void add_column(GString *out, eda_table *t, size_t column) {
  const double *number = eda_table_numbers(t, column);
  const char *unit = eda_table_unit(t, column);
  open_element(out);
  text_member(out, "name", eda_table_name(t, column));
  text_member(out, "unit", *unit ? unit : NULL);
  open_member(out, "values", '[');
  for (size_t i = 0; i < eda_table_rows(t); i++) {
    const char *text = eda_table_text(t, i, column);
    if (i) g_string_append_c(out, ',');
    if (number)
      json_number(out, number[i], 9);
    else
      json_text(out, *text ? text : NULL);
  }
  g_string_append(out, "]}");
}

static int add_tables(GString *out, eda_run *run, opc_error *error) {
  open_member(out, "tables", '{');
  for (size_t k = 0; k < G_N_ELEMENTS(tables); k++) {
    if (!eda_run_has_table(run, tables[k])) continue;
    eda_table *t = eda_run_table(run, tables[k], error);
    if (!t) return error->code;
    open_member(out, tables[k], '{');
    number_member(out, "rows", (double)eda_table_rows(t));
    open_member(out, "columns", '[');
    for (size_t c = 0; c < eda_table_columns(t); c++)
      if (is_wanted(tables[k], eda_table_name(t, c))) add_column(out, t, c);
    g_string_append(out, "]}");
  }
  g_string_append(out, "}");
  return OPC_OK;
}

/* ---- work: facts ---- */

static void add_metrics(GString *out, const eda_run_facts *f) {
  static const char *const better[] = {"neutral", "lower", "higher"};
  open_member(out, "metrics", '{');
  for (size_t i = 0; i < f->n_metrics; i++) {
    const eda_run_metric *m = &f->metrics[i];
    open_member(out, m->name, '{');
    append_member(out, "value");
    json_number(out, m->value, 17);
    text_member(out, "unit", m->unit);
    text_member(out, "better", better[m->better]);
    number_member(out, "tolerance", m->tolerance);
    g_string_append_c(out, '}');
  }
  g_string_append_c(out, '}');
}

static void add_parameters(GString *out, const eda_run_facts *f) {
  open_member(out, "parameters", '{');
  for (size_t i = 0; i < f->n_parameters; i++)
    text_member(out, f->parameters[i].name, f->parameters[i].value);
  g_string_append_c(out, '}');
}

static void add_verdicts(GString *out, const eda_run_facts *f) {
  open_member(out, "findings", '[');
  for (size_t i = 0; i < f->n_findings; i++) {
    open_element(out);
    text_member(out, "step", f->findings[i].step);
    text_member(out, "text", f->findings[i].text);
    g_string_append_c(out, '}');
  }
  g_string_append_c(out, ']');
  open_member(out, "requirements", '[');
  for (size_t i = 0; i < f->n_requirements; i++) {
    const eda_run_requirement *r = &f->requirements[i];
    open_element(out);
    text_member(out, "metric", r->metric);
    text_member(out, "required", r->required);
    number_member(out, "value", r->value);
    text_member(out, "unit", r->unit);
    append_member(out, "kept");
    g_string_append(out, r->kept ? "true}" : "false}");
  }
  g_string_append_c(out, ']');
}

static void add_origins(GString *out, const eda_run_facts *f) {
  open_member(out, "inputs", '[');
  for (size_t i = 0; i < f->n_inputs; i++) {
    open_element(out);
    text_member(out, "path", f->inputs[i].path);
    text_member(out, "sha256", f->inputs[i].sha256);
    g_string_append_c(out, '}');
  }
  g_string_append_c(out, ']');
  open_member(out, "plugins", '[');
  for (size_t i = 0; i < f->n_plugins; i++) {
    open_element(out);
    text_member(out, "id", f->plugins[i].id);
    text_member(out, "version", f->plugins[i].version);
    text_member(out, "sha256", f->plugins[i].sha256);
    g_string_append_c(out, '}');
  }
  g_string_append_c(out, ']');
  open_member(out, "steps", '[');
  for (size_t i = 0; i < f->n_steps; i++) {
    open_element(out);
    text_member(out, "name", f->steps[i].name);
    number_member(out, "seconds", f->steps[i].seconds);
    g_string_append_c(out, '}');
  }
  g_string_append_c(out, ']');
}

/* ---- work: pictures ---- */

/* Add the pictures of view.json. The file is not trusted: it is parsed, and `<`
   is escaped. */
static int add_view(page *p, GString *out, const char *folder,
                    const char *label, opc_error *error) {
  g_autofree char *path = g_build_filename(folder, "view.json", NULL);
  g_autofree char *text = NULL;
  g_autoptr(JsonParser) parser = json_parser_new_immutable();
  g_autoptr(GError) fault = NULL;
  gsize size;
  if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
    page_lacks(p,
               "%s: no pictures, because view.json is missing (add the step "
               "report.view)",
               label);
    return OPC_OK;
  }
  if (!g_file_get_contents(path, &text, &size, &fault))
    return opc_fail(error, OPC_IO, NULL, "%s", fault->message);
  if ((double)size > p->capacity) {
    page_lacks(
        p,
        "%s: pictures of %.1f MB omitted, because the page would be too large",
        label, (double)size / 1e6);
    return OPC_OK;
  }
  if (!json_parser_load_from_data(parser, text, (gssize)size, &fault))
    return opc_fail(error, OPC_INVALID, NULL, "'%s': %s", path, fault->message);
  JsonNode *root = json_parser_get_root(parser);
  JsonObject *o =
      root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_get_object(root) : NULL;
  if (!o || json_object_get_int_member_with_default(o, "view", 0) != 1)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s' is not a view of a mask of format 1", path);
  p->capacity -= (double)size;
  append_member(out, "view");
  for (gsize i = 0; i < size; i++)
    if (text[i] == '<')
      g_string_append(out, "\\u003c");
    else
      g_string_append_c(out, text[i]);
  return OPC_OK;
}

/* ---- work: runs ---- */

/* Return a label that no other run of the page has. */
static char *label_of(page *p, const char *name) {
  char *label = g_strdup(name);
  for (int k = 2; !g_hash_table_add(p->labels, g_strdup(label)); k++) {
    g_free(label);
    label = g_strdup_printf("%s (%d)", name, k);
  }
  return label;
}

static char *name_of(const eda_run_facts *f, const char *folder, int running) {
  if (running && f->variant)
    return g_strdup_printf("%s-%s", f->name, f->variant);
  if (running) return g_strdup(f->name);
  g_autofree char *canonical = g_canonicalize_filename(folder, NULL);
  return g_path_get_basename(canonical);
}

static int add_facts(page *p, GString *out, eda_run *run, const char *label,
                     const char *method, int running, opc_error *error) {
  const eda_run_facts *f = eda_run_info(run);
  text_member(out, "label", label);
  text_member(out, "method", method ? method : label);
  text_member(out, "folder", running ? NULL : f->folder);
  text_member(out, "name", f->name);
  text_member(out, "variant", f->variant);
  text_member(out, "version", f->version);
  text_member(out, "started", f->started);
  text_member(out, "failure", running ? NULL : f->failure);
  append_member(out, "running");
  g_string_append(out, running ? "true" : "false");
  number_member(out, "seconds", running ? NAN : eda_run_time(run));
  number_member(out, "threads", (double)f->threads);
  add_metrics(out, f);
  add_parameters(out, f);
  add_verdicts(out, f);
  add_origins(out, f);
  int code = add_tables(out, run, error);
  if (!code && !eda_run_has_table(run, "gates"))
    page_lacks(p, "%s: no charts of transistors, because gates.csv is missing",
               label);
  return code ? code : add_view(p, out, f->folder, label, error);
}

int page_add_run(page *p, const char *folder, const char *of_case,
                 const char *method, int running, opc_error *error) {
  eda_run *run = eda_run_open(folder, error);
  if (!run) return error->code;
  g_autofree char *name =
      method && of_case ? g_strdup_printf("%s, %s", of_case, method)
      : method          ? g_strdup(method)
                        : name_of(eda_run_info(run), folder, running);
  g_autofree char *label = label_of(p, name);
  g_autoptr(GString) out = g_string_new("{");
  text_member(out, "case", of_case ? of_case : "");
  int code = add_facts(p, out, run, label, method, running, error);
  if (!running && !eda_run_info(run)->failure) {
    g_ptr_array_add(p->places, g_strdup(of_case ? of_case : ""));
    g_ptr_array_add(p->places, g_strdup(method ? method : label));
    g_ptr_array_add(p->places, g_strdup(folder));
  }
  eda_run_free(run);
  if (code) return code;
  g_string_append_printf(p->runs, "%s%s}", p->runs->len ? ",\n" : "", out->str);
  return OPC_OK;
}

static int add_experiment(page *p, const char *folder, opc_error *error) {
  eda_run_cases *cases = eda_run_cases_open(folder, error);
  if (!cases) return error->code;
  size_t n;
  const eda_run_case *all = eda_run_cases_all(cases, &n);
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++)
    if (all[i].folder)
      code =
          page_add_run(p, all[i].folder, all[i].name, all[i].method, 0, error);
    else
      page_lacks(p, "%s, %s: %s", all[i].name, all[i].method, all[i].result);
  eda_run_cases_free(cases);
  return code;
}

int page_add(page *p, const char *folder, opc_error *error) {
  if (eda_run_is_experiment(folder)) return add_experiment(p, folder, error);
  return page_add_run(p, folder, NULL, NULL, 0, error);
}

void page_lacks(page *p, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *text = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  g_string_append(p->missing, p->missing->len ? ", " : "");
  json_text(p->missing, text);
}

/* ---- work: verdicts ---- */

/* Return the place of a text in an array, added if new. */
static size_t place_of(GPtrArray *texts, char *text) {
  guint at;
  if (g_ptr_array_find_with_equal_func(texts, text, g_str_equal, &at))
    return at;
  g_ptr_array_add(texts, text);
  return texts->len - 1;
}

static void add_change(GString *out, const eda_change *c) {
  open_member(out, c->name, '{');
  text_member(out, "title", c->title);
  text_member(out, "unit", c->unit);
  number_member(out, "base", c->base);
  number_member(out, "value", c->value);
  number_member(out, "change", c->change);
  number_member(out, "median", c->median.value);
  number_member(out, "low", c->median.low);
  number_member(out, "high", c->median.high);
  number_member(out, "independent", (double)c->median.n);
  text_member(out, "verdict", c->word);
  g_string_append_c(out, '}');
}

static void add_verdict(GString *out, const eda_verdict *v) {
  open_element(out);
  text_member(out, "method", v->method);
  text_member(out, "against", v->against);
  text_member(out, "text", v->text);
  open_member(out, "changes", '{');
  for (int i = 0; i < EDA_CHANGES; i++)
    if (v->changes[i].n) add_change(out, &v->changes[i]);
  g_string_append(out, "}}");
}

/* Append the verdicts on the methods of the page, without those that have no
   transistors in common. */
static void add_all_verdicts(page *p, GString *out) {
  g_autoptr(GPtrArray) cases = g_ptr_array_new();
  g_autoptr(GPtrArray) methods = g_ptr_array_new();
  char *const *place = (char *const *)p->places->pdata;
  opc_error error = {0};
  size_t n;
  for (guint i = 0; i < p->places->len; i += 3) {
    place_of(cases, place[i]);
    place_of(methods, place[i + 1]);
  }
  g_autofree const char **folders =
      g_new0(const char *, (gsize)cases->len * methods->len + 1);
  for (guint i = 0; i < p->places->len; i += 3)
    folders[place_of(cases, place[i]) * methods->len +
            place_of(methods, place[i + 1])] = place[i + 2];
  eda_verdict *v = eda_verdicts_new(cases->len, methods->len,
                                    (const char *const *)methods->pdata,
                                    folders, &n, &error);
  if (!v) {
    page_lacks(p, "no verdicts: %s", error.message);
    return;
  }
  for (size_t i = 0; i < n; i++)
    if (v[i].changes[EDA_CHANGE_ION].n) add_verdict(out, &v[i]);
  eda_verdicts_free(v, n);
}

/* ---- work: the page ---- */

void page_init(page *p, double megabytes) {
  /* A third is reserved for tables and the page itself. */
  *p = (page){g_string_new(NULL), g_string_new(NULL),
              g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL),
              g_ptr_array_new_with_free_func(g_free), megabytes * 1e6 * 2 / 3};
}

void page_clear(page *p) {
  g_string_free(p->runs, TRUE);
  g_string_free(p->missing, TRUE);
  g_hash_table_unref(p->labels);
  g_ptr_array_free(p->places, TRUE);
}

/* Append the contents of all page files with the suffix `end`, in place of
   @STYLE@ or @SCRIPT@. */
static void append_files(GString *out, const char *end) {
  for (size_t i = 0; i < G_N_ELEMENTS(samples); i++)
    if (g_str_has_suffix(samples[i].name, end))
      g_string_append_len(out, samples[i].bytes, (gssize)samples[i].size);
}

static void append_data(page *p, const char *title, GString *out) {
  g_autoptr(GString) verdicts = g_string_new("[");
  add_all_verdicts(p, verdicts);
  g_string_append(out, "{\"report\": 1");
  text_member(out, "opcflow", OPC_VERSION);
  text_member(out, "title", title);
  g_string_append_printf(
      out, ", \"missing\": [%s],\n\"verdicts\": %s],\n\"runs\": [\n%s]}",
      p->missing->str, verdicts->str, p->runs->str);
}

int page_write(page *p, const char *title, const char *path, opc_error *error) {
  g_autoptr(GString) frame = g_string_new(NULL), out = g_string_new(NULL);
  g_autoptr(GError) fault = NULL;
  append_files(frame, ".html");
  for (const char *at = frame->str; *at;)
    if (g_str_has_prefix(at, "@STYLE@")) {
      append_files(out, ".css");
      at += strlen("@STYLE@");
    } else if (g_str_has_prefix(at, "@DATA@")) {
      append_data(p, title, out);
      at += strlen("@DATA@");
    } else if (g_str_has_prefix(at, "@SCRIPT@")) {
      append_files(out, ".js");
      at += strlen("@SCRIPT@");
    } else {
      g_string_append_c(out, *at++);
    }
  if (g_file_set_contents(path, out->str, (gssize)out->len, &fault))
    return OPC_OK;
  return opc_fail(error, OPC_IO, "file", "%s", fault->message);
}
