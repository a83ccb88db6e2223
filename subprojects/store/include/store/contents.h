/* SPDX-License-Identifier: BSD-3-Clause */
/* What is in a run folder, and whether it is what the run wrote. */
#ifndef OPC_STORE_CONTENTS_H
#define OPC_STORE_CONTENTS_H

#include <json-glib/json-glib.h>
#include <opcflow/base.h>

/* The files of a run folder for its manifest, which is not among them: a list
   of { path, bytes, sha256 }, by path. Folders without a file are removed. NULL
   and *error. */
JsonArray *opc_contents_json(const char *folder, opc_error *error);

/* The tree of a manifest's text, NULL if it is none or too deep. */
JsonNode *opc_contents_parse(const char *text);

/* Whether a folder is empty, or a run of which every file is listed in its
   manifest and is as it was written; files may be missing. OPC_IO and *error,
   which names the first thing that is not of the run. */
int opc_contents_check(const char *folder, opc_error *error);

#endif
