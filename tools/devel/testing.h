/* SPDX-License-Identifier: BSD-3-Clause */
/* <opcflow/testing.h> with additions for the tests of this project. */
#pragma once

#include <glib.h>
#include <opcflow/testing.h>

#include "core/report/table.h"

G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_module, opc_test_module_free)

/* Return the last table of that name; NULL if there is none. */
const opc_table *opc_test_table(const char *name);
