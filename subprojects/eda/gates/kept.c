/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks as files. The same functions read and write, so that reading and
   writing handle the same members in the same order. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

/* This assertion fails after a member is appended to eda_mask. Add the member
   to move_mask, then change the assertion. */
G_STATIC_ASSERT(sizeof(eda_mask) ==
                G_STRUCT_OFFSET(eda_mask, flat) + sizeof(void *));

typedef struct stream {
  FILE *file;
  int writing, failed;
  uint64_t left;  /* bytes not yet read */
  opc_error full; /* code != OPC_OK: no space for a chip's records */
} stream;

/* ---- bytes ---- */

static void stream_move(stream *s, void *data, size_t size) {
  if (s->failed || !size) return;
  if (!s->writing && size > s->left)
    s->failed = 1;
  else if (s->writing)
    s->failed = fwrite(data, size, 1, s->file) != 1;
  else
    s->failed = fread(data, size, 1, s->file) != 1;
  if (!s->writing) s->left -= MIN(size, s->left);
}

/* Read or write an array of n elements, preceded by a byte: 0 if the array is
   NULL. */
static void move_array(stream *s, void *address, size_t n, size_t size) {
  void **array = address;
  uint8_t is_there = *array != NULL;
  stream_move(s, &is_there, 1);
  if (s->failed || !is_there) return;
  if (!s->writing && n > s->left / size) {
    s->failed = 1;
    return;
  }
  if (!s->writing) *array = eda_alloc(n, size);
  stream_move(s, *array, n * size);
}

static void move_count(stream *s, size_t *count) {
  uint64_t n = *count;
  stream_move(s, &n, sizeof n);
  *count = (size_t)n;
}

/* ---- a mask ---- */

/* Read or write polygons: `start` first, whose last element is the number of
   points. */
static void move_shapes(stream *s, eda_shapes *shapes) {
  move_count(s, &shapes->count);
  if (!s->writing && shapes->count > s->left) s->failed = 1;
  if (s->failed || !shapes->count) return;
  move_array(s, &shapes->start, shapes->count + 1, sizeof *shapes->start);
  if (s->failed || !shapes->start) {
    s->failed = 1;
    return;
  }
  move_array(s, &shapes->points, shapes->start[shapes->count],
             sizeof *shapes->points);
  move_array(s, &shapes->hole, shapes->count, sizeof *shapes->hole);
}

static void move_field(stream *s, eda_field *f) {
  stream_move(s, &f->frame, sizeof f->frame);
  stream_move(s, &f->nx, sizeof f->nx);
  stream_move(s, &f->ny, sizeof f->ny);
  if (f->nx < 0 || f->ny < 0) s->failed = 1;
  if (!s->failed)
    move_array(s, &f->coefficients, (size_t)f->nx * (size_t)f->ny,
               sizeof *f->coefficients);
}

static void move_performance(stream *s, eda_performance *p) {
  double **const arrays[] = {&p->ion,      &p->ioff, &p->leq_ion,
                             &p->leq_ioff, &p->weq,  &p->area};
  move_count(s, &p->count);
  for (size_t k = 0; k < G_N_ELEMENTS(arrays); k++)
    move_array(s, arrays[k], p->count, sizeof(double));
  move_array(s, &p->outside, p->count, sizeof *p->outside);
}

static void move_text(stream *s, const char **text) {
  size_t n = s->writing ? strlen(*text) : 0;
  char *copy = (char *)*text;
  move_count(s, &n);
  if (!s->writing && n > s->left) s->failed = 1;
  if (!s->writing) *text = copy = eda_alloc(s->failed ? 1 : n + 1, 1);
  stream_move(s, copy, n);
}

static void move_violations(stream *s, eda_mask *m) {
  size_t n = m->n_violations;
  move_count(s, &n);
  if (s->failed || (!s->writing && n > s->left)) {
    s->failed = 1;
    return;
  }
  if (!s->writing) m->violations = eda_alloc(n, sizeof *m->violations);
  for (size_t i = 0; i < n && !s->failed; i++) {
    eda_violation *v = &m->violations[i];
    m->n_violations = s->writing ? n : i + 1;
    move_text(s, &v->rule);
    stream_move(s, &v->gate, sizeof v->gate);
    stream_move(s, &v->x, sizeof v->x);
    stream_move(s, &v->y, sizeof v->y);
    stream_move(s, &v->value, sizeof v->value);
    stream_move(s, &v->limit, sizeof v->limit);
  }
}

static void move_list(stream *s, eda_box_list *list) {
  move_count(s, &list->count);
  move_array(s, &list->box, list->count, sizeof *list->box);
  if (!list->box) list->count = 0;
  list->capacity = list->count;
}

/* Read or write the arrays of displacements, which eda_moved_new has
   allocated. */
static void move_fields(stream *s, eda_moved *m) {
  int32_t *const numbers[] = {m->w, m->aside, m->l, m->jog};
  for (size_t k = 0; k < G_N_ELEMENTS(numbers); k++)
    stream_move(s, numbers[k], m->gates * sizeof(int32_t));
  stream_move(s, m->end, 2 * m->gates * sizeof *m->end);
  stream_move(s, m->part, EDA_PARTS * m->gates * sizeof *m->part);
  stream_move(s, m->flip, m->gates);
  stream_move(s, m->seen, m->gates * sizeof *m->seen);
  for (size_t k = 0; k < m->layers && !s->failed; k++) {
    move_list(s, &m->added[k]);
    move_list(s, &m->cutouts[k]);
  }
}

static void move_moved(stream *s, eda_mask *m) {
  uint8_t is_there = m->moved != NULL;
  stream_move(s, &is_there, 1);
  if (s->failed || !is_there) return;
  if (!s->writing) m->moved = eda_moved_new(m->layers, m->gates->count);
  move_fields(s, m->moved);
}

/* Read or write the records of a chip's transistors. */
static void move_records(stream *s, eda_chip *c) {
  if (!s->writing && c->count > s->left / sizeof *c->gate) s->failed = 1;
  if (s->failed) return;
  if (!s->writing && eda_chip_reserve(c, c->count, &s->full)) s->failed = 1;
  if (!s->failed) stream_move(s, c->gate, c->count * sizeof *c->gate);
}

/* Read or write the arrays of a chip. */
static void move_chip(stream *s, eda_chip *c) {
  size_t layers = c->layers;
  move_count(s, &layers);
  move_count(s, &c->count);
  move_count(s, &c->masks);
  move_count(s, &c->prints);
  move_count(s, &c->parts);
  move_count(s, &c->boxes);
  if (layers != c->layers) s->failed = 1;
  move_records(s, c);
  move_array(s, &c->mask, c->masks, sizeof *c->mask);
  move_array(s, &c->part, c->parts, sizeof *c->part);
  move_array(s, &c->box, c->boxes, sizeof *c->box);
}

/* Read or write the arrays of the gates of classes that do not follow from the
   chip: lengths and widths (not rounded to the grid), spaces and extensions. */
static void move_sizes(stream *s, eda_gates *g) {
  stream_move(s, g->length, g->count * sizeof *g->length);
  stream_move(s, g->width, g->count * sizeof *g->width);
  stream_move(s, g->space, 2 * g->count * sizeof *g->space);
  stream_move(s, g->extension, 2 * g->count * sizeof *g->extension);
}

static void move_mask(stream *s, eda_mask *m) {
  size_t layers = m->layers, count = m->gates->count;
  move_count(s, &layers);
  move_count(s, &count);
  /* If a count differs, the file belongs to other gates. */
  if (layers != m->layers || count != m->gates->count) s->failed = 1;
  for (size_t k = 0; k < m->layers && !s->failed; k++) {
    move_shapes(s, &m->shapes[k]);
    move_field(s, &m->print[k]);
    move_field(s, &m->drawn_print[k]);
  }
  move_performance(s, &m->design);
  move_performance(s, &m->before);
  move_performance(s, &m->after);
  move_array(s, &m->flags, count, sizeof *m->flags);
  stream_move(s, &m->iterations, sizeof m->iterations);
  stream_move(s, &m->simulations, sizeof m->simulations);
  stream_move(s, &m->fine_simulations, sizeof m->fine_simulations);
  move_violations(s, m);
  move_moved(s, m);
}

/* ---- files ---- */

/* Close the file. Return the result of reading or writing. */
static int close_stream(stream *s, const char *path, opc_error *error) {
  int code = OPC_OK;
  if (s->file && fclose(s->file)) s->failed = 1;
  if (s->full.code)
    *error = s->full, code = error->code;
  else if (!s->file || (s->writing && s->failed))
    code = opc_fail(error, OPC_IO, NULL, "'%s': cannot be %s", path,
                    s->writing ? "written" : "read");
  else if (s->failed || s->left)
    code = opc_fail(error, OPC_FAILED, NULL,
                    "'%s': the file does not belong to this mask", path);
  return code;
}

int eda_mask_save(const eda_mask *mask, const char *folder, opc_error *error) {
  int classes = mask->chip && mask->own;
  g_autofree char *path =
      g_build_filename(folder, classes ? "classes" : "mask", NULL);
  stream s = {.file = fopen(path, "wbe"), .writing = 1};
  if (s.file && classes) {
    move_chip(&s, mask->chip);
    move_sizes(&s, mask->own);
  }
  if (s.file) move_mask(&s, (eda_mask *)mask);
  return close_stream(&s, path, error);
}

/* Open the file of a mask for reading. The caller frees *path with g_free(). */
static stream open_kept(const char *folder, const char *name, char **path) {
  *path = g_build_filename(folder, name, NULL);
  stream s = {.file = fopen(*path, "rbe")};
  if (!s.file) return s;
  s.failed = fseek(s.file, 0, SEEK_END) != 0;
  s.left = s.failed ? 0 : (uint64_t)ftell(s.file);
  rewind(s.file);
  return s;
}

int eda_mask_restore(const eda_gates *gates, const char *folder, void **mask,
                     opc_error *error) {
  g_autofree char *path = NULL;
  stream s = open_kept(folder, "mask", &path);
  eda_mask *m = eda_mask_new(gates);
  *mask = m;
  if (s.file) move_mask(&s, m);
  return close_stream(&s, path, error);
}

/* Return 1 if the chip has valid indices and no class without transistors. */
static int chip_is_sound(const eda_chip *c) {
  opc_error ignored;
  if (eda_chip_check(c, &ignored)) return 0;
  g_autofree guint8 *used = g_new0(guint8, c->prints + 1);
  for (size_t i = 0; i < c->count; i++) used[c->gate[i].print] = 1;
  return !memchr(used, 0, c->prints) || !c->prints;
}

int eda_chip_mask_restore(eda_chip *c, const char *folder, void **mask,
                          opc_error *error) {
  g_autofree char *path = NULL;
  stream s = open_kept(folder, "classes", &path);
  if (s.file) move_chip(&s, c);
  if (!s.file || s.failed || !chip_is_sound(c)) {
    s.failed = 1;
    eda_chip_free(c);
    return close_stream(&s, path, error);
  }
  eda_mask *m = *mask = eda_chip_mask_new(c);
  move_sizes(&s, m->own);
  if (!s.failed) {
    eda_performance_clear(&m->design);
    eda_performance_clear(&m->before);
    eda_performance_clear(&m->after);
    free(m->flags);
    m->flags = NULL;
    move_mask(&s, m);
  }
  return close_stream(&s, path, error);
}
