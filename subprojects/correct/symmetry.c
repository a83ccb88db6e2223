/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the test of the optics for symmetry under rotation and
   mirroring. */
#include <correct/symmetry.h>

#include <eda/check.h>
#include <eda/gates.h>
#include <math.h>
#include <stdlib.h>

/* Tolerance of intensity, relative to the clear field; between rounding errors
   and the error of optical models. */
static const double same_part = 1e-4;

/* A shape without symmetry, nm, in a square frame; the size of the frame is the
   period of periodic kernels. */
static const eda_box shape[] = {
    {-200, -100, -120, 300}, {-120, 220, 150, 300}, {100, -250, 180, 0}};
static const eda_frame frame = {-1024, -1024, 2048, 2048};
enum { BOXES = 3, ALL = 8, SWAPPED = 4, ACROSS = 17, STEP = 50 };

static void point_turn(int orientation, double *x, double *y) {
  double was = *x;
  if (orientation & SWAPPED) {
    *x = *y;
    *y = was;
  }
  if (orientation & 1) *x = -*x;
  if (orientation & 2) *y = -*y;
}

/* Draw the shape in an orientation, with touching boxes merged. */
static int shape_draw(int orientation, eda_shapes *out, opc_error *error) {
  eda_point points[4 * BOXES];
  uint32_t start[BOXES + 1] = {0};
  for (int b = 0; b < BOXES; b++) {
    double x0 = shape[b].x0, y0 = shape[b].y0, x1 = shape[b].x1,
           y1 = shape[b].y1;
    point_turn(orientation, &x0, &y0);
    point_turn(orientation, &x1, &y1);
    const eda_point corner[] = {{(int32_t)x0, (int32_t)y0},
                                {(int32_t)x1, (int32_t)y0},
                                {(int32_t)x1, (int32_t)y1},
                                {(int32_t)x0, (int32_t)y1}};
    for (int k = 0; k < 4; k++) points[4 * b + k] = corner[k];
    start[b + 1] = (uint32_t)(4 * b + 4);
  }
  const eda_shapes boxes = {.count = BOXES, .start = start, .points = points};
  return eda_boolean(EDA_OR, &boxes, NULL, out, error);
}

/* Sample the image of the shape in an orientation, at positions in the same
   orientation. */
static int image_sample(const opc_context *context, const opc_module *litho,
                        int layer, int orientation, double *out,
                        opc_error *error) {
  enum { N = ACROSS * ACROSS };
  double x[N], y[N];
  eda_shapes mask = {0};
  eda_spectrum spectrum = {0};
  eda_field field = {0};
  for (int k = 0; k < N; k++) {
    int column = k % ACROSS - ACROSS / 2, row = k / ACROSS - ACROSS / 2;
    x[k] = STEP * column;
    y[k] = STEP * row;
    point_turn(orientation, &x[k], &y[k]);
  }
  const eda_litho *functions = litho->functions;
  int code = shape_draw(orientation, &mask, error);
  if (!code)
    code =
        eda_litho_spectrum(context, litho, &mask, 1, frame, &spectrum, error);
  if (!code)
    code = functions->image(litho->self, layer, &spectrum, &field, error);
  if (!code) eda_field_sample(&field, x, y, N, out);
  eda_shapes_clear(&mask);
  eda_spectrum_clear(&spectrum);
  eda_field_clear(&field);
  return code;
}

static int orientations_of_layer(const opc_context *context,
                                 const opc_module *litho, int layer,
                                 int *orientations, opc_error *error) {
  enum { N = ACROSS * ACROSS };
  double first[N], other[N], worst[2] = {0}; /* orientations without and with an
                                                exchange of x and y */
  int code = image_sample(context, litho, layer, 0, first, error);
  for (int orientation = 1; orientation < ALL && !code; orientation++) {
    double *most = &worst[orientation >= SWAPPED];
    code = image_sample(context, litho, layer, orientation, other, error);
    for (int k = 0; k < N && !code; k++)
      *most = fmax(*most, fabs(other[k] - first[k]));
  }
  *orientations = worst[0] > same_part   ? 1
                  : worst[1] > same_part ? SWAPPED
                                         : ALL;
  return code;
}

/* Set *orientations to the smaller one of the numbers for poly and active. */
int correct_symmetry_find(const opc_context *context, const opc_module *litho,
                          int *orientations, opc_error *error) {
  int poly, active;
  int code = orientations_of_layer(context, litho, EDA_POLY, &poly, error);
  if (!code)
    code = orientations_of_layer(context, litho, EDA_ACTIVE, &active, error);
  if (code) return eda_blame(error, code, "litho");
  *orientations = poly < active ? poly : active;
  return OPC_OK;
}
