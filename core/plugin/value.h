/* SPDX-License-Identifier: BSD-3-Clause */
/* From a text in a flow to the value a plugin declared, and on to its field. */
#pragma once

#include <base/node.h>
#include <opcflow/plugin.h>

/* What a field of an instance gets, by the type of its parameter. */
typedef union opc_field {
  int flag; /* of OPC_BOOL, and the index of an OPC_CHOICE */
  int64_t integer;
  double real;
  const char *text;
  opc_reals reals;
  opc_map map;
  const void *object; /* of an OPC_INPUT while running, of an OPC_SLOT */
} opc_field;

/* A checked value of a parameter. */
typedef struct opc_setting {
  gboolean present; /* given, or by default */
  gboolean given;   /* by the flow or the command line; not where it writes the
                       default out */
  opc_field field;
  const char *reference; /* of an OPC_INPUT: "step.port" */
} opc_setting;

/* What is neither given nor has a default. */
opc_setting opc_setting_absent(const opc_parameter *parameter);

/* Convert `node` as `parameter` says into *value; what it points to is put
   into `owned` (freed with g_free). FALSE and problems if it does not fit.
   OPC_SLOT is not for here. `check_files`: whether an OPC_FILE must exist. */
gboolean opc_setting_convert(const opc_parameter *parameter,
                             const opc_node *node, gboolean check_files,
                             GPtrArray *owned, opc_problems *problems,
                             opc_setting *value);

/* Write a value into the fields of an instance that `parameter` names. */
void opc_setting_store(const opc_parameter *parameter, const opc_setting *value,
                       void *instance);

/* The size of the field of a type; 0 for a number that is no type. */
size_t opc_setting_width(uint32_t type);

/* "real" ... ; NULL for a number that is no type */
const char *opc_type_name(uint32_t type);

/* The tree of a parameter's preset. */
opc_node *opc_preset_parse(const opc_parameter *parameter,
                           opc_problems *problems);

/* "a length with its unit", "true or false" ... (g_free) */
char *opc_setting_noun(const opc_parameter *parameter);

/* ">= 0 %, < 5 %", "" where there are no bounds (g_free). */
char *opc_bounds_text(const opc_parameter *parameter);

/* opc_number_text with the unit of a parameter behind. */
char *opc_quantity_text(const opc_parameter *parameter, double number);
