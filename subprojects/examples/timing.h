/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "timing": how long a transistor takes. A kind that opcflow knows nothing
   of: kind.timing brings it, and plugins of it fit into any slot that asks for
   "timing". */
#pragma once

#include <opcflow/plugin.h>

typedef struct timing {
  /* How long, in s, a transistor of that on current (A) takes to charge the
     gate area (nm^2) of one like it; more current, less time. [any] */
  double (*delay)(const void *self, double ion, double area);
} timing;
