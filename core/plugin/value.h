/* SPDX-License-Identifier: BSD-3-Clause */
/* Conversion of texts in a flow to parameter values, and storage of the values
   in fields of instances. */
#pragma once

#include <base/node.h>
#include <opcflow/plugin.h>

/* Value of an instance's field, by the type of its parameter. */
typedef union opc_field {
  int flag; /* OPC_BOOL; index of an OPC_CHOICE */
  int64_t integer;
  double real;
  const char *text;
  opc_reals reals;
  opc_map map;
  const void *object; /* OPC_INPUT during a run; OPC_SLOT */
} opc_field;

/* Checked value of a parameter. */
typedef struct opc_setting {
  gboolean present; /* the value is set or is the default */
  gboolean given;   /* the flow or the command line sets a value other than the
                       default */
  opc_field field;
  const char *reference; /* output that an OPC_INPUT refers to: "step.port" */
} opc_setting;

/* Return the value of a parameter that is not given and has no default. */
opc_setting opc_setting_absent(const opc_parameter *parameter);

/* Convert `node` into *value as `parameter` declares. Memory that the value
   points to is added to `owned` (freed with g_free). Returns FALSE and adds
   problems if the node is not valid. Not for OPC_SLOT. `check_files`: an
   OPC_FILE must exist. */
gboolean opc_setting_convert(const opc_parameter *parameter,
                             const opc_node *node, gboolean check_files,
                             GPtrArray *owned, opc_problems *problems,
                             opc_setting *value);

/* Store a value in the fields `offset` and `given` of an instance. */
void opc_setting_store(const opc_parameter *parameter, const opc_setting *value,
                       void *instance);

/* Return the width in bytes of the field of a type; 0 for an unknown type. */
size_t opc_setting_width(uint32_t type);

/* Return the name of a type, such as "real"; NULL for an unknown type. */
const char *opc_type_name(uint32_t type);

/* Return the tree of a parameter's preset (opc_node_free). */
opc_node *opc_preset_parse(const opc_parameter *parameter,
                           opc_problems *problems);

/* Return a noun for values of a parameter: "a length with a unit" (g_free). */
char *opc_setting_noun(const opc_parameter *parameter);

/* Return the bounds, such as ">= 0 %, < 5 %"; "" without bounds (g_free). */
char *opc_bounds_text(const opc_parameter *parameter);

/* Return opc_number_text with the parameter's unit appended (g_free). */
char *opc_quantity_text(const opc_parameter *parameter, double number);
