/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours of all pictures. Lines: the palette of Okabe and Ito and darker
   colours of the same hue. Fills: tints of the line colours. Deviations: RdBu
   of Brewer. Intensities: YlGnBu of Brewer. The colours are distinguishable
   with all common forms of colour blindness. */
#include <eda/drawing.h>
#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

const eda_colour eda_ink = EDA_COLOUR(0x202020),
                 eda_faint = EDA_COLOUR(0x9a9a9a),
                 eda_unknown = EDA_COLOUR(0x8c8c8c),
                 eda_ring_colour = EDA_COLOUR(0xd94019),
                 eda_contact_fill = EDA_COLOUR(0xbcbcbc);

/* Colours of poly, active, and the further layers in order, repeated
   cyclically. */
static const struct {
  eda_colour fill, outline, contour;
} layers[] = {
    {EDA_COLOUR(0xdedede), EDA_COLOUR(0xe07000), EDA_COLOUR(0x4a2000)},
    {EDA_COLOUR(0xd9eee2), EDA_COLOUR(0x009e73), EDA_COLOUR(0x00402e)},
    {EDA_COLOUR(0xf3e3ec), EDA_COLOUR(0xcc79a7), EDA_COLOUR(0x5c1f42)},
    {EDA_COLOUR(0xdbe8f2), EDA_COLOUR(0x0072b2), EDA_COLOUR(0x002f4a)},
    {EDA_COLOUR(0xfaf7d4), EDA_COLOUR(0xb5a800), EDA_COLOUR(0x4a4500)},
    {EDA_COLOUR(0xe2f2fb), EDA_COLOUR(0x56b4e9), EDA_COLOUR(0x174f6e)},
};

static const eda_colour diverging[] = {
    EDA_COLOUR(0x2166ac), EDA_COLOUR(0x4393c3), EDA_COLOUR(0x92c5de),
    EDA_COLOUR(0xd1e5f0), EDA_COLOUR(0xffffff), EDA_COLOUR(0xfddbc7),
    EDA_COLOUR(0xf4a582), EDA_COLOUR(0xd6604d), EDA_COLOUR(0xb2182b)};
static const eda_colour sequential[] = {
    EDA_COLOUR(0x081d58), EDA_COLOUR(0x253494), EDA_COLOUR(0x225ea8),
    EDA_COLOUR(0x1d91c0), EDA_COLOUR(0x41b6c4), EDA_COLOUR(0x7fcdbb),
    EDA_COLOUR(0xc7e9b4), EDA_COLOUR(0xedf8b1), EDA_COLOUR(0xffffd9)};

void eda_use(cairo_t *cairo, eda_colour colour) {
  cairo_set_source_rgb(cairo, colour.r, colour.g, colour.b);
}

eda_colour eda_layer_fill(size_t layer) {
  return layers[layer % COUNT(layers)].fill;
}

eda_colour eda_layer_outline(size_t layer) {
  return layers[layer % COUNT(layers)].outline;
}

eda_colour eda_layer_contour(size_t layer) {
  return layers[layer % COUNT(layers)].contour;
}

/* Interpolate linearly between n colour stops, t from 0 to 1. */
static eda_colour colour_between(const eda_colour *stops, size_t n, double t) {
  if (!(t > 0)) return stops[0];
  if (t >= 1) return stops[n - 1];
  double place = t * (double)(n - 1);
  size_t i = (size_t)place;
  double f = place - (double)i;
  eda_colour a = stops[i], b = stops[i + 1];
  return (eda_colour){a.r + f * (b.r - a.r), a.g + f * (b.g - a.g),
                      a.b + f * (b.b - a.b)};
}

eda_colour eda_diverging(double t) {
  return colour_between(diverging, COUNT(diverging), t);
}

eda_colour eda_sequential(double t) {
  return colour_between(sequential, COUNT(sequential), t);
}

uint32_t eda_colour_packed(eda_colour c) {
  return (uint32_t)lround(255 * c.r) << 16 | (uint32_t)lround(255 * c.g) << 8 |
         (uint32_t)lround(255 * c.b);
}
