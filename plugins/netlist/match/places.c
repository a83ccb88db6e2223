/* SPDX-License-Identifier: BSD-3-Clause */
/* Assigns the devices to the gates at their places in the netlist, without
   connectivity. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "match.h"

static int refuse_place(match_task *j, const eda_transistor *d,
                        const char *fault) {
  char where[256];
  eda_netlist_where(&j->netlist, d->from, where, sizeof where);
  return opc_fail(j->error, OPC_INVALID, "file",
                  "netlist device '%.100s' (%s) %s", d->name, where, fault);
}

/* Return the gate that contains a point, nm, or UINT32_MAX. */
static uint32_t gate_at(const eda_gates *g, double x, double y) {
  for (uint32_t i = 0; i < g->count; i++) {
    const eda_box *b = &g->box[i];
    if (x > b->x0 * g->grid && x < b->x1 * g->grid && y > b->y0 * g->grid &&
        y < b->y1 * g->grid)
      return i;
  }
  return UINT32_MAX;
}

static int check_gate(match_task *j, const eda_transistor *d, uint32_t gate) {
  const eda_gates *g = j->gates;
  const double stated[] = {d->length, d->width},
               drawn[] = {g->length[gate], g->width[gate]};
  char name[256], fault[400] = "";
  match_gate_name(j, gate, name, sizeof name);
  for (int k = 0; k < 2 && !*fault; k++)
    if (fabs(drawn[k] - stated[k]) > match_slack(j, stated[k]))
      snprintf(fault, sizeof fault,
               "has %c %.6g nm, but the gate '%s' has %.6g nm", "LW"[k],
               stated[k], name, drawn[k]);
  if (d->from->type != g->type[gate])
    snprintf(fault, sizeof fault, "is of another type than the gate '%s'",
             name);
  if (j->owner[gate] != UINT32_MAX)
    snprintf(fault, sizeof fault, "is at the gate '%s' of another device",
             name);
  if (d->fingers > 1)
    snprintf(fault, sizeof fault, "has %u fingers, but one place", d->fingers);
  return *fault ? refuse_place(j, d, fault) : OPC_OK;
}

int match_places(match_task *j) {
  j->owner = match_unknown(j, j->gates->count);
  for (size_t i = 0; i < j->flat.devices; i++) {
    const eda_transistor *d = &j->flat.device[i];
    double x = d->from->x, y = d->from->y;
    char fault[200];
    if (isnan(x) || isnan(y))
      return refuse_place(j, d, "has no place ('$ x=250.5 y=400 nm')");
    uint32_t gate = gate_at(j->gates, x, y);
    snprintf(fault, sizeof fault, "has no gate at (%.10g, %.10g) nm", x, y);
    if (gate == UINT32_MAX) return refuse_place(j, d, fault);
    if (check_gate(j, d, gate)) return j->error->code;
    j->owner[gate] = (uint32_t)i;
  }
  return OPC_OK;
}
