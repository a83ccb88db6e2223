/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON as text. */
#pragma once

#include <json-glib/json-glib.h>

/* Return the text, readable, with a last newline (g_free). Takes the node. */
char *opc_json_text(JsonNode *node);
