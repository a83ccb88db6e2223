/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* Return the area of the intersection of three disks. The first disk, with
   radius sigma around the origin, is the source. The other two, with radius 1
   around (r1, 0) and around (r2 cos(angle), r2 sin(angle)), are shifted pupils.
   The result is exact: an integral along the arcs that bound the intersection.
   [any] (opcflow/plugin.h) */
double opc_common_area(double sigma, double r1, double r2, double angle);
