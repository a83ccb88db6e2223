/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OPCFLOW_DRAW_PAPER_H
#define OPCFLOW_DRAW_PAPER_H

#include <cairo.h>
#include <opcflow/opcflow.h>
#include <stdio.h>

enum { PAPER_PNG, PAPER_SVG, PAPER_PDF };

typedef struct paper {
  cairo_t *cairo; /* draw here */
  cairo_surface_t *surface;
  const opc_host *host;
  int format;
  const char *path;
  FILE *file;
  int reason;     /* why it could not be written: an errno */
  size_t matched; /* of what is_number looks for */
} paper;

/* If it fails there is nothing to close. */
int paper_open(paper *p, const opc_host *host, int format, const char *path,
               double width, double height, opc_error *error);

/* Write the rest, unless `code` says that drawing has failed; returns `code` or
   what went wrong here. On failure no file is left. */
int paper_close(paper *p, int code, opc_error *error);

#endif
