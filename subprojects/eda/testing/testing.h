/* SPDX-License-Identifier: BSD-3-Clause */
/* For the unit tests of this library: a context whose work several threads do,
   in an order that is never the same. */
#pragma once

#include <opcflow/base.h>

/* One of `threads` threads, the caller among them. Freed with
   eda_test_context_free. */
const opc_context *eda_test_context_new(unsigned threads);
void eda_test_context_free(const opc_context *context);
