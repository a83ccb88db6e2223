/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OPCFLOW_HOPKINS_DISKS_H
#define OPCFLOW_HOPKINS_DISKS_H

/* The area common to the disk of radius sigma around the origin (the source)
   and the unit disks around (r1, 0) and around r2 (cos angle, sin angle) (the
   pupil as two frequencies see it). Exact: an integral along the arcs of its
   border. Any thread. */
double opc_common_area(double sigma, double r1, double r2, double angle);

#endif
