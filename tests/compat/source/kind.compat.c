/* SPDX-License-Identifier: BSD-3-Clause */
/* The kind "compat". */
#include "compat.model.h"

static void exercise(const opc_module *module, opc_inspector *inspector) {
  double factor =
      ((const compat_model *)module->functions)->factor(module->self);
  inspector->add(inspector, &factor, sizeof factor);
}

static const opc_function required[] = {OPC_FUNCTION(compat_model, factor)};
static const opc_template templates[] = {{"@ID@.c", "/* @NAME@ */\n"},
                                         {"README.md", "# @ID@\n"}};
static const opc_sample samples[] = {{"one", "1", 1}, {"two", "22", 2}};

OPC_KIND("compat", compat_model, "factors", OPC_SAMPLES(samples));
