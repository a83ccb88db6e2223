/* SPDX-License-Identifier: BSD-3-Clause */
/* A litho model as the loop and the resist see it: each call goes through to
   the plugin, and what it hands back is checked. The resist calls the model by
   itself while it calibrates; here its faults are told from those of the
   resist. */
#include <math.h>
#include <string.h>

#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

/* The first failure is kept; models are called from several threads. */
static int settle(opc_model *m, int code, opc_error *error) {
  if (!opc_blame(error, code, "litho")) return OPC_OK;
  if (!__atomic_exchange_n(&m->failed, 1, __ATOMIC_SEQ_CST)) m->fault = *error;
  return error->code;
}

static const opc_litho *inner(const opc_model *m) {
  return m->litho->plugin->operations;
}

static int prepare(void *self, opc_error *error) {
  opc_model *m = self;
  const char *before = opc_call(m->litho, error);
  int code = inner(m)->prepare(m->litho->self, error);
  double band = code ? 1 : inner(m)->band(m->litho->self);
  opc_leave(before);
  if (!(band > 0) || !isfinite(band))
    code = opc_fail(error, OPC_FAILED, NULL, "its band is %g 1/nm", band);
  return settle(m, code, error);
}

static double band(const void *self) {
  const opc_model *m = self;
  const char *before = opc_enter(m->litho->plugin->id);
  double value = inner(m)->band(m->litho->self);
  opc_leave(before);
  return value;
}

static int image_at(const void *self, int layer, const opc_spectrum *mask,
                    double defocus, opc_field *out, opc_error *error) {
  opc_model *m = (opc_model *)self;
  const opc_litho *litho = inner(m);
  memset(out, 0, sizeof *out);
  const char *before = opc_call(m->litho, error);
  int code =
      defocus == 0
          ? litho->image(m->litho->self, layer, mask, out, error)
          : litho->image_at(m->litho->self, layer, mask, defocus, out, error);
  opc_leave(before);
  if (!code) code = opc_check_field(out, &mask->frame, "intensity", error);
  return settle(m, code, error);
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  return image_at(self, layer, mask, 0, out, error);
}

void opc_model_make(opc_model *m, const opc_module *litho) {
  *m = (opc_model){.litho = litho, .plugin = *litho->plugin};
  m->operations = (opc_litho){.size = sizeof m->operations,
                              .prepare = prepare,
                              .band = band,
                              .image = image};
  const opc_litho *operations = litho->plugin->operations;
  if (operations->image_at) m->operations.image_at = image_at;
  m->plugin.size = sizeof m->plugin;
  m->plugin.operations = &m->operations;
  m->module = (opc_module){&m->plugin, m};
}
