/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole plugin interface. */
#ifndef OPCFLOW_OPCFLOW_H
#define OPCFLOW_OPCFLOW_H

#include <opcflow/circuit.h>
#include <opcflow/devices.h>
#include <opcflow/extract.h>
#include <opcflow/gates.h>
#include <opcflow/geometry.h>
#include <opcflow/imaging.h>
#include <opcflow/layout.h>
#include <opcflow/litho.h>
#include <opcflow/mask.h>
#include <opcflow/plugin.h>
#include <opcflow/settings.h>
#include <opcflow/step.h>

#endif
