/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters and metrics shared by the steps of timing. `self_type` is the
   struct of the step's instance. */
#pragma once

#include <opcflow/step.h>

/* Model cards: files in the member models[2] and model names in model[2]. */
#define TIMING_MODELS(self_type, flag, text)                                 \
  OPC_PARAMETER_NAMED("models", self_type, models[0], .type = OPC_FILE,      \
                      .flags = (flag), .summary = (text)),                   \
      OPC_PARAMETER_NAMED(                                                   \
          "pmos_models", self_type, models[1], .type = OPC_FILE,             \
          .summary =                                                         \
              "file with the model card of the p-transistor, if different"), \
      OPC_PARAMETER_NAMED("nmos", self_type, model[EDA_NMOS],                \
                          .type = OPC_TEXT, .preset = "nmos",                \
                          .summary = "name of the n-transistor's model"),    \
      OPC_PARAMETER_NAMED("pmos", self_type, model[EDA_PMOS],                \
                          .type = OPC_TEXT, .preset = "pmos",                \
                          .summary = "name of the p-transistor's model")

/* Time limit of the simulator, in the member limit, s. */
#define TIMING_TIME_LIMIT(self_type)                                       \
  OPC_PARAMETER_NAMED(                                                     \
      "time_limit", self_type, limit, .type = OPC_REAL, .unit = "s",       \
      .former = "limit", .flags = OPC_ABOVE | OPC_AT_MOST | OPC_NO_EFFECT, \
      .preset = "600 s", .min = 0, .max = 86400,                           \
      .summary = "Longest time of one process of the simulator")

/* Electrical conditions, in the member at of type conditions (graph.h). */
#define TIMING_CONDITIONS(self_type)                                           \
  OPC_PARAMETER_NAMED("load", self_type, at.load, .type = OPC_REAL,            \
                      .unit = "F", .flags = OPC_AT_LEAST | OPC_AT_MOST,        \
                      .preset = "4 fF", .min = 0, .max = 1e-6,                 \
                      .summary = "capacitance at each output of the circuit"), \
      OPC_PARAMETER_NAMED(                                                     \
          "wire", self_type, at.wire, .type = OPC_REAL, .unit = "F",           \
          .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0 fF", .min = 0,     \
          .max = 1e-6,                                                         \
          .summary = "capacitance of wires, for each pin on a net"),           \
      OPC_PARAMETER_NAMED(                                                     \
          "slew", self_type, at.slew, .type = OPC_REAL, .unit = "s",           \
          .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10 ps",              \
          .min = 1e-14, .max = 1e-3,                                           \
          .summary =                                                           \
              "input slew, between the voltage levels of the cells' slews")

#define FIGURE(id, of, text) \
  { .name = (id), .unit = (of), .better = OPC_NEUTRAL, .summary = (text) }
#define COST(id, of, text) \
  { .name = (id), .unit = (of), .better = OPC_LOWER, .summary = (text) }
