/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `layout.array`: an array of a cell, mirrored about shared
   edges as in memories, with cells at its sides and corners. */
#include <eda/layout.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <string.h>

/* ---- state ---- */

/* A cell of the array and its layout. */
typedef struct member {
  const eda_layout *layout; /* NULL if the array has no such cell */
  int32_t cell;             /* number in the new layout */
  eda_box box; /* abuts the boxes of neighbours; in database units */
} member;

typedef struct array {
  const opc_host *host;
  member inner, row_end, column_end, corner;
  const char *top, *boundary, *name;
  int64_t columns, rows;
  int mirror;
} array;

/* Values of `mirror`. */
enum { NONE = 0, IN_ROWS = 1, IN_COLUMNS = 2, BOTH = 3 };

/* ---- work ---- */

/* Largest coordinate of the array, database units. */
static const double most = 1 << 30;

/* Compute the bounding box of the boundary layer in a cell, or of all layers if
   no boundary layer is set. */
static int find_box(const array *a, const eda_layout *layout, int32_t cell,
                    eda_box *box, opc_error *error) {
  double unit = eda_layout_unit(layout);
  int32_t from = 0, to = (int32_t)eda_layout_layers(layout);
  *box = (eda_box)EDA_BOX_EMPTY;
  if (a->boundary) {
    from = eda_layout_select(layout, a->boundary, error);
    if (from < 0) return error->code;
    to = from + 1;
  }
  for (int32_t k = from; k < to; k++) {
    eda_box b;
    if (eda_layout_bounds(layout, cell, k, unit, &b, error)) return error->code;
    if (b.x0 <= b.x1) eda_box_join(box, b);
  }
  if (box->x0 < box->x1 && box->y0 < box->y1) return OPC_OK;
  return opc_fail(
      error, OPC_INVALID, NULL, "cell '%.200s' has no area on %s%.200s",
      eda_layout_cell_name(layout, cell), a->boundary ? "layer " : "any layer",
      a->boundary ? a->boundary : "");
}

static int set_parameter(opc_error *error, const char *name) {
  (void)snprintf(error->parameter, sizeof error->parameter, "%s", name);
  return error->code;
}

/* Copy a member into the new layout and find its box. */
static int member_add(const array *a, const char *parameter, const char *top,
                      member *m, eda_layout *out, opc_error *error) {
  if (!m->layout) return OPC_OK;
  int32_t cell = top ? eda_layout_find_cell(m->layout, top)
                     : eda_layout_top(m->layout, error);
  if (cell < 0 && top)
    return opc_fail(error, OPC_INVALID, "top",
                    "the layout has no cell '%.200s'", top);
  if (cell < 0 || find_box(a, m->layout, cell, &m->box, error))
    return set_parameter(error, parameter);
  m->cell = eda_layout_import(out, m->layout, cell, error);
  return m->cell < 0 ? set_parameter(error, parameter) : OPC_OK;
}

static int32_t wide(const member *m) { return m->box.x1 - m->box.x0; }
static int32_t high(const member *m) { return m->box.y1 - m->box.y0; }

/* Fail unless the cells at sides and corners have the sizes of the cells that
   they abut. */
static int check_sizes(const array *a, opc_error *error) {
  const struct {
    const char *parameter, *side;
    const member *m;
    int32_t found, expected;
  } all[] = {
      {"row_end", "height", &a->row_end, high(&a->row_end), high(&a->inner)},
      {"column_end", "width", &a->column_end, wide(&a->column_end),
       wide(&a->inner)},
      {"corner", "width", &a->corner, wide(&a->corner), wide(&a->row_end)},
      {"corner", "height", &a->corner, high(&a->corner), high(&a->column_end)}};
  double unit = eda_layout_unit(a->inner.layout);
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    if (all[i].m->layout && all[i].found != all[i].expected)
      return opc_fail(error, OPC_INVALID, all[i].parameter,
                      "the cell has a %s of %g nm, expected %g nm as the cell "
                      "beside it",
                      all[i].side, all[i].found * unit, all[i].expected * unit);
  return OPC_OK;
}

/* Place a member in `columns` at the distance dx and `rows` at the distance dy.
   The lower left corner of the first box is at (x, y). All are mirrored as the
   flags state. */
static int put_member(const member *m, eda_layout *out, int32_t cell, int64_t x,
                      int64_t y, int left_right, int upside_down,
                      uint32_t columns, uint32_t rows, int32_t dx, int32_t dy,
                      opc_error *error) {
  if (!columns || !rows) return OPC_OK;
  eda_placement p = {.magnification = 1,
                     .angle = left_right ? 180 : 0,
                     .mirror = left_right != upside_down,
                     .columns = columns,
                     .rows = rows,
                     .column_step = {dx, 0},
                     .row_step = {0, dy}};
  p.origin.x = (int32_t)(left_right ? x + m->box.x1 : x - m->box.x0);
  p.origin.y = (int32_t)(upside_down ? y + m->box.y1 : y - m->box.y0);
  return eda_layout_add_instance(out, cell, m->cell, &p, NULL, error);
}

/* Return the number of positions k, k + step, ... below n. */
static uint32_t positions(int64_t n, int k, int step) {
  return n > k ? (uint32_t)((n - k + step - 1) / step) : 0;
}

/* Place the cells inside the array, then the ends of rows and columns on both
   sides, then the four corners. */
static int put_cells(const array *a, eda_layout *out, int32_t cell,
                     opc_error *error) {
  int sx = a->mirror & IN_ROWS ? 2 : 1, sy = a->mirror & IN_COLUMNS ? 2 : 1;
  int64_t w = wide(&a->inner), h = high(&a->inner);
  int64_t right = a->columns * w, above = a->rows * h;
  int code = OPC_OK;
  for (int i = 0; i < sx && !code; i++)
    for (int j = 0; j < sy && !code; j++)
      code = put_member(&a->inner, out, cell, i * w, j * h, i, j,
                        positions(a->columns, i, sx), positions(a->rows, j, sy),
                        (int32_t)(sx * w), (int32_t)(sy * h), error);
  for (int j = 0; j < sy && !code && a->row_end.layout; j++)
    for (int left = 0; left < 2 && !code; left++)
      code = put_member(&a->row_end, out, cell,
                        left ? -wide(&a->row_end) : right, j * h, left, j, 1,
                        positions(a->rows, j, sy), 0, (int32_t)(sy * h), error);
  for (int i = 0; i < sx && !code && a->column_end.layout; i++)
    for (int below = 0; below < 2 && !code; below++)
      code = put_member(&a->column_end, out, cell, i * w,
                        below ? -high(&a->column_end) : above, i, below,
                        positions(a->columns, i, sx), 1, (int32_t)(sx * w), 0,
                        error);
  for (int k = 0; k < 4 && !code && a->corner.layout; k++) {
    int left = k % 2, below = k / 2;
    code = put_member(&a->corner, out, cell, left ? -wide(&a->corner) : right,
                      below ? -high(&a->corner) : above, left, below, 1, 1, 0,
                      0, error);
  }
  return code;
}

static int array_build(array *a, eda_layout *out, opc_error *error) {
  int code = member_add(a, "layout", a->top, &a->inner, out, error);
  if (!code) code = member_add(a, "row_end", NULL, &a->row_end, out, error);
  if (!code)
    code = member_add(a, "column_end", NULL, &a->column_end, out, error);
  if (!code) code = member_add(a, "corner", NULL, &a->corner, out, error);
  if (!code) code = check_sizes(a, error);
  if (code) return code;
  if ((double)wide(&a->inner) * (double)a->columns > most ||
      (double)high(&a->inner) * (double)a->rows > most)
    return opc_fail(error, OPC_INVALID, "columns",
                    "the array is larger than 2^30 units of %g nm",
                    eda_layout_unit(out));
  if (eda_layout_find_cell(out, a->name) >= 0)
    return opc_fail(error, OPC_INVALID, "name",
                    "the layout has a cell '%.200s', expected another name",
                    a->name);
  int32_t cell = eda_layout_cell(out, a->name, error);
  return cell < 0 ? error->code : put_cells(a, out, cell, error);
}

static int array_run(void *self, void **outputs, opc_error *error) {
  array a = *(const array *)self;
  eda_layout *out = eda_layout_new(eda_layout_unit(a.inner.layout), error);
  outputs[0] = out; /* released by the host on failure */
  int code = out ? array_build(&a, out, error) : error->code;
  if (code) return code;
  double unit = eda_layout_unit(out);
  const opc_metric_value values[] = {
      {"cells", (double)a.columns * (double)a.rows},
      {"width", wide(&a.inner) * unit},
      {"height", high(&a.inner) * unit}};
  return opc_put_metrics(a.host, OPC_ARRAY(values), error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("layout", array, inner.layout, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "layout",
                        .summary = "Layout of the cell"),
    OPC_PARAMETER(array, top, .type = OPC_TEXT,
                  .summary = "Cell of the array (default: the only top cell)"),
    OPC_PARAMETER(array, columns, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "8", .min = 1,
                  .max = 65535, .summary = "Number of cells in a row"),
    OPC_PARAMETER(array, rows, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "8", .min = 1,
                  .max = 65535, .summary = "Number of rows"),
    OPC_PARAMETER(array, mirror, .type = OPC_CHOICE, .preset = "both",
                  .choices = "none|rows|columns|both",
                  .summary = "Where every second cell is mirrored about the "
                             "edge that it shares: in rows (left to right), in "
                             "columns (upside down), or in both"),
    OPC_PARAMETER(array, boundary, .type = OPC_TEXT,
                  .summary = "Layer whose bounding box in a cell abuts those "
                             "of neighbours (default: all layers)"),
    OPC_PARAMETER_NAMED("row_end", array, row_end.layout, .type = OPC_INPUT,
                        .choices = "layout",
                        .summary = "Layout of the cell at the right end of "
                                   "each row, mirrored at the left end"),
    OPC_PARAMETER_NAMED("column_end", array, column_end.layout,
                        .type = OPC_INPUT, .choices = "layout",
                        .summary = "Layout of the cell at the upper end of "
                                   "each column, mirrored at the lower end"),
    OPC_PARAMETER_NAMED("corner", array, corner.layout, .type = OPC_INPUT,
                        .choices = "layout",
                        .summary = "Layout of the cell at the upper right "
                                   "corner, mirrored at the others"),
    OPC_PARAMETER(array, name, .type = OPC_TEXT, .preset = "array",
                  .summary = "Name of the cell that contains the array"),
};

static const opc_metric metrics[] = {
    {"cells", NULL, OPC_NEUTRAL, 0,
     "number of cells, without those at ends and corners"},
    {"width", "nm", OPC_NEUTRAL, 0, "distance from one column to the next"},
    {"height", "nm", OPC_NEUTRAL, 0, "distance from one row to the next"},
};

static int array_check(void *self, opc_error *error) {
  const array *a = self;
  if (a->boundary && eda_layer_is_expression(a->boundary) &&
      eda_layer_check(a->boundary, error))
    return set_parameter(error, "boundary");
  return OPC_OK;
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = array_run,
                                   .flags = OPC_STEP_LIGHT};

OPC_PLUGIN(array, .id = "layout.array", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "place a cell in rows and columns, as in a memory",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = array_check, OPC_FUNCTIONS(functions));
