/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the descent for all transistors: lengths are corrected first, then
   widths. */
#include "descent.h"

#include <eda/memory.h>
#include <stdlib.h>

/* Deviation, %, assumed for an open transistor: a transistor whose printed poly
   line is interrupted. An open line is too thin, so the deviation has the sign
   of too much current. */
static const double open = 100;

void descent_clear(descent *d) {
  free(d->state);
  free(d->moved);
}

void descent_reset(descent *d, size_t count) {
  descent_clear(d);
  d->state = eda_alloc(count, sizeof *d->state);
  d->moved = eda_alloc(count, sizeof *d->moved);
  d->count = count;
  d->begun = d->fine = 0;
}

static control_input descent_input(const descent *d, const eda_feedback *f,
                                   size_t i) {
  int prints = !(f->flags[i] & EDA_PRINT_OPEN);
  return (control_input){.error = prints ? d->error(d->self, f, i) : open,
                         .width = f->gates->width[i] / f->gates->grid,
                         .veto = f->vetoes[i]};
}

static int descent_next_length(descent *d, const eda_feedback *f, size_t i,
                               eda_moves *moves) {
  control_input in = descent_input(d, f, i);
  if (d->begun)
    return correct_control_length(&d->rules, &d->state[i], &in, &moves->l[i],
                                  moves->w[i]);
  return correct_control_first(&d->rules, &d->state[i], &in,
                               d->first(d->self, f, i), &moves->l[i]);
}

descent_moves descent_update(descent *d, const eda_feedback *f,
                             eda_moves *moves, int lengths_only) {
  descent_moves m = {0};
  for (size_t i = 0; i < d->count; i++) {
    d->moved[i] = (uint8_t)descent_next_length(d, f, i, moves);
    m.lengths += d->moved[i];
  }
  if ((!m.lengths || f->refines) && !lengths_only) d->fine = 1;
  for (size_t i = 0; i < d->count; i++) {
    control *c = &d->state[i];
    control_input in = descent_input(d, f, i);
    if (d->begun && d->fine && !d->moved[i])
      m.widths += correct_control_width(&d->rules, c, &in, &moves->w[i]) != 0;
    m.changed |= d->begun && c->error != in.error;
    c->error = in.error;
  }
  d->begun = 1;
  return m;
}

int descent_is_done(const opc_host *host, const eda_feedback *f,
                    const descent_moves *m) {
  host->log(host, OPC_LOG_DEBUG,
            "iteration %u: %zu lengths and %zu widths move", f->iteration,
            m->lengths, m->widths);
  return !m->lengths && !m->widths && !m->changed;
}

const char *descent_verdict(const descent *d, size_t gate) {
  return gate < d->count ? correct_control_verdict(&d->state[gate]) : NULL;
}
