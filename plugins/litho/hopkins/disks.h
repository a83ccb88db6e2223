/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* Return the common area of the source, a disk of radius sigma around the
   origin, and two shifted pupils, unit disks around (r1, 0) and r2 (cos angle,
   sin angle). Exact: an integral along the arcs of the border. [any] */
double opc_common_area(double sigma, double r1, double r2, double angle);
