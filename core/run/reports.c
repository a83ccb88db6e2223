/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes flow.yaml, metrics.json and manifest.json. */
#include "core/run/reports.h"

#include <store/files.h>

#include <store/contents.h>
#include "core/binding/outputs.h"
#include "core/binding/resolve.h"
#include "core/report/json.h"

void opc_reports_reserve(opc_run *run) {
  for (size_t i = 0; i < OPC_RESERVED; i++)
    g_hash_table_insert(run->written.claims, g_strdup(opc_reserved[i]),
                        g_strdup("opcflow"));
}

gboolean opc_reports_has_others(const opc_run *run) {
  return g_hash_table_size(run->written.claims) > OPC_RESERVED;
}

gboolean opc_reports_write_file(const opc_run *run, const char *name,
                                char *text, opc_problems *problems) {
  g_autofree char *path = g_build_filename(run->written.work, name, NULL);
  opc_error error;
  int code = opc_write_file(path, text, &error);
  if (code) opc_problem_add(problems, code, NULL, "%s", error.message);
  g_free(text);
  return !code;
}

/* Add the files of the run folder to the manifest. All files but the manifest
   must already exist. */
static gboolean list_files(const opc_run *run, JsonNode *manifest,
                           opc_problems *problems) {
  opc_error error;
  JsonArray *files = opc_contents_json(run->written.work, &error);
  if (!files)
    return opc_problem_add(problems, error.code, NULL, "%s", error.message);
  json_object_set_array_member(json_node_get_object(manifest), "files", files);
  return TRUE;
}

gboolean opc_reports_write(const opc_run *run, gboolean last,
                           opc_problems *problems) {
  char *metrics = opc_outcome_metrics_text(&run->out);
  const opc_manifest about = {&run->out, run->flow, run->registry,
                              run->options->store, run->options->command};
  JsonNode *manifest = opc_manifest_json(&about);
  char *flow = opc_flow_resolved(run->flow, run->out.sweep);
  gboolean good = opc_reports_write_file(run, "flow.yaml", flow, problems);
  good &= opc_reports_write_file(run, "metrics.json", metrics, problems);
  if (last) good &= list_files(run, manifest, problems);
  good &= opc_reports_write_file(run, "manifest.json", opc_json_text(manifest),
                                 problems);
  return good;
}
