/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `report.view`: the picture data of a mask, as a file of
   the run folder. */
#include <opcflow/step.h>

#include <report/drawing.h>

/* ---- state ---- */

typedef struct viewer {
  const opc_host *host;
  const eda_mask *mask;
  const char *file;
  drawing_limits limits;
} viewer;

/* ---- work ---- */

static int view_run(void *self, void **outputs, opc_error *error) {
  const viewer *v = self;
  (void)outputs;
  const char *path = v->host->output_path(v->host, v->file, error);
  if (!path) return error->code;
  return drawing_file(v->host->context, v->mask, &v->limits, path, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(viewer, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Mask to show"),
    OPC_PARAMETER(viewer, file, .type = OPC_OUTPUT, .preset = "view.json",
                  .summary = "File of picture data for 'opcflow report'"),
    DRAWING_PARAMETERS(viewer, limits),
};

/* ---- entry ---- */

static const opc_step functions = {.run = view_run};

OPC_PLUGIN(
    viewer, .id = "report.view", .kind = "step", .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Write a mask with simulated contours as data for a report",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_FUNCTIONS(functions));
