/* SPDX-License-Identifier: BSD-3-Clause */
/* <opcflow/testing.h>, and more for our own tests. */
#pragma once

#include <glib.h>
#include <opcflow/testing.h>

#include "core/report/table.h"

G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_module, opc_test_module_free)

/* The last table of that name, NULL if there is none. */
const opc_table *opc_test_table(const char *name);
