/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `library.sheet`: a layout that contains each cell of
   another layout once, as drawn and isolated. */
#include <glib.h>
#include <math.h>
#include <opcflow/step.h>
#include <string.h>

#include <correct/units.h>

/* ---- state ---- */

typedef struct sheet {
  const opc_host *host;
  const eda_layout *layout;
  const char *top, *cells, *boundary;
  int neighbours;
} sheet;

enum { NONE, ITSELF }; /* values of `neighbours` */

/* Space between two cells, nm; larger than the search range of
   segment.transistors. The space need not exceed the optical range, because
   library.build extracts each cell from the sheet before simulation. */
static const double gap = 4000;

/* Step of positions, database units: a multiple of any mask grid, so that the
   position does not change the rounding of a cell to the grid. */
enum { STEP = 10000 };

/* ---- work ---- */

typedef struct maker {
  const sheet *sheet;
  eda_layout *out;
  int32_t top;
  int64_t x, y, row, width; /* next position, height of the row, largest width
                               of a row */
  size_t count;
  opc_error *error;
} maker;

/* Bounding boxes of a cell: of all shapes, and of the boundary layer. */
typedef struct extents {
  eda_box shapes, boundary;
} extents;

static int copy_layer(const maker *m, int32_t from, int32_t to, int32_t layer,
                      extents *of) {
  const eda_layout *in = m->sheet->layout;
  const char *name = eda_layout_layer_name(in, layer);
  double fine = eda_layout_unit(in);
  int32_t into = eda_layout_layer(m->out, name, m->error);
  if (into >= 0)
    eda_layout_set_file_layer(m->out, into, eda_layout_file_layer(in, layer));
  eda_flat flat;
  if (into < 0) return m->error->code;
  int code = eda_layout_flatten(in, from, layer, fine, &flat, m->error);
  const eda_shapes *s = &flat.shapes;
  for (size_t i = 0; i < s->count && !code; i++) {
    const eda_point *p = s->points + s->start[i];
    size_t n = s->start[i + 1] - s->start[i];
    eda_box b = eda_bounds(p, n);
    eda_box_join(&of->shapes, b);
    if (!strcmp(name, m->sheet->boundary)) eda_box_join(&of->boundary, b);
    code = eda_layout_add_polygon(m->out, to, into, p, n, m->error);
  }
  eda_flat_clear(&flat);
  if (code) return code;
  eda_flat_texts texts;
  code = eda_layout_flatten_texts(in, from, layer, fine, &texts, m->error);
  for (size_t i = 0; !code && i < texts.at.shapes.count; i++)
    code = eda_layout_add_text(m->out, to, into, texts.at.shapes.points[i],
                               texts.text[i], m->error);
  eda_flat_texts_clear(&texts);
  return code;
}

static int64_t step_up(double x) { return (int64_t)ceil(x / STEP) * STEP; }

/* Find a position, a multiple of STEP, for a cell with shapes in box b. Rows
   are filled from left to right. */
static int find_place(maker *m, eda_box b, eda_point *out) {
  double clear = gap / eda_layout_unit(m->sheet->layout);
  int64_t wide = step_up((double)b.x1 - b.x0 + clear),
          high = step_up((double)b.y1 - b.y0 + clear);
  if (m->x && m->x + wide > m->width) {
    m->x = 0;
    m->y += m->row;
    m->row = 0;
  }
  int64_t x = m->x - (int64_t)floor((double)b.x0 / STEP) * STEP,
          y = m->y - (int64_t)floor((double)b.y0 / STEP) * STEP;
  if (x > INT32_MAX / 2 || y > INT32_MAX / 2)
    return opc_fail(m->error, OPC_INVALID, NULL,
                    "too many cells for one sheet: select some with 'cells'");
  *out = (eda_point){(int32_t)x, (int32_t)y};
  m->x += wide;
  m->row = MAX(m->row, high);
  return OPC_OK;
}

static int sheet_put(const maker *m, int32_t cell, const char *name,
                     eda_point at, uint32_t mirror) {
  eda_placement p = {.origin = at,
                     .magnification = 1,
                     .mirror = mirror,
                     .columns = 1,
                     .rows = 1};
  return eda_layout_add_instance(m->out, m->top, cell, &p, name, m->error);
}

/* Place eight copies of a cell as in rows of cells: unchanged to the left and
   right, mirrored above and below, so that supply lines coincide. The names are
   NAME~1 to NAME~8. */
static int put_neighbours(const maker *m, int32_t cell, const char *name,
                          eda_point at, eda_box b) {
  int code = OPC_OK;
  int32_t wide = b.x1 - b.x0;
  for (int k = 0, n = 0; k < 9 && !code; k++) {
    int column = k % 3 - 1, row = k / 3 - 1;
    if (!column && !row) continue;
    int32_t up = row > 0 ? 2 * b.y1 : row < 0 ? 2 * b.y0 : 0;
    eda_point there = {at.x + column * wide, at.y + up};
    g_autofree char *label = g_strdup_printf("%s~%d", name, ++n);
    code = sheet_put(m, cell, label, there, row != 0);
  }
  return code;
}

static int sheet_place(maker *m, int32_t cell, const char *name,
                       const extents *of) {
  eda_box b = of->boundary, extent = of->shapes;
  int around = m->sheet->neighbours == ITSELF;
  eda_point at = {0, 0};
  if (around && b.x0 > b.x1)
    return opc_fail(
        m->error, OPC_INVALID, "boundary",
        "cell '%s' has no shape on layer '%s', expected its abutment "
        "box",
        name, m->sheet->boundary);
  if (around) {
    int32_t wide = b.x1 - b.x0, high = b.y1 - b.y0;
    extent = (eda_box){extent.x0 - wide, extent.y0 - high, extent.x1 + wide,
                       extent.y1 + high};
  }
  int code = find_place(m, extent, &at);
  if (!code) code = sheet_put(m, cell, name, at, 0);
  return code || !around ? code : put_neighbours(m, cell, name, at, b);
}

static int add_cell(maker *m, int32_t from) {
  static const eda_box nothing = EDA_BOX_EMPTY;
  const eda_layout *in = m->sheet->layout;
  const char *name = eda_layout_cell_name(in, from);
  int32_t to = eda_layout_cell(m->out, name, m->error);
  extents of = {nothing, nothing};
  int code = to < 0 ? m->error->code : OPC_OK;
  for (size_t k = 0; k < eda_layout_layers(in) && !code; k++)
    code = copy_layer(m, from, to, (int32_t)k, &of);
  if (code || of.shapes.x0 > of.shapes.x1) return code;
  m->count++;
  return sheet_place(m, to, name, &of);
}

static int is_wanted(const sheet *s, const char *name) {
  if (!s->cells) return 1;
  g_auto(GStrv) patterns = g_strsplit_set(s->cells, ", ", -1);
  for (char **p = patterns; *p; p++)
    if (**p && g_pattern_match_simple(*p, name)) return 1;
  return 0;
}

/* Return a row width that makes the sheet about square. */
static int64_t row_width(const eda_layout *layout, size_t cells) {
  double one = fmax(2 * gap / eda_layout_unit(layout), STEP);
  return step_up(ceil(sqrt((double)cells)) * one);
}

static int add_all(maker *m, const units *found) {
  const eda_layout *in = m->sheet->layout;
  g_autofree char *seen = g_malloc0(eda_layout_cells(in) + 1);
  int code = OPC_OK;
  m->width = row_width(in, MIN(found->count, eda_layout_cells(in)));
  for (size_t i = 0; i < found->count; i++) seen[found->unit[i].cell] = 1;
  for (size_t c = 0; c < eda_layout_cells(in) && !code; c++)
    if (seen[c] && is_wanted(m->sheet, eda_layout_cell_name(in, (int32_t)c)))
      code = add_cell(m, (int32_t)c);
  if (!code && !m->count)
    code = opc_fail(m->error, OPC_INVALID, m->sheet->cells ? "cells" : NULL,
                    "no cell %s poly or active",
                    m->sheet->cells ? "with a name of 'cells' draws" : "draws");
  return code;
}

static int sheet_make(maker *m) {
  const sheet *s = m->sheet;
  units found = {0};
  int32_t top = s->top ? eda_layout_find_cell(s->layout, s->top) : -1;
  if (s->top && top < 0)
    return opc_fail(m->error, OPC_INVALID, "top", "cell '%s' does not exist",
                    s->top);
  int code = correct_units_find(s->layout, top, &found, m->error);
  m->top = eda_layout_cell(m->out, "library sheet", m->error);
  if (!code && m->top < 0) code = m->error->code;
  if (!code) code = add_all(m, &found);
  g_free(found.unit);
  if (code) return code;
  return s->host->metric(s->host, "cells", (double)m->count, m->error);
}

static int sheet_run(void *self, void **outputs, opc_error *error) {
  sheet *s = self;
  maker m = {.sheet = s, .error = error};
  outputs[0] = m.out = eda_layout_new(eda_layout_unit(s->layout), error);
  return m.out ? sheet_make(&m) : error->code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(sheet, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout",
                  .summary = "Layout of a circuit or a library"),
    OPC_PARAMETER(sheet, top, .type = OPC_TEXT,
                  .summary = "Cell of the circuit whose cells are placed on "
                             "the sheet (default: all top cells)"),
    OPC_PARAMETER(sheet, cells, .type = OPC_TEXT,
                  .summary = "Names of cells, with wildcards * and ?, "
                             "separated by spaces (default: all)"),
    OPC_PARAMETER(sheet, neighbours, .type = OPC_CHOICE, .preset = "none",
                  .choices = "none|itself",
                  .summary = "Environment of a cell during its correction: "
                             "none, or copies of the cell as in rows"),
    OPC_PARAMETER(
        sheet, boundary, .type = OPC_TEXT, .preset = "outline",
        .summary = "Layer whose shapes are the abutment boxes of cells"),
};

static const opc_metric metrics[] = {
    {"cells", NULL, OPC_NEUTRAL, 0, "cells on the sheet"},
};

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = sheet_run,
                                   .flags = OPC_STEP_LIGHT};

OPC_PLUGIN(sheet, .id = "library.sheet", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "place each cell of a layout alone on a sheet",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
