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

JsonObject *py_add_table(py_worker *w, JsonObject *to, const char *name,
                         const py_table *table, size_t count,
                         const void *from) {
  JsonObject *o = py_object(to, name);
  for (size_t i = 0; i < table->count; i++) {
    const py_field *f = &table->fields[i];
    py_add_array(w, o, f->name, f->type, count, f->width, field_array(f, from));
  }
  return o;
}

void py_get_table(const py_worker *w, JsonObject *from, const py_table *table,
                  const void *to) {
  for (size_t i = 0; i < table->count; i++) {
    void *array = field_array(&table->fields[i], to);
    if (array) py_get_array(w, from, table->fields[i].name, array);
  }
}

/* ---- other data ---- */

void py_add_performance(py_worker *w, JsonObject *to, const char *name,
                        const eda_performance *p) {
  if (p)
    py_add_table(w, to, name, &py_performance, p->count, p);
  else
    json_object_set_null_member(to, name);
}

void py_add_frame(py_worker *w, JsonObject *to, eda_frame frame) {
  const double sides[] = {frame.x0, frame.y0, frame.width, frame.height};
  py_add_array(w, to, "frame", "f8", G_N_ELEMENTS(sides), 0, sides);
}

void py_add_scanner(JsonObject *to, eda_scanner scanner) {
  JsonObject *o = py_object(to, "scanner");
  py_set_number(o, "wavelength", scanner.wavelength);
  py_set_number(o, "na", scanner.na);
}

void py_add_texts(JsonObject *to, const char *name, const void *texts,
                  size_t n) {
  JsonArray *list = json_array_new();
  for (size_t i = 0; texts && i < n; i++)
    json_array_add_string_element(list, ((const char *const *)texts)[i]);
  json_object_set_array_member(to, name, list);
}

void py_add_shapes(py_worker *w, JsonObject *to, const char *name,
                   size_t layers, const eda_shapes *shapes) {
  JsonArray *list = json_array_new();
  for (size_t k = 0; shapes && k < layers; k++) {
    const eda_shapes *s = &shapes[k];
    JsonObject *o = json_object_new();
    py_add_array(w, o, "start", "u4", s->count ? s->count + 1 : 0, 0, s->start);
    py_add_array(w, o, "points", "i4", s->count ? s->start[s->count] : 0, 2,
                 s->points);
    py_add_array(w, o, "hole", "u1", s->count, 0, s->hole);
    json_array_add_object_element(list, o);
  }
  json_object_set_array_member(to, name, list);
}

void py_add_gates(py_worker *w, JsonObject *to, const char *name,
                  const eda_gates *g) {
  JsonObject *o = py_add_table(w, to, name, &py_gates, g->count, g);
  const int32_t extent[] = {g->extent.x0, g->extent.y0, g->extent.x1,
                            g->extent.y1};
  json_object_set_string_member(o, "name", g->name);
  py_set_number(o, "grid", g->grid);
  json_object_set_int_member(o, "count", (gint64)g->count);
  py_add_texts(o, "layers", g->layer, g->layers);
  py_add_texts(o, "instance", g->instance, g->count);
  py_add_texts(o, "cell", g->cell, g->count);
  py_add_texts(o, "flavour", g->flavour, g->count);
  py_add_array(w, o, "extent", "i4", 4, 0, extent);
  py_add_array(w, o, "corrected", "u1", g->layers, 0, g->corrected);
  py_add_shapes(w, o, "drawn", g->layers, g->drawn);
}
