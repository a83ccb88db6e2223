/* SPDX-License-Identifier: BSD-3-Clause */
/* File of a picture. Cairo's output is collected in memory first, so that write
   errors are reported with a reason and numbers in SVG files can be
   replaced. */
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <eda/drawing.h>
#include <errno.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { PNG, SVG, PDF, FORMATS };
static const char *const extensions[FORMATS] = {
    [PNG] = ".png", [SVG] = ".svg", [PDF] = ".pdf"};

typedef struct sheet {
  eda_paper paper; /* public members; must be first */
  cairo_surface_t *surface;
  int format;
  const char *path;
  FILE *file;
  GString *content;
} sheet;

/* ---- content ---- */

static cairo_status_t svg_append(void *closure, const unsigned char *data,
                                 unsigned n) {
  sheet *s = closure;
  g_string_append_len(s->content, (const char *)data, n);
  return CAIRO_STATUS_SUCCESS;
}

/* Replace the numbers of groups and images in an SVG file. Cairo counts them
   over all surfaces of the process, so equal pictures would differ. Numbers of
   groups are removed, because they are never referenced. Images are numbered
   from 1. */
static gboolean svg_renumber(const GMatchInfo *match, GString *out,
                             void *data) {
  g_autofree char *name = g_match_info_fetch(match, 1);
  g_autofree char *digits = g_match_info_fetch(match, 2);
  gint64 *first = data, number = g_ascii_strtoll(digits, NULL, 10);
  g_string_append(out, name);
  if (g_str_has_suffix(name, "surface")) return FALSE;
  if (!*first) *first = number;
  g_string_append_printf(out, "%" G_GINT64_FORMAT, number - *first + 1);
  return FALSE;
}

/* Write the content and close the file. Return 0 or an errno value. */
static int write_content(sheet *s) {
  gint64 first = 0;
  if (s->format == SVG) {
    GRegex *regex = g_regex_new("(id=\"surface|id=\"image|#image)([0-9]+)",
                                G_REGEX_RAW, 0, NULL);
    char *text =
        g_regex_replace_eval(regex, s->content->str, (gssize)s->content->len, 0,
                             0, svg_renumber, &first, NULL);
    g_string_assign(s->content, text);
    g_free(text);
    g_regex_unref(regex);
  }
  errno = 0;
  size_t done = fwrite(s->content->str, 1, s->content->len, s->file);
  int reason = done < s->content->len ? errno : 0;
  if (fclose(s->file) && !reason) reason = errno;
  return reason;
}

/* ---- surfaces ---- */

static cairo_surface_t *new_surface(sheet *s) {
  double width = s->paper.width, height = s->paper.height;
  cairo_surface_t *out;
  if (!(height > 0)) return cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
  switch (s->format) {
    case SVG:
      out = cairo_svg_surface_create_for_stream(svg_append, s, width, height);
      cairo_svg_surface_set_document_unit(out, CAIRO_SVG_UNIT_PX);
      return out;
    case PDF:
      out = cairo_pdf_surface_create_for_stream(svg_append, s, width, height);
      cairo_pdf_surface_set_metadata(out, CAIRO_PDF_METADATA_CREATE_DATE,
                                     "1970-01-01T00:00:00Z");
      return out;
    default:
      return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width,
                                        (int)height);
  }
}

/* Select a font without hinting, so that text looks the same on every
   device. */
static void set_font(const eda_paper *p) {
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(p->cairo, options);
  cairo_font_options_destroy(options);
  cairo_select_font_face(p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(p->cairo, p->font);
}

static void sheet_begin(sheet *s) {
  s->surface = new_surface(s);
  s->paper.cairo = cairo_create(s->surface);
  cairo_set_source_rgb(s->paper.cairo, 1, 1, 1);
  cairo_paint(s->paper.cairo);
  eda_use(s->paper.cairo, eda_ink);
  set_font(&s->paper);
}

/* ---- paper ---- */

static int format_of(const char *file) {
  const char *dot = strrchr(file, '.');
  for (int i = 0; dot && i < FORMATS; i++)
    if (!strcasecmp(dot, extensions[i])) return i;
  return -1;
}

int eda_paper_check(const char *file, const char *parameter, opc_error *error) {
  if (format_of(file) >= 0) return OPC_OK;
  return opc_fail(error, OPC_INVALID, parameter,
                  "'%s': the name of a picture must end in .png, .svg or .pdf",
                  file);
}

eda_paper *eda_paper_open(const char *path, double width, double height,
                          double font, opc_error *error) {
  FILE *file = fopen(path, "wb");
  if (!file) {
    opc_fail(error, OPC_IO, NULL, "'%s': %s", path, strerror(errno));
    return NULL;
  }
  sheet *s = g_new(sheet, 1);
  *s = (sheet){.paper = {.width = width,
                         .height = height,
                         .font = font,
                         .margin = ceil(0.9 * font)},
               .format = format_of(path),
               .path = path,
               .file = file,
               .content = g_string_new(NULL)};
  s->paper.pixels = s->format != SVG && s->format != PDF;
  sheet_begin(s);
  return &s->paper;
}

void eda_paper_cut(eda_paper *paper, double height) {
  sheet *s = (sheet *)paper;
  cairo_destroy(paper->cairo);
  cairo_surface_destroy(s->surface);
  paper->height = height;
  g_string_truncate(s->content, 0);
  sheet_begin(s);
}

int eda_paper_close(eda_paper *paper, int code, opc_error *error) {
  sheet *s = (sheet *)paper;
  cairo_status_t status = cairo_status(paper->cairo);
  cairo_destroy(paper->cairo);
  if (!code && !status && paper->pixels)
    status = cairo_surface_write_to_png_stream(s->surface, svg_append, s);
  cairo_surface_finish(s->surface);
  if (!status) status = cairo_surface_status(s->surface);
  cairo_surface_destroy(s->surface);
  int reason = write_content(s);
  if (!code && reason)
    code = opc_fail(error, OPC_IO, NULL, "'%s': %s", s->path, strerror(reason));
  if (!code && status)
    code = opc_fail(error, OPC_FAILED, NULL, "'%s': %s", s->path,
                    cairo_status_to_string(status));
  if (code) remove(s->path);
  g_string_free(s->content, TRUE);
  g_free(s);
  return code;
}
