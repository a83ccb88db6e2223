/* SPDX-License-Identifier: BSD-3-Clause */
/* Contexts for unit tests of this library: several threads share the work, in
   varying order. */
#pragma once

#include <opcflow/base.h>

/* Return a context with `threads` threads, including the caller. Free it with
   eda_test_context_free. */
const opc_context *eda_test_context_new(unsigned threads);
void eda_test_context_free(const opc_context *context);
