/* SPDX-License-Identifier: BSD-3-Clause */
/* Figures of benchmarks, each with a goal. For single-threaded programs. */
#pragma once

#include <stddef.h>

enum { BENCH_LOWER, BENCH_HIGHER }; /* values of `better` */

/* Store a figure for bench_write. Names are "circuit.figure". `reach` is the
   goal; INFINITY stands for a figure without a goal (null in the file). */
void bench_report(const char *name, double value, const char *unit,
                  double reach, int better);

/* Print all figures as a table, and write them to NAME.json in the folder named
   by OPCFLOW_BENCH (default: the current folder). The file is a list of { name,
   value, unit, reach, better }. Returns the exit code of the program. A figure
   that misses its goal does not change the exit code. */
int bench_write(const char *name);

/* Return the median; sorts the values. */
double bench_median(double *values, size_t n);
