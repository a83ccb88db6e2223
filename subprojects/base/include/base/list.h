/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists in files: CSV or YAML. */
#pragma once

#include <base/node.h>

/* The file at `path`, as a list or a map of nodes of `source`. Of a CSV file
   (NAME.csv, RFC 4180) each line is a map from what the first one says to its
   cells, without those that are empty. NULL and problems, of the file as such
   at `at`. */
opc_node *opc_list_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);
