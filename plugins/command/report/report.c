/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verb `opcflow report RUN ...`: one HTML page of runs and
   experiments. */
#include <opcflow/command.h>

#include <report/page.h>

/* ---- state ---- */

typedef struct reporter {
  const opc_host *host;
  const char *output, *title;
  double limit; /* MB */
} reporter;

/* ---- work ---- */

static int report_run(void *self, size_t n, const char *const *arguments,
                      opc_error *error) {
  const reporter *r = self;
  page p;
  int code = OPC_OK;
  if (!n) return opc_fail(error, OPC_INVALID, NULL, "no run folder is given");
  page_init(&p, r->limit);
  for (size_t i = 0; i < n && !code; i++)
    code = page_add(&p, arguments[i], error);
  if (!code) code = page_write(&p, r->title, r->output, error);
  page_clear(&p);
  if (!code) r->host->log(r->host, OPC_LOG_INFO, "the page is '%s'", r->output);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(reporter, output, .type = OPC_TEXT, .preset = "report.html",
                  .summary = "HTML file to write"),
    OPC_PARAMETER(reporter, title, .type = OPC_TEXT,
                  .summary = "Title of the page (default: names of the runs)"),
    PAGE_LIMIT(reporter, limit),
};

/* ---- entry ---- */

static const opc_command functions = {.arguments = "RUN ...",
                                      .run = report_run};

OPC_PLUGIN(reporter, .id = "command.report", .kind = "command",
           .version = "0.1.0", .licence = "BSD-3-Clause",
           .summary = "Write one HTML page of runs and experiments",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
