/* SPDX-License-Identifier: BSD-3-Clause */
/* The file that a picture goes to. Everything passes through a function of
   ours, so that a failure has a reason and equal pictures are equal files. */
#include "paper.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <ctype.h>
#include <errno.h>
#include <string.h>

/* Cairo ends the names of groups in an SVG file with how many surfaces the
   process has made so far. The digits are left out; nothing refers to them. */
static const char numbered[] = "id=\"surface";

static int is_number(paper *p, unsigned char c) {
  if (p->matched == sizeof numbered - 1) {
    if (isdigit(c)) return 1;
    p->matched = 0;
  }
  if (c == (unsigned char)numbered[p->matched])
    p->matched++;
  else
    p->matched = c == (unsigned char)numbered[0];
  return 0;
}

static cairo_status_t put(void *closure, const unsigned char *data,
                          unsigned n) {
  paper *p = closure;
  for (unsigned i = 0; i < n; i++) {
    if (p->format == PAPER_SVG && is_number(p, data[i])) continue;
    if (putc(data[i], p->file) != EOF) continue;
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
