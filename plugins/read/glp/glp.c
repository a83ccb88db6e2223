/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements read.glp: a GLP clip (the text format of the ICCAD 2013 contest)
   as a layout. Each line is a record. The shapes of a CELL are RECT N LAYER x y
   width height and PGON N LAYER x1 y1 x2 y2 ... */
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
  reading b;
  const char *at; /* place in the text */
  size_t line;
  const char *line_start;
  const char *record; /* first word of the current record */
  double unit;        /* nm; 0 before EQUIV */
  eda_point *points;
  size_t capacity;
} clip;

/* ---- work: words ---- */

/* Fail at a place; parsing ends after a failure. */
static void glp_refuse_at(clip *c, const char *at, const char *what) {
  if (c->b.failed) return;
  c->b.failed =
      opc_fail(c->b.error, OPC_IO, NULL, "%s:%zu:%zu: %s", c->b.r->file,
               c->line, (size_t)(at - c->line_start) + 1, what);
  c->at = c->b.text + c->b.n;
}

static void glp_refuse(void *self, const char *what) {
  glp_refuse_at(self, ((clip *)self)->record, what);
}

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Return the next word of this line, empty at the end or at a comment. */
static word next_word(clip *c) {
  const char *end = c->b.text + c->b.n;
  while (c->at < end && is_blank(*c->at)) c->at++;
  word w = {c->at, 0};
  if (end - c->at >= 2 && c->at[0] == '/' && c->at[1] == '*') return w;
  while (c->at < end && *c->at != '\n' && !is_blank(*c->at)) c->at++;
  w.n = (size_t)(c->at - w.s);
  return w;
}

/* Advance to the next line. Return 0 at the end of the text. */
static int next_line(clip *c) {
  const char *end = memchr(c->at, '\n', (size_t)(c->b.text + c->b.n - c->at));
  if (!end) return 0;
  c->at = c->line_start = end + 1;
  c->line++;
  return 1;
}

static int word_is(word w, const char *s) {
  return w.n == strlen(s) && !memcmp(w.s, s, w.n);
}

/* Convert a word to an integer within +-2^31. Return 0 on failure. */
static int word_number(word w, int32_t *out) {
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

static int32_t need_number(clip *c) {
  int32_t value = 0;
  word w = next_word(c);
  if (!word_number(w, &value))
    glp_refuse_at(
        c, w.s,
        w.n ? "expected a whole number within 2^31" : "a number is missing");
  return value;
}

/* Copy a name of printable ASCII characters. */
static word take_name(clip *c, char out[256]) {
  word w = next_word(c);
  if (!w.n) glp_refuse_at(c, w.s, "a name is missing");
  if (w.n > 255) glp_refuse_at(c, w.s, "name of more than 255 letters");
  for (size_t i = 0; i < w.n; i++)
    if (w.s[i] < 33 || w.s[i] > 126)
      glp_refuse_at(c, w.s + i, "name with a letter that is not ASCII");
  size_t n = MIN(w.n, 255); /* the text has no terminating zero */
  memcpy(out, w.s, n);
  out[n] = 0;
  return w;
}

/* ---- work: records ---- */

/* Read the units per micrometre: EQUIV 1 1000 MICRON +X,+Y. */
static void take_unit(clip *c) {
  int32_t microns = need_number(c), units = need_number(c);
  word name = next_word(c), axes = next_word(c);
  if (c->unit > 0) glp_refuse(c, "EQUIV a second time");
  if (c->b.layout) glp_refuse(c, "EQUIV after a CELL");
  if (microns <= 0 || units <= 0 || !word_is(name, "MICRON"))
    glp_refuse(c, "EQUIV that is not in MICRON");
  if (axes.n && !word_is(axes, "+X,+Y"))
    glp_refuse_at(c, axes.s, "axes other than +X,+Y");
  c->unit = 1e3 * microns / units;
}

static void begin_cell(clip *c) {
  reading *b = &c->b;
  char name[256];
  c->record = take_name(c, name).s;
  if (!b->layout && !b->failed) {
    double unit = c->unit > 0 ? c->unit : 1;
    b->layout = eda_layout_new(unit * b->r->scale, &b->layout_error);
    reading_check(b, b->layout ? OPC_OK : b->layout_error.code);
  }
  if (b->failed) return;
  if (eda_layout_find_cell(b->layout, name) >= 0)
    glp_refuse(c, "a cell of this name exists already");
  b->cell =
      reading_number(b, eda_layout_cell(b->layout, name, &b->layout_error));
}

/* Read the type and the layer of a shape, and return the layer of the layout.
 */
static int32_t take_layer(clip *c) {
  char name[256];
  next_word(c); /* type of the shape, N */
  take_name(c, name);
  return c->b.failed ? -1 : reading_named_layer(&c->b, name);
}

static void take_box(clip *c) {
  reading *b = &c->b;
  int32_t layer = take_layer(c), v[4];
  for (int i = 0; i < 4; i++) v[i] = need_number(c);
  int64_t x = (int64_t)v[0] + v[2], y = (int64_t)v[1] + v[3];
  if (v[2] <= 0 || v[3] <= 0) glp_refuse(c, "RECT without area");
  if (x > INT32_MAX || y > INT32_MAX) glp_refuse(c, "RECT beyond 2^31");
  eda_box box = {v[0], v[1], (int32_t)x, (int32_t)y};
  if (!b->failed)
    reading_check(b, eda_layout_add_box(b->layout, b->cell, layer, box,
                                        &b->layout_error));
}

static void take_polygon(clip *c) {
  reading *b = &c->b;
  int32_t layer = take_layer(c);
  size_t n = 0;
  for (word w = next_word(c); w.n; w = next_word(c), n++) {
    eda_grow(&c->points, &c->capacity, n + 1, sizeof *c->points);
    if (!word_number(w, &c->points[n].x))
      glp_refuse_at(c, w.s, "expected a whole number within 2^31");
    c->points[n].y = need_number(c);
  }
  if (n < 3) glp_refuse(c, "PGON of fewer than 3 points");
  if (!b->failed)
    reading_check(b, eda_layout_add_polygon(b->layout, b->cell, layer,
                                            c->points, n, &b->layout_error));
}

/* Read one line. Return 0 at ENDMSG. */
static int take_record(clip *c) {
  word w = next_word(c);
  int rect = word_is(w, "RECT");
  c->record = w.s;
  if (word_is(w, "ENDMSG")) return 0;
  if (!w.n || word_is(w, "BEGIN") || word_is(w, "CNAME") || word_is(w, "LEVEL"))
    return 1; /* CELL and shapes contain the names of these records */
  if (word_is(w, "EQUIV")) {
    take_unit(c);
  } else if (word_is(w, "CELL")) {
    begin_cell(c);
  } else if (!rect && !word_is(w, "PGON")) {
    glp_refuse(c, "unknown record");
  } else {
    if (c->b.cell < 0) glp_refuse(c, "shape before the first CELL");
    if (rect)
      take_box(c);
    else
      take_polygon(c);
    word more = next_word(c);
    if (more.n) glp_refuse_at(c, more.s, "unexpected number at the end");
  }
  return 1;
}

static void read_clip(void *self) {
  clip *c = self;
  if (!reading_text(&c->b)) return;
  c->at = c->line_start = c->b.text;
  while (take_record(c))
    if (!next_line(c)) {
      glp_refuse_at(c, c->at, "the file ends before ENDMSG");
      return;
    }
  if (!c->b.layout) glp_refuse_at(c, c->at, "no CELL");
}

static int glp_run(void *self, void **outputs, opc_error *error) {
  clip c = {.b.format = "GLP", .b.refuse = glp_refuse, .line = 1};
  int code = reading_run(&c, self, outputs, error, read_clip);
  free(c.points);
  return code;
}

/* ---- entry ---- */

READER_FUNCTIONS(
    glp_run, 0, "The GLP file",
    "Layer names, as in { metal: M1 }; other layers keep the names of the file")

OPC_PLUGIN(reader, .id = "read.glp", .summary = "Read a GLP clip",
           READER_ENTRY);
