/* SPDX-License-Identifier: BSD-3-Clause */
/* A step that declares two or more of everything, and uses all services. */
#include "compat.h"
#ifdef COMPAT_NEWER
#include "compat.added.h"
#endif
#include "compat.model.h"

#ifndef COMPAT_ID
#define COMPAT_ID "compat.step"
#endif

enum { PIECES = 5 };

typedef struct step {
  const opc_host *host;
  double size, gap;
  int64_t count;
  int fast, given;
  const char *name;
  opc_reals list;
  opc_map map;
  const opc_module *model;
  int64_t pieces[PIECES];
} step;

/* ---- pieces ---- */

static int do_piece(void *data, size_t i, opc_bytes *out, opc_error *error) {
  const int64_t square = (int64_t)(i * i);
  (void)data, (void)error;
  out->add(out, &square, sizeof square);
  return OPC_OK;
}

static int take_piece(void *data, size_t i, const void *bytes, size_t size,
                      opc_error *error) {
  step *s = (step *)data;
  if (size != sizeof(int64_t))
    return opc_fail(error, OPC_FAILED, NULL, "%zu bytes", size);
  memcpy(&s->pieces[i], bytes, size);
  return OPC_OK;
}

/* ---- work ---- */

/* 1 if an earlier run kept what this one keeps. */
static int keep(const step *s) {
  static const char kept[] = "kept";
  const opc_results *results = opc_get_results(s->host);
  size_t size = 0;
  void *found = results ? results->find(s->host, s->name, &size) : NULL;
  int good = found && size == sizeof kept && !memcmp(found, kept, size);
  free(found);
  if (results) results->keep(s->host, s->name, kept, sizeof kept);
  return good;
}

/* The sum; twice the sum if the host has the service of the extended
   interface. */
static double sum_of(const step *s) {
  double sum = 0;
  size_t i;
  for (i = 0; i < PIECES; i++) sum += (double)s->pieces[i];
#ifdef COMPAT_NEWER
  const compat_added *added =
      (const compat_added *)s->host->service(s->host, COMPAT_ADDED);
  if (added) return added->twice(s->host, sum);
#endif
  return sum;
}

static int run(void *self, void **outputs, opc_error *error) {
  step *s = (step *)self;
  const compat_model *model = (const compat_model *)s->model->functions;
  const opc_pieces pieces = {.data = s,
                             .name = "piece",
                             .count = PIECES,
                             .work = do_piece,
                             .take = take_piece};
  const double reals[2] = {s->size, s->gap};
  const int64_t whole[2] = {s->count, (int64_t)s->list.count};
  const char *const texts[2] = {s->name, "other"};
  const opc_column columns[] = {{"text", NULL, OPC_TEXT, 0, texts},
                                {"real", "nm", OPC_REAL, -1, reals},
                                {"whole", NULL, OPC_INT, 0, whole}};
  const opc_progress progress = {1, 2, 3, "nm"};
  opc_metric_value values[4];
  int code = opc_do_pieces(s->host, &pieces, error);
  s->host->progress(s->host, &progress);
  if (s->host->service(s->host, "compat.nothing/1"))
    return opc_fail(error, OPC_FAILED, NULL, "there is such a service");
  values[0] = (opc_metric_value){"sum", sum_of(s)};
  values[1] = (opc_metric_value){"kept", keep(s)};
  values[2] = (opc_metric_value){
      "factor", model->factor(s->model->self) + (model->other != NULL)};
  values[3] = (opc_metric_value){
      "given", s->given + 10 * s->fast + 100 * (int)s->map.count};
  if (!code)
    code = opc_put_table(s->host, "compat", OPC_TABLE_PRINT, 2,
                         OPC_ARRAY(columns), error);
  if (!code) code = opc_put_metrics(s->host, OPC_ARRAY(values), error);
  outputs[0] = outputs[1] = s;
  return code;
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  (void)self, (void)error;
  out->memory = 1e6;
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(step, size, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "65 nm",
                  .given = offsetof(step, given), .summary = "a length"),
    OPC_PARAMETER(step, gap, .type = OPC_REAL, .unit = "nm", .preset = "30 nm",
                  .former = "space", .summary = "a space"),
    OPC_PARAMETER(step, count, .type = OPC_INT, .preset = "7",
                  .summary = "a number"),
    OPC_PARAMETER(step, fast, .type = OPC_BOOL, .preset = "true",
                  .summary = "a choice"),
    OPC_PARAMETER(step, name, .type = OPC_TEXT, .flags = OPC_LISTED,
                  .preset = "one", .summary = "a name"),
    OPC_PARAMETER(step, list, .type = OPC_REALS, .unit = "nm",
                  .preset = "[1 nm, 2 nm]", .summary = "lengths"),
    OPC_PARAMETER(step, map, .type = OPC_MAP, .summary = "names"),
    OPC_PARAMETER(step, model, .type = OPC_SLOT, .choices = "compat",
                  .preset = "{ use: compat.model }", .summary = "a factor"),
};

static const opc_metric metrics[] = {
    {"sum", NULL, OPC_NEUTRAL, 0, "of all pieces"},
    {"kept", NULL, OPC_NEUTRAL, 0, "1: an earlier run kept it"},
    {"factor", NULL, OPC_HIGHER, 0.1, "of the model"},
    {"given", NULL, OPC_LOWER, 0, "of parameters"},
};

/* ---- entry ---- */

static int choices(void *self, const char *parameter,
                   void (*take)(void *data, const char *value), void *data,
                   opc_error *error) {
  (void)self, (void)parameter, (void)error;
  take(data, "one");
  take(data, "two");
  return OPC_OK;
}

static const void *extension(const char *name) {
  static const opc_choices listed = {choices};
  return strcmp(name, OPC_CHOICES) ? NULL : &listed;
}

static int check_output(const void *object, opc_error *error) {
  return ((const step *)object)->count >= 0
             ? OPC_OK
             : opc_fail(error, OPC_FAILED, NULL, "negative");
}

static void release(void *object) { (void)object; }

static const opc_port outputs[] = {
    {"first", "compat_first", check_output, release},
    {"second", "compat_second", check_output, release}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run,
                                   .forecast = forecast,
                                   .flags = OPC_STEP_OUTSIDE | OPC_STEP_PIECES};

OPC_PLUGIN(step, .id = COMPAT_ID, .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "Kept as a binary",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .extension = extension, OPC_FUNCTIONS(functions));
