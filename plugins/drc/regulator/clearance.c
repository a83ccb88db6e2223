/* SPDX-License-Identifier: BSD-3-Clause */
/* Line ends look outwards through a window, for the drawn poly edges in it. */
#include "clearance.h"

void line_end_clearance(const opc_gates *g, const bins *poly, int32_t range,
                        int32_t beside, int32_t *out) {
  const opc_edges *e = &g->edges[OPC_POLY];
  for (size_t i = 0; i < 2 * g->count; i++) out[i] = range;
  for (size_t p = 0; p < e->polygons; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const opc_fragment *f = &e->fragments[i];
      if (f->role != OPC_END_LOW && f->role != OPC_END_HIGH) continue;
      uint32_t next = i + 1 < e->start[p + 1] ? i + 1 : e->start[p];
      opc_point a = f->from, b = e->fragments[next].from;
      opc_box end = {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                     a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
      int high = f->role == OPC_END_HIGH;
      int side = g->axis[f->gate] == OPC_Y ? (high ? RIGHT : LEFT)
                                           : (high ? ABOVE : BELOW);
      /* From the next step on, without its own edge. */
      opc_box window = bins_window(end, side, 1, range, beside);
      out[2 * f->gate + high] =
          bins_nearest(poly, window, side, range - 1, NULL) + 1;
    }
}
