/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of boolean operations and fractures of a placed circuit against KLayout
   0.30 (Region.merged with min_coherence, and its operators). */
#include <eda/layout.h>
#include <stdlib.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

static const char *const names[] = {"active", "nwell",   "nimplant",
                                    "poly",   "contact", "metal1"};
enum { ACTIVE, NWELL, NIMPLANT, POLY, CONTACT, METAL1, LAYERS };

typedef struct known {
  int op, a, b; /* b < 0: merge a */
  gint64 area;  /* database units squared */
  size_t polygons, holes, points;
} known;

static const known want[] = {
    {EDA_OR, ACTIVE, -1, 8834850000, 272, 0, 1160},
    {EDA_OR, NWELL, -1, 10300355000, 5, 0, 20},
    {EDA_OR, NIMPLANT, -1, 7122225000, 5, 0, 20},
    {EDA_OR, POLY, -1, 2855250000, 372, 0, 3248},
    {EDA_OR, CONTACT, -1, 843310000, 1996, 0, 7984},
    {EDA_OR, METAL1, -1, 6302152500, 513, 0, 5044},
    {EDA_OR, POLY, ACTIVE, 9649250000, 151, 327, 7688},
    {EDA_AND, POLY, ACTIVE, 2040850000, 820, 0, 3280},
    {EDA_NOT, POLY, ACTIVE, 814400000, 1192, 0, 6528},
    {EDA_XOR, POLY, ACTIVE, 7608400000, 2284, 0, 10968},
    {EDA_OR, METAL1, POLY, 8418502500, 28, 873, 9026},
    {EDA_AND, METAL1, POLY, 738900000, 1718, 0, 8316},
    {EDA_NOT, METAL1, POLY, 5563252500, 1142, 0, 11944},
    {EDA_XOR, METAL1, POLY, 7679602500, 2038, 15, 17342},
    {EDA_OR, METAL1, CONTACT, 6302152500, 513, 0, 5044},
    {EDA_AND, METAL1, CONTACT, 843310000, 1996, 0, 7984},
    {EDA_NOT, METAL1, CONTACT, 5458842500, 513, 10, 13024},
};

static void cell_check(const known *w, const eda_flat *flat) {
  eda_shapes out;
  opc_error error;
  eda_box *boxes;
  size_t n, holes = 0;
  g_assert_cmpint(
      eda_boolean(w->op, &flat[w->a].shapes,
                  w->b < 0 ? NULL : &flat[w->b].shapes, &out, &error),
      ==, OPC_OK);
  for (size_t p = 0; p < out.count; p++) holes += out.hole[p];
  g_assert_cmpint(eda_area2(&out), ==, 2 * w->area);
  g_assert_cmpuint(out.count - holes, ==, w->polygons);
  g_assert_cmpuint(holes, ==, w->holes);
  g_assert_cmpuint(out.start[out.count], ==, w->points);
  g_assert_cmpint(eda_fracture(&out, &boxes, &n, &error), ==, OPC_OK);
  gint64 area = 0;
  for (size_t i = 0; i < n; i++)
    area += (gint64)(boxes[i].x1 - boxes[i].x0) * (boxes[i].y1 - boxes[i].y0);
  g_assert_cmpint(area, ==, w->area);
  free(boxes);
  eda_shapes_clear(&out);
}

static void test_c432(void) {
  g_autofree char *path = find_data("iscas85/c432/c432.gds");
  if (!path) return;
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', layers: { active: 1/0, nwell: 3/0, nimplant: 4/0, "
      "poly: 9/0, contact: 10/0, metal1: 11/0 } }",
      path);
  opc_error error;
  opc_module *reader = opc_test_module("read.gds", map, &error);
  if (!reader) g_error("%s", error.message);
  void *layout;
  if (opc_test_run(reader, &layout, &error)) g_error("%s", error.message);
  eda_flat flat[LAYERS];
  for (int k = 0; k < LAYERS; k++)
    g_assert_cmpint(
        eda_layout_flatten(layout, eda_layout_top(layout, &error),
                           eda_layout_find_layer(layout, names[k]),
                           eda_layout_unit(layout), &flat[k], &error),
        ==, OPC_OK);
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++) cell_check(&want[i], flat);
  for (int k = 0; k < LAYERS; k++) eda_flat_clear(&flat[k]);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/nangate/c432", test_c432);
  return g_test_run();
}
