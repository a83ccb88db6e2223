/* SPDX-License-Identifier: BSD-3-Clause */
/* Measurement of a printed gate on cut lines through the level sets of poly and
   active. */
#include "gates/gate.h"

#include <math.h>

#include "imaging/cuts.h"
#include "imaging/edge.h"

/* Search distance beyond the drawn gate, nm. */
static const double reach = 300;

/* Ratios of printed to drawn length below and above which a flag is set.
   Leakage doubles every 2 to 3 nm of length, so a much shorter slice carries
   nearly all leakage. */
static const double neck = 0.75, wide = 2;

/* Relative current error above which a flag is set. Strips of the channel with
   different widths are in series, so the current follows the harmonic mean of
   the widths. Relative to the arithmetic mean, the error is variance(width) /
   mean(width)^2. */
static const double notch_limit = 1e-3;

/* Printed edges on a cut line, as distances (nm) from a start point: [0]
   towards smaller, [1] towards larger coordinates. */
typedef struct section {
  double limit[2];    /* search limits */
  double drawn[2];    /* drawn edges of the gate */
  double distance[2]; /* printed edges; `limit` if no edge is found, 0 if the
                         start point does not print */
  int open;           /* 1: no edge within the limit on at least one side */
  int pieces;         /* 1: separate shapes print within the drawn edges */
} section;

/* Find the printed edges on the line at `at` along `axis`, from the start point
   `place`. Return whether the start point prints. */
static int field_cut(const eda_field *field, int axis, double at, double place,
                     section *s) {
  eda_line line;
  eda_line_search search[2];
  eda_line_make(field, axis, at, &line);
  int prints = eda_line_start(&line, place, &search[0], &search[1]) > 0;
  s->open = s->pieces = 0;
  for (int side = 0; side < 2; side++) {
    double d = eda_line_search_to(&search[side],
                                  prints ? s->limit[side] : s->drawn[side]);
    if (!prints)
      s->pieces |= !isnan(d);
    else if (isnan(d))
      s->open = 1;
    else if (d < s->drawn[side])
      s->pieces |= !isnan(eda_line_search_to(&search[side], s->drawn[side]));
    s->distance[side] = !prints ? 0 : isnan(d) ? s->limit[side] : d;
  }
  return prints;
}

/* Find the printed edges on n parallel lines at positions `at` along the other
   axis, all from the start point `place`. Write the distances to found[j]; set
   found[j][0] to NAN where a single cut (field_cut) is needed. */
static void cut_all(const eda_field *field, int axis, double place, size_t n,
                    const double *at, double (*found)[2], const section *s) {
  eda_cut_many(field, axis, place, fmax(s->drawn[0], s->drawn[1]), n, at,
               found);
  for (size_t j = 0; j < n; j++)
    if (!(found[j][0] <= s->limit[0] && found[j][1] <= s->limit[1]))
      found[j][0] = NAN;
}

/* Set the distances of a section from a result of cut_all. Return 0 if cut_all
   has no result, otherwise 1. */
static int section_take(const double found[2], section *s) {
  if (isnan(found[0])) return 0;
  s->open = s->pieces = 0;
  for (int side = 0; side < 2; side++) s->distance[side] = found[side];
  return 1;
}

/* Measure the printed active: mean width and mean edges over the channel
   length, by Gauss-Legendre quadrature with three points. */
static void measure_width(eda_gate *g) {
  static const double place[3] = {-0.7745966692414834, 0, 0.7745966692414834};
  static const double share[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  double half[2] = {g->middle[0] - g->low[0], g->middle[1] - g->low[1]};
  section s = {.limit = {half[1] + reach, half[1] + reach},
               .drawn = {half[1], half[1]}};
  double width = 0, square = 0, at[3], found[3][2];
  for (int k = 0; k < 3; k++) at[k] = g->middle[0] + half[0] * place[k];
  cut_all(g->active, g->axis[1], g->middle[1], 3, at, found, &s);
  g->from = g->to = g->middle[1];
  for (int k = 0; k < 3; k++) {
    int prints = section_take(found[k], &s) ||
                 field_cut(g->active, g->axis[1], at[k], g->middle[1], &s);
    if (!prints && k == 1) g->flags |= EDA_PRINT_NO_ACTIVE;
    if (s.open) g->flags |= EDA_PRINT_MERGED;
    if (s.pieces) g->flags |= EDA_PRINT_ISLAND;
    double w = s.distance[0] + s.distance[1];
    g->from -= share[k] * s.distance[0];
    g->to += share[k] * s.distance[1];
    width += share[k] * w;
    square += share[k] * w * w;
  }
  if (g->flags & EDA_PRINT_NO_ACTIVE) g->from = g->to = g->middle[1];
  if (square > (1 + notch_limit) * width * width) g->flags |= EDA_PRINT_NOTCH;
}

/* Return the extension of the printed poly beyond the printed active on `side`,
   nm; negative if the poly ends within the active; INFINITY if the drawn poly
   continues or no end is found. */
static double measure_extension(eda_gate *g, int side) {
  double drawn = g->drawn_extension[side], out = side ? 1 : -1;
  double edge = side ? g->to : g->from;
  if (isinf(drawn)) return INFINITY;
  eda_line line;
  eda_line_search search[2];
  eda_line_make(g->poly, g->axis[1], g->middle[0], &line);
  if (eda_line_start(&line, edge, &search[0], &search[1]) > 0) {
    double limit = (side ? g->high[1] : g->low[1]) + out * (drawn + reach);
    double distance = eda_line_search_to(&search[side], out * (limit - edge));
    return isnan(distance) ? INFINITY : distance;
  }
  g->flags |= EDA_PRINT_SHORT;
  double distance =
      eda_line_search_to(&search[!side], fabs(edge - g->middle[1]));
  return isnan(distance) ? -(g->high[1] - g->low[1]) / 2 : -distance;
}

/* Measure lengths (nm) at n fractions `place` of the printed width; set
   flags. */
static void measure_lengths(eda_gate *g, size_t n, const double *place,
                            double *length) {
  double half = g->middle[0] - g->low[0];
  double at[EDA_GATE_LENGTHS], found[EDA_GATE_LENGTHS][2];
  section s = {.limit = {half + fmin(reach, g->space[0] / 2),
                         half + fmin(reach, g->space[1] / 2)},
               .drawn = {half, half}};
  for (size_t j = 0; j < n; j++) at[j] = g->from + place[j] * (g->to - g->from);
  cut_all(g->poly, g->axis[0], g->middle[0], n, at, found, &s);
  for (size_t j = 0; j < n; j++) {
    if (!section_take(found[j], &s) &&
        !field_cut(g->poly, g->axis[0], at[j], g->middle[0], &s))
      g->flags |= EDA_PRINT_OPEN;
    if (s.open) g->flags |= EDA_PRINT_MERGED;
    if (s.pieces) g->flags |= EDA_PRINT_ISLAND;
    length[j] = s.distance[0] + s.distance[1];
    if (length[j] < 2 * half * neck) g->flags |= EDA_PRINT_NECK;
    if (length[j] > 2 * half * wide) g->flags |= EDA_PRINT_WIDE;
  }
}

/* Return the index of the measured `place`; g->known if `place` is not
   measured. Start the search at index `from`. */
static size_t find_known(const eda_gate *g, double place, size_t from) {
  for (size_t k = from; k < g->known; k++)
    if (g->place[k] == place) return k;
  for (size_t k = 0; k < from; k++)
    if (g->place[k] == place) return k;
  return g->known;
}

/* Compute n <= EDA_GATE_LENGTHS lengths; measure only at places that were not
   measured before. */
static void some_lengths(eda_gate *g, size_t n, const double *place,
                         double *length) {
  size_t m = 0, k = 0, which[EDA_GATE_LENGTHS];
  double wanted[EDA_GATE_LENGTHS], found[EDA_GATE_LENGTHS];
  for (size_t j = 0; j < n; j++) {
    length[j] = NAN;
    if (!(place[j] >= 0 && place[j] <= 1)) continue;
    k = find_known(g, place[j], k < g->known ? k : 0);
    if (k < g->known) {
      length[j] = g->length[k];
    } else {
      which[m] = j;
      wanted[m++] = place[j];
    }
  }
  if (m) measure_lengths(g, m, wanted, found);
  for (size_t i = 0; i < m; i++) {
    length[which[i]] = found[i];
    if (g->known == EDA_GATE_LENGTHS) continue;
    g->place[g->known] = wanted[i];
    g->length[g->known++] = found[i];
  }
}

void eda_gate_lengths(eda_gate *g, size_t n, const double *place,
                      double *length) {
  for (size_t j = 0; j < n; j += EDA_GATE_LENGTHS)
    some_lengths(g, n - j < EDA_GATE_LENGTHS ? n - j : EDA_GATE_LENGTHS,
                 place + j, length + j);
}

/* ---- interface of extractors ---- */

static double printed_length(const eda_printed_gate *shown, double place) {
  double length;
  eda_gate_lengths((eda_gate *)shown->data, 1, &place, &length);
  return length;
}

static void printed_lengths(const eda_printed_gate *shown, size_t n,
                            const double *place, double *length) {
  eda_gate_lengths((eda_gate *)shown->data, n, place, length);
}

static double drawn_length(const eda_printed_gate *shown, double place) {
  return place >= 0 && place <= 1 ? shown->design_length : NAN;
}

static void drawn_lengths(const eda_printed_gate *shown, size_t n,
                          const double *place, double *length) {
  for (size_t j = 0; j < n; j++) length[j] = drawn_length(shown, place[j]);
}

/* Set all members of `g` that need no measurement. */
static void gate_begin(const eda_gates *gates, size_t i, eda_gate *g) {
  eda_box b = gates->box[i];
  const double x[2] = {b.x0 * gates->grid, b.x1 * gates->grid};
  const double y[2] = {b.y0 * gates->grid, b.y1 * gates->grid};
  int across = gates->axis[i] == EDA_Y;
  g->axis[0] = across ? EDA_Y : EDA_X;
  g->axis[1] = across ? EDA_X : EDA_Y;
  for (int k = 0; k < 2; k++) {
    const double *side = g->axis[k] == EDA_X ? x : y;
    g->low[k] = side[0];
    g->high[k] = side[1];
    g->middle[k] = (side[0] + side[1]) / 2;
  }
  g->space = gates->space + 2 * i;
  g->drawn_extension = gates->extension + 2 * i;
  g->flags = 0;
  g->known = 0;
  g->shown = (eda_printed_gate){.type = gates->type[i],
                                .design_length = gates->length[i],
                                .design_width = gates->width[i],
                                .data = g,
                                .flavour = eda_gates_flavour(gates, i)};
}

static void gate_show(eda_gate *g, int printed) {
  g->shown.width = g->to - g->from;
  g->shown.length = printed ? printed_length : drawn_length;
  g->shown.lengths = printed ? printed_lengths : drawn_lengths;
  for (int side = 0; side < 2; side++)
    g->shown.extension[side] = g->extension[side];
}

void eda_gate_measure(const eda_gates *gates, size_t i, const eda_field *print,
                      eda_gate *g) {
  gate_begin(gates, i, g);
  g->poly = &print[EDA_POLY];
  g->active = &print[EDA_ACTIVE];
  measure_width(g);
  for (int side = 0; side < 2; side++)
    g->extension[side] = measure_extension(g, side);
  gate_show(g, 1);
}

void eda_gate_draw(const eda_gates *gates, size_t i, eda_gate *g) {
  gate_begin(gates, i, g);
  g->from = 0;
  g->to = gates->width[i];
  for (int side = 0; side < 2; side++)
    g->extension[side] = g->drawn_extension[side];
  gate_show(g, 0);
}
