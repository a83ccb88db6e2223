/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kinds in requests: tables of the arrays of each struct, and one
   function that adds the arrays of a table. */
#include <string.h>

#include "py.h"

/* ---- structs of arrays ---- */

#define FIELD(of, member, notation, elements) \
  { #member, notation, offsetof(of, member), elements }

static const py_field gates_fields[] = {
    FIELD(eda_gates, box, "i4", 4),    FIELD(eda_gates, type, "u1", 0),
    FIELD(eda_gates, axis, "u1", 0),   FIELD(eda_gates, length, "f8", 0),
    FIELD(eda_gates, width, "f8", 0),  FIELD(eda_gates, space, "f8", 2),
    FIELD(eda_gates, number, "u4", 0), FIELD(eda_gates, extension, "f8", 2)};
static const py_field performance_fields[] = {
    FIELD(eda_performance, ion, "f8", 0),
    FIELD(eda_performance, ioff, "f8", 0),
    FIELD(eda_performance, leq_ion, "f8", 0),
    FIELD(eda_performance, leq_ioff, "f8", 0),
    FIELD(eda_performance, weq, "f8", 0),
    FIELD(eda_performance, area, "f8", 0),
    FIELD(eda_performance, outside, "u1", 0)};
static const py_field feedback_fields[] = {
    FIELD(eda_feedback, flags, "u4", 0), FIELD(eda_feedback, vetoes, "u4", 0),
    FIELD(eda_feedback, end, "i4", 2), FIELD(eda_feedback, next_end, "i4", 2)};
static const py_field moves_fields[] = {
    FIELD(eda_moves, l, "i4", 0), FIELD(eda_moves, w, "i4", 0),
    FIELD(eda_moves, jog, "i4", 0), FIELD(eda_moves, aside, "i4", 0),
    FIELD(eda_moves, part, "i4", 3 * EDA_PARTS)};
static const py_field printed_fields[] = {
    FIELD(eda_printed, flags, "u4", 0),
    FIELD(eda_printed, l, "i4", 0),
    FIELD(eda_printed, w, "i4", 0),
    FIELD(eda_printed, aside, "i4", 0),
    FIELD(eda_printed, extension, "f8", 2),
    FIELD(eda_printed, want_extension, "f8", 2),
    FIELD(eda_printed, want_head, "f8", 2)};
static const py_field ruling_fields[] = {FIELD(eda_ruling, vetoes, "u4", 0),
                                         FIELD(eda_ruling, end, "i4", 2)};

#define TABLE(fields) \
  { fields, G_N_ELEMENTS(fields) }
const py_table py_gates = TABLE(gates_fields),
               py_performance = TABLE(performance_fields),
               py_feedback = TABLE(feedback_fields),
               py_moves = TABLE(moves_fields),
               py_printed = TABLE(printed_fields),
               py_ruling = TABLE(ruling_fields);

/* Return the array of a field. */
static void *field_array(const py_field *f, const void *from) {
  void *array;
  memcpy(&array, (const char *)from + f->offset, sizeof array);
  return array;
}

void py_put_table(py_worker *w, const py_table *table, size_t count,
                  const void *from, int lend) {
  for (size_t i = 0; i < table->count; i++) {
    const py_field *f = &table->fields[i];
    void *array = field_array(f, from);
    if (lend)
      py_lend_array(w, f->name, f->type, count, f->width, array);
    else
      py_put_array(w, f->name, f->type, count, f->width, array);
  }
}

/* ---- other data ---- */

void py_put_performance(py_worker *w, const char *name,
                        const eda_performance *p) {
  if (!p) {
    py_put(w, name, "null");
    return;
  }
  py_begin(w, name, '{');
  py_put_table(w, &py_performance, p->count, p, 0);
  py_end(w, '}');
}

void py_put_frame(py_worker *w, eda_frame frame) {
  const double sides[] = {frame.x0, frame.y0, frame.width, frame.height};
  py_put_array(w, "frame", "f8", G_N_ELEMENTS(sides), 0, sides);
}

void py_put_scanner(py_worker *w, eda_scanner scanner) {
  py_begin(w, "scanner", '{');
  py_put_number(w, "wavelength", scanner.wavelength);
  py_put_number(w, "na", scanner.na);
  py_end(w, '}');
}

void py_put_texts(py_worker *w, const char *name, const void *texts, size_t n) {
  py_begin(w, name, '[');
  for (size_t i = 0; texts && i < n; i++)
    py_put_text(w, NULL, ((const char *const *)texts)[i]);
  py_end(w, ']');
}

void py_put_shapes(py_worker *w, const char *name, size_t layers,
                   const eda_shapes *shapes) {
  py_begin(w, name, '[');
  for (size_t k = 0; shapes && k < layers; k++) {
    const eda_shapes *s = &shapes[k];
    size_t n = s->count ? s->start[s->count] : 0;
    py_begin(w, NULL, '{');
    py_put_array(w, "start", "u4", s->count ? s->count + 1 : 0, 0, s->start);
    py_put_array(w, "points", "i4", n, 2, s->points);
    py_put_array(w, "hole", "u1", s->count, 0, s->hole);
    py_end(w, '}');
  }
  py_end(w, ']');
}

void py_put_gates(py_worker *w, const char *name, const eda_gates *g) {
  const int32_t extent[] = {g->extent.x0, g->extent.y0, g->extent.x1,
                            g->extent.y1};
  py_begin(w, name, '{');
  py_put_table(w, &py_gates, g->count, g, 0);
  py_put_text(w, "name", g->name);
  py_put_number(w, "grid", g->grid);
  py_put_int(w, "count", (int64_t)g->count);
  py_put_texts(w, "layers", g->layer, g->layers);
  py_put_texts(w, "instance", g->instance, g->count);
  py_put_texts(w, "cell", g->cell, g->count);
  py_put_texts(w, "flavour", g->flavour, g->count);
  py_put_array(w, "extent", "i4", 4, 0, extent);
  py_put_array(w, "corrected", "u1", g->layers, 0, g->corrected);
  py_put_shapes(w, "drawn", g->layers, g->drawn);
  py_end(w, '}');
}
