/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistor flavours by the marker layers that cover each gate. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

enum { MOST_FLAVOURS = 32 };

/* ---- settings ---- */

/* Return the next marker of a text, and its length *n; NULL at the end. Markers
   are words separated by blanks; an expression of layers is one marker. */
static const char *next_word(const char *text, size_t *n) {
  text += strspn(text, " ");
  *n = strpbrk(text, "+-^&(") ? strlen(text) : strcspn(text, " ");
  return *n ? text : NULL;
}

static const char *name_of(const eda_segment_settings *s, size_t i) {
  return s->flavours[2 * i];
}

static const char *markers_of(const eda_segment_settings *s, size_t i) {
  return s->flavours[2 * i + 1];
}

static int error_set_flavour(opc_error *error, const char *flavour) {
  (void)snprintf(error->parameter, sizeof error->parameter, "flavours.%.50s",
                 flavour);
  return error->code;
}

int segment_check_flavours(const eda_segment_settings *s, opc_error *error) {
  if (s->flavour_count > MOST_FLAVOURS)
    return opc_fail(error, OPC_INVALID, "flavours",
                    "%zu flavours, expected at most %d", s->flavour_count,
                    MOST_FLAVOURS);
  for (size_t i = 0; i < s->flavour_count; i++) {
    size_t n;
    if (next_word(markers_of(s, i), &n) && *name_of(s, i)) continue;
    (void)opc_fail(error, OPC_INVALID, NULL,
                   "'%.50s' must name the marker layer of the transistors, or "
                   "several marker layers separated by blanks",
                   name_of(s, i));
    return error_set_flavour(error, name_of(s, i));
  }
  return OPC_OK;
}

/* ---- work ---- */

static int32_t layer_of(const segment *s, const char *name, size_t n) {
  char text[512];
  (void)snprintf(text, sizeof text, "%.*s", (int)n, name);
  return eda_layout_select(s->layout, text, s->error);
}

static void count_name(void *data, const char *name) {
  (void)name;
  ++*(size_t *)data;
}

/* Set covers[] to the relation (SEGMENT_INSIDE ...) of each region to the
   intersection of all markers of a flavour. Set *markers to the number of
   marker layers; an expression counts as its layers. */
static int find_markers(segment *s, size_t flavour, uint8_t *covers,
                        size_t *markers) {
  const char *of = name_of(s->settings, flavour);
  const char *word = markers_of(s->settings, flavour);
  uint8_t *one = eda_alloc(s->regions.count, 1);
  int code = OPC_OK;
  memset(covers, SEGMENT_INSIDE, s->regions.count);
  *markers = 0;
  for (size_t n; !code && (word = next_word(word, &n)); word += n) {
    int32_t layer = layer_of(s, word, n);
    eda_shapes shapes = {0};
    eda_flat flat = {0};
    if (layer < 0) {
      code = error_set_flavour(s->error, of);
      break;
    }
    if (!eda_layout_is_derived(s->layout, layer) ||
        eda_layer_names(eda_layout_layer_name(s->layout, layer), count_name,
                        markers, s->error))
      ++*markers;
    code = segment_flatten(s->layout, s->top, layer, s->grid, s->window, &flat,
                           &shapes, s->error);
    if (!code) code = segment_cover(s, &shapes, one);
    for (size_t i = 0; i < s->regions.count && !code; i++)
      if (one[i] == SEGMENT_PARTLY)
        covers[i] = SEGMENT_PARTLY;
      else if (one[i] == SEGMENT_OUTSIDE && covers[i] == SEGMENT_INSIDE)
        covers[i] = SEGMENT_OUTSIDE;
    eda_flat_clear(&flat);
    eda_shapes_clear(&shapes);
  }
  free(one);
  return code;
}

static int region_refuse(segment *s, size_t region, const char *a,
                         const char *b) {
  char text[200];
  if (b)
    (void)snprintf(text, sizeof text,
                   "the transistor is marked as '%.50s' and as '%.50s': define "
                   "a flavour of both markers, 'NAME: A B'",
                   a, b);
  else
    (void)snprintf(text, sizeof text,
                   "a marker of '%.50s' covers the transistor in part", a);
  return segment_refuse(s, region, text);
}

/* If several flavours match a gate, the flavour with the largest number of
   marker layers applies, because it is the most specific. Two matching flavours
   with this number are an error. */
int segment_flavours(segment *s) {
  const eda_segment_settings *set = s->settings;
  size_t n = s->regions.count;
  uint8_t *covers = eda_alloc(n, 1);
  size_t *most = eda_alloc(n, sizeof *most), markers = 0;
  size_t *flavour = eda_alloc(n, sizeof *flavour);
  const char **rival = eda_alloc(n, sizeof *rival);
  int code = OPC_OK;
  for (size_t f = 0; f < set->flavour_count && !code; f++) {
    code = find_markers(s, f, covers, &markers);
    for (size_t i = 0; i < n && !code; i++) {
      if (covers[i] == SEGMENT_PARTLY)
        code = region_refuse(s, i, name_of(set, f), NULL);
      if (covers[i] != SEGMENT_INSIDE || markers < most[i]) continue;
      rival[i] = markers == most[i] ? name_of(set, flavour[i]) : NULL;
      flavour[i] = f;
      most[i] = markers;
    }
  }
  for (size_t i = 0; i < n && !code; i++) {
    if (rival[i])
      code = region_refuse(s, i, rival[i], name_of(set, flavour[i]));
    if (!most[i] || code) continue;
    eda_gates *g = s->gates;
    if (!g->flavour) g->flavour = eda_alloc(g->count, sizeof *g->flavour);
    g->flavour[i] = eda_gates_text(g, name_of(set, flavour[i]));
  }
  free(covers);
  free(most);
  free(flavour);
  free(rival);
  return code;
}
