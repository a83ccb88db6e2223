/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the layer list of KLayout. Drawn shapes have light fills, masks
   have outlines. The printed contour of the drawn mask is dashed, that of the
   corrected mask is dark. */
#include <eda/drawing.h>

#include "klayout.h"

/* KLayout's dither patterns (I0 solid, I1 none) and line styles (I0 solid, I2
   dashed). */
static const struct {
  const char *name, *dither, *line;
  int width; /* pixels */
} groups[GROUPS] = {{"drawn", "I0", "I0", 1},
                    {"mask", "I1", "I0", 2},
                    {"printed as drawn", "I1", "I2", 1},
                    {"printed by the mask", "I1", "I0", 2}};

static eda_colour colour_of(const klayout *k, const sheet *s) {
  int contact = eda_gates_layer(k->mask->gates, "contact") == (int)s->layer;
  if (s->group == MASK) return eda_layer_outline(s->layer);
  if (s->group == DRAWN)
    return contact ? eda_contact_fill : eda_layer_fill(s->layer);
  return eda_layer_contour(s->layer);
}

static unsigned colour_byte(double part) {
  return (unsigned)(part * 255 + 0.5);
}

static void put_look(GString *out, int group, eda_colour c) {
  g_string_append_printf(out,
                         "<frame-color>#%02x%02x%02x</frame-color>\n"
                         "<fill-color>#%02x%02x%02x</fill-color>\n"
                         "<frame-brightness>0</frame-brightness>\n"
                         "<fill-brightness>0</fill-brightness>\n"
                         "<dither-pattern>%s</dither-pattern>\n"
                         "<line-style>%s</line-style>\n"
                         "<valid>true</valid>\n"
                         "<visible>true</visible>\n"
                         "<transparent>false</transparent>\n"
                         "<width>%d</width>\n"
                         "<marked>false</marked>\n"
                         "<xfill>false</xfill>\n"
                         "<animation>0</animation>\n",
                         colour_byte(c.r), colour_byte(c.g), colour_byte(c.b),
                         colour_byte(c.r), colour_byte(c.g), colour_byte(c.b),
                         groups[group].dither, groups[group].line,
                         groups[group].width);
}

static void put_sheet(GString *out, const klayout *k, const sheet *s) {
  g_autofree char *name = g_markup_escape_text(s->name, -1);
  g_string_append(out, "<group-members>\n");
  put_look(out, s->group, colour_of(k, s));
  g_string_append_printf(out,
                         "<name>%s</name>\n<source>%s@1</source>\n"
                         "</group-members>\n",
                         name, s->number);
}

static int group_is_shown(const sheet *s, int group) {
  return s->group == group && !s->empty;
}

/* The group has no style, because a style of the group would override the
   styles of its members. */
static void begin_group(GString *out, int group) {
  g_string_append_printf(out,
                         "<properties>\n<frame-color/>\n<fill-color/>\n"
                         "<frame-brightness>0</frame-brightness>\n"
                         "<fill-brightness>0</fill-brightness>\n"
                         "<dither-pattern/>\n<line-style/>\n"
                         "<valid>true</valid>\n<visible>true</visible>\n"
                         "<transparent>false</transparent>\n<width/>\n"
                         "<marked>false</marked>\n<xfill>false</xfill>\n"
                         "<animation>0</animation>\n<name>%s</name>\n"
                         "<source>*/*@*</source>\n",
                         groups[group].name);
}

int klayout_put_style(const klayout *k, opc_error *error) {
  GString *out = g_string_new(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
      "<layer-properties>\n");
  for (int group = 0; group < GROUPS; group++) {
    int any = 0;
    for (size_t i = 0; i < k->n_sheets; i++)
      any |= group_is_shown(&k->sheets[i], group);
    if (!any) continue;
    begin_group(out, group);
    for (size_t i = 0; i < k->n_sheets; i++)
      if (group_is_shown(&k->sheets[i], group))
        put_sheet(out, k, &k->sheets[i]);
    g_string_append(out, "</properties>\n");
  }
  g_string_append(out, "<name/>\n</layer-properties>\n");
  int code = klayout_put_text(k, k->style_name, out, error);
  g_string_free(out, TRUE);
  return code;
}
