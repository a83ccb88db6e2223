/* SPDX-License-Identifier: BSD-3-Clause */
/* read.glp: a GLP clip (the text format of the ICCAD 2013 contest) as a
   layout: a line for each record, RECT x y width height and PGON x1 y1 x2 y2
   ... within a CELL. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "../reader.h"

/* ---- state ---- */

typedef struct word {
  const char *s;
  size_t n;
} word;

typedef struct clip {
  const reader *r;
  char *seen; /* which names of the map of layers the file has */
  char *text;
  size_t n;
  const char *at; /* within text */
  size_t line;
  const char *line_start;
  double unit; /* nm; 0 before EQUIV */
  eda_layout *layout;
  int32_t cell; /* -1 before the first */
  eda_point *points;
  size_t room;
} clip;

/* ---- work: words ---- */

static int refuse(const clip *c, const char *at, opc_error *error,
                  const char *what) {
  return opc_fail(error, OPC_IO, NULL, "%s:%zu:%zu: %s", c->r->file, c->line,
                  (size_t)(at - c->line_start) + 1, what);
}

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* The next word of this line, empty at its end. A comment ends the line. */
static word next_word(clip *c) {
  const char *end = c->text + c->n;
  while (c->at < end && is_blank(*c->at)) c->at++;
  word w = {c->at, 0};
  if (end - c->at >= 2 && c->at[0] == '/' && c->at[1] == '*') return w;
  while (c->at < end && *c->at != '\n' && !is_blank(*c->at)) c->at++;
  w.n = (size_t)(c->at - w.s);
  return w;
}

/* 0 at the end of the text. */
static int next_line(clip *c) {
  const char *end = memchr(c->at, '\n', (size_t)(c->text + c->n - c->at));
  if (!end) return 0;
  c->at = c->line_start = end + 1;
  c->line++;
  return 1;
}

static int is(word w, const char *s) {
  return w.n == strlen(s) && !memcmp(w.s, s, w.n);
}

/* A whole number within +-2^31; 0 if the word is none. */
static int number(word w, int32_t *out) {
  size_t i = w.n && (*w.s == '-' || *w.s == '+');
  int64_t value = 0;
  if (i == w.n) return 0;
  for (; i < w.n; i++) {
    if (w.s[i] < '0' || w.s[i] > '9') return 0;
    value = value * 10 + (w.s[i] - '0');
    if (value > INT32_MAX) return 0;
  }
  *out = (int32_t)(*w.s == '-' ? -value : value);
  return 1;
}

static int need_number(clip *c, int32_t *out, opc_error *error) {
  word w = next_word(c);
  if (number(w, out)) return OPC_OK;
  return refuse(c, w.s, error,
                w.n ? "not a whole number within 2^31" : "a number is missing");
}

/* A copy of a name, of printable ASCII. */
static int take_name(clip *c, word w, char out[256], opc_error *error) {
  if (!w.n) return refuse(c, w.s, error, "a name is missing");
  if (w.n > 255) return refuse(c, w.s, error, "name of more than 255 letters");
  for (size_t i = 0; i < w.n; i++)
    if (w.s[i] < 33 || w.s[i] > 126)
      return refuse(c, w.s + i, error, "name with a letter that is not ASCII");
  memcpy(out, w.s, w.n);
  out[w.n] = 0;
  return OPC_OK;
}

/* ---- work: records ---- */

/* What the layout said to a record; a refusal with the record's place. */
static int located(clip *c, int code, word record, opc_error *error) {
  if (!code) return OPC_OK;
  opc_error why = *error;
  return opc_fail(error, code, NULL, "%s:%zu:%zu: %s", c->r->file, c->line,
                  (size_t)(record.s - c->line_start) + 1, why.message);
}

/* The units in a micron: EQUIV 1 1000 MICRON +X,+Y. */
static int take_unit(clip *c, word record, opc_error *error) {
  int32_t microns, units;
  if (need_number(c, &microns, error) || need_number(c, &units, error))
    return error->code;
  word name = next_word(c), axes = next_word(c);
  if (c->unit > 0) return refuse(c, record.s, error, "EQUIV a second time");
  if (c->layout) return refuse(c, record.s, error, "EQUIV after a CELL");
  if (microns <= 0 || units <= 0 || !is(name, "MICRON"))
    return refuse(c, record.s, error, "EQUIV that is not in MICRON");
  if (axes.n && !is(axes, "+X,+Y"))
    return refuse(c, axes.s, error, "axes other than +X,+Y");
  c->unit = 1e3 * microns / units;
  return OPC_OK;
}

static int begin_cell(clip *c, opc_error *error) {
  word w = next_word(c);
  char name[256];
  if (take_name(c, w, name, error)) return error->code;
  if (!c->layout) {
    double unit = c->unit > 0 ? c->unit : 1;
    c->layout = eda_layout_new(unit * c->r->scale, error);
    if (!c->layout) return error->code;
  }
  if (eda_layout_find_cell(c->layout, name) >= 0)
    return refuse(c, w.s, error, "a cell of this name was there before");
  c->cell = eda_layout_cell(c->layout, name, error);
  return c->cell < 0 ? located(c, error->code, w, error) : OPC_OK;
}

/* The layer of a shape, by its new name if it has one. */
static int take_layer(clip *c, int32_t *layer, opc_error *error) {
  next_word(c); /* the shape's type, N */
  word w = next_word(c);
  char name[256];
  if (take_name(c, w, name, error)) return error->code;
  const char *known = name;
  const opc_map *map = &c->r->layers;
  for (size_t i = 0; i < map->count; i++)
    if (!strcmp(map->pairs[i].value, name)) {
      known = map->pairs[i].key;
      c->seen[i] = 1;
    }
  *layer = eda_layout_layer(c->layout, known, error);
  return *layer < 0 ? located(c, error->code, w, error) : OPC_OK;
}

static int take_box(clip *c, word record, opc_error *error) {
  int32_t layer, v[4];
  if (take_layer(c, &layer, error)) return error->code;
  for (int i = 0; i < 4; i++)
    if (need_number(c, &v[i], error)) return error->code;
  int64_t x = (int64_t)v[0] + v[2], y = (int64_t)v[1] + v[3];
  if (v[2] <= 0 || v[3] <= 0)
    return refuse(c, record.s, error, "RECT without area");
  if (x > INT32_MAX || y > INT32_MAX)
    return refuse(c, record.s, error, "RECT beyond 2^31");
  eda_box box = {v[0], v[1], (int32_t)x, (int32_t)y};
  return located(c, eda_layout_add_box(c->layout, c->cell, layer, box, error),
                 record, error);
}

static int take_polygon(clip *c, word record, opc_error *error) {
  int32_t layer;
  size_t n = 0;
  if (take_layer(c, &layer, error)) return error->code;
  for (word w = next_word(c); w.n; w = next_word(c), n++) {
    eda_grow(&c->points, &c->room, n + 1, sizeof *c->points);
    if (!number(w, &c->points[n].x))
      return refuse(c, w.s, error, "not a whole number within 2^31");
    if (need_number(c, &c->points[n].y, error)) return error->code;
  }
  if (n < 3) return refuse(c, record.s, error, "PGON of less than 3 points");
  return located(
      c, eda_layout_add_polygon(c->layout, c->cell, layer, c->points, n, error),
      record, error);
}

/* One line; *done at ENDMSG. */
static int take_record(clip *c, int *done, opc_error *error) {
  word w = next_word(c);
  int rect = is(w, "RECT"), code = OPC_OK;
  if (!w.n || is(w, "BEGIN") || is(w, "CNAME") || is(w, "LEVEL"))
    return OPC_OK; /* names again what the records below name */
  if (is(w, "ENDMSG")) {
    *done = 1;
    return OPC_OK;
  }
  if (is(w, "EQUIV")) return take_unit(c, w, error);
  if (is(w, "CELL")) return begin_cell(c, error);
  if (!rect && !is(w, "PGON")) return refuse(c, w.s, error, "unknown record");
  if (c->cell < 0) return refuse(c, w.s, error, "shape before the first CELL");
  code = rect ? take_box(c, w, error) : take_polygon(c, w, error);
  if (code) return code;
  word more = next_word(c);
  return more.n ? refuse(c, more.s, error, "one number too many") : OPC_OK;
}

static int read_clip(clip *c, opc_error *error) {
  const reader *r = c->r;
  int done = 0;
  if (reader_load(r, &c->text, &c->n, error)) return error->code;
  c->at = c->line_start = c->text;
  do
    if (take_record(c, &done, error)) return error->code;
  while (!done && next_line(c));
  if (!done) return refuse(c, c->at, error, "the file ends before ENDMSG");
  if (!c->layout) return refuse(c, c->at, error, "no CELL");
  for (size_t i = 0; i < r->layers.count; i++)
    if (!c->seen[i])
      return opc_fail(error, OPC_INVALID, "layers", "'%s' has no layer '%s'",
                      r->file, r->layers.pairs[i].value);
  return reader_keep(r, c->layout, NULL, -1, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const reader *r = self;
  clip c = {
      .r = r, .seen = eda_alloc(r->layers.count, 1), .line = 1, .cell = -1};
  int code = read_clip(&c, error);
  outputs[0] = c.layout;
  free(c.seen);
  free(c.text);
  free(c.points);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {READ_PARAMETERS(
    "The GLP file", "Names for layers: { metal: M1 }; the others keep theirs")};

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run};

OPC_PLUGIN(reader, .id = "read.glp", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause", .summary = "Read a GLP clip",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
