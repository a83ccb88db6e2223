/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists in files: CSV or YAML. */
#pragma once

#include <base/node.h>

/* Return the file at `path` as a list or a map of nodes of `source`. Each line
   of a CSV file (NAME.csv, RFC 4180) becomes a map from the names in the first
   line to its cells, without empty cells. NULL and problems on failure;
   problems of the file as a whole have the place `at`. */
opc_node *opc_list_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);
