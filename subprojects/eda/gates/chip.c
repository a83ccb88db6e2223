/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors of a chip; assignment of their edge displacements to the
   transistors of a window. */
#include <errno.h>
#include <fcntl.h>
#include <glib.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <eda/chip.h>
#include <eda/memory.h>

/* ---- records in a file ---- */

/* Return the folder of temporary files. The default is not /tmp, which is in
   memory on many systems. */
static const char *file_folder(void) {
  const char *given = g_getenv("TMPDIR");
  return given && *given ? given : "/var/tmp";
}

static int file_fail(int fault, size_t size, opc_error *error) {
  return opc_fail(
      error, OPC_IO, NULL,
      "'%s': cannot allocate a temporary file of %zu bytes with the "
      "records of transistors: %s; set TMPDIR to another folder",
      file_folder(), size, g_strerror(fault));
}

/* Create the file and remove its name: the system frees the space when the
   file is closed or the process ends. */
static int file_open(eda_chip *c, size_t size, opc_error *error) {
  g_autofree char *path =
      g_build_filename(file_folder(), "opcflow-XXXXXX", NULL);
  int file = g_mkstemp_full(path, O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) return file_fail(errno, size, error);
  (void)unlink(path);
  c->file = file;
  return OPC_OK;
}

int eda_chip_reserve(eda_chip *c, size_t count, opc_error *error) {
  size_t size = count * sizeof *c->gate, before = c->capacity * sizeof *c->gate;
  if (count <= c->capacity) return OPC_OK;
  int code = c->capacity ? OPC_OK : file_open(c, size, error);
  if (code) return code;
  /* Without the allocation, writing to a full disk would be a bus error. */
  int fault;
  do fault = posix_fallocate(c->file, 0, (off_t)size);
  while (fault == EINTR);
  void *at = MAP_FAILED;
  if (!fault && c->capacity)
    at = mremap(c->gate, before, size, MREMAP_MAYMOVE);
  else if (!fault)
    at = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, c->file, 0);
  if (at == MAP_FAILED) {
    if (!fault) fault = errno;
    if (!c->capacity) (void)close(c->file);
    return file_fail(fault, size, error);
  }
  c->gate = at;
  c->capacity = count;
  return OPC_OK;
}

static void file_close(eda_chip *c) {
  (void)munmap(c->gate, c->capacity * sizeof *c->gate);
  (void)close(c->file);
}

/* ---- memory ---- */

void eda_chip_free(eda_chip *c) {
  if (!c) return;
  for (size_t k = 0; k < c->layers; k++) free(c->layer[k]);
  free(c->layer);
  free(c->corrected);
  if (c->capacity)
    file_close(c);
  else
    free(c->gate);
  free(c->mask);
  free(c->part);
  free(c->box);
  for (int drawn = 0; drawn < 2; drawn++) eda_layout_free(c->hierarchy[drawn]);
  eda_gates_free(c->flat);
  free(c);
}

/* ---- check ---- */

#define unsound(error, ...) opc_fail(error, OPC_FAILED, NULL, __VA_ARGS__)

static int box_before(eda_box a, eda_box b) {
  return a.y0 < b.y0 || (a.y0 == b.y0 && a.x0 < b.x0);
}

static int check_gates(const eda_chip *c, opc_error *error) {
  for (size_t i = 0; i < c->count; i++) {
    const eda_chip_gate *g = &c->gate[i];
    if (g->box.x0 >= g->box.x1 || g->box.y0 >= g->box.y1)
      return unsound(error, "transistor %zu has no size", i + 1);
    if (i && !box_before(g[-1].box, g->box))
      return unsound(error, "transistor %zu is out of order", i + 1);
    if (g->mask >= c->masks || g->print >= c->prints)
      return unsound(error, "transistor %zu has no mask or no class", i + 1);
    if (g->type > EDA_PMOS || g->axis > EDA_Y ||
        g->flip > (EDA_FLIP_L | EDA_FLIP_W))
      return unsound(error, "transistor %zu has no valid type, axis or flip",
                     i + 1);
  }
  return OPC_OK;
}

static int check_masks(const eda_chip *c, opc_error *error) {
  for (size_t i = 0; i < c->masks; i++) {
    const eda_chip_mask *m = &c->mask[i];
    if (m->parts > EDA_PARTS || (size_t)m->part + m->parts > c->parts ||
        (size_t)m->box + m->boxes > c->boxes)
      return unsound(
          error, "mask %zu refers to parts or boxes that do not exist", i + 1);
  }
  for (size_t i = 0; i < c->boxes; i++)
    if (c->box[i].layer >= c->layers)
      return unsound(error, "box %zu has no valid layer", i + 1);
  return OPC_OK;
}

int eda_chip_check(const eda_chip *c, opc_error *error) {
  if (!c) return unsound(error, "the chip is missing");
  if (!c->layout || c->top < 0 || !(c->grid > 0))
    return unsound(error, "the layout or the grid is missing");
  if (c->layers <= EDA_ACTIVE || !c->layer || !c->corrected || !c->gate ||
      !c->mask)
    return unsound(error, "an array is missing");
  int code = check_gates(c, error);
  return code ? code : check_masks(c, error);
}

/* ---- a window ---- */

size_t eda_chip_find(const eda_chip *c, eda_box box) {
  size_t from = 0, to = c->count;
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    if (box_before(c->gate[middle].box, box))
      from = middle + 1;
    else
      to = middle;
  }
  if (from == c->count) return SIZE_MAX;
  eda_box b = c->gate[from].box;
  return b.x0 == box.x0 && b.y0 == box.y0 && b.x1 == box.x1 && b.y1 == box.y1
             ? from
             : SIZE_MAX;
}

/* Convert a span from coordinates relative to [low, high] to absolute
   coordinates; `flip`: 1: mirror the span. To convert from absolute to relative
   coordinates, pass -low. */
static void span_convert(int32_t low, int32_t high, int flip, int32_t *from,
                         int32_t *to) {
  int32_t a = *from, b = *to;
  *from = flip ? high - b : low + a;
  *to = flip ? high - a : low + b;
}

static eda_box box_swapped(eda_box b) {
  return (eda_box){b.y0, b.x0, b.y1, b.x1};
}

eda_box eda_chip_place(eda_box gate, uint8_t axis, uint8_t flip, eda_box own) {
  eda_box g = axis == EDA_X ? gate : box_swapped(gate);
  span_convert(g.x0, g.x1, flip & EDA_FLIP_L, &own.x0, &own.x1);
  span_convert(g.y0, g.y1, flip & EDA_FLIP_W, &own.y0, &own.y1);
  return axis == EDA_X ? own : box_swapped(own);
}

eda_box eda_chip_own(eda_box gate, uint8_t axis, uint8_t flip, eda_box placed) {
  eda_box g = axis == EDA_X ? gate : box_swapped(gate);
  eda_box b = axis == EDA_X ? placed : box_swapped(placed);
  span_convert(-g.x0, g.x1, flip & EDA_FLIP_L, &b.x0, &b.x1);
  span_convert(-g.y0, g.y1, flip & EDA_FLIP_W, &b.y0, &b.y1);
  return b;
}

/* Copy the parts of a mask to `to`. If `backwards` is set, mirror the parts
   within the gate width, so that they stay ordered from the LOW end. */
static void put_parts(const eda_chip *c, const eda_chip_mask *m, int32_t width,
                      int backwards, eda_part *to) {
  const eda_part *from = c->part + m->part;
  for (uint32_t k = 0; k < m->parts; k++) {
    const eda_part *p = &from[backwards ? m->parts - 1 - k : k];
    to[k] = backwards ? (eda_part){width - p->to, width - p->from, p->by} : *p;
  }
}

static void put_boxes(const eda_chip *c, const eda_chip_gate *g, eda_box at,
                      const eda_chip_mask *m, eda_moved *to) {
  for (uint32_t k = 0; k < m->boxes; k++) {
    const eda_chip_box *b = &c->box[m->box + k];
    eda_box_list *list = b->cutout ? to->cutouts : to->added;
    eda_box_list_add(&list[b->layer],
                     eda_chip_place(at, g->axis, g->flip, b->box));
  }
}

void eda_chip_move(const eda_chip *c, size_t gate, eda_box at, eda_moved *to,
                   size_t i) {
  const eda_chip_gate *g = &c->gate[gate];
  const eda_chip_mask *m = &c->mask[g->mask];
  int w_back = (g->flip & EDA_FLIP_W) != 0;
  int32_t width = g->axis == EDA_X ? at.y1 - at.y0 : at.x1 - at.x0;
  to->w[i] = m->w;
  to->aside[i] = w_back ? -m->aside : m->aside;
  to->l[i] = m->l;
  to->jog[i] = m->jog;
  to->end[2 * i] = m->end[w_back];
  to->end[2 * i + 1] = m->end[!w_back];
  to->flip[i] = g->flip;
  put_parts(c, m, width, w_back, to->part + EDA_PARTS * i);
  put_boxes(c, g, at, m, to);
}

eda_moved *eda_chip_moved(const eda_chip *c, const eda_gates *window) {
  eda_moved *to = eda_moved_new(window->layers, window->count);
  for (size_t i = 0; i < window->count; i++) {
    size_t k = eda_chip_find(c, window->box[i]);
    if (k != SIZE_MAX) eda_chip_move(c, k, window->box[i], to, i);
  }
  return to;
}

/* ---- a mask ---- */

static void class_begin(eda_mask *m, eda_gates *g, size_t i) {
  const eda_chip *c = m->chip;
  const eda_chip_gate *from = &c->gate[i];
  size_t k = from->print;
  if (m->count[k]++) return;
  eda_box b = g->box[k] = from->box;
  double wide = (b.x1 - b.x0) * c->grid, high = (b.y1 - b.y0) * c->grid;
  g->type[k] = from->type;
  g->axis[k] = from->axis;
  g->length[k] = from->axis == EDA_X ? wide : high;
  g->width[k] = from->axis == EDA_X ? high : wide;
  g->instance[k] = eda_gates_text(g, "");
  g->cell[k] = g->name;
  g->number[k] = (uint32_t)(i + 1);
}

eda_mask *eda_chip_mask_new(eda_chip *c) {
  size_t n = c->prints;
  eda_gates *g = eda_gates_new(c->layers, n);
  g->name = eda_gates_text(g, eda_layout_cell_name(c->layout, c->top));
  g->grid = c->grid;
  g->extent = c->extent;
  for (size_t k = 0; k < c->layers; k++) {
    g->layer[k] = eda_gates_text(g, c->layer[k]);
    g->corrected[k] = c->corrected[k];
  }
  eda_mask *m = eda_mask_new(g);
  m->own = g;
  m->chip = c;
  m->count = eda_alloc(n, sizeof *m->count);
  for (size_t i = 0; i < c->count; i++) class_begin(m, g, i);
  eda_performance_init(&m->design, n);
  eda_performance_init(&m->before, n);
  eda_performance_init(&m->after, n);
  m->flags = eda_alloc(n, sizeof *m->flags);
  return m;
}
