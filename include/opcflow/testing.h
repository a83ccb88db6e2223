/* SPDX-License-Identifier: BSD-3-Clause */
/* Unit tests of plugins: create and run one plugin, without a flow, from
   parameters in the syntax of a flow. Link with the library opcflow-testing
   (pkg-config: opcflow-testing). For single-threaded test programs only. The
   library finds plugins in the same folders as the command `opcflow`: set
   OPCFLOW_PLUGIN_PATH to the folder of your build, followed by the folder of
   the installed plugins (`pkg-config --variable=pluginsdir opcflow`). */
#ifndef OPCFLOW_TESTING_H
#define OPCFLOW_TESTING_H

#include <opcflow/opcflow.h>

OPC_C_BEGIN

/* Return the host of all test instances, and the folder of its output files,
   which is removed at the end of the program. */
OPC_EXPORT const opc_host *opc_test_host(void);
OPC_EXPORT const char *opc_test_folder(void);

/* Create the plugin `id` with parameters from a map in flow syntax, "{
   wavelength: 193 nm, litho: { use: litho.hopkins } }" ("{}" for none); file
   names are relative to the current folder. An OPC_INPUT may be missing. If the
   parameters are not valid, returns NULL and writes all faults to *error. */
OPC_EXPORT opc_module *opc_test_module(const char *id, const char *mapping,
                                       opc_error *error);
/* Free a module of opc_test_module. */
OPC_EXPORT void opc_test_module_free(opc_module *module);

/* Set the object of an OPC_INPUT, which the caller owns. Aborts if the plugin
   has no input of that name. */
OPC_EXPORT void opc_test_input(opc_module *module, const char *name,
                               void *object);

/* Run a module of the kind step. `outputs` has space for all outputs; the
   caller releases them with opc_test_release. Returns 0, or an error code with
   *error filled; on failure the outputs are already released. */
OPC_EXPORT int opc_test_run(opc_module *module, void **outputs,
                            opc_error *error);
/* Release the outputs of opc_test_run. */
OPC_EXPORT void opc_test_release(opc_module *module, void **outputs);

/* Correct the mask of a NAND gate of 65 nm rules with a plugin of the
   correction loop, as an acceptance test. `plugin`, "{ use: synthesizer.mine
   }", is in the slot "litho", "resist", "extractor", "synthesizer" or
   "regulator"; shipped plugins are in the other slots, and the guard of the
   loop is off. The test passes if the loop converges, every transistor prints,
   and none is worse than drawn. The largest |Ion deviation| must be less than
   as drawn, or at most 0.5 %. Returns OPC_OK, or an error code and the reason
   in *error. Metrics of the correction, such as "ion_max", can be read
   afterwards. Since 0.8. */
OPC_EXPORT int opc_test_corrects(const char *slot, const char *plugin,
                                 opc_error *error);

/* Return the last value of a metric since the last opc_test_forget; NAN if
   there is none. */
OPC_EXPORT double opc_test_metric(const char *name);

/* Return data of the last table named `table`. opc_test_rows: the number of
   rows, 0 without such a table. opc_test_text: the text of a cell, valid until
   the next call; "" if the cell does not exist. opc_test_number: the number in
   a cell; NAN if the cell has no number. `column` is a name without unit. */
OPC_EXPORT size_t opc_test_rows(const char *table);
OPC_EXPORT const char *opc_test_text(const char *table, const char *column,
                                     size_t row);
OPC_EXPORT double opc_test_number(const char *table, const char *column,
                                  size_t row);

/* Return all logged lines, each with a newline. */
OPC_EXPORT const char *opc_test_log(void);

/* Discard metrics, tables and log. */
OPC_EXPORT void opc_test_forget(void);

/* Set the return value of opc_context.cancelled of the test host: 1 requests
   the plugin to stop, 0 does not. */
OPC_EXPORT void opc_test_cancel(int cancel);

OPC_C_END
#endif
