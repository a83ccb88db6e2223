/* SPDX-License-Identifier: BSD-3-Clause */
/* The verbs of opcflow-devel. */
#pragma once

#include "core/cli/cli.h"

extern const cli_verb devel_cache, devel_explain, devel_plugins, devel_inspect,
    devel_lint, devel_schema, devel_new, devel_complete;
