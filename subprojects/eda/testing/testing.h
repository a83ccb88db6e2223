/* SPDX-License-Identifier: BSD-3-Clause */
/* Contexts for unit tests of this library: several threads share the work, in
   varying order. */
#ifndef EDA_TESTING_TESTING_H
#define EDA_TESTING_TESTING_H

#include <opcflow/base.h>

/* Return a context with `threads` threads, including the caller. Free it with
   eda_test_context_free. */
const opc_context *eda_test_context_new(unsigned threads);
void eda_test_context_free(const opc_context *context);

#endif
