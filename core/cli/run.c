/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/run.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/cli/progress.h"

/* ---- stopping ---- */

static volatile sig_atomic_t stopped;

static void stop(int number) {
  (void)number;
  stopped = 1;
}

/* The first signal asks, the second one ends. */
static void catch_signals(void) {
  struct sigaction action = {.sa_handler = stop, .sa_flags = (int)SA_RESETHAND};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

static int is_stopped(void *data) {
  (void)data;
  return stopped;
}

/* ---- what came of it ---- */

static void print_text(const opc_run *run) {
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_run_table *t = run->tables->pdata[i];
    if (!(t->table->flags & OPC_TABLE_PRINT)) continue;
    g_autofree char *text = opc_table_text(t->table);
    cli_print("%s.%s\n%s\n", t->step, t->table->name, text);
  }
  cli_print("%s: %.2f s\n", run->folder, run->total);
}

static void add_tables(JsonBuilder *b, const opc_run *run) {
  json_builder_set_member_name(b, "tables");
  json_builder_begin_array(b);
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_run_table *t = run->tables->pdata[i];
    if (!(t->table->flags & OPC_TABLE_PRINT)) continue;
    JsonNode *node = opc_table_json(t->table);
    json_object_set_string_member(json_node_get_object(node), "step", t->step);
    json_builder_add_value(b, node);
  }
  json_builder_end_array(b);
}

static void print_json(const opc_run *run) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "folder");
  json_builder_add_string_value(b, run->folder);
  json_builder_set_member_name(b, "seconds");
  json_builder_add_double_value(b, run->total);
  json_builder_set_member_name(b, "metrics");
  json_builder_add_value(b, opc_run_metrics_json(run));
  add_tables(b, run);
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
  g_object_unref(b);
}

/* ---- the work ---- */

typedef struct request {
  const char *path;
  const char *const *sets;
  opc_run_options options;
  gboolean json, quiet;
} request;

static int tell(const opc_run *run, const request *r, opc_problems *problems) {
  if (problems->list->len) {
    int code = cli_problems(problems);
    if (run->folder)
      cli_message("note", "what was written so far is in '%s'", run->folder);
    return stopped ? CLI_STOPPED : code;
  }
  if (r->json)
    print_json(run);
  else if (!r->quiet)
    print_text(run);
  return CLI_GOOD;
}

static int run_flow(const request *r) {
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(r->path, r->sets, registry, problems);
  if (problems->list->len) return cli_problems(problems);
  catch_signals();
  cli_progress progress;
  cli_progress_start(&progress, r->quiet);
  const opc_watch watch = {&progress, cli_progress_log, cli_progress_step,
                           cli_progress_show, is_stopped};
  g_autoptr(opc_run) run =
      opc_run_flow(flow, registry, &r->options, &watch, problems);
  cli_progress_end(&progress);
  return tell(run, r, problems);
}

static int set_threads(const char *text) {
  if (!text) return -1;
  char *end;
  unsigned long n = strtoul(text, &end, 10);
  if (!g_ascii_isdigit(*text) || *end || !n || n > 4096) {
    cli_message("error", "'--threads' needs a number from 1 to 4096, not '%s'",
                text);
    return CLI_USAGE;
  }
  opc_set_threads((unsigned)n);
  return -1;
}

static int run(const cli_verb *verb, int argc, char **argv) {
  request r = {0};
  const char *threads = NULL;
  g_autoptr(GPtrArray) sets = g_ptr_array_new();
  const cli_option options[] = {
      {"set", "STEP.PARAMETER=VALUE", "over what the flow says", NULL, NULL,
       sets},
      {"output", "DIR", "the run folder (default: runs/NAME)", NULL,
       &r.options.output, NULL},
      {"force", NULL, "replace an earlier run in DIR", &r.options.force, NULL,
       NULL},
      {"threads", "N", "default: as many as there are processors", NULL,
       &threads, NULL},
      {"json", NULL, "the result as JSON", &r.json, NULL, NULL},
      {"quiet", NULL, "nothing but warnings and errors", &r.quiet, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  g_autoptr(GPtrArray) command = g_ptr_array_new();
  g_ptr_array_add(command, (char *)"opcflow");
  g_ptr_array_add(command, (char *)verb->name);
  for (int i = 0; i < argc; i++) g_ptr_array_add(command, argv[i]);
  g_ptr_array_add(command, NULL);
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code < 0) code = set_threads(threads);
  if (code >= 0) return code;
  g_ptr_array_add(sets, NULL);
  r.path = rest->pdata[0];
  r.sets = (const char *const *)sets->pdata;
  r.options.command = (const char *const *)command->pdata;
  return run_flow(&r);
}

const cli_verb cli_run = {"run", "FLOW", "Run a flow", run};
