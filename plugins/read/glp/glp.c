/* SPDX-License-Identifier: BSD-3-Clause */
/* read.glp: a GLP clip (the text format of the ICCAD 2013 contest) as a
   layout: a line for each record, RECT x y width height and PGON x1 y1 x2 y2
   ... within a CELL. */
#include "../parameters.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <opcflow/opcflow.h>

/* ---- state ---- */

typedef struct reader {
  const opc_host *host;
  const opc_value *values;
} reader;

typedef struct word {
  const char *s;
  size_t n;
} word;

typedef struct clip {
  const opc_host *host;
  const char *path;
  const opc_value *map; /* name: the file's name */
  char *seen;           /* which of its names the file has */
  char *text;
  size_t n;
  const char *at; /* within text */
  size_t line;
  const char *line_start;
  double scale, unit; /* nm; 0 before EQUIV */
  opc_layout *layout;
  int32_t cell; /* -1 before the first */
  opc_point *points;
  size_t room;
} clip;

/* A port is released without its instance: the table that every host has. */
static const opc_layout_service *layouts;

/* ---- work: words ---- */

static int no_memory(const clip *c, opc_error *error) {
  c->host->fail(c->host, error, OPC_FAILED, NULL, "'%s': out of memory",
                c->path);
  return OPC_FAILED;
}

static int refuse(const clip *c, const char *at, opc_error *error,
                  const char *what) {
  return c->host->fail(c->host, error, OPC_IO, NULL, "%s:%zu:%zu: %s", c->path,
                       c->line, (size_t)(at - c->line_start) + 1, what);
}

static int load(clip *c, opc_error *error) {
  FILE *file = fopen(c->path, "rb");
  if (!file) {
    c->host->fail(c->host, error, OPC_IO, NULL, "'%s': %s", c->path,
                  strerror(errno));
    return OPC_IO;
  }
  size_t room = 0, got;
  int code = OPC_OK;
  do {
    if (room - c->n < 2) {
      char *more = realloc(c->text, room = 2 * room + 65536);
      if (!more) {
        fclose(file);
        return no_memory(c, error);
      }
      c->text = more;
    }
    got = fread(c->text + c->n, 1, room - c->n - 1, file);
    c->n += got;
  } while (got);
  if (ferror(file))
    code = c->host->fail(c->host, error, OPC_IO, NULL, "'%s': %s", c->path,
                         strerror(errno));
  fclose(file);
  c->text[c->n] = 0;
  c->at = c->line_start = c->text;
  c->line = 1;
  return code;
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
  return c->host->fail(c->host, error, code, NULL, "%s:%zu:%zu: %s", c->path,
                       c->line, (size_t)(record.s - c->line_start) + 1,
                       why.message);
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
    c->layout = layouts->create(c->host, unit * c->scale, error);
    if (!c->layout) return error->code;
  }
  if (layouts->find_cell(c->layout, name) >= 0)
    return refuse(c, w.s, error, "a cell of this name was there before");
  c->cell = layouts->cell(c->layout, name, error);
  return c->cell < 0 ? located(c, error->code, w, error) : OPC_OK;
}

/* The layer of a shape, by its new name if it has one. */
static int take_layer(clip *c, int32_t *layer, opc_error *error) {
  next_word(c); /* the shape's type, N */
  word w = next_word(c);
  char name[256];
  if (take_name(c, w, name, error)) return error->code;
  const char *known = name;
  for (size_t i = 0; i < c->map->count; i++)
    if (!strcmp(c->map->pairs[i].value, name)) {
      known = c->map->pairs[i].key;
      c->seen[i] = 1;
    }
  *layer = layouts->layer(c->layout, known, error);
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
  opc_box box = {v[0], v[1], (int32_t)x, (int32_t)y};
  return located(c, layouts->add_box(c->layout, c->cell, layer, box, error),
                 record, error);
}

static int take_polygon(clip *c, word record, opc_error *error) {
  int32_t layer;
  size_t n = 0;
  if (take_layer(c, &layer, error)) return error->code;
  for (word w = next_word(c); w.n; w = next_word(c), n++) {
    if (n == c->room) {
      size_t room = 2 * c->room + 64;
      opc_point *more = realloc(c->points, room * sizeof *more);
      if (!more) return no_memory(c, error);
      c->points = more;
      c->room = room;
    }
    if (!number(w, &c->points[n].x))
      return refuse(c, w.s, error, "not a whole number within 2^31");
    if (need_number(c, &c->points[n].y, error)) return error->code;
  }
  if (n < 3) return refuse(c, record.s, error, "PGON of less than 3 points");
  return located(
      c, layouts->add_polygon(c->layout, c->cell, layer, c->points, n, error),
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

static int read_clip(clip *c, const opc_value *top, opc_error *error) {
  int done = 0;
  do
    if (take_record(c, &done, error)) return error->code;
  while (!done && next_line(c));
  if (!done) return refuse(c, c->at, error, "the file ends before ENDMSG");
  if (!c->layout) return refuse(c, c->at, error, "no CELL");
  for (size_t i = 0; i < c->map->count; i++)
    if (!c->seen[i])
      return c->host->fail(c->host, error, OPC_INVALID, "layers",
                           "'%s' has no layer '%s'", c->path,
                           c->map->pairs[i].value);
  if (top->type == OPC_ABSENT) return OPC_OK;
  int32_t cell = layouts->find_cell(c->layout, top->text);
  if (cell < 0)
    return c->host->fail(c->host, error, OPC_INVALID, "top",
                         "'%s': there is no cell '%s'", c->path, top->text);
  return layouts->keep(c->layout, cell, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const reader *r = self;
  clip c = {.host = r->host,
            .path = r->values[FILE_NAME].text,
            .map = &r->values[LAYERS],
            .scale = r->values[SCALE].real,
            .cell = -1};
  c.seen = calloc(c.map->count + 1, 1);
  int code = c.seen ? load(&c, error) : no_memory(&c, error);
  if (!code) code = read_clip(&c, &r->values[TOP], error);
  if (code) {
    if (c.layout) layouts->destroy(c.layout);
  } else {
    outputs[0] = c.layout;
  }
  free(c.seen);
  free(c.text);
  free(c.points);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    READ_PARAMETERS("The GLP file",
                    "Names for layers: { metal: M1 }; the others keep "
                    "theirs")};

static void release_layout(void *layout) { layouts->destroy(layout); }

static const opc_port outputs[] = {{"layout", "layout", release_layout}};

static void destroy(void *self) { free(self); }

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  reader *r = malloc(sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  layouts = host->layout;
  *r = (reader){host, values};
  return r;
}

/* ---- entry ---- */

static const opc_step step = {.size = sizeof step,
                              .n_outputs = 1,
                              .port_size = sizeof(opc_port),
                              .outputs = outputs,
                              .run = run};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "read.glp",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "Read a GLP clip",
      .kind = OPC_KIND_STEP,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &step,
  };
  return &plugin;
}
