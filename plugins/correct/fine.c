/* SPDX-License-Identifier: BSD-3-Clause */
/* From how far off an Ion may be to how good a print has to be. */
#include "fine.h"

#include <glib.h>
#include <math.h>

/* Ours. */
static const struct {
  double limit, error, least, most, margin, near;
} tuned = {
    /* % of Ion, and clear field 1. Prints of 1e-4 and of 5e-5 differed from
       those of all 1402 systems by 0.05 % of Ion in the mean and 0.27 % at
       most, and by 0.03 and 0.15 (c432 corrected, litho.hopkins when it took 83
       and 156 systems; it takes 105 and 221 now), so that the mean of 5e-5 is
       within a tenth of 0.5 %. Both go with each other. */
    .limit = 0.5,
    .error = 5e-5,

    /* What all kernels reach; and what few of them give by themselves. */
    .least = 5e-5,
    .most = 1e-3,

    /* nm, at 193 nm, NA 0.75: how far the light of an edge counts, and so much
       where there is no fine print. 4 um instead of 3 change Ion of c432 by
       0.015 % in the mean. Longer waves need more: eda_margin tells. */
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
                  "'fine' is '%s': a number above 0 and below 0.1, or off",
                  text);
}

double fine_margin(double margin, double fine) {
  return !isnan(margin) ? margin : fine > 0 ? tuned.margin : tuned.near;
}
