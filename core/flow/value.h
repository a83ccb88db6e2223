/* SPDX-License-Identifier: BSD-3-Clause */
/* From a text in a flow to the value a plugin declared. */
#ifndef OPCFLOW_CORE_VALUE_H
#define OPCFLOW_CORE_VALUE_H

#include "core/flow/node.h"

/* A flag of the core's own parameters: the values of an OPC_MAP may be lists and
   maps; they are handed on as one line. */
enum { OPC_MAP_OF_ANY = 1 << 30 };

/* Convert `node` as `parameter` says into *value; what it points to is put
   into `owned` (freed with g_free). FALSE and problems if it does not fit. Of
   an OPC_INPUT the text is "step" or "step.port"; OPC_SLOT is not for here.
   `check_files`: whether an OPC_FILE must exist. */
gboolean opc_value_convert(const opc_parameter *parameter, const opc_node *node,
                           gboolean check_files, GPtrArray *owned,
                           opc_problems *problems, opc_value *value);

/* The tree of a parameter's preset. */
opc_node *opc_preset_parse(const opc_parameter *parameter,
                           const opc_source *source, opc_problems *problems);

/* "a length with its unit", "true or false" ... (g_free) */
char *opc_value_noun(const opc_parameter *parameter);

/* ">= 0 %, < 5 %", "" where there are no bounds (g_free). */
char *opc_bounds_text(const opc_parameter *parameter);

/* The shortest text that reads back as the same number. */
char *opc_number_text(double number);

/* Whether a file name stays inside the folder that it is relative to. */
gboolean opc_name_is_inside(const char *name);

#endif
