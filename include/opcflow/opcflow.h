/* SPDX-License-Identifier: BSD-3-Clause */
/* Includes the complete plugin interface. */
#ifndef OPCFLOW_OPCFLOW_H
#define OPCFLOW_OPCFLOW_H

#include <opcflow/base.h>
#include <opcflow/command.h>
#include <opcflow/inner.h>
#include <opcflow/kind.h>
#include <opcflow/plugin.h>
#include <opcflow/step.h>
#include <opcflow/table.h>

#endif
