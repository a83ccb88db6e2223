/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours: lines of Okabe and Ito's palette and darker ones of the same hue,
   fills tints of it, deviations on Brewer's RdBu. All of these can be told
   apart with any common colour blindness. */
#include "picture.h"

#define RGB(hex)                                             \
  {                                                          \
    ((hex) >> 16 & 255) / 255.0, ((hex) >> 8 & 255) / 255.0, \
        ((hex)&255) / 255.0                                  \
  }

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
static const rgb scale[] = {RGB(0x2166ac), RGB(0x4393c3), RGB(0x92c5de),
                            RGB(0xd1e5f0), RGB(0xffffff), RGB(0xfddbc7),
                            RGB(0xf4a582), RGB(0xd6604d), RGB(0xb2182b)};
enum { LAST = sizeof scale / sizeof scale[0] - 1 };

void picture_use(cairo_t *cairo, rgb colour) {
  cairo_set_source_rgb(cairo, colour.r, colour.g, colour.b);
}

rgb picture_diverging(double t) {
  if (!(t > -1)) return scale[0];
  if (t >= 1) return scale[LAST];
  double place = (t + 1) / 2 * LAST;
  int i = (int)place;
  double f = place - i;
  rgb a = scale[i], b = scale[i + 1];
  return (rgb){a.r + f * (b.r - a.r), a.g + f * (b.g - a.g),
               a.b + f * (b.b - a.b)};
}
