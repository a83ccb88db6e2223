/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole plugin interface. */
#pragma once

#include <opcflow/base.h>
#include <opcflow/command.h>
#include <opcflow/inner.h>
#include <opcflow/kind.h>
#include <opcflow/plugin.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
