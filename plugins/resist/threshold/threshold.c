/* SPDX-License-Identifier: BSD-3-Clause */
/* resist.threshold: a feature prints where the intensity stays below a
   constant. The constant of each layer is the one that prints an anchor, a
   line of a grating or an isolated one, to its size. */
#include <opcflow/gates.h>
#include <opcflow/litho.h>

#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct anchor {
  double line, pitch, cd;   /* nm; pitch 0: isolated */
  double fixed;             /* a threshold that was given; NAN: calibrate */
} anchor;

typedef struct resist {
  const opc_host *host;
  anchor anchor[OPC_MASKS];
  double threshold[OPC_MASKS];
} resist;

static const char *const group[OPC_MASKS] = {"anchor", "active_anchor"};

/* ---- work ---- */

/* Units of the anchor's coordinates: fine enough for any line. */
static const double unit = 1e-3;

/* An isolated line is one whose neighbours are this far away, nm. */
static const double isolation = 4000;

static int32_t units(double nm) { return (int32_t)lround(nm / unit); }

/* The image of the anchor: a vertical line in the middle of the frame, whole
   height, x = 0 its middle. */
static int image_anchor(const resist *r, int layer,
                        const opc_module *litho, opc_field *field,
                        opc_error *error) {
  const opc_litho *model = litho->plugin->operations;
  const anchor *a = &r->anchor[layer];
  double period = a->pitch > 0 ? a->pitch : a->line + isolation;
  opc_frame frame = {-period / 2, 0, period, period};
  int32_t x = units(a->line / 2), top = units(period);
  opc_point points[4] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[2] = {0, 4};
  opc_shapes line = {.count = 1, .start = start, .points = points};
  opc_spectrum mask;
  int code = r->host->imaging->mask_spectrum(r->host, &line, unit, frame,
                                             model->band(litho->self), &mask,
                                             error);
  if (code) return code;
  code = model->image(litho->self, layer, &mask, field, error);
  r->host->imaging->release_spectrum(r->host, &mask);
  return code;
}

static int calibrate(resist *r, int layer, const opc_module *litho,
                     opc_error *error) {
  const anchor *a = &r->anchor[layer];
  if (!isnan(a->fixed)) {
    r->threshold[layer] = a->fixed;
    return OPC_OK;
  }
  opc_field field;
  int code = image_anchor(r, layer, litho, &field, error);
  if (code) return code;
  double x[3] = {a->cd / 2, 0, field.frame.width / 2}, y[3] = {0}, value[3];
  r->host->imaging->sample(&field, x, y, 3, value);
  r->host->imaging->release_field(r->host, &field);
  if (!(value[1] < value[0] && value[0] < value[2]))
    return r->host->fail(
        r->host, error, OPC_INVALID, group[layer],
        "'%s' cannot be printed: intensity %.3f in the middle of the line, "
        "%.3f at its edge, %.3f between lines",
        group[layer], value[1], value[0], value[2]);
  r->threshold[layer] = value[0];
  return OPC_OK;
}

static int prepare(void *self, const opc_module *litho, opc_error *error) {
  resist *r = self;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    int code = calibrate(r, layer, litho, error);
    if (code) return code;
  }
  r->host->log(r->host, OPC_LOG_INFO,
               "resist.threshold: poly prints below %.4f, active below %.4f",
               r->threshold[OPC_POLY], r->threshold[OPC_ACTIVE]);
  return OPC_OK;
}

static int print(const void *self, int layer, opc_field *field,
                 opc_error *error) {
  const resist *r = self;
  (void)error;
  float threshold = (float)r->threshold[layer];
  size_t n = (size_t)field->nx * (size_t)field->ny;
  for (size_t i = 0; i < n; i++)
    field->coefficients[i] = threshold - field->coefficients[i];
  return OPC_OK;
}

/* ---- parameters ---- */

enum {
  LINE, PITCH, CD, THRESHOLD,
  ACTIVE_LINE, ACTIVE_PITCH, ACTIVE_CD, ACTIVE_THRESHOLD,
  PARAMETERS
};

static const opc_parameter parameters[PARAMETERS] = {
    [LINE] = {.name = "anchor.line", .type = OPC_REAL, .flags = OPC_ABOVE,
              .unit = "nm", .preset = "65 nm",
              .summary = "drawn width of the poly line that prints to size"},
    [PITCH] = {.name = "anchor.pitch", .type = OPC_REAL, .flags = OPC_AT_LEAST,
               .unit = "nm", .preset = "250 nm",
               .summary = "pitch of its grating; 0 nm for an isolated line"},
    [CD] = {.name = "anchor.cd", .type = OPC_REAL, .flags = OPC_ABOVE,
            .unit = "nm",
            .summary = "printed width wanted; the drawn one if not given"},
    [THRESHOLD] = {.name = "threshold", .type = OPC_REAL,
                   .flags = OPC_ABOVE | OPC_BELOW, .min = 0, .max = 1,
                   .summary = "of poly, clear field 1; instead of the anchor"},
    [ACTIVE_LINE] = {.name = "active_anchor.line", .type = OPC_REAL,
                     .flags = OPC_ABOVE, .unit = "nm", .preset = "1000 nm",
                     .summary = "the same for active"},
    [ACTIVE_PITCH] = {.name = "active_anchor.pitch", .type = OPC_REAL,
                      .flags = OPC_AT_LEAST, .unit = "nm", .preset = "0 nm",
                      .summary = "the same for active"},
    [ACTIVE_CD] = {.name = "active_anchor.cd", .type = OPC_REAL,
                   .flags = OPC_ABOVE, .unit = "nm",
                   .summary = "the same for active"},
    [ACTIVE_THRESHOLD] = {.name = "active_threshold", .type = OPC_REAL,
                          .flags = OPC_ABOVE | OPC_BELOW, .min = 0, .max = 1,
                          .summary = "the same for active"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  resist *r = calloc(1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    const opc_value *v = values + (layer == OPC_POLY ? LINE : ACTIVE_LINE);
    anchor *a = &r->anchor[layer];
    a->line = v[LINE].real;
    a->pitch = v[PITCH].real;
    a->cd = v[CD].type == OPC_ABSENT ? a->line : v[CD].real;
    a->fixed = v[THRESHOLD].type == OPC_ABSENT ? (double)NAN : v[THRESHOLD].real;
    if (a->pitch > 0 && fmax(a->line, a->cd) >= a->pitch) {
      host->fail(host, error, OPC_INVALID, group[layer],
                 "'%s' has no space between its lines: %g nm every %g nm",
                 group[layer], fmax(a->line, a->cd), a->pitch);
      free(r);
      return NULL;
    }
  }
  return r;
}

static void destroy(void *self) { free(self); }

/* ---- entry ---- */

static const opc_resist operations = {
    .size = sizeof operations, .prepare = prepare, .print = print};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "resist.threshold",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "constant threshold, calibrated to an anchor for each layer",
      .kind = OPC_KIND_RESIST,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
