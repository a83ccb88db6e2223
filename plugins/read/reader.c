/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the common part of the layout readers; compiled into each. */
#include "reader.h"

#include <eda/formats.h>
#include <eda/memory.h>
#include <eda/pool.h>
#include <eda/words.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONTEXT_CELL "$$$CONTEXT_INFO$$$"

/* Bytes between two updates of progress and checks for cancellation. */
enum { STRETCH = 1 << 20 };

char *reader_string(const void *bytes, size_t n) {
  const char *from = bytes;
  GString *out = g_string_sized_new(n);
  for (size_t i = 0; i < n; i++) {
    size_t start = i;
    while (i < n && from[i] >= 0x20 && from[i] < 0x7f) i++;
    g_string_append_len(out, from + start, (gssize)(i - start));
    if (i < n) g_string_append_printf(out, "\\x%02X", (uint8_t)from[i]);
  }
  return g_string_free(out, FALSE);
}

/* ---- the file ---- */

/* Fail if the file has another known format; the message names the reader for
   that format. */
static void check_format(reading *b) {
  static const struct {
    const char *start;
    size_t n;
    const char *name, *reader;
  } formats[] = {{"\0\6\0\2", 4, "GDSII", "read.gds"},
                 {"%SEMI-OASIS\r\n", 13, "OASIS", "read.oasis"},
                 {"BEGIN", 5, "GLP", "read.glp"}};
  size_t n = 0;
  const uint8_t *first = b->failed ? NULL : reading_view(b, 0, 16, &n);
  for (size_t i = 0; i < G_N_ELEMENTS(formats) && !b->failed; i++)
    if (n >= formats[i].n && !memcmp(first, formats[i].start, formats[i].n) &&
        strcmp(b->format, formats[i].name) != 0)
      b->failed =
          opc_fail(b->error, OPC_IO, NULL,
                   "'%s': is a file of %s, expected %s: use the reader '%s'",
                   b->r->file, formats[i].name, b->format, formats[i].reader);
}

int reading_goes_on(reading *b, size_t at, int show) {
  if (at < b->next_progress || b->failed) return !b->failed;
  const opc_host *host = b->r->host;
  opc_progress progress = {(double)at, (double)b->n, NAN, NULL};
  b->next_progress = at + STRETCH;
  if (show) host->progress(host, &progress);
  if (opc_cancelled(host->context))
    b->failed = opc_fail(b->error, OPC_CANCELLED, NULL, "cancelled");
  return !b->failed;
}

int reading_check(reading *b, int code) {
  if (code && !b->failed) {
    b->refuse(b, b->layout_error.message);
    b->error->code = b->failed = code;
  }
  return !b->failed;
}

int32_t reading_number(reading *b, int32_t number) {
  reading_check(b, number < 0 ? b->layout_error.code : OPC_OK);
  return number;
}

/* ---- layers ---- */

static int same_layer(const char *a, const char *b, uint32_t most) {
  eda_layer_number x, y;
  int any_x, any_y;
  if (!most) return !strcmp(a, b);
  return eda_layer_number_read(a, most, &x, &any_x) &&
         eda_layer_number_read(b, most, &y, &any_y) && any_x == any_y &&
         x.layer == y.layer && x.datatype == y.datatype;
}

/* A layer expression of the map. */
typedef struct reader_expression {
  const reader *r;
  uint32_t most;
  opc_error *error;
  int code;
} reader_expression;

static int is_key(const reader *r, const char *name) {
  for (size_t i = 0; i < r->layers.count; i++)
    if (!strcmp(r->layers.pairs[i].key, name)) return 1;
  return 0;
}

/* Fail for a name in an expression that cannot be a layer of the file. */
static void check_name(void *data, const char *name) {
  reader_expression *x = data;
  eda_layer_number number;
  if (x->code || !x->most || is_key(x->r, name) ||
      eda_layer_number_read(name, x->most, &number, NULL))
    return;
  x->code =
      opc_fail(x->error, OPC_INVALID, NULL,
               "'%s': expected a layer as 9/0, or a name of 'layers'", name);
}

static int check_expression(const reader *r, uint32_t most,
                            const opc_pair *pair, opc_error *error) {
  reader_expression x = {r, most, error, OPC_OK};
  int code = eda_layer_names(pair->value, check_name, &x, error);
  if (!code) code = x.code;
  if (code)
    (void)snprintf(error->parameter, sizeof error->parameter, "layers.%.50s",
                   pair->key);
  return code;
}

int reader_check(const reader *r, uint32_t most, opc_error *error) {
  const opc_pair *pairs = r->layers.pairs;
  for (size_t i = 0; i < r->layers.count; i++) {
    eda_layer_number number;
    int any;
    if (eda_layer_is_expression(pairs[i].value)) {
      int code = check_expression(r, most, &pairs[i], error);
      if (code) return code;
    } else if (most &&
               !eda_layer_number_read(pairs[i].value, most, &number, &any))
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': expected a layer as 9/0, 9 for every datatype, or "
                      "an expression of layers",
                      pairs[i].value);
    if (most && eda_layer_number_read(pairs[i].key, UINT32_MAX, &number, NULL))
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': not allowed as a name, because layers without a "
                      "name have names of this form",
                      pairs[i].key);
    for (size_t j = 0; j < i; j++)
      if (same_layer(pairs[i].value, pairs[j].value, most))
        return opc_fail(error, OPC_INVALID, "layers",
                        "'%s': layer %s is '%s' already", pairs[i].key,
                        pairs[i].value, pairs[j].key);
  }
  return OPC_OK;
}

int32_t reading_named_layer(reading *b, const char *name) {
  const opc_map *map = &b->r->layers;
  for (size_t i = 0; i < map->count; i++) {
    if (strcmp(map->pairs[i].value, name) != 0) continue;
    b->seen[i] = 1;
    name = map->pairs[i].key;
    break;
  }
  return reading_number(b, eda_layout_layer(b->layout, name, &b->layout_error));
}

/* Return the layer of a layer number and datatype. The name is that of the
   entry of `layers` with both numbers, else that of the entry for every
   datatype, else "L/D". */
int32_t reading_numbered_layer(reading *b, uint32_t layer, uint32_t datatype) {
  const opc_map *map = &b->r->layers;
  uint64_t code = (uint64_t)layer << 32 | datatype;
  if (!b->last || b->last->code != code)
    b->last = g_hash_table_lookup(b->layers, &code);
  if (b->last) return b->last->number;
  char buffer[32];
  const char *name = buffer;
  snprintf(buffer, sizeof buffer, "%u/%u", layer, datatype);
  for (int wanted = 0; wanted < 2 && name == buffer; wanted++)
    for (size_t i = 0; i < map->count && name == buffer; i++) {
      eda_layer_number number;
      int any;
      if (!eda_layer_number_read(map->pairs[i].value, UINT32_MAX, &number,
                                 &any) ||
          number.layer != layer || any != wanted ||
          (!any && number.datatype != datatype))
        continue;
      b->seen[i] = 1;
      name = map->pairs[i].key;
    }
  int32_t number =
      reading_number(b, eda_layout_layer(b->layout, name, &b->layout_error));
  if (number < 0) return -1;
  /* If an entry of the map names all datatypes of a layer, the layout keeps the
     first of these datatypes as the layer in the file. */
  if (name != buffer && !strcmp(eda_layout_file_layer(b->layout, number), name))
    eda_layout_set_file_layer(b->layout, number, buffer);
  layer_node *node = eda_alloc(1, sizeof *node);
  *node = (layer_node){code, number};
  g_hash_table_add(b->layers, node);
  b->last = node;
  return number;
}

static int by_code(const void *a, const void *b) {
  const layer_node *x = a, *y = b;
  return (x->code > y->code) - (x->code < y->code);
}

/* Return the name that a layer of the layout has in the file. */
static const char *name_in_file(const reading *b, size_t layer) {
  const opc_map *map = &b->r->layers;
  const char *name = eda_layout_layer_name(b->layout, (int32_t)layer);
  for (size_t i = 0; i < map->count; i++)
    if (!strcmp(map->pairs[i].key, name)) return map->pairs[i].value;
  return name;
}

/* Return 1 if pair i is optional; a missing optional layer becomes empty. */
static int is_optional(const reading *b, size_t i) {
  opc_error ignored;
  const char *name = b->r->layers.pairs[i].key;
  return b->r->optional && eda_in_list(b->r->optional, name) &&
         eda_layout_layer(b->layout, name, &ignored) >= 0;
}

/* Store, for each layer of the map, the layer in the file. Writers use it by
   default. */
static void reading_keep_names(const reading *b) {
  const opc_map *map = &b->r->layers;
  for (size_t i = 0; i < map->count; i++) {
    const char *name = map->pairs[i].key;
    int32_t layer = eda_layout_find_layer(b->layout, name);
    if (layer >= 0 && !strcmp(eda_layout_file_layer(b->layout, layer), name))
      eda_layout_set_file_layer(b->layout, layer, map->pairs[i].value);
  }
}

/* Fail if the file lacks a layer of the map. The message lists the layers of
   the file, sorted by number or name, up to a maximum length. */
static int check_layers(const reading *b) {
  const opc_map *map = &b->r->layers;
  size_t missing = 0;
  while (missing < map->count && (b->seen[missing] || is_optional(b, missing)))
    missing++;
  if (missing == map->count) return OPC_OK;
  enum { MOST = 374 };
  g_autoptr(GString) all = g_string_new(NULL);
  g_autoptr(GList) nodes =
      g_list_sort(g_hash_table_get_keys(b->layers), by_code);
  for (GList *l = nodes; l && all->len < MOST; l = l->next) {
    uint64_t code = ((const layer_node *)l->data)->code;
    g_string_append_printf(all, ", %u/%u", (unsigned)(code >> 32),
                           (unsigned)(code & UINT32_MAX));
  }
  size_t n = nodes ? 0 : eda_layout_layers(b->layout);
  for (size_t i = 0; i < n && all->len < MOST; i++)
    g_string_append_printf(all, ", %.200s", name_in_file(b, i));
  return opc_fail(b->error, OPC_INVALID, "layers",
                  "'%s': no layer %s for '%s'; the file has %s", b->r->file,
                  map->pairs[missing].value, map->pairs[missing].key,
                  all->len ? all->str + 2 : "no layers");
}

/* ---- layer expressions ---- */

/* The layers of the file that an expression names. */
typedef struct operands {
  reading *b;
  size_t found;     /* number of layers that exist */
  const char *file; /* name in the file of the first existing layer */
  GString *missing; /* names of layers that the file lacks */
} operands;

/* A layer that the file lacks becomes an empty layer. */
static void find_operand(void *data, const char *name) {
  operands *o = data;
  eda_layout *layout = o->b->layout;
  opc_error ignored;
  int32_t layer = eda_layout_select(layout, name, &ignored);
  if (layer < 0) {
    g_string_append_printf(o->missing, "%s%s", o->missing->len ? ", " : "",
                           name);
    (void)eda_layout_layer(layout, name, &ignored);
    return;
  }
  if (!o->found++) o->file = eda_layout_file_layer(layout, layer);
}

static void derive_layer(reading *b, size_t i) {
  const opc_pair *pair = &b->r->layers.pairs[i];
  g_autoptr(GString) missing = g_string_new(NULL);
  operands o = {.b = b, .missing = missing};
  b->failed = eda_layer_names(pair->value, find_operand, &o, b->error);
  b->seen[i] = o.found > 0;
  if (b->failed || !o.found) return;
  int32_t layer = eda_layout_find_layer(b->layout, pair->key);
  eda_layout_set_file_layer(b->layout, layer, o.file);
  if (missing->len && !is_optional(b, i))
    b->r->host->log(b->r->host, OPC_LOG_WARNING,
                    "'%s': no layer %.400s: empty in the expression of '%s'",
                    b->r->file, missing->str, pair->key);
  b->failed = eda_layout_derive(b->layout, pair->key, pair->value, b->error);
}

/* Define the layers of the map that are expressions. All their names exist
   before, so that expressions may use each other in any order. */
static void reading_derive(reading *b) {
  const opc_map *map = &b->r->layers;
  for (size_t i = 0; i < map->count && !b->failed; i++) {
    const opc_pair *pair = &map->pairs[i];
    if (!eda_layer_is_expression(pair->value)) continue;
    if (eda_layout_find_layer(b->layout, pair->key) >= 0)
      b->failed = opc_fail(b->error, OPC_INVALID, "layers",
                           "'%s': the file has a layer '%s', expected another "
                           "name for the expression %s",
                           b->r->file, pair->key, pair->value);
    else
      (void)reading_number(
          b, eda_layout_layer(b->layout, pair->key, &b->layout_error));
  }
  for (size_t i = 0; i < map->count && !b->failed; i++)
    if (eda_layer_is_expression(map->pairs[i].value)) derive_layer(b, i);
}

/* ---- cells ---- */

static int cell_is_defined(const reading *b, int32_t cell) {
  return !b->there || ((guint)cell < b->there->len &&
                       g_array_index(b->there, uint8_t, cell));
}

void reading_begin_cell(reading *b, const char *name) {
  b->cell = -1;
  if (b->failed || !strcmp(name, CONTEXT_CELL)) return;
  b->cell =
      reading_number(b, eda_layout_cell(b->layout, name, &b->layout_error));
  if (b->failed) return;
  if (!b->there) b->there = g_array_new(FALSE, TRUE, 1);
  if (cell_is_defined(b, b->cell)) {
    g_autofree char *what =
        g_strdup_printf("cell '%.200s' a second time", name);
    b->refuse(b, what);
  }
  if ((guint)b->cell >= b->there->len)
    g_array_set_size(b->there, (guint)b->cell + 1);
  g_array_index(b->there, uint8_t, b->cell) = 1;
}

/* Log a warning about placed cells without definition. Such cells are empty, as
   in other readers. */
static void reading_warn_undefined(const reading *b) {
  size_t missing = 0;
  int32_t first = -1;
  for (int32_t i = (int32_t)eda_layout_cells(b->layout); i-- > 0;)
    if (!cell_is_defined(b, i)) {
      missing++;
      first = i;
    }
  if (missing)
    b->r->host->log(b->r->host, OPC_LOG_WARNING,
                    "'%s': %zu placed cells are not defined and are read as "
                    "empty, the first is '%.200s'",
                    b->r->file, missing,
                    eda_layout_cell_name(b->layout, first));
}

/* Fail because the top cell is missing; suggest the most similar name. */
static int reading_miss_top(const reading *b) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < eda_layout_cells(b->layout); i++)
    if (cell_is_defined(b, (int32_t)i))
      g_ptr_array_add(names,
                      (char *)eda_layout_cell_name(b->layout, (int32_t)i));
  g_ptr_array_add(names, NULL);
  const char *near = eda_nearest(b->r->top, (const char *const *)names->pdata);
  return opc_fail(b->error, OPC_INVALID, "top",
                  "'%s': cell '%.200s' does not exist%s%.200s%s", b->r->file,
                  b->r->top, near ? ", did you mean '" : "", near ? near : "",
                  near ? "'?" : "");
}

/* Drop the cells that the top cell does not use. */
static int reading_keep_top(const reading *b) {
  const reader *r = b->r;
  int32_t cell = r->top ? eda_layout_find_cell(b->layout, r->top) : b->top;
  if (r->top && (cell < 0 || !cell_is_defined(b, cell)))
    return reading_miss_top(b);
  return cell < 0 ? OPC_OK : eda_layout_keep(b->layout, cell, b->error);
}

int reader_choices(void *self,
                   int (*run)(void *self, void **outputs, opc_error *error),
                   void (*take)(void *data, const char *value), void *data,
                   opc_error *error) {
  reader *r = self;
  const char *top = r->top;
  void *layout = NULL;
  r->top = NULL;
  int code = run(self, &layout, error);
  r->top = top;
  for (size_t i = 0; !code && i < eda_layout_cells(layout); i++)
    take(data, eda_layout_cell_name(layout, (int32_t)i));
  eda_layout_free(layout);
  return code;
}

/* ---- reading a file ---- */

int reading_run(void *state, void *self, void **outputs, opc_error *error,
                void (*read)(void *state)) {
  reading *b = state;
  b->r = self;
  b->error = error;
  b->cell = b->top = -1;
  b->seen = eda_alloc(b->r->layers.count, 1);
  b->layers = g_hash_table_new_full(g_int64_hash, g_int64_equal, free, NULL);
  reading_open(b);
  check_format(b);
  if (!b->failed) read(b);
  if (!b->failed) reading_derive(b);
  if (!b->failed) b->failed = check_layers(b);
  if (!b->failed) {
    reading_keep_names(b);
    reading_warn_undefined(b);
    b->failed = reading_keep_top(b);
  }
  outputs[0] = b->layout;
  reading_close(b);
  g_clear_pointer(&b->there, g_array_unref);
  g_hash_table_unref(b->layers);
  free(b->seen);
  return b->failed;
}
