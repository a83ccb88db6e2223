/* SPDX-License-Identifier: BSD-3-Clause */
/* The transistors of opc_test_gates: what segmentation makes of a poly line
   (x 0..60, y 0..1000) over an n-active (x -200..260, y 100..300) and a
   p-active (y 600..900). */
#include <math.h>

#include "core/plugin/testing.h"

enum { LINE = 12, ACTIVE = 8 };

static opc_point poly_points[] = {{0, 0}, {60, 0}, {60, 1000}, {0, 1000}};
static uint32_t poly_start[] = {0, 4};

static opc_point active_points[] = {{-200, 100}, {260, 100},  {260, 300},
                                    {-200, 300}, {-200, 600}, {260, 600},
                                    {260, 900},  {-200, 900}};
static uint32_t active_start[] = {0, 4, 8};

static opc_fragment poly_fragments[LINE] = {
    {{0, 0}, 0, OPC_END_LOW, {0}},      {{60, 0}, -1, OPC_FIXED, {0}},
    {{60, 100}, 0, OPC_L_HIGH, {0}},    {{60, 300}, -1, OPC_FIXED, {0}},
    {{60, 600}, 1, OPC_L_HIGH, {0}},    {{60, 900}, -1, OPC_FIXED, {0}},
    {{60, 1000}, 1, OPC_END_HIGH, {0}}, {{0, 1000}, -1, OPC_FIXED, {0}},
    {{0, 900}, 1, OPC_L_LOW, {0}},      {{0, 600}, -1, OPC_FIXED, {0}},
    {{0, 300}, 0, OPC_L_LOW, {0}},      {{0, 100}, -1, OPC_FIXED, {0}},
};
static uint32_t poly_edges[] = {0, LINE};

#define ACTIVE_FRAGMENTS(gate, low, high)                                     \
  {{-200, low}, -1, OPC_FIXED, {0}}, {{0, low}, gate, OPC_W_LOW, {0}},        \
      {{60, low}, -1, OPC_FIXED, {0}}, {{260, low}, -1, OPC_FIXED, {0}},      \
      {{260, high}, -1, OPC_FIXED, {0}}, {{60, high}, gate, OPC_W_HIGH, {0}}, \
      {{0, high}, -1, OPC_FIXED, {0}}, {                                      \
    {-200, high}, -1, OPC_FIXED, { 0 }                                        \
  }
static opc_fragment active_fragments[2 * ACTIVE] = {
    ACTIVE_FRAGMENTS(0, 100, 300), ACTIVE_FRAGMENTS(1, 600, 900)};
static uint32_t active_edges[] = {0, ACTIVE, 2 * ACTIVE};

static opc_box box[] = {{0, 100, 60, 300}, {0, 600, 60, 900}};
static uint8_t type[] = {OPC_NMOS, OPC_PMOS}, axis[] = {OPC_X, OPC_X};
static double length[] = {60, 60}, width[] = {200, 300};
static double room[] = {400, 400, 400, 400};
static double extension[] = {100, INFINITY, INFINITY, 100};
static const char *instance[] = {"", ""}, *cell[] = {"sample", "sample"};
static uint32_t number[] = {1, 2};

const opc_gates *opc_test_gates(void) {
  static const opc_gates gates = {
      .size = sizeof gates,
      .name = "sample",
      .grid = 1,
      .extent = {-200, 0, 260, 1000},
      .drawn = {{1, poly_start, poly_points, NULL},
                {2, active_start, active_points, NULL}},
      .edges = {{1, poly_edges, poly_fragments},
                {2, active_edges, active_fragments}},
      .count = 2,
      .box = box,
      .type = type,
      .axis = axis,
      .length = length,
      .width = width,
      .room = room,
      .extension = extension,
      .instance = instance,
      .cell = cell,
      .number = number,
  };
  return &gates;
}
