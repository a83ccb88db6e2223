/* SPDX-License-Identifier: BSD-3-Clause */
/* Contents of a run folder, and checks against the manifest. */
#pragma once

#include <json-glib/json-glib.h>
#include <opcflow/base.h>

/* Return the files of a run folder, except the manifest: a list of { path,
   bytes, sha256 }, sorted by path. Remove folders without files. NULL and error
   on failure. */
JsonArray *opc_contents_json(const char *folder, opc_error *error);

/* Return the tree of the text of a manifest, NULL if malformed or nested too
   deeply. */
JsonNode *opc_contents_parse(const char *text);

/* Return OPC_OK if a folder is empty, or a run whose files are all listed in
   the manifest and unchanged; files may be missing. Otherwise return OPC_IO and
   error, which names the first foreign or changed file. */
int opc_contents_check(const char *folder, opc_error *error);
