/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of lists: a list of maps from CSV, or a list or map from YAML. */
#include <base/list.h>

#include <base/file.h>
#include <base/sheet.h>
#include <string.h>

/* The limits of a flow file. */
enum { MOST_BYTES = 16 << 20, MOST_CELLS = 200000 };

/* ---- CSV ---- */

typedef struct csv {
  const opc_source *source;
  const char *at;
  opc_place place; /* place of `at` */
  guint cells;
  opc_problems *problems;
} csv;

static void csv_advance(csv *c) {
  c->place.column++;
  if (*c->at++ == '\n') {
    c->place.line++;
    c->place.column = 1;
  }
}

/* Read the text of a quoted cell. Return FALSE and a problem on failure. */
static gboolean read_quoted(csv *c, GString *text) {
  const opc_place start = c->place;
  gboolean open = TRUE;
  for (csv_advance(c); *c->at; csv_advance(c)) {
    if (*c->at == '"') {
      csv_advance(c);
      open = *c->at == '"';
      if (!open) break;
    }
    g_string_append_c(text, *c->at);
  }
  if (open)
    return opc_problem_add(c->problems, OPC_INVALID, &start,
                           "unterminated quote");
  return !*c->at || strchr(",\r\n", *c->at) ||
         opc_problem_add(c->problems, OPC_INVALID, &c->place,
                         "unexpected text after a closing quote");
}

/* Return a cell, up to the comma or the end of the line (exclusive). */
static opc_node *read_cell(csv *c) {
  const opc_place start = c->place;
  g_autoptr(GString) text = g_string_new(NULL);
  gboolean quoted = *c->at == '"';
  if (quoted && !read_quoted(c, text)) return NULL;
  for (; !quoted && *c->at && !strchr(",\r\n", *c->at); csv_advance(c))
    g_string_append_c(text, *c->at);
  if (++c->cells > MOST_CELLS) {
    opc_problem_add(c->problems, OPC_INVALID, &start, "more than %d cells",
                    MOST_CELLS);
    return NULL;
  }
  opc_cell_unmark(text->str);
  opc_node *node =
      opc_node_text_new(c->source, quoted ? text->str : g_strstrip(text->str));
  node->plain = !quoted;
  node->at = start;
  return node;
}

/* Return the cells of a line and consume its end; NULL and a problem on
   failure. */
static GPtrArray *read_line(csv *c) {
  g_autoptr(GPtrArray) cells =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  for (;;) {
    opc_node *cell = read_cell(c);
    if (!cell) return NULL;
    g_ptr_array_add(cells, cell);
    if (*c->at != ',') break;
    csv_advance(c);
  }
  if (*c->at == '\r') csv_advance(c);
  if (*c->at == '\n') csv_advance(c);
  return g_steal_pointer(&cells);
}

static gboolean add_row(const csv *c, opc_node *list, const GPtrArray *head,
                        const GPtrArray *cells) {
  const opc_node *first = cells->pdata[0];
  if (cells->len == 1 && !*first->text) return TRUE; /* an empty line */
  if (cells->len != head->len)
    return opc_problem_add(c->problems, OPC_INVALID, &first->at,
                           "%u cells, the first line has %u", cells->len,
                           head->len);
  opc_node *row = opc_node_map_new(c->source, &first->at);
  for (guint i = 0; i < head->len; i++) {
    const opc_node *cell = cells->pdata[i];
    if (*cell->text)
      opc_node_add(row, opc_node_copy(head->pdata[i], NULL),
                   opc_node_copy(cell, NULL));
  }
  g_ptr_array_add(list->items, row);
  return TRUE;
}

static gboolean check_head(const csv *c, const GPtrArray *head) {
  for (guint i = 0; i < head->len; i++) {
    const opc_node *name = head->pdata[i];
    if (!*name->text)
      return opc_wrong(c->problems, name, "a column has no name");
    for (guint k = 0; k < i; k++)
      if (!strcmp(((const opc_node *)head->pdata[k])->text, name->text))
        return opc_wrong(c->problems, name, "two columns have the name '%s'",
                         name->text);
  }
  return TRUE;
}

static opc_node *read_csv(const opc_source *source, const char *text,
                          opc_problems *problems) {
  csv c = {source, text, {source->name, 1, 1}, 0, problems};
  g_autoptr(GPtrArray) head = read_line(&c);
  if (!head || !check_head(&c, head)) return NULL;
  opc_node *list = opc_node_parse(source, "[]", 2, problems);
  gboolean good = TRUE;
  while (good && *c.at) {
    g_autoptr(GPtrArray) cells = read_line(&c);
    good = cells && add_row(&c, list, head, cells);
  }
  if (good) return list;
  opc_node_free(list);
  return NULL;
}

/* ---- files ---- */

opc_node *opc_list_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems) {
  if (!g_str_has_suffix(path, ".csv"))
    return opc_node_read(source, path, at, problems);
  g_autofree char *text = NULL;
  g_autoptr(GError) error = NULL;
  size_t size = 0;
  const char *why = opc_file_fault(path, &size);
  const opc_place file = {source->name, 0, 0};
  if (!why && size > MOST_BYTES) why = "larger than 16 MB";
  if (!why && !g_file_get_contents(path, &text, &size, &error))
    why = error->message;
  if (why) {
    opc_problem_add(problems, OPC_IO, at, "'%s': %s", path, why);
    return NULL;
  }
  if (strlen(text) == size && g_utf8_validate(text, -1, NULL))
    return read_csv(source, text, problems);
  opc_problem_add(problems, OPC_INVALID, &file, "is not UTF-8 text");
  return NULL;
}
