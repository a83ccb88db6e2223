/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of device tables (docs/reference/devices.md). Reports the first fault
   of a file and the number of further faults. */
#include <base/range.h>
#include <base/unit.h>
#include <eda/devices.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
  eda_devices *devices; /* current table */
  eda_devices *first;   /* first table of the file */
  opc_problems *problems;
} reader;

/* ---- nodes of the file ---- */

/* Return the map `key` of `parent`. Report keys that are not in `known`. Report
   a fault and return NULL if there is no such map. */
static const opc_node *get_map(reader *r, const opc_node *parent,
                               const char *key, const char *known) {
  const opc_node *node = opc_node_get(parent, key);
  if (node && node->type == OPC_NODE_MAP) {
    opc_node_check_keys(node, known, "", r->problems);
    return node;
  }
  opc_wrong(r->problems, node ? node : parent,
            node ? "'%s' needs a map" : "missing '%s'", key);
  return NULL;
}

/* Return whether a node is a text that is not empty. `wanted` followed by
   `rest` describes the expected text in the message. */
static gboolean is_text(reader *r, const opc_node *node, const char *key,
                        const char *wanted, const char *rest) {
  if (node->type != OPC_NODE_TEXT)
    return opc_wrong(r->problems, node, "'%s' requires %s%s, found %s", key,
                     wanted, rest, opc_node_noun(node));
  return !opc_node_is_empty(node) ||
         opc_wrong(r->problems, node, "'%s' has no value", key);
}

/* ---- numbers ---- */

/* Read a number and convert to the unit `in`. `given` is the unit of the
   column, or NULL if the text contains the unit. */
static gboolean read_number(reader *r, const opc_node *node, const char *key,
                            const char *given, const char *in,
                            gboolean positive, double *out) {
  if (!is_text(r, node, key, opc_unit_noun(opc_unit_find(in)),
               " with a unit") ||
      !opc_quantity_read(node, given, in, key, out, r->problems))
    return FALSE;
  return !positive || *out > 0 ||
         opc_wrong(r->problems, node, "'%s' must be above 0 %s, found '%s%s%s'",
                   key, in, node->text, given ? " " : "", given ? given : "");
}

/* Read the numbers of a list, each above 0, to *out. Advance *out. */
static gboolean read_items(reader *r, const opc_node *list, const char *key,
                           const char *given, const char *in, double **out) {
  gboolean good = TRUE;
  for (guint i = 0; i < list->items->len; i++)
    good &=
        read_number(r, list->items->pdata[i], key, given, in, TRUE, (*out)++);
  return good;
}

static gboolean is_list(const opc_node *node) {
  return node && node->type == OPC_NODE_LIST;
}

/* Return the list of values of `{ unit: nm, values: [...] }`, and the unit.
   Report a fault and return NULL if the form differs. */
static const opc_node *get_list(reader *r, const opc_node *parent,
                                const char *key, const char *in,
                                const char **given) {
  const opc_node *map = get_map(r, parent, key, "unit|values");
  if (!map) return NULL;
  const opc_node *of = opc_node_get(map, "unit");
  const opc_node *list = opc_node_get(map, "values");
  if (of && of->type == OPC_NODE_TEXT && is_list(list)) {
    *given = of->text;
    return list;
  }
  opc_wrong(r->problems, map, "'%s' must be '{ unit: %s, values: [...] }'", key,
            in);
  return NULL;
}

/* Return the values of a column in the unit `in`, each above 0 (free()). Report
   a fault and return NULL if a value is not valid. */
static double *get_column(reader *r, const opc_node *parent, const char *key,
                          const char *in, size_t *count) {
  const char *given;
  const opc_node *list = get_list(r, parent, key, in, &given);
  if (!list) return NULL;
  *count = list->items->len;
  double *column = eda_alloc(*count, sizeof *column), *to = column;
  if (read_items(r, list, key, given, in, &to)) return column;
  free(column);
  return NULL;
}

/* Return the values of a list of rows, each with `columns` numbers, in the unit
   `in` (free()). Report a fault and return NULL if a row is not valid. */
static double *get_rows(reader *r, const opc_node *parent, const char *key,
                        const char *in, size_t rows, size_t columns) {
  const char *given;
  const opc_node *list = get_list(r, parent, key, in, &given);
  if (!list) return NULL;
  if (list->items->len != rows) {
    opc_wrong(r->problems, list,
              "'%s' has %u lists, expected %zu as in 'width'", key,
              list->items->len, rows);
    return NULL;
  }
  double *all = eda_alloc(rows * columns, sizeof *all), *to = all;
  gboolean good = TRUE;
  for (size_t i = 0; i < rows && good; i++) {
    const opc_node *row = list->items->pdata[i];
    if (!is_list(row) || row->items->len != columns)
      good = opc_wrong(r->problems, row,
                       "'%s' must be a list of %zu values for each width", key,
                       columns);
    else
      good = read_items(r, row, key, given, in, &to);
  }
  if (good) return all;
  free(all);
  return NULL;
}

/* ---- the table ---- */

/* Report each value of a column that is not above the preceding value. `what`
   names the values in the message. */
static void check_rise(reader *r, const opc_node *root, const char *key,
                       const char *what, const double *x, size_t n) {
  const opc_node *list = opc_node_get(opc_node_get(root, key), "values");
  for (size_t i = 1; i < n; i++) {
    const opc_node *item = list->items->pdata[i];
    if (x[i] <= x[i - 1])
      opc_wrong(r->problems, item, "%s must increase: '%s'", what, item->text);
  }
}

static void read_lengths(reader *r, const opc_node *root) {
  eda_devices *d = r->devices;
  double *lengths = get_column(r, root, "length", "nm", &d->count);
  if (!lengths) return;
  const opc_node *list = opc_node_get(opc_node_get(root, "length"), "values");
  if (d->count < 2)
    opc_wrong(r->problems, list, "'length' must have at least two values");
  check_rise(r, root, "length", "lengths", lengths, d->count);
  d->length = lengths;
}

/* Read one width or a list of widths. The largest width is d->width. */
static void read_widths(reader *r, const opc_node *root) {
  eda_devices *d = r->devices;
  const opc_node *node = opc_node_get(root, "width");
  size_t count = 0;
  if (!node) opc_wrong(r->problems, root, "missing 'width'");
  if (!node) return;
  if (node->type != OPC_NODE_MAP) {
    read_number(r, node, "width", NULL, "nm", TRUE, &d->width);
    return;
  }
  double *widths = get_column(r, root, "width", "nm", &count);
  if (!widths) return;
  if (count < 2)
    opc_wrong(r->problems, node,
              "a list of widths must have at least two values");
  check_rise(r, root, "width", "widths", widths, count);
  if (count) d->width = widths[count - 1];
  d->narrow = count > 1 ? count - 1 : 0;
  d->narrow_width = widths;
}

/* Return a quantity per nm of width at all lengths, for a table of one
   width. */
static double *read_row(reader *r, const opc_node *map, const char *key,
                        const char *in) {
  const eda_devices *d = r->devices;
  size_t count = 0;
  double *row = get_column(r, map, key, in, &count);
  if (row && d->length && count != d->count)
    opc_wrong(r->problems, opc_node_get(map, key),
              "'%s' has %zu values, expected %zu as in 'length'", key, count,
              d->count);
  for (size_t j = 0; row && d->width > 0 && j < count; j++) row[j] /= d->width;
  return row;
}

/* Return a quantity per nm of width at all lengths for the largest width. Write
   the quantity at the narrow widths to *narrow. */
static double *read_rows(reader *r, const opc_node *map, const char *key,
                         const char *in, double **narrow) {
  const eda_devices *d = r->devices;
  if (!d->length) return NULL; /* fault is already reported */
  double *all = get_rows(r, map, key, in, d->narrow + 1, d->count);
  if (!all) return NULL;
  double *wide = eda_alloc(d->count, sizeof *wide);
  for (size_t i = 0; i < d->narrow * d->count; i++)
    all[i] /= d->narrow_width[i / d->count];
  for (size_t i = 0; i < d->count; i++)
    wide[i] = all[d->narrow * d->count + i] / d->width;
  *narrow = all;
  return wide;
}

/* Read all quantities of one transistor type, and divide by the width. */
static void read_type(reader *r, const opc_node *root, const char *key,
                      int type) {
  static const char *const known[] = {"ion", "ioff", "cgate"};
  eda_devices *d = r->devices;
  double **wide[] = {&d->ion[type], &d->ioff[type], &d->cgate[type]};
  double **narrow[] = {&d->narrow_ion[type], &d->narrow_ioff[type],
                       &d->narrow_cgate[type]};
  const opc_node *map = get_map(r, root, key, "ion|ioff|cgate");
  for (int i = 0; map && i < 3; i++) {
    const char *in = i < 2 ? "A" : "F";
    if (i == 2 && !opc_node_get(map, known[i])) continue; /* optional */
    *wide[i] = d->narrow ? read_rows(r, map, known[i], in, narrow[i])
                         : read_row(r, map, known[i], in);
  }
}

/* Detect exchanged columns: at the longest length, Ioff must be below Ion. */
static void check_currents(reader *r, const opc_node *root, const char *key,
                           int type) {
  const eda_devices *d = r->devices;
  if (r->problems->list->len ||
      d->ioff[type][d->count - 1] < d->ion[type][d->count - 1])
    return;
  const opc_node *ioff = opc_node_get(opc_node_get(root, key), "ioff");
  const opc_node *last = opc_node_get(ioff, "values");
  while (is_list(last)) last = last->items->pdata[last->items->len - 1];
  opc_wrong(r->problems, last, "'ioff' at %g nm is not below 'ion'",
            d->length[d->count - 1]);
}

static void read_version(reader *r, const opc_node *node, const char *key) {
  if (!is_text(r, node, key, "a whole number", "")) return;
  const char *text = node->text, *digits = text + (*text == '-');
  if (!*digits || strspn(digits, "0123456789") != strlen(digits))
    opc_wrong(r->problems, node, "'%s' must be a whole number, found '%s'", key,
              text);
  else if (strtoll(text, NULL, 10) != 1)
    opc_wrong(r->problems, node, "'%s' must be at %s 1, found '%s'", key,
              strtoll(text, NULL, 10) < 1 ? "least" : "most", text);
}

/* Check that each table except the first has a unique flavour. */
static void check_flavour(reader *r, const opc_node *root) {
  const eda_devices *d = r->devices, *other = r->first;
  const opc_node *node = opc_node_get(root, "flavour");
  if (!node && d != other)
    opc_wrong(r->problems, root,
              "'flavour' is missing, required for all tables after the first");
  if (!node || !d->flavour) return;
  if (d == other)
    opc_wrong(r->problems, node, "the first table must not have a 'flavour'");
  for (; other != d; other = other->next)
    if (other->flavour && !strcmp(other->flavour, d->flavour))
      opc_wrong(r->problems, node, "a second table of flavour '%s'",
                d->flavour);
}

/* Read the members that are single values. */
static void read_head(reader *r, const opc_node *root) {
  eda_devices *d = r->devices;
  double ignored;
  const struct {
    const char *key;
    char **text; /* receives the text; NULL: ignored */
    const char *unit;
    double *number; /* receives the number in this unit */
    gboolean optional;
  } entries[] = {
      {"name", .text = &d->name},
      {"flavour", .text = &d->flavour, .optional = 1},
      {"supply", .unit = "V", .number = &d->supply},
      {"temperature", .unit = "C", .number = &ignored, .optional = 1},
      {"nmos_modelled", .unit = "nm", .number = &d->modelled[EDA_NMOS],
       .optional = 1},
      {"pmos_modelled", .unit = "nm", .number = &d->modelled[EDA_PMOS],
       .optional = 1},
      {"source", .optional = 1},
      {"extended", .optional = 1},
      {"ion", .optional = 1},
      {"ioff", .optional = 1},
      {"cgate", .optional = 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(entries); i++) {
    const char *key = entries[i].key, *in = entries[i].unit;
    const opc_node *node = opc_node_get(root, key);
    if (!node && !entries[i].optional)
      opc_wrong(r->problems, root, "missing '%s'", key);
    if (!node) continue;
    if (in)
      read_number(r, node, key, NULL, in, strcmp(in, "C") != 0,
                  entries[i].number);
    else if (is_text(r, node, key, "a text", "") && entries[i].text)
      *entries[i].text = g_strdup(node->text);
  }
}

static void read_table(reader *r, const opc_node *root) {
  static const char version_key[] = "opcflow-devices";
  if (root->type != OPC_NODE_MAP) {
    opc_wrong(r->problems, root, "a device table must be a map, found %s",
              opc_node_noun(root));
    return;
  }
  opc_node_check_keys(root,
                      "opcflow-devices|name|flavour|source|supply|temperature|"
                      "width|length|ion|ioff|cgate|extended|nmos|pmos|"
                      "nmos_modelled|pmos_modelled",
                      "", r->problems);
  const opc_node *version = opc_node_get(root, version_key);
  if (version)
    read_version(r, version, version_key);
  else
    opc_wrong(r->problems, root, "missing '%s'", version_key);
  read_head(r, root);
  check_flavour(r, root);
  read_widths(r, root);
  read_lengths(r, root);
  read_type(r, root, "nmos", EDA_NMOS);
  read_type(r, root, "pmos", EDA_PMOS);
  check_currents(r, root, "nmos", EDA_NMOS);
  check_currents(r, root, "pmos", EDA_PMOS);
  if (!r->problems->list->len &&
      !r->devices->cgate[EDA_NMOS] != !r->devices->cgate[EDA_PMOS])
    opc_wrong(r->problems, root, "only one type has 'cgate'");
}

/* ---- the file ---- */

eda_devices *eda_devices_read(const char *path, opc_error *error) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_source *source = opc_source_new(path, "");
  GPtrArray *roots = opc_node_read_all(source, path, problems);
  reader r = {.problems = problems};
  eda_devices **to = &r.first;
  for (guint i = 0; i < roots->len; i++, to = &(*to)->next) {
    r.devices = *to = eda_alloc(1, sizeof **to);
    read_table(&r, roots->pdata[i]);
  }
  g_ptr_array_free(roots, TRUE);
  opc_source_free(source);
  if (!opc_problems_error(problems, error)) return r.first;
  eda_devices_free(r.first);
  return NULL;
}

static void free_table(eda_devices *d) {
  for (int type = 0; type < 2; type++) {
    free(d->ion[type]);
    free(d->ioff[type]);
    free(d->narrow_ion[type]);
    free(d->narrow_ioff[type]);
    free(d->cgate[type]);
    free(d->narrow_cgate[type]);
  }
  free(d->narrow_width);
  free(d->length);
  free(d->name);
  free(d->flavour);
  free(d);
}

void eda_devices_free(eda_devices *d) {
  while (d) {
    eda_devices *next = d->next;
    free_table(d);
    d = next;
  }
}
