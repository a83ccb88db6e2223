/* SPDX-License-Identifier: BSD-3-Clause */
/* Parts of a mask for consumers that need flat masks. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A large mask is visited in horizontal strips. Area of a strip, nm^2, and its
   smallest height, nm. The window of a strip also contains 2 to 3 um of layout
   below and above. The window of a strip of a memory 2 mm wide has about 10^5
   transistors. */
static const double strip_area = 9e8, strip_least = 4000;

/* ---- parts to simulate ---- */

int eda_mask_each_class(const eda_mask *mask, double reach,
                        eda_mask_visit *visit, void *data, opc_error *error) {
  const eda_mask_part whole = {.mask = mask, .clear = NAN, .count = 1};
  return mask->chip ? mask->access->each_class(mask, reach, visit, data, error)
                    : visit(data, &whole, error);
}

eda_gates eda_mask_part_outline(const eda_mask *mask, double reach) {
  eda_gates g = *mask->gates;
  if (!mask->chip) return g;
  double side = (mask->access->side + 2 * reach) / g.grid;
  g.extent = (eda_box){0, 0, (int32_t)ceil(side), (int32_t)ceil(side)};
  return g;
}

void eda_mask_share(eda_mask *mask, const eda_mask *of) {
  size_t n = of->gates->count;
  if (!of->chip) return;
  mask->chip = of->chip;
  mask->access = of->access;
  mask->data = of->data;
  mask->count = eda_alloc(n, sizeof *mask->count);
  if (n) memcpy(mask->count, of->count, n * sizeof *mask->count);
  if (!mask->moved) mask->moved = eda_chip_moved(of->chip, of->gates);
}

/* ---- all transistors ---- */

/* Number gate i within its instance or cell (eda_gates_owner). `of` maps the
   name of each owner to the number of its transistors found so far. */
static void number_gate(GHashTable *of, eda_gates *g, size_t i) {
  const char *owner = eda_gates_owner(g, i);
  guint n = GPOINTER_TO_UINT(g_hash_table_lookup(of, owner)) + 1;
  g->number[i] = n;
  if (n > 1)
    g_hash_table_replace(of, g_strdup(owner), GUINT_TO_POINTER(n));
  else
    g_hash_table_insert(of, g_strdup(owner), GUINT_TO_POINTER(n));
}

static GHashTable *numbers_new(void) {
  return g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
}

/* Visit a strip: the transistors whose lower edge is within `core`. Other
   transistors of the window are marked as neighbours. */
static int strip_visit(const eda_mask *mask, eda_box core, GHashTable *numbers,
                       eda_mask_part *part, eda_mask_visit *visit, void *data,
                       opc_error *error) {
  const eda_chip *c = mask->chip;
  eda_mask *m;
  int code = mask->access->window(mask, core, &m, error);
  if (code) return code;
  size_t n = m->gates->count;
  uint32_t *gate = eda_alloc(n, sizeof *gate);
  for (size_t i = 0; i < n; i++) {
    eda_box b = m->gates->box[i];
    int within = b.y0 >= core.y0 && b.y0 < core.y1;
    size_t k = within ? eda_chip_find(c, b) : SIZE_MAX;
    gate[i] = k == SIZE_MAX ? UINT32_MAX : c->gate[k].print;
    if (k != SIZE_MAX) number_gate(numbers, m->own, i);
  }
  part->mask = m;
  part->gate = gate;
  code = visit(data, part, error);
  free(gate);
  eda_mask_free(m);
  return code;
}

int eda_mask_each_strip(const eda_mask *mask, eda_mask_visit *visit, void *data,
                        opc_error *error) {
  const eda_mask_part whole = {.mask = mask, .clear = NAN, .count = 1};
  if (!mask->chip) return visit(data, &whole, error);
  eda_box e = mask->chip->extent;
  double grid = mask->gates->grid, wide = ((double)e.x1 - e.x0) * grid;
  int32_t high = (int32_t)ceil(fmax(strip_area / wide, strip_least) / grid);
  eda_mask_part part = {.clear = NAN,
                        .count = (size_t)(((int64_t)e.y1 - e.y0) / high + 1)};
  GHashTable *numbers = numbers_new();
  int code = OPC_OK;
  for (; part.index < part.count && !code; part.index++) {
    eda_box core = e;
    core.y0 = e.y0 + (int32_t)part.index * high;
    core.y1 = core.y0 + high;
    code = strip_visit(mask, core, numbers, &part, visit, data, error);
  }
  g_hash_table_destroy(numbers);
  return code;
}

/* ---- the flat mask ---- */

/* Move the gates of the first flat mask into the chip. All flat masks of the
   chip then use these gates instead of their own. */
static void flat_adopt(eda_chip *c, eda_mask *flat) {
  if (!c->flat) {
    GHashTable *numbers = numbers_new();
    c->flat = flat->own;
    for (size_t i = 0; i < c->flat->count; i++)
      number_gate(numbers, c->flat, i);
    g_hash_table_destroy(numbers);
  } else {
    eda_gates_free(flat->own);
  }
  flat->gates = c->flat;
  flat->own = NULL;
  free(flat->count);
  flat->count = NULL;
}

int eda_mask_flat(const eda_mask *mask, const eda_mask **out,
                  opc_error *error) {
  eda_mask **flat = &((eda_mask *)mask)->flat;
  int code = OPC_OK;
  *out = mask;
  if (!mask->chip) return OPC_OK;
  if (!*flat) {
    code = mask->access->window(mask, mask->chip->extent, flat, error);
    if (!code) flat_adopt(mask->chip, *flat);
  }
  *out = *flat;
  return code;
}

double eda_mask_flat_bytes(const eda_mask *mask) {
  const eda_chip *c = mask->chip;
  return c ? 2 * eda_segment_bytes(c->layout, c->top, &c->segment) : 0;
}
