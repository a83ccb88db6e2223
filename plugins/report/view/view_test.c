/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests view.json by an independent parser: areas equal those of the shapes,
   contours are at zeros of the field, and malicious names have no effect. */
#include <eda/gates.h>
#include <eda/memory.h>
#include <gio/gio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

static const char bad_name[] =
    "</script><img src=x onerror=alert(1)>\"\\\x01\xff";

/* ---- a mask ---- */

enum { SIDE = 2000, NODES = 64 };

/* Return level - cos - cos over one period in each direction. */
static eda_field island(double level) {
  eda_field f = {.frame = {-1000, -900, SIDE, SIDE}, .nx = NODES, .ny = NODES};
  f.coefficients = eda_alloc((size_t)NODES * NODES, sizeof *f.coefficients);
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++)
      f.coefficients[NODES * j + i] =
          (float)(level - cos(2 * M_PI * i / NODES) -
                  cos(2 * M_PI * j / NODES));
  eda_field_from_samples(NULL, &f);
  return f;
}

/* Return the sample's transistors with masks 7 nm larger, printed as an
   island. */
static eda_mask *mask_of(const eda_gates *gates) {
  opc_error error;
  eda_mask *m = eda_mask_new(gates);
  for (size_t k = 0; k < 2; k++)
    if (eda_shapes_grow(&gates->drawn[k], 7, &m->shapes[k], &error))
      g_error("%s", error.message);
  m->print[EDA_POLY] = island(-1.5);
  eda_performance_init(&m->design, gates->count);
  eda_performance_init(&m->before, gates->count);
  eda_performance_init(&m->after, gates->count);
  m->flags = eda_alloc(gates->count, sizeof *m->flags);
  for (size_t i = 0; i < gates->count; i++)
    m->design.ion[i] = m->before.ion[i] = 1e-3,
    m->after.ion[i] = 1e-3 * (1 + 0.01 * (double)i);
  return m;
}

static JsonNode *view_of(eda_mask *m, const char *mapping) {
  void *none[1];
  opc_error error;
  g_autoptr(opc_module) v = opc_test_module("report.view", mapping, &error);
  if (!v) g_error("%s", error.message);
  opc_test_input(v, "mask", m);
  if (opc_test_run(v, none, &error)) g_error("%s", error.message);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "view.json", NULL);
  g_autofree char *text = NULL;
  g_autoptr(GError) fault = NULL;
  if (!g_file_get_contents(path, &text, NULL, &fault))
    g_error("%s", fault->message);
  g_assert_null(strchr(text, '<'));
  JsonNode *root = json_from_string(text, &fault);
  if (!root) g_error("%s", fault->message);
  return root;
}

/* ---- unpacking ---- */

static GBytes *text_inflate(const char *text) {
  gsize size;
  g_autofree guchar *packed = g_base64_decode(text, &size);
  g_autoptr(GConverter) zlib =
      G_CONVERTER(g_zlib_decompressor_new(G_ZLIB_COMPRESSOR_FORMAT_ZLIB));
  g_autoptr(GInputStream) in =
      g_memory_input_stream_new_from_data(packed, (gssize)size, NULL);
  g_autoptr(GInputStream) stream = g_converter_input_stream_new(in, zlib);
  g_autoptr(GOutputStream) out = g_memory_output_stream_new_resizable();
  g_autoptr(GError) error = NULL;
  g_output_stream_splice(out, stream, G_OUTPUT_STREAM_SPLICE_CLOSE_TARGET, NULL,
                         &error);
  g_assert_no_error(error);
  return g_memory_output_stream_steal_as_bytes(G_MEMORY_OUTPUT_STREAM(out));
}

static GArray *array_unpack(JsonObject *o, const char *name, guint stride) {
  g_autoptr(GBytes) bytes =
      text_inflate(json_object_get_string_member(o, name));
  gsize size;
  const guint8 *b = g_bytes_get_data(bytes, &size);
  GArray *out = g_array_new(FALSE, FALSE, sizeof(gint32));
  g_assert_cmpuint(size % 4, ==, 0);
  for (guint i = 0; i < size / 4; i++, b += 4) {
    guint32 v =
        b[0] | (guint32)b[1] << 8 | (guint32)b[2] << 16 | (guint32)b[3] << 24;
    gint32 number = (gint32)v;
    if (i >= stride) number += g_array_index(out, gint32, i - stride);
    g_array_append_val(out, number);
  }
  return out;
}

/* Return the area of closed lines, in their units. */
static double area_of(JsonObject *shape) {
  g_autoptr(GArray) sizes = array_unpack(shape, "sizes", 1);
  g_autoptr(GArray) p = array_unpack(shape, "points", 2);
  const gint32 *at = (const gint32 *)p->data;
  double twice = 0;
  for (guint i = 0; i < sizes->len; i++) {
    int n = g_array_index(sizes, gint32, i);
    for (int k = 0; k < n; k++) {
      int m = (k + 1) % n;
      twice +=
          (double)at[2 * k] * at[2 * m + 1] - (double)at[2 * m] * at[2 * k + 1];
    }
    at += 2 * n;
  }
  g_assert_true(at == (const gint32 *)p->data + p->len);
  return twice / 2;
}

static JsonObject *shape_of(JsonNode *view, int layer, const char *role) {
  JsonArray *all =
      json_object_get_array_member(json_node_get_object(view), "shapes");
  for (guint i = 0; i < json_array_get_length(all); i++) {
    JsonObject *s = json_array_get_object_element(all, i);
    if (json_object_get_int_member(s, "layer") == layer &&
        !strcmp(json_object_get_string_member(s, "role"), role))
      return s;
  }
  return NULL;
}

/* ---- tests ---- */

static void test_areas(void) {
  const eda_gates *g = eda_gates_sample();
  eda_mask *m = mask_of(g);
  g_autoptr(JsonNode) view = view_of(m, "{}");
  for (int k = 0; k < 2; k++) {
    g_assert_cmpfloat(area_of(shape_of(view, k, "drawn")), ==,
                      (double)eda_area2(&g->drawn[k]) / 2);
    g_assert_cmpfloat(area_of(shape_of(view, k, "mask")), ==,
                      (double)eda_area2(&m->shapes[k]) / 2);
  }
  g_autoptr(GArray) boxes =
      array_unpack(json_node_get_object(view), "boxes", 4);
  g_assert_cmpuint(boxes->len, ==, 4 * g->count);
  for (size_t i = 0; i < g->count; i++)
    g_assert_cmpmem(&g_array_index(boxes, gint32, 4 * i), sizeof *g->box,
                    &g->box[i], sizeof *g->box);
  eda_mask_free(m);
}

/* Return the island's area in closed form: the integral over x of the height at
   which cos = level - cos x, by Simpson's rule. */
static double island_area(double level) {
  enum { STEPS = 200000 };
  double w = SIDE / (2 * M_PI), sum = 0, most = acos(level + 1);
  /* Around the middle: u = x - pi, where -cos x = cos u. */
  double reach = M_PI - most;
  for (int i = 0; i <= STEPS; i++) {
    double u = -reach + 2 * reach * i / STEPS;
    double c = -level - cos(u);
    double height = 2 * acos(fmin(1, fmax(-1, c)));
    sum += (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2) * height;
  }
  return sum * (2 * reach / STEPS) / 3 * w * w;
}

static void test_contours(void) {
  eda_gates g = *eda_gates_sample();
  g.extent =
      (eda_box){-500, -400, 500, 600}; /* the whole island, in one tile */
  eda_mask *m = mask_of(&g);
  g_autoptr(JsonNode) view = view_of(m, "{}");
  JsonObject *s = shape_of(view, 0, "print");
  double unit = json_object_get_double_member(s, "unit");
  double found = area_of(s) * unit * unit, exact = island_area(-1.5);
  g_test_message("area %.1f, exact %.1f", found, exact);
  g_assert_cmpfloat_with_epsilon(found, exact, 2e-3 * exact);
  g_autoptr(GArray) p = array_unpack(s, "points", 2);
  double worst = 0;
  for (guint i = 0; i + 1 < p->len; i += 2) {
    double x = g_array_index(p, gint32, i) * unit;
    double y = g_array_index(p, gint32, i + 1) * unit, v, dx, dy;
    eda_field_gradient(&m->print[0], &x, &y, 1, &v, &dx, &dy);
    worst = fmax(worst, fabs(v) / hypot(dx, dy));
  }
  g_test_message("%u points, worst %.3f nm off", p->len / 2, worst);
  g_assert_cmpfloat(worst, <, 0.4); /* half a unit in each direction is 0.35 */
  eda_mask_free(m);
}

/* In the image, 128 is the edge, larger values print, and rows begin at the
   bottom. */
static void test_image(void) {
  const eda_gates *g = eda_gates_sample();
  eda_mask *m = mask_of(g);
  g_autoptr(JsonNode) view = view_of(m, "{}");
  JsonObject *o =
      json_object_get_object_member(json_node_get_object(view), "image");
  g_autoptr(GBytes) bytes =
      text_inflate(json_object_get_string_member(o, "bytes"));
  gsize size, columns = (gsize)json_object_get_int_member(o, "columns");
  const guint8 *grey = g_bytes_get_data(bytes, &size);
  double pixel = json_object_get_double_member(o, "pixel");
  double most = json_object_get_double_member(o, "most");
  g_assert_cmpuint(size, ==,
                   columns * (gsize)json_object_get_int_member(o, "rows"));
  for (gsize i = 0; i < size; i += 97) {
    gsize row = i / columns;
    double x = json_object_get_double_member(o, "x") +
               ((double)(i % columns) + 0.5) * pixel;
    double y = json_object_get_double_member(o, "y") +
               ((double)row + 0.5) * pixel,
           v;
    eda_field_sample(&m->print[0], &x, &y, 1, &v);
    g_assert_cmpfloat_with_epsilon(grey[i], 128 + 127 * v / most, 0.51);
  }
  eda_mask_free(m);
}

static void test_names(void) {
  eda_gates g = *eda_gates_sample();
  g.name = (char *)bad_name;
  eda_mask *m = mask_of(&g);
  g_autoptr(JsonNode) view = view_of(m, "{}");
  g_assert_cmpstr(
      json_object_get_string_member(json_node_get_object(view), "cell"), ==,
      "</script><img src=x onerror=alert(1)>\"\\\x01\xef\xbf\xbd");
  eda_mask_free(m);
}

/* The page shows the worse of two transistors, and the environment. */
static void test_worst(void) {
  eda_gates g = *eda_gates_sample();
  eda_box far = {9000, 9000, 9060, 9200}, boxes[2] = {g.box[0], far};
  g.box = boxes;
  eda_mask *m = mask_of(&g);
  g_autoptr(JsonNode) view = view_of(m, "{ whole: 1, worst: 1 }");
  JsonObject *o = json_node_get_object(view);
  g_assert_false(json_object_get_boolean_member(o, "whole"));
  g_assert_null(shape_of(view, 0, "drawn"));
  m->flags[0] = EDA_PRINT_OPEN;
  g_autoptr(JsonNode) other = view_of(m, "{ whole: 1, worst: 1 }");
  g_assert_nonnull(shape_of(other, 0, "drawn"));
  g_autoptr(GArray) all = array_unpack(json_node_get_object(other), "boxes", 4);
  g_assert_cmpuint(all->len, ==, 8);
  eda_mask_free(m);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/report.view/areas", test_areas);
  g_test_add_func("/report.view/contours", test_contours);
  g_test_add_func("/report.view/image", test_image);
  g_test_add_func("/report.view/names", test_names);
  g_test_add_func("/report.view/worst", test_worst);
  return g_test_run();
}
