/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours: lines of Okabe and Ito's palette and darker ones of the same hue,
   fills tints of it, deviations on Brewer's RdBu, intensities on YlGnBu. All of
   these can be told apart with any common colour blindness. */
#include "colours.h"

const rgb picture_drawn[OPC_LAYERS] = {[OPC_POLY] = RGB(0xdedede),
                                       [OPC_ACTIVE] = RGB(0xd9eee2),
                                       [OPC_CONTACT] = RGB(0xbcbcbc)};
const rgb picture_mask[OPC_MASKS] = {
    [OPC_POLY] = RGB(0xe07000), [OPC_ACTIVE] = RGB(0x009e73)};
const rgb picture_print[OPC_MASKS] = {
    [OPC_POLY] = RGB(0x4a2000), [OPC_ACTIVE] = RGB(0x00402e)};
const rgb picture_ink = RGB(0x202020), picture_faint = RGB(0x9a9a9a),
          picture_unknown = RGB(0x8c8c8c);

/* From the lowest to the highest deviation. */
static const rgb diverging[] = {RGB(0x2166ac), RGB(0x4393c3), RGB(0x92c5de),
                                RGB(0xd1e5f0), RGB(0xffffff), RGB(0xfddbc7),
                                RGB(0xf4a582), RGB(0xd6604d), RGB(0xb2182b)};
/* From dark to light: Brewer's YlGnBu. */
static const rgb sequential[] = {RGB(0x081d58), RGB(0x253494), RGB(0x225ea8),
                                 RGB(0x1d91c0), RGB(0x41b6c4), RGB(0x7fcdbb),
                                 RGB(0xc7e9b4), RGB(0xedf8b1), RGB(0xffffd9)};

#define STOPS(scale) (sizeof(scale) / sizeof((scale)[0]))

void picture_use(cairo_t *cairo, rgb colour) {
  cairo_set_source_rgb(cairo, colour.r, colour.g, colour.b);
}

/* Linear between the stops; t from 0 to 1, clamped. */
static rgb between(const rgb *scale, size_t stops, double t) {
  if (!(t > 0)) return scale[0];
  if (t >= 1) return scale[stops - 1];
  double place = t * (double)(stops - 1);
  size_t i = (size_t)place;
  double f = place - (double)i;
  rgb a = scale[i], b = scale[i + 1];
  return (rgb){a.r + f * (b.r - a.r), a.g + f * (b.g - a.g),
               a.b + f * (b.b - a.b)};
}

rgb picture_diverging(double t) {
  return between(diverging, STOPS(diverging), (t + 1) / 2);
}

rgb picture_sequential(double t) {
  return between(sequential, STOPS(sequential), t);
}
