/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OPCFLOW_DRAW_PAPER_H
#define OPCFLOW_DRAW_PAPER_H

#include <cairo.h>
#include <opcflow/opcflow.h>
#include <stdio.h>

enum { PAPER_PNG, PAPER_SVG, PAPER_PDF };

enum { PAPER_NAMES = 3 }; /* that cairo numbers in an SVG file */

typedef struct paper {
  cairo_t *cairo; /* draw here */
  cairo_surface_t *surface;
  const opc_host *host;
  int format;
  const char *path;
  FILE *file;
  int reason; /* why it could not be written: an errno */
  /* What is_number has read so far. */
  size_t matched[PAPER_NAMES];
  int name;           /* whose number comes next, from 1; 0: none */
  long number, first; /* that number; the first image's */
} paper;

/* PAPER_PNG and so on, by the end of a file's name; -1 for none of them. */
int paper_format(const char *file);

/* If it fails there is nothing to close. */
int paper_open(paper *p, const opc_host *host, int format, const char *path,
               double width, double height, opc_error *error);

/* Write the rest, unless `code` says that drawing has failed; returns `code` or
   what went wrong here. On failure no file is left. */
int paper_close(paper *p, int code, opc_error *error);

#endif
