/* SPDX-License-Identifier: BSD-3-Clause */
/* What the prints of a loop or of a verification will take. */
#ifndef CORRECT_FORECAST_H
#define CORRECT_FORECAST_H

#include <eda/print.h>
#include <opcflow/step.h>

/* All corrected layers side by side, as the printer does them. `prints` says
   how many there are ("at most 101 prints"), and `fine_prints` if they are of
   the error `fine`, which the model has to have. */
OPC_EXPORT void forecast_prints(const opc_context *context,
                                const eda_gates *gates, const opc_module *litho,
                                const opc_module *resist, double margin,
                                double fine, const char *prints,
                                const char *fine_prints, opc_forecast *out);

#endif
