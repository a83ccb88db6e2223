/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares two masks written by write.gds: reads the polygons of one cell and
   computes the XOR per layer. (General layouts are read by the plugins
   read.*.) */
#include "masks.h"

#include <eda/gds.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>

/* ---- state ---- */

/* Polygons of a layer: points of all polygons in sequence. */
typedef struct drawn {
  uint32_t layer, datatype;
  GArray *points; /* eda_point */
  GArray *starts; /* uint32_t */
} drawn;

typedef struct mask {
  const char *path;
  char *bytes;
  size_t size, at;
  double unit;    /* nm */
  GArray *layers; /* drawn */
} mask;

/* ---- reading ---- */

static int mask_fail(const mask *m, const char *what, opc_error *error) {
  return opc_fail(error, OPC_INVALID, NULL, "'%s', byte %zu: %s", m->path,
                  m->at, what);
}

static drawn *find_layer(mask *m, uint32_t layer, uint32_t datatype) {
  for (guint i = 0; i < m->layers->len; i++) {
    drawn *d = &g_array_index(m->layers, drawn, i);
    if (d->layer == layer && d->datatype == datatype) return d;
  }
  drawn d = {layer, datatype, g_array_new(FALSE, FALSE, sizeof(eda_point)),
             g_array_new(FALSE, FALSE, sizeof(uint32_t))};
  uint32_t zero = 0;
  g_array_append_val(d.starts, zero);
  g_array_append_val(m->layers, d);
  return &g_array_index(m->layers, drawn, m->layers->len - 1);
}

/* Add a polygon without the last point, which repeats the first point in a
   GDSII boundary. */
static void add_polygon(drawn *to, const uint8_t *data, size_t n) {
  for (size_t i = 0; i + 1 < n; i++) {
    eda_point p = {eda_gds_i32(data + 8 * i), eda_gds_i32(data + 8 * i + 4)};
    g_array_append_val(to->points, p);
  }
  uint32_t end = to->points->len;
  g_array_append_val(to->starts, end);
}

/* Check the record at m->at and return its data length in *n. Returns 0, or an
   error code with *error filled. */
static int read_record(const mask *m, size_t *n, opc_error *error) {
  const uint8_t *r = (const uint8_t *)m->bytes + m->at;
  size_t left = m->size - m->at;
  size_t length = left < 4 ? 0 : eda_gds_u16(r);
  if (length < 4 || length > left)
    return mask_fail(m, "not a GDSII file, or truncated", error);
  *n = length - 4;
  return OPC_OK;
}

/* State of the GDSII element being read. */
typedef struct element {
  int is_polygon;
  uint32_t layer, datatype;
} element;

static int take_record(mask *m, element *e, uint32_t type, const uint8_t *data,
                       size_t n, opc_error *error) {
  size_t least = type == EDA_GDS_UNITS                               ? 16
                 : type == EDA_GDS_LAYER || type == EDA_GDS_DATATYPE ? 2
                                                                     : 0;
  if (n < least) return mask_fail(m, "a record is too short", error);
  switch (type) {
    case EDA_GDS_UNITS:
      m->unit = eda_gds_real(data + 8) * 1e9;
      break;
    case EDA_GDS_BOUNDARY:
      *e = (element){.is_polygon = 1};
      break;
    case EDA_GDS_LAYER:
      e->layer = eda_gds_u16(data);
      break;
    case EDA_GDS_DATATYPE:
      e->datatype = eda_gds_u16(data);
      break;
    case EDA_GDS_XY:
      if (e->is_polygon)
        add_polygon(find_layer(m, e->layer, e->datatype), data, n / 8);
      break;
    case EDA_GDS_PATH:
    case EDA_GDS_SREF:
    case EDA_GDS_AREF:
    case EDA_GDS_BOX:
      return mask_fail(m, "has elements other than the polygons of a mask",
                       error);
    case EDA_GDS_ENDEL:
      *e = (element){0};
      break;
    default:
      break;
  }
  return OPC_OK;
}

static int read_mask(mask *m, const char *path, opc_error *error) {
  g_autoptr(GError) trouble = NULL;
  *m = (mask){.path = path, .layers = g_array_new(FALSE, FALSE, sizeof(drawn))};
  if (!g_file_get_contents(path, &m->bytes, &m->size, &trouble))
    return opc_fail(error, OPC_IO, NULL, "%s", trouble->message);
  element e = {0};
  uint32_t type = EDA_GDS_HEADER;
  while (type != EDA_GDS_ENDLIB) {
    size_t n = 0;
    const uint8_t *r = (const uint8_t *)m->bytes + m->at;
    if (read_record(m, &n, error)) return error->code;
    type = r[2];
    if (take_record(m, &e, type, r + 4, n, error)) return error->code;
    m->at += n + 4;
  }
  if (!(m->unit > 0)) return mask_fail(m, "no UNITS record", error);
  return OPC_OK;
}

static void clear_mask(mask *m) {
  for (guint i = 0; i < m->layers->len; i++) {
    g_array_free(g_array_index(m->layers, drawn, i).points, TRUE);
    g_array_free(g_array_index(m->layers, drawn, i).starts, TRUE);
  }
  g_array_free(m->layers, TRUE);
  g_free(m->bytes);
}

/* ---- comparing ---- */

static eda_shapes shapes_of(const drawn *d) {
  if (d->starts->len < 2) return (eda_shapes){0};
  return (eda_shapes){.count = d->starts->len - 1,
                      .start = (uint32_t *)(void *)d->starts->data,
                      .points = (eda_point *)(void *)d->points->data};
}

static int compare_layer(const drawn *a, const drawn *b, double um,
                         mask_difference *out, opc_error *error) {
  eda_shapes x = shapes_of(a), y = shapes_of(b);
  eda_shapes one = {0}, two = {0}, rest = {0};
  eda_box *boxes = NULL;
  size_t n = 0;
  int code = eda_boolean(EDA_OR, &x, NULL, &one, error);
  if (!code) code = eda_boolean(EDA_OR, &y, NULL, &two, error);
  if (!code) code = eda_boolean(EDA_XOR, &one, &two, &rest, error);
  if (!code) code = eda_fracture(&rest, &boxes, &n, error);
  if (!code) {
    *out = (mask_difference){a->layer,
                             a->datatype,
                             (double)eda_area2(&one) / 2 * um * um,
                             (double)eda_area2(&two) / 2 * um * um,
                             (double)eda_area2(&rest) / 2 * um * um,
                             0,
                             (int64_t)n};
    for (size_t i = 0; i < rest.count; i++)
      out->places += !(rest.hole && rest.hole[i]);
  }
  free(boxes);
  eda_shapes_clear(&one);
  eda_shapes_clear(&two);
  eda_shapes_clear(&rest);
  return code;
}

EDA_COMPARE_RISING(by_number, mask_difference, layer, datatype);

static int compare_all(mask *a, mask *b, mask_difference **out, size_t *n,
                       opc_error *error) {
  if (a->unit != b->unit)
    return opc_fail(error, OPC_INVALID, NULL,
                    "the masks have grids of %g nm and %g nm", a->unit,
                    b->unit);
  /* Add to each mask the layers that only the other mask has. */
  for (guint i = 0; i < a->layers->len; i++) {
    const drawn d = g_array_index(a->layers, drawn, i);
    find_layer(b, d.layer, d.datatype);
  }
  *out = eda_alloc(b->layers->len, sizeof **out);
  *n = 0;
  int code = OPC_OK;
  for (guint i = 0; i < b->layers->len && !code; i++) {
    const drawn to = g_array_index(b->layers, drawn, i);
    const drawn *from = find_layer(a, to.layer, to.datatype);
    code = compare_layer(from, &to, a->unit * 1e-3, &(*out)[(*n)++], error);
  }
  qsort(*out, *n, sizeof **out, by_number);
  return code;
}

int masks_compare(const char *base, const char *other, mask_difference **out,
                  size_t *n, opc_error *error) {
  mask a = {0}, b = {0};
  *out = NULL;
  int code = read_mask(&a, base, error);
  if (!code) {
    code = read_mask(&b, other, error);
    if (!code) code = compare_all(&a, &b, out, n, error);
    clear_mask(&b);
  }
  clear_mask(&a);
  if (code) {
    free(*out);
    *out = NULL;
  }
  return code;
}
