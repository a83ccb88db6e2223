/* SPDX-License-Identifier: BSD-3-Clause */
/* Layouts and models that the benchmarks of imaging share. The layout consists
   of rows of 65 nm lines at 250 nm pitch. */
#pragma once

#include <eda/eda.h>

#include "core/plugin/host.h"
#include "tools/devel/testing.h"

/* Cut-off of the pupil in 1/nm, and radius of the ring of source points. */
#define LINES_CUTOFF (0.75 / 193)
#define LINES_SIGMA 0.75

/* Abort with the message of `error` if `code` is not 0. */
void lines_require(int code, const opc_error *error);

/* Return the lines of a square layout of `side` nm (g_free of .start and
   .points). */
eda_shapes lines_shapes(double side);

/* Return the frame of a square layout, with margins of 1 um. */
eda_frame lines_frame(double side);

/* Return a prepared litho.hopkins. */
opc_module *lines_litho(const char *parameters);

/* Return the kernels of *count source points on a ring; at most 64. `scale`
   multiplies the band of the intensity. `count` must outlive the kernels. */
eda_kernels lines_kernels(size_t *count, double scale);
