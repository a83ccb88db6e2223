/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists that are read from CSV or YAML files. */
#pragma once

#include <base/node.h>

/* Return the file at `path` as a list or a map of nodes of `source`. In a CSV
   file (NAME.csv, RFC 4180), each line after the first becomes a map from the
   column names in the first line to the non-empty cells. NULL and problems on
   failure; a problem of the whole file has the place `at`. The caller frees the
   node with opc_node_free(). */
opc_node *opc_list_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);
