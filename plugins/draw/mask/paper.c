/* SPDX-License-Identifier: BSD-3-Clause */
/* The file that a picture goes to. Everything passes through a function of
   ours, so that a failure has a reason and equal pictures are equal files. */
#include "paper.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <ctype.h>
#include <errno.h>
#include <string.h>
#include <strings.h>

/* Cairo ends the names of groups and images in an SVG file with how many
   surfaces the process has made so far. Nothing refers to groups: their digits
   are left out. Images are counted from the first one of the file. */
enum { GROUP, IMAGE, IMAGE_USE };
static const char *const numbered[PAPER_NAMES] = {
    [GROUP] = "id=\"surface", [IMAGE] = "id=\"image", [IMAGE_USE] = "#image"};

/* Whether the byte is part of such a number; *end is 1 at the first one that is
   none any more. */
static int is_number(paper *p, unsigned char c, int *end) {
  *end = 0;
  if (p->name) {
    if (isdigit(c)) {
      p->number = 10 * p->number + (c - '0');
      return 1;
    }
    *end = p->name - 1 != GROUP;
    p->name = 0;
  }
  for (int k = 0; k < PAPER_NAMES; k++) {
    size_t *n = &p->matched[k];
    if (c == (unsigned char)numbered[k][*n])
      ++*n;
    else
      *n = c == (unsigned char)numbered[k][0];
    if (numbered[k][*n]) continue;
    *n = 0;
    p->name = k + 1;
  }
  return 0;
}

static int put_byte(paper *p, unsigned char c) {
  int end = 0;
  if (p->format == PAPER_SVG && is_number(p, c, &end)) return 1;
  if (end) {
    if (!p->first) p->first = p->number;
    if (fprintf(p->file, "%ld", p->number - p->first + 1) < 0) return 0;
  }
  if (p->format == PAPER_SVG && p->name) p->number = 0;
  return putc(c, p->file) != EOF;
}

static cairo_status_t put(void *closure, const unsigned char *data,
                          unsigned n) {
  paper *p = closure;
  for (unsigned i = 0; i < n; i++) {
    if (put_byte(p, data[i])) continue;
    if (!p->reason) p->reason = errno;
    return CAIRO_STATUS_WRITE_ERROR;
  }
  return CAIRO_STATUS_SUCCESS;
}

static cairo_surface_t *make_surface(paper *p, double width, double height) {
  cairo_surface_t *s;
  switch (p->format) {
    case PAPER_SVG:
      s = cairo_svg_surface_create_for_stream(put, p, width, height);
      cairo_svg_surface_set_document_unit(s, CAIRO_SVG_UNIT_PX);
      return s;
    case PAPER_PDF:
      s = cairo_pdf_surface_create_for_stream(put, p, width, height);
      cairo_pdf_surface_set_metadata(s, CAIRO_PDF_METADATA_CREATE_DATE,
                                     "1970-01-01T00:00:00Z");
      return s;
    default:
      return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width,
                                        (int)height);
  }
}

int paper_format(const char *file) {
  static const char *const extensions[] = {
      [PAPER_PNG] = ".png", [PAPER_SVG] = ".svg", [PAPER_PDF] = ".pdf"};
  const char *dot = strrchr(file, '.');
  for (int i = 0; dot && i < 3; i++)
    if (!strcasecmp(dot, extensions[i])) return i;
  return -1;
}

int paper_open(paper *p, const opc_host *host, int format, const char *path,
               double width, double height, opc_error *error) {
  *p = (paper){.host = host, .format = format, .path = path};
  p->file = fopen(path, "wb");
  if (!p->file)
    return host->fail(host, error, OPC_IO, NULL, "'%s': %s", path,
                      strerror(errno));
  p->surface = make_surface(p, width, height);
  p->cairo = cairo_create(p->surface);
  return OPC_OK;
}

int paper_close(paper *p, int code, opc_error *error) {
  cairo_status_t status = cairo_status(p->cairo);
  cairo_destroy(p->cairo);
  if (!code && !status && p->format == PAPER_PNG)
    status = cairo_surface_write_to_png_stream(p->surface, put, p);
  cairo_surface_finish(p->surface);
  if (!status) status = cairo_surface_status(p->surface);
  cairo_surface_destroy(p->surface);
  errno = 0;
  if (fclose(p->file) && !p->reason) p->reason = errno;
  if (!code && p->reason)
    code = p->host->fail(p->host, error, OPC_IO, NULL, "'%s': %s", p->path,
                         strerror(p->reason));
  if (!code && status)
    code = p->host->fail(p->host, error, OPC_FAILED, NULL, "'%s': %s", p->path,
                         cairo_status_to_string(status));
  if (code) remove(p->path);
  return code;
}
