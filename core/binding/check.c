/* SPDX-License-Identifier: BSD-3-Clause */
/* All that can be told without work about a flow with its variants and what it
   sweeps. */
#include "core/binding/flow.h"

/* Of an axis; of more values the first ones and the last one are looked at. */
enum { MOST_VALUES = 1000 };

static void check_one(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      opc_problems *problems) {
  if (opc_problems_full(problems)) return;
  g_autoptr(opc_problems) found = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_make(recipe, choice, registry, found);
  if (!found->list->len && watch)
    opc_flow_create(flow, NULL, watch, NULL, found);
  g_autofree char *note =
      choice->variant ? g_strdup_printf(" (variant '%s')", choice->variant)
                      : NULL;
  opc_problems_merge(problems, found, note);
}

/* Each value of each axis once: a fault of one combination alone is rare, and
   is found when its turn comes. */
void opc_flow_check(const opc_recipe *recipe, const opc_choice *choice,
                    opc_registry *registry, const opc_watch *watch,
                    opc_problems *problems) {
  opc_choice at = *choice;
  at.point = 0;
  check_one(recipe, &at, registry, watch, problems);
  const GPtrArray *axes = choice->sweep ? choice->sweep->axes : NULL;
  for (guint a = 0; axes && a < axes->len; a++) {
    guint n = ((const opc_axis *)axes->pdata[a])->values->len;
    for (guint i = 1; i < n; i++) {
      if (i == MOST_VALUES - 1) i = n - 1;
      at.point = opc_sweep_point(choice->sweep, a, i);
      check_one(recipe, &at, registry, watch, problems);
    }
  }
}
