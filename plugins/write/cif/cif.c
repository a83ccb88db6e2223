/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements write.cif: a layout or a corrected mask as a CIF 2.0 file. */
#include <eda/memory.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../writer.h"

/* ---- state ---- */

typedef struct cif {
  writer w;
  char layer[64];
  char written[64]; /* current layer of the file */
  const eda_layout *layout;
  int64_t a, b; /* coordinates in units times a / b are centimicrons */
  uint64_t calls;
  size_t changed; /* number of texts with replaced blanks */
} cif;

/* Largest number of calls that replace arrays in a file. */
enum { MAX_CALLS = 1 << 24 };

/* ---- work: names ---- */

/* Return 1 if the text is a word without characters that end a word in read.cif
   and other readers. */
static int is_word(const char *text) {
  if (!*text) return 0;
  for (; *text; text++)
    if (*text <= ' ' || *text > '~' || strchr(";()", *text)) return 0;
  return 1;
}

/* Set the layer. A layer of two numbers gets a name as in KLayout's files. */
static int set_layer(void *self, const char *layer) {
  cif *w = self;
  eda_layer_number number;
  int n;
  if (eda_layer_number_read(layer, UINT32_MAX, &number, NULL))
    n = snprintf(w->layer, sizeof w->layer, "L%uD%u", (unsigned)number.layer,
                 (unsigned)number.datatype);
  else if (is_word(layer))
    n = snprintf(w->layer, sizeof w->layer, "%s", layer);
  else
    return 0;
  return n < (int)sizeof w->layer;
}

static void name_layer(const eda_gates *gates, size_t k, int drawn,
                       char *name) {
  static const char *const known[2][3] = {{"CP", "CA", "CC"},
                                          {"XP", "XA", "XC"}};
  int contact = !strcmp(gates->layer[k], "contact");
  if (k <= EDA_ACTIVE || contact)
    snprintf(name, 64, "%s", known[drawn][k <= EDA_ACTIVE ? k : 2]);
  else
    snprintf(name, 64, "%s%s", gates->layer[k], drawn ? "_drawn" : "");
}

static void at_layer(cif *w) {
  if (!strcmp(w->layer, w->written)) return;
  memcpy(w->written, w->layer, sizeof w->written);
  fprintf(w->w.file, "L %s;\n", w->layer);
}

/* ---- work: the scale ---- */

/* Find the first convergent a / b of the continued fraction of v with a
   relative error of at most 1e-14. Return 0 if there is none. */
static int as_fraction(double v, int64_t *a, int64_t *b) {
  int64_t a0 = 1, b0 = 0, a1 = (int64_t)floor(v), b1 = 1;
  double rest = v - floor(v);
  for (int i = 0; i < 40; i++) {
    if (a1 > 0 && fabs((double)a1 / (double)b1 - v) <= 1e-14 * v) {
      *a = a1;
      *b = b1;
      return 1;
    }
    if (rest < 1e-15) return 0;
    double inverse = 1 / rest;
    int64_t k = (int64_t)floor(inverse);
    rest = inverse - floor(inverse);
    int64_t a2 = k * a1 + a0, b2 = k * b1 + b0;
    if (k > INT32_MAX || a2 > INT32_MAX || b2 > INT32_MAX) return 0;
    a0 = a1, b0 = b1;
    a1 = a2, b1 = b2;
  }
  return 0;
}

static void cif_begin(void *self, const eda_layout *layout, double unit) {
  cif *w = self;
  w->layout = layout;
  w->calls = 0;
  w->changed = 0;
  if (!(unit < 1e9) || !as_fraction(unit / 10, &w->a, &w->b))
    writer_fail(&w->w, "a unit of %.17g nm cannot be represented in CIF", unit);
}

/* ---- work: cells ---- */

static void begin_cell(void *self, int32_t cell, const char *name) {
  cif *w = self;
  size_t n = strlen(name);
  if (!n || name[0] == ' ' || name[n - 1] == ' ' || strchr(name, ';'))
    writer_fail(&w->w, "'%.200s' is not allowed as the name of a cell in CIF",
                name);
  fprintf(w->w.file, "DS %d %" PRId64 " %" PRId64 ";\n9 %s;\n", cell + 1, w->a,
          w->b, name);
  w->written[0] = '\0';
}

/* Return 1 if p is a rectangle whose centre is on the grid. */
static int is_box(const eda_point *p, size_t n) {
  if (!eda_is_box(p, n)) return 0;
  int64_t x = (int64_t)p[0].x + p[2].x, y = (int64_t)p[0].y + p[2].y;
  int64_t l = (int64_t)p[0].x - p[2].x, h = (int64_t)p[0].y - p[2].y;
  return x % 2 == 0 && y % 2 == 0 && llabs(l) <= INT32_MAX &&
         llabs(h) <= INT32_MAX;
}

static void put_polygon(void *self, const eda_point *p, size_t n) {
  cif *w = self;
  FILE *file = w->w.file;
  at_layer(w);
  if (is_box(p, n)) {
    fprintf(file, "B %lld %lld %lld %lld;\n", llabs((long long)p[0].x - p[2].x),
            llabs((long long)p[0].y - p[2].y), ((long long)p[0].x + p[2].x) / 2,
            ((long long)p[0].y + p[2].y) / 2);
    return;
  }
  fputc('P', file);
  for (size_t i = 0; i < n; i++) fprintf(file, " %d %d", p[i].x, p[i].y);
  fputs(";\n", file);
}

/* Write a text as one word. */
static void put_text(void *self, eda_point at, const char *text) {
  cif *w = self;
  at_layer(w); /* the layer is set before, because readers differ in the syntax
                  of layers in a text command */
  fputs("94 ", w->w.file);
  if (!*text) fputc('_', w->w.file);
  if (!is_word(text)) w->changed++;
  for (const char *c = text; *c; c++)
    fputc(*c <= ' ' || *c > '~' || strchr(";()", *c) ? '_' : *c, w->w.file);
  fprintf(w->w.file, " %d %d;\n", at.x, at.y);
}

/* ---- work: placements ---- */

static void cif_refuse(cif *w, const char *child, const char *what) {
  writer_fail(&w->w, "'%.200s' in '%.200s': %s", child, w->w.cell, what);
}

static void put_call(cif *w, int32_t child, const eda_placement *p, int turns,
                     eda_point at) {
  static const char *const turn[] = {"", " R 0 1", " R -1 0", " R 0 -1"};
  fprintf(w->w.file, "C %d%s%s", child + 1, p->mirror ? " M Y" : "",
          turn[turns]);
  if (at.x || at.y) fprintf(w->w.file, " T %d %d", at.x, at.y);
  fputs(";\n", w->w.file);
}

/* Write one call per member of an array. */
static void put_placement(void *self, int32_t child, const char *child_name,
                          const eda_placement *p, const char *name) {
  cif *w = self;
  (void)name;
  double turns = fmod(p->angle / 90, 4);
  if (turns < 0) turns += 4;
  w->calls += (uint64_t)p->columns * p->rows;
  if (p->magnification != 1)
    cif_refuse(w, child_name, "CIF cannot magnify a cell");
  else if (turns != floor(turns))
    cif_refuse(w, child_name,
               "CIF output supports rotations by right angles only");
  else if (w->calls > MAX_CALLS || (uint64_t)p->columns * p->rows > MAX_CALLS)
    cif_refuse(w, child_name,
               "CIF has no arrays, and the array has too many elements to "
               "write individually");
  for (uint32_t r = 0; r < p->rows && !w->w.failed; r++)
    for (uint32_t c = 0; c < p->columns && !w->w.failed; c++) {
      eda_point row, at;
      if (!writer_along(p->origin, r, p->row_step, &row) ||
          !writer_along(row, c, p->column_step, &at))
        cif_refuse(w, child_name, "the array leaves the range of coordinates");
      else
        put_call(w, child, p, (int)turns, at);
    }
}

static void end_cell(void *self) { fputs("DF;\n", ((cif *)self)->w.file); }

/* ---- work: the end ---- */

/* Add calls of the cells that no other cell places. */
static void put_tops(cif *w) {
  size_t n = w->layout ? eda_layout_cells(w->layout) : 0;
  if (!w->layout) fputs("C 1;\n", w->w.file);
  uint8_t *placed = eda_alloc(n, 1);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < eda_layout_instances(w->layout, (int32_t)i); k++) {
      int32_t child;
      eda_placement p;
      eda_layout_instance(w->layout, (int32_t)i, k, &child, &p);
      placed[child] = 1;
    }
  for (size_t i = 0; i < n; i++)
    if (!placed[i]) fprintf(w->w.file, "C %zu;\n", i + 1);
  free(placed);
}

static void cif_end(void *self) {
  cif *w = self;
  put_tops(w);
  fputs("E\n", w->w.file);
  if (w->changed)
    w->w.host->log(w->w.host, OPC_LOG_WARNING,
                   "'%s': characters of %zu texts are replaced by '_', because "
                   "CIF does not allow them",
                   w->w.path, w->changed);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] =
    WRITE_PARAMETERS(cif, "mask.cif", "Layer names, as in { poly: CP }");

static const write_format format = {
    .layer = "CP",
    .most_points = SIZE_MAX,
    .name_layer = name_layer,
    .set_layer = set_layer,
    .begin = cif_begin,
    .begin_cell = begin_cell,
    .polygon = put_polygon,
    .text = put_text,
    .placement = put_placement,
    .end_cell = end_cell,
    .end = cif_end,
};

static int cif_check(void *self, opc_error *error) {
  return writer_check(self, &format, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = writer_run,
                                   .forecast = writer_forecast};

OPC_PLUGIN(cif, .id = "write.cif", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "Write a layout or a mask as a CIF file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = cif_check,
           OPC_FUNCTIONS(functions));
