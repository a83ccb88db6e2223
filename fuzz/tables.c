/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes CSV tables: first corrections, weights of slices, widths that print,
   and goals of single transistors. */
#include <eda/goals.h>
#include <math.h>

#include "core/plugin/host.h"
#include "fuzz/fuzz.h"
#include "plugins/extractor/weights.h"
#include "plugins/resist/calibrate.h"
#include "plugins/synthesizer/dpb/table.h"

static opc_error error;

static void read_goals_of_two(const char *path) {
  static char nothing[] = "", deep[] = "a/b", nand[] = "nand2";
  static char *instance[] = {nothing, deep}, *cell[] = {nand, nand};
  static uint32_t number[] = {1, 2};
  const eda_gates gates = {
      .count = 2, .instance = instance, .cell = cell, .number = number};
  eda_goal goals[2] = {eda_goal_none, eda_goal_none};
  eda_goals_read(path, &gates, goals, &error);
}

/* A litho model, which reading a table requires. No image is computed. */
static double unused_band(const void *self) {
  (void)self;
  return 1e-3;
}

static int unused_image(const void *self, int layer, const eda_spectrum *mask,
                        eda_field *out, opc_error *e) {
  (void)self, (void)layer, (void)mask, (void)out;
  return opc_fail(e, OPC_FAILED, NULL, "no image");
}

static void read_widths(const char *path) {
  static const eda_litho litho = {.band = unused_band, .image = unused_image};
  static opc_host *host;
  if (!host) host = opc_host_new("fuzz", NULL, NULL);
  const opc_module module = {.functions = &litho, .id = "fuzz"};
  static const int fit[] = {1};
  double coefficient[] = {0.3};
  resist_base resist = {.host = host};
  resist_layer *layer = &resist.layer[0];
  *layer = (resist_layer){.anchor = {65, 250, NAN}, .file = path};
  if (!resist_layer_check(layer, 0, &error))
    resist_fit(&resist, 0, &module, "fuzz", NULL, 1, fit, coefficient, &error);
  resist_clear(&resist);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file(data, size);
  first_table table;
  if (!first_table_read(path, &table, &error)) first_table_clear(&table);
  weights w = {0};
  weights_read(path, "weights", &w, &error);
  weights_clear(&w);
  read_goals_of_two(path);
  read_widths(path);
  return 0;
}
