/* SPDX-License-Identifier: BSD-3-Clause */
/* Order of the cells, numbers and paths of placements, and the top cell.

   Placements are numbered depth first: a cell before the cells in it, instances
   in their order, array members row by row. A cell has no numbers if the cell
   and all cells below contain no shape and no text. Instances of such cells are
   skipped. */
#include <stdlib.h>
#include <string.h>

#include "layout/layout.h"

/* ---- order of cells, numbers of placements ---- */

static uint64_t cell_drawn(const cell *c) {
  uint64_t n = c->n_labels;
  for (size_t i = 0; i < c->n_sheets; i++)
    n += sheet_boxes(&c->sheets[i]) + c->sheets[i].n_polygons;
  return n;
}

/* Number the placements in a cell whose child cells are already numbered. */
static void number_placements(eda_layout *layout, cell *c) {
  uint64_t next = 1;
  for (size_t i = 0; i < c->n_instances; i++) {
    const cell *child = &layout->cells[c->instances[i].child];
    c->before[i] = (uint32_t)MIN(next, UINT32_MAX);
    next = add_product(next, members(&c->instances[i]), child->placements,
                       EDA_MANY);
  }
  c->placements = next == 1 && !cell_drawn(c) ? 0 : next;
}

typedef struct visit {
  int32_t cell;
  size_t next; /* index of the next instance */
} visit;

enum { NEW = 0, OPEN = 1, DONE = 2 };

/* Visit `root` and the cells below depth first, with an explicit stack. A cell
   on the stack is OPEN. A cell is circular if it places an open cell or a
   circular cell. */
static void order_below(eda_layout *layout, int32_t root, uint8_t *state,
                        visit *stack, size_t *done) {
  size_t depth = 0;
  stack[depth++] = (visit){root, 0};
  state[root] = OPEN;
  while (depth) {
    visit *top = &stack[depth - 1];
    cell *c = &layout->cells[top->cell];
    if (top->next == c->n_instances) {
      number_placements(layout, c);
      state[top->cell] = DONE;
      layout->order[(*done)++] = top->cell;
      depth--;
      if (depth && c->circular)
        layout->cells[stack[depth - 1].cell].circular = true;
      continue;
    }
    int32_t child = c->instances[top->next++].child;
    if (state[child] == OPEN || layout->cells[child].circular)
      c->circular = true;
    if (state[child] != NEW) continue;
    state[child] = OPEN;
    stack[depth++] = (visit){child, 0};
  }
}

static void order_cells(eda_layout *layout) {
  size_t n = layout->n_cells, done = 0;
  uint8_t *state = eda_alloc(n, 1);
  visit *stack = eda_alloc(n, sizeof *stack);
  free(layout->order);
  layout->order = eda_alloc(n, sizeof *layout->order);
  for (size_t i = 0; i < n; i++) {
    cell *c = &layout->cells[i];
    free(c->before);
    c->before = eda_alloc(c->n_instances, sizeof *c->before);
    c->placements = 0;
    c->circular = false;
  }
  for (size_t i = 0; i < n; i++)
    if (state[i] == NEW) order_below(layout, (int32_t)i, state, stack, &done);
  free(state);
  free(stack);
}

void eda_layout_order(const eda_layout *layout) {
  eda_layout *writable = (eda_layout *)layout;
  if (g_atomic_int_get(&writable->ordered)) return;
  g_mutex_lock(&writable->lock);
  if (!writable->ordered) order_cells(writable);
  g_atomic_int_set(&writable->ordered, 1);
  g_mutex_unlock(&writable->lock);
}

/* ---- top cell ---- */

/* Append the names of the cells marked in `wanted`, limited to the length of a
   message. */
static void list_cells(const eda_layout *layout, const uint8_t *wanted,
                       GString *out) {
  size_t left = 0;
  for (size_t i = 0; i < layout->n_cells; i++) {
    if (!wanted[i]) continue;
    if (out->len > 600)
      left++;
    else
      g_string_append_printf(out, "%s'%.100s'", out->len ? ", " : "",
                             layout->cells[i].name);
  }
  if (left) g_string_append_printf(out, " and %zu more", left);
}

int32_t eda_layout_top(const eda_layout *layout, opc_error *error) {
  eda_layout_order(layout);
  uint8_t *mark = eda_alloc(layout->n_cells, 1);
  size_t tops = 0, circular = 0;
  int32_t top = -1;
  for (size_t i = 0; i < layout->n_cells; i++)
    circular += layout->cells[i].circular;
  if (circular) {
    for (size_t i = 0; i < layout->n_cells; i++)
      mark[i] = layout->cells[i].circular;
  } else {
    memset(mark, 1, layout->n_cells);
    for (size_t i = 0; i < layout->n_cells; i++)
      for (size_t j = 0; j < layout->cells[i].n_instances; j++)
        mark[layout->cells[i].instances[j].child] = 0;
    for (size_t i = 0; i < layout->n_cells; i++)
      if (mark[i]) {
        top = (int32_t)i;
        tops++;
      }
  }
  if (tops != 1) {
    g_autoptr(GString) names = g_string_new(NULL);
    list_cells(layout, mark, names);
    if (circular)
      opc_fail(error, OPC_INVALID, NULL,
               "cells place each other in a cycle: %s", names->str);
    else if (tops)
      opc_fail(error, OPC_INVALID, NULL,
               "the layout has %zu top cells: select one by 'top': %s", tops,
               names->str);
    else
      opc_fail(error, OPC_INVALID, NULL, "the layout has no cells");
    top = -1;
  }
  free(mark);
  return top;
}

/* ---- paths ---- */

/* Return the instance that contains placement p > 0 of a cell: the last
   instance whose first placement is at most p. */
static size_t instance_with(const cell *c, uint32_t p) {
  size_t low = 0, high = c->n_instances;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (c->before[middle] <= p)
      low = middle;
    else
      high = middle;
  }
  return low;
}

int32_t eda_layout_path(const eda_layout *layout, int32_t top, uint32_t p,
                        char *buffer, size_t capacity) {
  if (capacity) buffer[0] = '\0';
  if (top < 0 || (size_t)top >= layout->n_cells) return -1;
  eda_layout_order(layout);
  const cell *c = &layout->cells[top];
  if (c->circular || c->placements >= EDA_MANY || p >= MAX(c->placements, 1))
    return -1;
  int32_t number = top;
  size_t used = 0;
  while (p > 0) {
    size_t i = instance_with(c, p);
    const instance *in = &c->instances[i];
    const cell *child = &layout->cells[in->child];
    uint64_t member = (p - c->before[i]) / child->placements;
    p = (uint32_t)((p - c->before[i]) % child->placements);
    char name[64] = "", at[32] = "";
    if (!in->name) g_snprintf(name, sizeof name, "#%zu", i);
    if (members(in) > 1)
      g_snprintf(at, sizeof at, "[%u,%u]",
                 (unsigned)(member % in->placement.columns),
                 (unsigned)(member / in->placement.columns));
    if (used < capacity)
      used += (size_t)g_snprintf(
          buffer + used, capacity - used, "%s%s%s%s", used ? "/" : "",
          in->name ? layout->strings + in->name : child->name, name, at);
    number = in->child;
    c = child;
  }
  return number;
}
