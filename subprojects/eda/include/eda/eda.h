/* SPDX-License-Identifier: BSD-3-Clause */
/* Most headers of the library. Include <eda/drawing.h>, which needs cairo,
   <eda/median.h>, <eda/models.h> and <eda/verdicts.h> separately. */
#pragma once

#include <eda/check.h>
#include <eda/chip.h>
#include <eda/circuit.h>
#include <eda/csv.h>
#include <eda/curves.h>
#include <eda/delays.h>
#include <eda/devices.h>
#include <eda/experiment.h>
#include <eda/extractor.h>
#include <eda/file.h>
#include <eda/formats.h>
#include <eda/gates.h>
#include <eda/gds.h>
#include <eda/geometry.h>
#include <eda/goals.h>
#include <eda/imaging.h>
#include <eda/index.h>
#include <eda/layout.h>
#include <eda/litho.h>
#include <eda/memory.h>
#include <eda/netlist.h>
#include <eda/oasis.h>
#include <eda/pool.h>
#include <eda/print.h>
#include <eda/random.h>
#include <eda/regulator.h>
#include <eda/resist.h>
#include <eda/rules.h>
#include <eda/runs.h>
#include <eda/samples.h>
#include <eda/sdf.h>
#include <eda/segment.h>
#include <eda/settings.h>
#include <eda/simd.h>
#include <eda/simulator.h>
#include <eda/srafs.h>
#include <eda/synthesizer.h>
#include <eda/timing.h>
#include <eda/wave.h>
#include <eda/words.h>
#include <opcflow/base.h>
