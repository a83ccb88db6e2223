/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <string.h>

#include "image.h"

/* A field that cannot be sampled is a fault of the plugin that made it. */
static int check_field(const image_run *r, const opc_field *f,
                       const opc_frame *frame, const char *what,
                       const char *plugin, opc_error *error) {
  const opc_host *host = r->view.host;
  int good = f->coefficients && f->nx > 0 && f->ny > 0 &&
             f->frame.x0 == frame->x0 && f->frame.y0 == frame->y0 &&
             f->frame.width == frame->width && f->frame.height == frame->height;
  size_t n = good ? (size_t)f->nx * (size_t)f->ny : 0;
  for (size_t i = 0; i < n && good; i++) good = isfinite(f->coefficients[i]);
  if (good) return OPC_OK;
  return host->fail(host, error, OPC_FAILED, NULL,
                    "the %s of '%s' is not a field of numbers over the mask",
                    what, plugin);
}

static int prepare(const image_model *m, opc_error *error) {
  const opc_litho *litho = m->litho->plugin->operations;
  const opc_resist *resist = m->resist->plugin->operations;
  int code = litho->prepare(m->litho->self, error);
  return code ? code : resist->prepare(m->resist->self, m->litho, error);
}

static int make_image(const image_run *r, image_model *m, opc_frame frame,
                      opc_error *error) {
  const opc_host *host = r->view.host;
  const opc_litho *litho = m->litho->plugin->operations;
  opc_spectrum spectrum;
  int code = host->imaging->mask_spectrum(host, r->mask, r->view.grid, frame,
                                          litho->band(m->litho->self),
                                          &spectrum, error);
  if (code) return code;
  code = litho->image(m->litho->self, r->layer, &spectrum, &m->image, error);
  host->imaging->release_spectrum(host, &spectrum);
  if (code) return code;
  return check_field(r, &m->image, &frame, "intensity", m->litho->plugin->id,
                     error);
}

static int make_print(const image_run *r, image_model *m, opc_error *error) {
  const opc_host *host = r->view.host;
  const opc_resist *resist = m->resist->plugin->operations;
  size_t n = (size_t)m->image.nx * (size_t)m->image.ny;
  float *copy = host->alloc(host, n, sizeof *copy);
  if (!copy) return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  memcpy(copy, m->image.coefficients, n * sizeof *copy);
  m->print = m->image;
  m->print.coefficients = copy;
  int code = resist->print(m->resist->self, r->layer, &m->print, error);
  if (code) return code;
  return check_field(r, &m->print, &m->image.frame, "level set",
                     m->resist->plugin->id, error);
}

int image_simulate(image_run *r, opc_error *error) {
  const opc_host *host = r->view.host;
  opc_box b = r->gates->extent;
  double grid = r->view.grid, margin = r->margin;
  opc_frame frame = {b.x0 * grid - margin, b.y0 * grid - margin,
                     ((double)b.x1 - b.x0) * grid + 2 * margin,
                     ((double)b.y1 - b.y0) * grid + 2 * margin};
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code; k++) {
    opc_progress progress = {.size = sizeof progress,
                             .done = (double)k,
                             .total = (double)r->n,
                             .worst = (double)NAN};
    host->progress(host, &progress);
    if (host->cancelled(host))
      return host->fail(host, error, OPC_CANCELLED, NULL, "stopped");
    code = prepare(&r->model[k], error);
    if (!code) code = make_image(r, &r->model[k], frame, error);
    if (!code) code = make_print(r, &r->model[k], error);
  }
  return code;
}
