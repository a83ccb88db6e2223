/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.resist: prints what stays below the intensity at the edge of a wide
   line, which it asks the litho model for. */
#include "compat.h"

static double threshold;

static int prepare(void *self, const opc_module *litho, opc_error *error) {
  const compat *c = self;
  const opc_host *host = c->host;
  const opc_imaging_service *imaging = host->imaging;
  const opc_litho *model = litho->plugin->operations;
  opc_point points[4] = {{-500, 0}, {500, 0}, {500, 4000}, {-500, 4000}};
  uint32_t start[2] = {0, 4};
  const opc_shapes line = {1, start, points, NULL};
  const opc_frame frame = {-2000, 0, 4000, 4000};
  opc_spectrum mask;
  opc_field field;
  const double x = 500, y = 2000;
  int code = imaging->mask_spectrum(host, &line, 1, frame,
                                    model->band(litho->self), &mask, error);
  if (code) return code;
  code = model->image(litho->self, OPC_POLY, &mask, &field, error);
  imaging->release_spectrum(host, &mask);
  if (code) return code;
  imaging->sample(&field, &x, &y, 1, &threshold);
  imaging->release_field(host, &field);
  host->log(host, OPC_LOG_DEBUG, "threshold %.4f", threshold);
  return OPC_OK;
}

static int print(const void *self, int layer, opc_field *field,
                 opc_error *error) {
  (void)self, (void)layer, (void)error;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  for (size_t i = 0; i < n; i++)
    field->coefficients[i] = (float)threshold - field->coefficients[i];
  return OPC_OK;
}

static const opc_resist operations = {sizeof operations, prepare, print};

COMPAT_PLUGIN("compat.resist", OPC_KIND_RESIST, .n_parameters = 0);
