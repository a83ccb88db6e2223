/* SPDX-License-Identifier: BSD-3-Clause */
/* Publishes the runs, parameters, transistors and masks of a comparison as
   tables. */
#include "tables.h"

#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include "masks.h"
#include "same.h"

int put_table(comparison *c, const char *name, size_t rows, size_t size,
              const opc_column *columns, size_t n, opc_error *error) {
  size_t skip = !c->field.experiment;       /* omit the column of cases */
  skip += skip && c->field.pairs->len == 1; /* omit the column of methods for a
                                               single pair */
  return rows ? opc_put_rows(c->host, name, OPC_TABLE_PRINT, rows, size,
                             columns + skip, n - skip, error)
              : OPC_OK;
}

/* Publish a table whose first column is the method; return the status. */
static int put_of_methods(comparison *c, const char *name, size_t rows,
                          size_t size, const opc_column *columns, size_t n,
                          opc_error *error) {
  size_t skip = !c->field.experiment && c->field.pairs->len == 1;
  return rows ? opc_put_rows(c->host, name, OPC_TABLE_PRINT, rows, size,
                             columns + skip, n - skip, error)
              : OPC_OK;
}

/* ---- runs ---- */

typedef struct run_row {
  const char *label, *folder, *variant, *version;
  double seconds;
  const char *started;
} run_row;

int runs_publish(comparison *c, opc_error *error) {
  const field *f = &c->field;
  g_autofree run_row *r = g_new0(run_row, f->runs->len);
  for (guint i = 0; i < f->runs->len; i++) {
    const eda_run_facts *t = eda_run_info(f->runs->pdata[i]);
    r[i] = (run_row){f->labels->pdata[i],
                     t->folder,
                     t->variant,
                     t->version,
                     eda_run_time(f->runs->pdata[i]),
                     t->started};
  }
  const opc_column columns[] = {{"run", NULL, OPC_TEXT, 0, &r->label},
                                {"folder", NULL, OPC_TEXT, 0, &r->folder},

                                {"variant", NULL, OPC_TEXT, 0, &r->variant},
                                {"opcflow", NULL, OPC_TEXT, 0, &r->version},
                                {"seconds", "s", OPC_REAL, 2, &r->seconds},
                                {"started", NULL, OPC_TEXT, 0, &r->started}};
  return opc_put_rows(c->host, "runs", OPC_TABLE_PRINT, f->runs->len, sizeof *r,
                      columns, G_N_ELEMENTS(columns), error);
}

/* ---- parameters ---- */

typedef struct parameter_row {
  const char *method, *name, *base, *value;
} parameter_row;

/* Return 1 if the table lists a parameter that one run lacks. If the run lacks
   the whole step, only the plugin of the step is listed; otherwise plugins of
   slots and values given by the user. */
static int is_shown(const eda_run *without, const eda_run_parameter *p) {
  g_autofree char *step =
      g_strdup_printf("%.*s.use", (int)strcspn(p->name, "."), p->name);
  if (!eda_run_parameter_of(without, step)) return !strcmp(p->name, step);
  return p->given || g_str_has_suffix(p->name, ".use");
}

static int parameters_differ(const pair *p, const eda_run_parameter *a,
                             const eda_run_parameter *b) {
  const char *x = same_content(p->base, a), *y = same_content(p->other, b);
  return x && y ? strcmp(x, y) != 0 : strcmp(a->value, b->value) != 0;
}

static void add_parameters(GArray *out, const pair *p) {
  const eda_run_facts *a = eda_run_info(p->base), *b = eda_run_info(p->other);
  for (size_t i = 0; i < a->n_parameters; i++) {
    const eda_run_parameter *x = &a->parameters[i];
    const eda_run_parameter *y = eda_run_parameter_of(p->other, x->name);
    if (y ? !parameters_differ(p, x, y) : !is_shown(p->other, x)) continue;
    const parameter_row row = {p->method, x->name, x->value,
                               y ? y->value : NULL};
    g_array_append_val(out, row);
  }
  for (size_t i = 0; i < b->n_parameters; i++) {
    const eda_run_parameter *y = &b->parameters[i];
    if (eda_run_parameter_of(p->base, y->name) || !is_shown(p->base, y))
      continue;
    const parameter_row row = {p->method, y->name, NULL, y->value};
    g_array_append_val(out, row);
  }
}

/* Return whether an earlier pair has the same method. */
static int is_repeated(const field *f, guint i) {
  const char *method = g_array_index(f->pairs, pair, i).method;
  while (i-- > 0)
    if (!strcmp(method, g_array_index(f->pairs, pair, i).method)) return 1;
  return 0;
}

/* In an experiment, the first case of each method is compared. With more than
   two methods, the table is written to a file but not printed, because it is
   long. */
int parameters_publish(comparison *c, opc_error *error) {
  const field *f = &c->field;
  g_autoptr(GArray) all = ROWS(parameter_row);
  for (guint i = 0; i < f->pairs->len; i++)
    if (!is_repeated(f, i))
      add_parameters(all, &g_array_index(f->pairs, pair, i));
  const parameter_row *r = (const parameter_row *)(void *)all->data;
  uint32_t flags = f->experiment && f->methods > 2 ? 0 : OPC_TABLE_PRINT;
  size_t skip = !f->experiment && f->pairs->len == 1;
  const opc_column columns[] = {{"run", NULL, OPC_TEXT, 0, &r->method},
                                {"parameter", NULL, OPC_TEXT, 0, &r->name},
                                {"base", NULL, OPC_TEXT, 0, &r->base},
                                {"value", NULL, OPC_TEXT, 0, &r->value}};
  return all->len
             ? opc_put_rows(c->host, "parameters", flags, all->len, sizeof *r,
                            columns + skip, G_N_ELEMENTS(columns) - skip, error)
             : OPC_OK;
}

/* ---- transistors ---- */

/* Add the verdict on a method over all cases, and the statistics of its
   transistors. */
static int add_verdict(comparison *c, const char *method, opc_error *error) {
  const field *f = &c->field;
  g_autoptr(GArray) pairs = ROWS(eda_run_pair);
  eda_verdict v;
  for (guint i = 0; i < f->pairs->len; i++) {
    const pair *p = &g_array_index(f->pairs, pair, i);
    const eda_run_pair runs = {p->base, p->other};
    if (!strcmp(p->method, method)) g_array_append_val(pairs, runs);
  }
  const eda_run_pair *all = (const eda_run_pair *)(void *)pairs->data;
  int code = eda_verdict_init(&v, method, *f->base ? f->base : "the base",
                              pairs->len, all, error);
  for (int i = EDA_CHANGE_ION; i <= EDA_CHANGE_AREA && !code; i++) {
    const transistor_row row = {method, v.changes[i]};
    if (row.c.n) g_array_append_val(c->intervals, row);
  }
  g_ptr_array_add(c->sentences, g_strdup(v.text));
  eda_verdict_clear(&v);
  return code;
}

int transistors_publish(comparison *c, opc_error *error) {
  const field *f = &c->field;
  int code = OPC_OK;
  for (guint i = 0; i < f->pairs->len && !code; i++)
    if (!is_repeated(f, i))
      code = add_verdict(c, g_array_index(f->pairs, pair, i).method, error);
  const transistor_row *r = (const transistor_row *)(void *)c->intervals->data;
  const opc_column columns[] = {
      {"run", NULL, OPC_TEXT, 0, &r->method},
      {"figure", NULL, OPC_TEXT, 0, &r->c.name},
      {"base", "%", OPC_REAL, 4, &r->c.base},
      {"value", "%", OPC_REAL, 4, &r->c.value},
      {"change", "%", OPC_REAL, 4, &r->c.change},
      {"median", "%", OPC_REAL, 4, &r->c.median.value},
      {"low", "%", OPC_REAL, 4, &r->c.median.low},
      {"high", "%", OPC_REAL, 4, &r->c.median.high},
      {"verdict", NULL, OPC_TEXT, 0, &r->c.word},
      {"better", NULL, OPC_INT, 0, &r->c.better},
      {"worse", NULL, OPC_INT, 0, &r->c.worse},
      {"same", NULL, OPC_INT, 0, &r->c.same},
      {"transistors", NULL, OPC_INT, 0, &r->c.n},
      {"cells", NULL, OPC_INT, 0, &r->c.median.n}};
  return code ? code
              : put_of_methods(c, "transistors", c->intervals->len, sizeof *r,
                               columns, G_N_ELEMENTS(columns), error);
}

int verdicts_publish(comparison *c, opc_error *error) {
  const opc_column column = {"verdict", NULL, OPC_TEXT, 0, c->sentences->pdata};
  return opc_put_table(c->host, "verdicts", OPC_TABLE_PRINT, c->sentences->len,
                       &column, 1, error);
}

/* ---- masks ---- */

typedef struct mask_row {
  const char *method, *layer;
  mask_difference d;
  double shots_base, shots; /* NAN if a run has no table of costs */
} mask_row;

static eda_table *open_cost(eda_run *run) {
  opc_error none;
  return eda_run_has_table(run, "cost") ? eda_run_table(run, "cost", &none)
                                        : NULL;
}

/* Return the name of the layer number in parameters with the prefix `start`;
   NULL if there is none. */
static const char *named_by(const eda_run *run, const char *start,
                            const mask_difference *d) {
  const eda_run_facts *f = eda_run_info(run);
  g_autofree char *number = g_strdup_printf("%u/%u", d->layer, d->datatype);
  for (size_t i = 0; i < f->n_parameters; i++) {
    const char *name = f->parameters[i].name;
    const char *at = strstr(name, ".layers.");
    if (at && g_str_has_prefix(name, start) &&
        !strcmp(f->parameters[i].value, number))
      return at + strlen(".layers.");
  }
  return NULL;
}

/* Return the name of a layer, or NULL. The name is searched in the parameters
   of the step that wrote the mask. Then the default numbers of the first two
   layers (see eda_gates_number) are searched in the table of costs. The
   parameters of all other steps come last. */
static const char *layer_name(eda_run *run, const char *step,
                              const mask_difference *d) {
  static const uint32_t numbers[] = {9, 1};
  g_autofree char *own = g_strconcat(step, ".", NULL);
  const char *name = named_by(run, own, d);
  eda_table *t = name || d->datatype ? NULL : open_cost(run);
  int column = t ? eda_table_find(t, "layer") : -1;
  for (size_t i = 0; column >= 0 && i < G_N_ELEMENTS(numbers); i++)
    if (d->layer == numbers[i] && i < eda_table_rows(t))
      name = eda_table_text(t, i, (size_t)column);
  return name ? name : named_by(run, "", d);
}

/* Return the number of shots of a layer in the table cost; NAN if unknown. */
static double shots_of(eda_run *run, const char *layer) {
  eda_table *t = open_cost(run);
  int name = t ? eda_table_find(t, "layer") : -1;
  int shots = t ? eda_table_find(t, "shots") : -1;
  const double *numbers =
      name < 0 || shots < 0 ? NULL : eda_table_numbers(t, (size_t)shots);
  for (size_t i = 0; numbers && i < eda_table_rows(t); i++)
    if (!strcmp(eda_table_text(t, i, (size_t)name), layer)) return numbers[i];
  return NAN;
}

/* Add a layer of one case to the row of the method, with sums over cases. */
static void add_mask(GArray *out, const pair *p, const char *step,
                     const mask_difference *d) {
  const char *name = layer_name(p->base, step, d);
  mask_row row = {.method = p->method,
                  .layer = name ? name : "",
                  .d = *d,
                  .shots_base = name ? shots_of(p->base, name) : NAN,
                  .shots = name ? shots_of(p->other, name) : NAN};
  for (guint i = 0; i < out->len; i++) {
    mask_row *r = &g_array_index(out, mask_row, i);
    if (strcmp(r->method, row.method) != 0 || r->d.layer != d->layer ||
        r->d.datatype != d->datatype)
      continue;
    r->d.base += d->base;
    r->d.other += d->other;
    r->d.area += d->area;
    r->d.places += d->places;
    r->d.rectangles += d->rectangles;
    r->shots_base += row.shots_base;
    r->shots += row.shots;
    return;
  }
  g_array_append_val(out, row);
}

static int add_masks(GArray *out, const pair *p, const char *step,
                     const char *base, const char *other, opc_error *error) {
  const char *from = eda_run_info(p->base)->folder;
  const char *to = eda_run_info(p->other)->folder;
  g_autofree char *one = g_build_filename(from, base, NULL);
  g_autofree char *two = g_build_filename(to, other, NULL);
  mask_difference *d;
  size_t n;
  if (masks_compare(one, two, &d, &n, error)) return error->code;
  for (size_t i = 0; i < n; i++) add_mask(out, p, step, &d[i]);
  free(d);
  return OPC_OK;
}

/* Return the mask file written by a step write.gds; NULL if there is none. */
static const char *mask_file(const eda_run *run, const char *step) {
  g_autofree char *use = g_strconcat(step, ".use", NULL);
  g_autofree char *mask = g_strconcat(step, ".mask", NULL);
  g_autofree char *file = g_strconcat(step, ".file", NULL);
  const eda_run_parameter *plugin = eda_run_parameter_of(run, use);
  const eda_run_parameter *name = eda_run_parameter_of(run, file);
  if (!plugin || !name || strcmp(plugin->value, "write.gds") != 0 ||
      !eda_run_parameter_of(run, mask))
    return NULL;
  const eda_run_facts *f = eda_run_info(run);
  for (size_t i = 0; i < f->n_files; i++)
    if (!strcmp(f->files[i].path, name->value)) return name->value;
  return NULL;
}

/* Compare the masks of the first step that wrote a mask in both runs. */
static int compare_masks(GArray *out, const pair *p, opc_error *error) {
  const eda_run_facts *f = eda_run_info(p->base);
  for (size_t i = 0; i < f->n_parameters; i++) {
    const char *name = f->parameters[i].name;
    const char *dot = strchr(name, '.');
    if (!dot || strcmp(dot, ".use") != 0) continue;
    g_autofree char *step = g_strndup(name, (gsize)(dot - name));
    const char *a = mask_file(p->base, step), *b = mask_file(p->other, step);
    if (a && b) return add_masks(out, p, step, a, b, error);
  }
  return OPC_OK;
}

int masks_publish(comparison *c, opc_error *error) {
  const field *f = &c->field;
  g_autoptr(GArray) all = ROWS(mask_row);
  int code = OPC_OK;
  for (guint i = 0; i < f->pairs->len && !code; i++)
    code = compare_masks(all, &g_array_index(f->pairs, pair, i), error);
  if (code) return code;
  /* Remove layers without a difference, such as drawn and uncorrected
     layers. */
  for (guint i = all->len; i-- > 0;)
    if (!c->all && g_array_index(all, mask_row, i).d.area == 0)
      g_array_remove_index(all, i);
  g_autoptr(GPtrArray) numbers = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < all->len; i++) {
    mask_row *m = &g_array_index(all, mask_row, i);
    if (*m->layer) continue;
    m->layer = g_strdup_printf("%u/%u", m->d.layer, m->d.datatype);
    g_ptr_array_add(numbers, (char *)m->layer);
  }
  const mask_row *r = (const mask_row *)(void *)all->data;
  const opc_column columns[] = {
      {"run", NULL, OPC_TEXT, 0, &r->method},
      {"layer", NULL, OPC_TEXT, 0, &r->layer},
      {"area_base", "um^2", OPC_REAL, 4, &r->d.base},
      {"area", "um^2", OPC_REAL, 4, &r->d.other},
      {"differs", "um^2", OPC_REAL, 4, &r->d.area},
      {"places", NULL, OPC_INT, 0, &r->d.places},
      {"rectangles", NULL, OPC_INT, 0, &r->d.rectangles},
      {"shots_base", NULL, OPC_REAL, 0, &r->shots_base},
      {"shots", NULL, OPC_REAL, 0, &r->shots}};
  return put_of_methods(c, "masks", all->len, sizeof *r, columns,
                        G_N_ELEMENTS(columns), error);
}
