/* SPDX-License-Identifier: BSD-3-Clause */
#include "descent.h"

#include <stdlib.h>

int descent_begin(descent *d, size_t count) {
  descent_clear(d);
  d->state = calloc(count + 1, sizeof *d->state);
  d->moved = calloc(count + 1, sizeof *d->moved);
  d->count = count;
  d->begun = d->fine = 0;
  return d->state && d->moved;
}

static control_input input(const descent *d, const opc_feedback *f, size_t i) {
  return (control_input){.error = d->error(d->self, f, i),
                         .width = f->gates->width[i] / f->gates->grid,
                         .veto = f->vetoes[i]};
}

static int next_length(descent *d, const opc_feedback *f, size_t i,
                       opc_moves *moves) {
  control_input in = input(d, f, i);
  if (d->begun)
    return control_length(&d->rules, &d->state[i], &in, &moves->l[i],
                          moves->w[i]);
  return control_first(&d->rules, &d->state[i], &in, d->first(d->self, f, i),
                       &moves->l[i]);
}

descent_moves descent_update(descent *d, const opc_feedback *f,
                             opc_moves *moves, int lengths_only) {
  descent_moves m = {0};
  for (size_t i = 0; i < d->count; i++) {
    d->moved[i] = (uint8_t)next_length(d, f, i, moves);
    m.lengths += d->moved[i];
  }
  if (!m.lengths && !lengths_only) d->fine = 1;
  for (size_t i = 0; i < d->count; i++) {
    control *c = &d->state[i];
    control_input in = input(d, f, i);
    if (d->begun && d->fine && !d->moved[i])
      m.widths += control_width(&d->rules, c, &in, &moves->w[i]) != 0;
    m.changed |= d->begun && c->error != in.error;
    c->error = in.error;
  }
  d->begun = 1;
  return m;
}

void descent_clear(descent *d) {
  free(d->state);
  free(d->moved);
  d->state = NULL;
  d->moved = NULL;
  d->count = 0;
}
