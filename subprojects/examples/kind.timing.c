/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "timing": required functions, tests of a plugin, and the template of a
   new one. */
#include <math.h>
#include <opcflow/kind.h>

#include "timing.h"

typedef struct kind {
  const opc_host *host;
} kind;

/* ---- test of a plugin ---- */

/* Test the delays for currents of small to large transistors. */
static void exercise(const opc_module *module, opc_inspector *inspector) {
  const timing *t = module->functions;
  double last = INFINITY;
  for (double ion = 1e-5; ion < 1e-2; ion *= 1.5) {
    double delay = t->delay(module->self, ion, 65 * 200);
    if (!(delay > 0) || !isfinite(delay))
      inspector->find(inspector, "delay: %g s for %g A", delay, ion);
    else if (delay > last)
      inspector->find(inspector,
                      "delay: a larger current results in a longer delay");
    last = delay;
    inspector->add(inspector, &delay, sizeof delay);
  }
}

/* ---- template ---- */

static const opc_template templates[] = {
    {"@ID@.c",
     "/* @ID@: a timing model. */\n"
     "#include <timing.h>\n"
     "\n"
     "typedef struct state {\n"
     "  const opc_host *host;\n"
     "} state;\n"
     "\n"
     "static double delay(const void *self, double ion, double area) {\n"
     "  (void)self;\n"
     "  return 1.9e-20 * area / ion;\n"
     "}\n"
     "\n"
     "static const timing functions = {.delay = delay};\n"
     "OPC_PLUGIN(state, .id = \"@ID@\", .kind = \"timing\",\n"
     "           .version = \"0.1.0\", .licence = \"BSD-3-Clause\",\n"
     "           .summary = \"a timing model\",\n"
     "           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,\n"
     "           OPC_FUNCTIONS(functions));\n"},
    {"meson.build",
     "project('@ID@', 'c')\n"
     "shared_module('@ID@', '@ID@.c', name_prefix: '',\n"
     "  gnu_symbol_visibility: 'hidden',\n"
     "  dependencies: dependency('opcflow'))\n"},
};

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(timing, delay)};

static const opc_kind functions = {
    .functions_size = sizeof(timing),
    OPC_REQUIRED_FUNCTIONS(required),
    .exercise = exercise,
    OPC_TEMPLATES(templates),
};

OPC_PLUGIN(kind, .id = "kind.timing", .kind = "kind", .version = "1.0.0",
           .licence = "BSD-3-Clause",
           .summary = "timing models: delay of a transistor",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_FUNCTIONS(functions));
