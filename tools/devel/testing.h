/* SPDX-License-Identifier: BSD-3-Clause */
/* <opcflow/testing.h> with additions for the tests of this project. */
#pragma once

#include <glib.h>
#include <opcflow/testing.h>

#include "core/report/table.h"

G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_module, opc_test_module_free)

/* Skip a test of accuracy in a build with AddressSanitizer, where such a test
   takes up to a minute and other tests of the program run the same code. Return
   whether the test is skipped. */
static inline gboolean opc_test_sanitized_skip(void) {
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("accuracy is tested without the sanitizer");
  return TRUE;
#else
  return FALSE;
#endif
}

/* Return the last table of that name; NULL if there is none. */
const opc_table *opc_test_table(const char *name);
