/* SPDX-License-Identifier: BSD-3-Clause */
/* Common header of the files of write.klayout. */
#pragma once

#include "../oasis/stream.h"

/* Content of a layer of the file, and group of the layer list; later groups are
   drawn on top. */
enum { DRAWN, MASK, BEFORE, AFTER, GROUPS };

/* A layer of the file. */
typedef struct sheet {
  int group;
  size_t layer; /* layer of the gates */
  int holes;    /* 1: holes of a printed contour */
  int empty;    /* 1: not in the file */
  char number[32], name[64];
} sheet;

typedef struct klayout {
  oasis file; /* first member, passed to the stream's functions */
  const eda_mask *mask;
  const char *style_name, *markers_name;
  int64_t worst;
  sheet *sheets;
  size_t n_sheets;
} klayout;

/* Write the .lyp file with names, colours and groups of the layers. Return
   OPC_OK or an error. */
int klayout_put_style(const klayout *k, opc_error *error);

/* Write the .lyrdb file with kinds and places of faults. Return the code. */
int klayout_put_markers(const klayout *k, opc_error *error);

/* Write a text as a file of the run folder. Return OPC_OK or an error. */
int klayout_put_text(const klayout *k, const char *name, const GString *text,
                     opc_error *error);
