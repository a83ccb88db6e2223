/* SPDX-License-Identifier: BSD-3-Clause */
/* For the unit tests of plugins, and for nothing else: one plugin, made from a
   text in the syntax of a flow, without a flow. Link with the library
   opcflow-testing (pkg-config: opcflow-testing). One test program, one thread.
   Plugins are looked for as the command does: set OPCFLOW_PLUGIN_PATH to the
   folder with what you have built, then that of the installed ones
   (`pkg-config --variable=pluginsdir opcflow`). */
#ifndef OPCFLOW_TESTING_H
#define OPCFLOW_TESTING_H

#include <opcflow/opcflow.h>

OPC_C_BEGIN

/* The host that all of it reports to. output_path gives a place in a fresh
   folder, which is removed when the program ends. */
OPC_EXPORT const opc_host *opc_test_host(void);
OPC_EXPORT const char *opc_test_folder(void);

/* Make the plugin `id` from a map in flow syntax,
   "{ wavelength: 193 nm, litho: { use: litho.hopkins } }" ("{}" for nothing);
   files are relative to the current folder. An OPC_INPUT need not be given.
   NULL and *error, with all faults, if it is refused. */
OPC_EXPORT opc_module *opc_test_module(const char *id, const char *mapping,
                                       opc_error *error);
OPC_EXPORT void opc_test_module_free(opc_module *module);

/* Set the object of an OPC_INPUT; the program ends if there is none of that
   name. */
OPC_EXPORT void opc_test_input(opc_module *module, const char *name,
                               void *object);

/* Run a module of the kind step. `outputs` has room for all of them; the
   caller releases them with opc_test_release. On failure they are released
   here. */
OPC_EXPORT int opc_test_run(opc_module *module, void **outputs,
                            opc_error *error);
OPC_EXPORT void opc_test_release(opc_module *module, void **outputs);

/* The last value of a metric since the last opc_test_forget, NAN if there is
   none. */
OPC_EXPORT double opc_test_metric(const char *name);

/* Of the last table of that name: its rows, 0 if there is none; a cell of a
   column (by its name without unit) as text, "" if there is none, and as a
   number, NAN if it is none. The text is valid until the next call. */
OPC_EXPORT size_t opc_test_rows(const char *table);
OPC_EXPORT const char *opc_test_text(const char *table, const char *column,
                                     size_t row);
OPC_EXPORT double opc_test_number(const char *table, const char *column,
                                  size_t row);

/* All lines logged, each with a newline. */
OPC_EXPORT const char *opc_test_log(void);

/* Drop metrics, tables and log. */
OPC_EXPORT void opc_test_forget(void);

/* Make opc_host.cancelled answer yes or no. */
OPC_EXPORT void opc_test_cancel(int cancel);

OPC_C_END
#endif
