/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "timing": models of a transistor's delay. The kind is not built into
   opcflow: kind.timing declares it, and slots of the kind "timing" accept its
   plugins. */
#pragma once

#include <opcflow/plugin.h>

/* Functions of a timing model. */
typedef struct timing {
  /* Return the time, in s, in which a transistor with the on current `ion` (A)
     charges the gate of an equal transistor, of area `area` (nm^2). The time
     must not increase with the current. [any]: see plugin.h. */
  double (*delay)(const void *self, double ion, double area);
} timing;
