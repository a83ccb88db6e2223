/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements small patterns that measure the error of kernels. Their reference
   images are sums over all pairs of frequencies and are independent of the
   kernels. */
#include "patterns.h"

#include <complex.h>
#include <eda/memory.h>
#include <math.h>
#include <string.h>

/* Pattern 0: two rows of dense lines with staggered ends, an isolated line and
   a block. Lengths of all patterns are in units of a sixteenth of wavelength /
   NA. */
enum { ACROSS = 64, ALONG = 128 };
static const eda_box lines_and_block[] = {
    {2, 4, 6, 55},     {18, 9, 22, 58},   {34, 2, 38, 52}, {2, 66, 6, 122},
    {18, 70, 22, 118}, {34, 64, 38, 125}, {50, 6, 54, 90}, {46, 104, 60, 124}};

/* Patterns 1 to 4: long rows of long lines with a wide space on both sides.
   The peaks of their spectrum are as narrow as in a large layout, the worst
   case for kernels. */
enum { ROW = 480, HIGH = 4, SPACE = 48 };
static const int pitches[PATTERNS - 1] = {13, 16, 20, 27};

enum {
  MOST = ROW / 13,         /* largest number of boxes of a row */
  TOP = 2 * ROW / 16,      /* number of frequencies of a row below twice the
                              cutoff */
  TOP_X = 2 * ACROSS / 16, /* the same of the first pattern along x */
  TOP_Y = 2 * ALONG / 16,  /* the same of the first pattern along y */
  ORDERS = (2 * TOP_X + 1) * (2 * TOP_Y + 1)
};
_Static_assert(ORDERS >= 2 * TOP + 1, "rows have fewer frequencies");

static size_t boxes_of(int which, eda_box *out, eda_frame *frame) {
  if (which == 0) {
    *frame = (eda_frame){0, 0, ACROSS, ALONG};
    memcpy(out, lines_and_block, sizeof lines_and_block);
    return sizeof lines_and_block / sizeof *out;
  }
  *frame = (eda_frame){0, 0, ROW, HIGH};
  size_t n = 0;
  int pitch = pitches[which - 1], line = pitch * 5 / 16;
  for (int x = SPACE; x + line <= ROW - SPACE; x += pitch)
    out[n++] = (eda_box){x, 0, x + line, HIGH};
  return n;
}

int pattern_spectrum(const kernels *k, int which, eda_spectrum *out,
                     opc_error *error) {
  eda_box boxes[MOST];
  eda_frame f;
  uint32_t n = (uint32_t)boxes_of(which, boxes, &f);
  eda_point points[4 * MOST];
  uint32_t start[MOST + 1] = {0};
  eda_shapes shapes = {n, start, points, NULL};
  for (uint32_t i = 0; i < n; i++) eda_shapes_set_box(&shapes, i, boxes[i]);
  double unit = 1 / k->cutoff / 16;
  eda_frame frame = {0, 0, f.width * unit, f.height * unit};
  return eda_mask_spectrum(k->context, &shapes, unit, frame,
                           k->radius * k->cutoff, out, error);
}

/* A frequency in steps of 1 / frame (u, v) and in units of the cutoff (x, y),
   and the mask's coefficient. */
typedef struct order {
  int u, v;
  double x, y;
  double complex a;
} order;

/* Find the frequencies within the band, sorted so that entry n - 1 - i is the
   negative of entry i. Return their number. */
static size_t orders_find(const kernels *k, const eda_spectrum *mask,
                          order *out) {
  size_t n = 0;
  int rows = (mask->rows - 1) / 2;
  for (int v = -rows; v <= rows; v++)
    for (int u = 1 - mask->columns; u < mask->columns; u++) {
      double x = u / mask->frame.width / k->cutoff;
      double y = v / mask->frame.height / k->cutoff;
      if (hypot(x, y) >= k->radius || n == ORDERS) continue;
      int row = ((u < 0 ? -v : v) + mask->rows) % mask->rows;
      size_t at = (size_t)row * (size_t)mask->columns + (size_t)abs(u);
      const float *c = mask->data + 2 * at;
      double complex a = (double)c[0] + (u < 0 ? -I : I) * (double)c[1];
      out[n++] = (order){u, v, x, y, a};
    }
  return n;
}

/* Fourier coefficients of an intensity, |u| <= top_x, |v| <= top_y. */
typedef struct coefficients {
  int top_x, top_y, columns;
  double complex at[ORDERS]; /* [v][u], rows of u */
} coefficients;

static double complex *spectrum_coefficient(coefficients *c, int u, int v) {
  return &c->at[(v + c->top_y) * c->columns + u + c->top_x];
}

/* Compute the sum of T(f1, f2) a(f1) a(f2)* over all pairs of frequencies. Two
   symmetries reduce the pairs to a quarter, because T is real, T(f1, f2) =
   T(f2, f1) = T(-f1, -f2), and a(-f) = a(f)*. The pair (-f2, -f1) has the same
   term at the same frequency f1 - f2. The pair (f2, f1) has the conjugate term
   at the opposite frequency. */
static void coefficients_sum_pairs(const kernels *k, const eda_spectrum *mask,
                                   coefficients *out) {
  order o[ORDERS];
  size_t n = orders_find(k, mask, o);
  for (size_t p = 0; p < n; p++)
    for (size_t q = n - 1 - p; q <= p; q++) {
      int u = o[p].u - o[q].u, v = o[p].v - o[q].v;
      if (hypot(o[p].x - o[q].x, o[p].y - o[q].y) >= 2) continue;
      double t = k->cross(k, o[p].x, o[p].y, o[q].x, o[q].y);
      double complex c = t * o[p].a * conj(o[q].a) * (p + q == n - 1 ? 1 : 2);
      *spectrum_coefficient(out, u, v) += c;
      if (p != q) *spectrum_coefficient(out, -u, -v) += conj(c);
    }
}

/* Compute the sum of c[u] exp(2 pi i u x / n), |u| <= top, at all x; root[x] =
   exp(2 pi i x / n). */
static void row_transform(const double complex *c, int top,
                          const double complex *root, int n,
                          double complex *out) {
  for (int x = 0; x < n; x++) {
    double complex sum = c[top];
    for (int u = 1; u <= top; u++) {
      double complex turn = root[(size_t)u * (size_t)x % (size_t)n];
      sum += turn * c[top + u] + conj(turn) * c[top - u];
    }
    out[x] = sum;
  }
}

static void row_roots(double complex *root, int n) {
  for (int x = 0; x < n; x++) root[x] = cexp(2 * M_PI * I * x / n);
}

/* Compute the values of an intensity from its coefficients. `memory`: [2 * (nx
   + ny) + ny * columns], receives intermediate rows; nx and ny are those of
   *out, `columns` that of *c. */
static void coefficients_image(coefficients *c, double complex *memory,
                               eda_field *out) {
  double complex *root = memory, *line = root + out->nx + out->ny;
  double complex *column = line + out->nx, *planes = column + out->ny;
  row_roots(root, out->ny);
  for (int u = 0; u < c->columns; u++) {
    double complex along[2 * TOP_Y + 1];
    for (int v = 0; v <= 2 * c->top_y; v++)
      along[v] = c->at[v * c->columns + u];
    row_transform(along, c->top_y, root, out->ny, column);
    for (int y = 0; y < out->ny; y++) planes[y * c->columns + u] = column[y];
  }
  row_roots(root, out->nx);
  for (int y = 0; y < out->ny; y++) {
    row_transform(planes + (size_t)y * (size_t)c->columns, c->top_x, root,
                  out->nx, line);
    for (int x = 0; x < out->nx; x++)
      out->coefficients[y * out->nx + x] = (float)creal(line[x]);
  }
}

void pattern_image(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, const eda_field *like,
                   eda_field *out) {
  coefficients sum = {.top_x = (int)(2 * k->cutoff * mask->frame.width + 0.5),
                      .top_y = (int)(2 * k->cutoff * mask->frame.height + 0.5)};
  sum.columns = 2 * sum.top_x + 1;
  size_t nx = (size_t)like->nx, ny = (size_t)like->ny;
  double complex *memory =
      eda_alloc(2 * (nx + ny) + ny * (size_t)sum.columns, sizeof *memory);
  *out = *like;
  out->coefficients = eda_alloc(nx * ny, sizeof *out->coefficients);
  coefficients_sum_pairs(k, mask, &sum);
  coefficients_image(&sum, memory, out);
  free(memory);
  eda_field_from_samples(context, out);
}

/* ---- lines ---- */

/* Smallest sum of coefficients that counts, relative to the clear field;
   smaller sums are rounding errors of the spectrum. */
static const double nothing = 2e-6;

int pattern_is_lines(const kernels *k, const eda_spectrum *mask) {
  double beyond = 0;
  if (4 * k->cutoff * mask->frame.width + 2 > ORDERS) return 0;
  for (size_t l = 1; l < (size_t)mask->rows; l++)
    for (size_t i = 0; i < 2 * (size_t)mask->columns; i++)
      beyond += fabs((double)mask->data[2 * l * (size_t)mask->columns + i]);
  return beyond < nothing;
}

void pattern_lines(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, eda_field *image) {
  eda_spectrum row = *mask;
  eda_field like = *image;
  row.rows = 1;
  row.frame.height = like.frame.height = 0.1 / k->cutoff;
  free(image->coefficients);
  pattern_image(context, k, &row, &like, image);
  image->frame = mask->frame;
}
