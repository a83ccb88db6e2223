/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables in CSV files: first corrections, weights of slices, widths that print,
   wishes for single transistors. */
#include "core/plugin/host.h"
#include "fuzz/fuzz.h"
#include "plugins/extract/weights.h"
#include "plugins/mask/dpb/table.h"
#include "plugins/mask/newton/wishes.h"
#include "plugins/resist/calibrate.h"

static const opc_host *host;
static opc_error error;

static void read_wishes_of_two(const char *path) {
  static const char *instance[] = {"", "a/b"}, *cell[] = {"nand2", "nand2"};
  static uint32_t number[] = {1, 2};
  const opc_gates gates = {.size = sizeof gates,
                           .count = 2,
                           .instance = instance,
                           .cell = cell,
                           .number = number};
  wish wishes[2] = {{1, 1}, {1, 1}};
  read_wishes(host, path, &gates, wishes, &error);
}

/* A model that a table is read for, and no image taken from. */
static double band(const void *self) {
  (void)self;
  return 1e-3;
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *e) {
  (void)self, (void)layer, (void)mask, (void)out;
  return host->fail(host, e, OPC_FAILED, NULL, "no image");
}

static void read_widths(const char *path) {
  static const opc_litho litho = {
      .size = sizeof litho, .band = band, .image = image};
  static const opc_plugin plugin = {.operations = &litho};
  const opc_module module = {.plugin = &plugin};
  const resist_model model = {0};
  const opc_value values[RESIST_LAYER_PARAMETERS] = {
      [RESIST_LINE] = {.type = OPC_REAL, .real = 65},
      [RESIST_TABLE_FILE] = {.type = OPC_FILE, .text = path}};
  static const int fit[] = {1};
  double coefficient[] = {0.3};
  resist_layer layer;
  if (!resist_layer_create(&layer, host, "fuzz", OPC_POLY, values, &error))
    resist_fit(&layer, &module, &model, 1, fit, coefficient, &error);
  resist_layer_clear(&layer);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!host) host = opc_host_new(NULL);
  const char *path = fuzz_file(data, size);
  first_table table;
  if (!first_table_read(host, path, &table, &error)) first_table_clear(&table);
  weights w = {0};
  weights_read(host, path, "weights", &w, &error);
  weights_clear(&w);
  read_wishes_of_two(path);
  read_widths(path);
  return 0;
}
