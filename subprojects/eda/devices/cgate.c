/* SPDX-License-Identifier: BSD-3-Clause */
/* Gate capacitance from a table, by linear interpolation in L and W. Above the
   largest width, the capacitance is proportional to W. */
#include <eda/devices.h>
#include <math.h>

/* Return the capacitance (F) at width `row` of the table, interpolated between
   lengths `low` and low + 1. d->narrow as `row` denotes the largest width. */
static double of_row(const eda_devices *d, int type, size_t row, size_t low,
                     double part) {
  int wide = row == d->narrow;
  const double *c =
      wide ? d->cgate[type] : d->narrow_cgate[type] + row * d->count;
  double width = wide ? d->width : d->narrow_width[row];
  return width * (c[low] + part * (c[low + 1] - c[low]));
}

double eda_devices_cgate(const eda_devices *d, int type, double length,
                         double width) {
  const double *x = d->length;
  size_t low = 0, row = 0;
  if (!d->cgate[type]) return NAN;
  if (!(length >= x[0] && length <= x[d->count - 1] && width > 0)) return NAN;
  while (x[low + 1] < length) low++;
  double part = (length - x[low]) / (x[low + 1] - x[low]);
  if (!d->narrow || width >= d->width)
    return width / d->width * of_row(d, type, d->narrow, low, part);
  const double *w = d->narrow_width;
  if (!(width >= w[0])) return NAN;
  while (row + 1 < d->narrow && w[row + 1] < width) row++;
  double next = row + 1 < d->narrow ? w[row + 1] : d->width;
  double c = of_row(d, type, row, low, part);
  return c + (width - w[row]) / (next - w[row]) *
                 (of_row(d, type, row + 1, low, part) - c);
}
