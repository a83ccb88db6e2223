/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `report.html`: a page of the run that contains the step,
   or of an experiment. The step is not deterministic, because the page contains
   times and the results of all earlier steps. */
#include <eda/experiment.h>
#include <opcflow/step.h>

#include <report/drawing.h>
#include <report/page.h>

/* ---- state ---- */

typedef struct writer {
  const opc_host *host;
  const eda_mask *mask;
  const eda_experiment *experiment;
  const char *file, *title, *view;
  double limit; /* MB */
  drawing_limits limits;
} writer;

/* ---- work ---- */

/* Return 1 if the present run already has a manifest. A run inside a step that
   runs flows receives its manifest only at the end. */
static int has_manifest(const writer *w, const char *folder) {
  g_autofree char *manifest = g_build_filename(folder, "manifest.json", NULL);
  if (g_file_test(manifest, G_FILE_TEST_EXISTS)) return 1;
  w->host->log(w->host, OPC_LOG_WARNING,
               "no page of an inner run is written; '%s' is kept for the page "
               "of the outer run",
               w->view);
  return 0;
}

static int keep_view(const writer *w, opc_error *error) {
  const char *path = w->host->output_path(w->host, w->view, error);
  if (!path) return error->code;
  return drawing_file(w->host->context, w->mask, &w->limits, path, error);
}

static int add_experiment(const eda_experiment *e, page *p, opc_error *error) {
  int code = OPC_OK;
  for (size_t c = 0; c < e->n_cases; c++)
    for (size_t m = 0; m < e->n_methods && !code; m++) {
      const char *folder = e->folders[c * e->n_methods + m];
      if (folder)
        code = page_add_run(p, folder, e->cases[c], e->methods[m], 0, error);
      else
        page_lacks(p, "%s, %s: the run failed", e->cases[c], e->methods[m]);
    }
  return code;
}

static int html_run(void *self, void **outputs, opc_error *error) {
  const writer *w = self;
  page p;
  (void)outputs;
  if (!w->mask == !w->experiment)
    return opc_fail(error, OPC_INVALID, "mask", "set 'mask' or 'experiment'");
  const char *path = w->host->output_path(w->host, w->file, error);
  int code = !path ? error->code : w->mask ? keep_view(w, error) : OPC_OK;
  if (code) return code;
  g_autofree char *folder = g_path_get_dirname(path);
  if (w->mask && !has_manifest(w, folder)) return OPC_OK;
  page_init(&p, w->limit);
  code = w->mask ? page_add_run(&p, folder, NULL, NULL, 1, error)
                 : add_experiment(w->experiment, &p, error);
  if (!code) code = page_write(&p, w->title, path, error);
  page_clear(&p);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(writer, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "Mask of this run, for a page of the run"),
    OPC_PARAMETER(writer, experiment, .type = OPC_INPUT,
                  .choices = "experiment",
                  .summary = "Experiment, for a page of all runs"),
    OPC_PARAMETER(writer, file, .type = OPC_OUTPUT, .preset = "report.html",
                  .summary = "HTML file to write"),
    OPC_PARAMETER(
        writer, view, .type = OPC_OUTPUT, .preset = "view.json",
        .summary = "File of the mask's picture data for 'opcflow report'"),
    OPC_PARAMETER(writer, title, .type = OPC_TEXT,
                  .summary = "Title of the page (default: names of the runs)"),
    PAGE_LIMIT(writer, limit),
    DRAWING_PARAMETERS(writer, limits),
};

/* ---- entry ---- */

static const opc_step functions = {.run = html_run};

OPC_PLUGIN(writer, .id = "report.html", .kind = "step", .version = "0.1.0",
           .licence = "BSD-3-Clause",
           .summary = "Write a page that shows a run or an experiment",
           .flags = OPC_REENTRANT, OPC_PARAMETERS(parameters),
           OPC_FUNCTIONS(functions));
