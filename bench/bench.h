/* SPDX-License-Identifier: BSD-3-Clause */
/* Figures of benchmarks, each with a goal. For single-threaded programs. */
#pragma once

#include <stddef.h>

enum {
  BENCH_LOWER,
  BENCH_HIGHER
}; /* whether lower or higher values are
      better */

/* Keep a figure for bench_write. Names are "circuit.figure". `reach` is
   INFINITY where there is nothing to reach (null in the file). */
void bench_report(const char *name, double value, const char *unit,
                  double reach, int better);

/* Show all figures as a table and write them to NAME.json in the folder that
   OPCFLOW_BENCH names (default: the current one), as a list of
   { name, value, unit, reach, better }. Returns the exit code of the program:
   figures that fall short of their reach are shown, but are no failure. */
int bench_write(const char *name);

/* Return the median; sorts the values. */
double bench_median(double *values, size_t n);
