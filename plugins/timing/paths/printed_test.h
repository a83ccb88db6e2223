/* SPDX-License-Identifier: BSD-3-Clause */
/* An inverter with printed sizes, for tests of timing.paths. */
#pragma once

#include "library_test.h"

/* Printed sizes of XU1, the inverter from a to `out`. */
static double leq[2], weq[2], area[2];

static inline eda_mask *printed(const char *out, eda_circuit *circuit) {
  static const uint32_t finger[2] = {0, 1};
  static const char *nets[] = {"a", NULL, "VDD", "VSS"};
  static uint32_t port[] = {0, 1, 2, 3}, flags[2];
  static uint8_t role[] = {EDA_PIN_INPUT, EDA_PIN_OUTPUT, EDA_PIN_SUPPLY,
                           EDA_PIN_GROUND};
  static eda_device device[2] = {
      {"XU1/MN", 1, 0, 3, 3, 60, 200, EDA_NMOS, 1, &finger[0], "nmos"},
      {"XU1/MP", 1, 0, 2, 2, 60, 300, EDA_PMOS, 1, &finger[1], "pmos"}};
  static eda_mask mask;
  nets[1] = out;
  *circuit = (eda_circuit){.name = "top",
                           .gates = eda_gates_sample(),
                           .nets = 4,
                           .net = nets,
                           .ports = 4,
                           .port = port,
                           .role = role,
                           .count = 2,
                           .device = device};
  mask = (eda_mask){
      .gates = circuit->gates,
      .flags = flags,
      .after = {.count = 2, .leq_ion = leq, .weq = weq, .area = area}};
  return &mask;
}
