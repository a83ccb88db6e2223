/* SPDX-License-Identifier: BSD-3-Clause */
/* For the tests of plugins: one plugin, made from a text in the syntax of a
   flow, without a flow. One test program, one thread. */
#ifndef OPCFLOW_CORE_TESTING_H
#define OPCFLOW_CORE_TESTING_H

#include <glib.h>
#include <opcflow/opcflow.h>

#include "core/flow/table.h"

/* The host that all of it reports to. output_path gives a place in a fresh
   folder, which is removed when the program ends. */
const opc_host *opc_test_host(void);
const char *opc_test_folder(void);

/* Make the plugin `id` of OPCFLOW_PLUGIN_PATH from a map in flow syntax,
   "{ wavelength: 193 nm, litho: { use: litho.hopkins } }" ("{}" for nothing);
   files are relative to the current folder. An OPC_INPUT need not be given.
   NULL and *error, with all faults, if it is refused. */
opc_module *opc_test_module(const char *id, const char *mapping,
                            opc_error *error);
void opc_test_module_free(opc_module *module);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_module, opc_test_module_free)

/* Set the object of an OPC_INPUT; the program ends if there is none of that
   name. */
void opc_test_input(opc_module *module, const char *name, void *object);

/* Run a module of the kind step. `outputs` has room for all of them; the
   caller releases them with opc_test_release. On failure they are released
   here. */
int opc_test_run(opc_module *module, void **outputs, opc_error *error);
void opc_test_release(opc_module *module, void **outputs);

/* The last value of a metric since the last opc_test_forget, NAN if there is
   none. */
double opc_test_metric(const char *name);

/* The last table of that name, NULL if there is none. */
const opc_table *opc_test_table(const char *name);

/* All lines logged, each with a newline. */
const char *opc_test_log(void);

/* Drop metrics, tables and log. */
void opc_test_forget(void);

/* Make opc_host.cancelled answer yes or no. */
void opc_test_cancel(gboolean cancel);

#endif
