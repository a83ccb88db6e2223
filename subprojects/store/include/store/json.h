/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON as text. */
#pragma once

#include <json-glib/json-glib.h>

/* Return the text of a node, indented, with a final newline (g_free). Takes
   ownership of the node. */
char *opc_json_text(JsonNode *node);
