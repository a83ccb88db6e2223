/* SPDX-License-Identifier: BSD-3-Clause */
/* The command opcflow. Verbs without a function belong to opcflow-devel. */
#include "core/cli/cli.h"

static const cli_verb cache = {CLI_CACHE}, explain = {CLI_EXPLAIN},
                      plugins = {CLI_PLUGINS}, inspect = {CLI_INSPECT},
                      lint = {CLI_LINT}, schema = {CLI_SCHEMA}, new = {CLI_NEW},
                      complete = {CLI_COMPLETE};

const cli_verb *const cli_verbs[] = {
    &cli_run, &cli_check, &explain,     &cache,    &plugins,  &inspect, &lint,
    &schema,  &new,       &cli_version, &cli_help, &complete, NULL};

/* Commands of plugins are verbs of opcflow-devel, which finds the plugin. */
const cli_verb *cli_plugin_verb(const char *name, opc_error *error) {
  static cli_verb verb;
  (void)error;
  verb.name = name;
  return &verb;
}

int main(int argc, char **argv) { return cli_main(argc, argv); }
