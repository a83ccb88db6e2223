/* SPDX-License-Identifier: BSD-3-Clause */
/* What the prints of a loop or of a verification will take. */
#ifndef CORRECT_FORECAST_H
#define CORRECT_FORECAST_H

#include <eda/print.h>
#include <opcflow/step.h>

/* All corrected layers side by side, as the printer does them, and `prints` of
   them ("at most 101 prints"). */
void forecast_prints(const opc_context *context, const eda_gates *gates,
                     const opc_module *litho, const opc_module *resist,
                     double margin, const char *prints, opc_forecast *out);

#endif
