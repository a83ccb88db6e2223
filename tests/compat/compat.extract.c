/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.extract: the current of a slice falls as 1 / L, from what a device
   table says of its first length. */
#include "compat.h"

enum { DEVICES, PARAMETERS };

static double on[2], off[2]; /* A: of W = L */

static int prepare(void *self, opc_error *error) {
  const compat *c = self;
  const opc_device_service *service = c->host->devices;
  opc_devices *d =
      service->load(c->host, c->values[DEVICES].text, error);
  if (!d) return error->code;
  for (int type = 0; type < 2; type++) {
    on[type] = d->ion[type][0] * d->length[0];
    off[type] = d->ioff[type][0] * d->length[0];
  }
  service->release(d);
  return OPC_OK;
}

static size_t slicing(const void *self, const double **place,
                      const double **width) {
  static const double places[3] = {0.125, 0.5, 0.875};
  static const double widths[3] = {0.25, 0.5, 0.25};
  (void)self;
  *place = places;
  *width = widths;
  return 3;
}

static int extract(const void *self, const opc_slices *in,
                   opc_performance *out, opc_error *error) {
  (void)self, (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double per_l = 0, w = 0, area = 0;
    for (size_t s = i * in->slices; s < (i + 1) * in->slices; s++) {
      per_l += in->length[s] > 0 ? in->width[s] / in->length[s] : 0;
      w += in->width[s];
      area += in->width[s] * in->length[s];
    }
    out->ion[i] = on[in->type[i]] * per_l;
    out->ioff[i] = off[in->type[i]] * per_l;
    out->leq_ion[i] = out->leq_ioff[i] = per_l > 0 ? w / per_l : 0;
    out->weq[i] = w;
    out->area[i] = area;
  }
  return OPC_OK;
}

static const opc_parameter parameters[PARAMETERS] = {
    {"devices", OPC_FILE, OPC_REQUIRED, NULL, NULL, 0, 0, NULL,
     "a device table"},
};

static const opc_extract operations = {sizeof operations, prepare, slicing,
                                       extract};

COMPAT_PLUGIN("compat.extract", OPC_KIND_EXTRACT, OPC_PARAMETERS(parameters));
