/* SPDX-License-Identifier: BSD-3-Clause */
/* Contents of a run folder, and comparison with its manifest. */
#pragma once

#include <json-glib/json-glib.h>
#include <opcflow/base.h>

/* Return the regular files of a run folder except the manifest, as a list of {
   path, bytes, sha256 } sorted by path, and remove empty folders from disk.
   NULL and *error on failure. */
JsonArray *opc_contents_json(const char *folder, opc_error *error);

/* Return the JSON tree of a manifest; NULL if malformed or nested too
   deeply. */
JsonNode *opc_contents_parse(const char *text);

/* Return OPC_OK if a folder is empty, or is a run folder whose manifest lists
   every file and folder, and the files are unchanged. Listed files may be
   missing. Otherwise return OPC_IO and *error with the first unlisted or
   changed file. */
int opc_contents_check(const char *folder, opc_error *error);
