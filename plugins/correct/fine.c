/* SPDX-License-Identifier: BSD-3-Clause */
/* From how far off an Ion may be to how good a print has to be. */
#include "fine.h"

#include <glib.h>
#include <math.h>

/* Ours. */
static const struct {
  double limit, error, least, most, margin, near;
} tuned = {
    /* Prints of 2e-4 and of 1e-4 of a corrected circuit differ by 0.03 % of Ion
       (standard deviation), 0.13 % at most, so that those of 1e-4 are within a
       tenth of 0.5 %. Both go with each other. */
    .limit = 0.5,
    .error = 1e-4,

    /* What single precision and a layout's kernels give; and what kernels that
       are quick to find give by themselves. */
    .least = 1e-5,
    .most = 1e-3,

    /* nm: how far the light of an edge counts, at 1e-4 and where there is no
       fine print. */
    .margin = 3000,
    .near = 1000,
};

int fine_error(const char *text, double limit, double *fine, opc_error *error) {
  char *end = NULL;
  *fine =
      fmin(fmax(tuned.error * limit / tuned.limit, tuned.least), tuned.most);
  if (!text) return OPC_OK;
  *fine = 0;
  if (!g_strcmp0(text, "off")) return OPC_OK;
  *fine = g_ascii_strtod(text, &end);
  if (end != text && !*end && *fine > 0 && *fine < 0.1) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "fine",
                  "'fine' is %s: a number above 0 and below 0.1, or off", text);
}

double fine_margin(double margin, double fine) {
  return !isnan(margin) ? margin : fine > 0 ? tuned.margin : tuned.near;
}
