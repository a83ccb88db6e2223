/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow-devel: the verbs that are not needed to run flows. The command
   `opcflow` replaces itself by this program for these verbs. This program also
   has the other verbs, for the completion of command lines and for `help`. */
#include "tools/devel/verbs.h"

const cli_verb *const cli_verbs[] = {
    &cli_run,     &cli_check,     &devel_explain,
    &devel_cache, &devel_plugins, &devel_inspect,
    &devel_lint,  &devel_schema,  &devel_new,
    &cli_version, &cli_help,      &devel_complete,
    NULL};

int main(int argc, char **argv) { return cli_main(argc, argv); }
