/* SPDX-License-Identifier: BSD-3-Clause */
/* Gates returned by eda_gates_sample: the result of segmenting a poly line (x
   0..60, y 0..1000) over an n-active (x -200..260, y 100..300) and a p-active
   (y 600..900), nm. */
#include <eda/gates.h>
#include <math.h>

enum { LINE = 12, ACTIVE = 8 };

static eda_point poly_points[] = {{0, 0}, {60, 0}, {60, 1000}, {0, 1000}};
static uint32_t poly_start[] = {0, 4};

static eda_point active_points[] = {{-200, 100}, {260, 100},  {260, 300},
                                    {-200, 300}, {-200, 600}, {260, 600},
                                    {260, 900},  {-200, 900}};
static uint32_t active_start[] = {0, 4, 8};

static eda_fragment poly_fragments[LINE] = {
    {{0, 0}, 0, EDA_END_LOW},      {{60, 0}, -1, EDA_FIXED},
    {{60, 100}, 0, EDA_L_HIGH},    {{60, 300}, -1, EDA_FIXED},
    {{60, 600}, 1, EDA_L_HIGH},    {{60, 900}, -1, EDA_FIXED},
    {{60, 1000}, 1, EDA_END_HIGH}, {{0, 1000}, -1, EDA_FIXED},
    {{0, 900}, 1, EDA_L_LOW},      {{0, 600}, -1, EDA_FIXED},
    {{0, 300}, 0, EDA_L_LOW},      {{0, 100}, -1, EDA_FIXED},
};
static uint32_t poly_edges[] = {0, LINE};

#define ACTIVE_FRAGMENTS(gate, low, high)                           \
  {{-200, low}, -1, EDA_FIXED}, {{0, low}, gate, EDA_W_LOW},        \
      {{60, low}, -1, EDA_FIXED}, {{260, low}, -1, EDA_FIXED},      \
      {{260, high}, -1, EDA_FIXED}, {{60, high}, gate, EDA_W_HIGH}, \
      {{0, high}, -1, EDA_FIXED}, {                                 \
    {-200, high}, -1, EDA_FIXED                                     \
  }
static eda_fragment active_fragments[2 * ACTIVE] = {
    ACTIVE_FRAGMENTS(0, 100, 300), ACTIVE_FRAGMENTS(1, 600, 900)};
static uint32_t active_edges[] = {0, ACTIVE, 2 * ACTIVE};

static char *layer[] = {"poly", "active"};
static uint8_t corrected[] = {1, 1};
static eda_shapes drawn[] = {{1, poly_start, poly_points, NULL},
                             {2, active_start, active_points, NULL}};
static eda_edges edges[] = {{1, poly_edges, poly_fragments},
                            {2, active_edges, active_fragments}};

static eda_box box[] = {{0, 100, 60, 300}, {0, 600, 60, 900}};
static uint8_t type[] = {EDA_NMOS, EDA_PMOS}, axis[] = {EDA_X, EDA_X};
static double length[] = {60, 60}, width[] = {200, 300};
static double space[] = {400, 400, 400, 400};
static double extension[] = {100, INFINITY, INFINITY, 100};
static char *instance[] = {"", ""}, *cell[] = {"sample", "sample"};
static uint32_t number[] = {1, 2};

const eda_gates *eda_gates_sample(void) {
  static const eda_gates gates = {
      .name = "sample",
      .grid = 1,
      .extent = {-200, 0, 260, 1000},
      .layers = 2,
      .layer = layer,
      .corrected = corrected,
      .drawn = drawn,
      .edges = edges,
      .count = 2,
      .box = box,
      .type = type,
      .axis = axis,
      .length = length,
      .width = width,
      .space = space,
      .extension = extension,
      .instance = instance,
      .cell = cell,
      .number = number,
  };
  return &gates;
}
