/* SPDX-License-Identifier: BSD-3-Clause */
/* Common header of the files of write.klayout. */
#pragma once

#include "../oasis/stream.h"

/* Content of a layer of the file: drawn shapes, mask, contours printed by the
   drawn mask (BEFORE) and by the corrected mask (AFTER). The layer list of
   KLayout has a group for each content; later groups are drawn on top. */
enum { DRAWN, MASK, BEFORE, AFTER, GROUPS };

/* A layer of the file. */
typedef struct sheet {
  int group;
  size_t layer; /* index of the layer in eda_gates */
  int holes;    /* 1: holes of a printed contour */
  int empty;    /* 1: no shapes; the layer is then not in the file */
  char number[32], name[64];
} sheet;

/* The instance of write.klayout. */
typedef struct klayout {
  oasis file; /* first member, passed to the stream's functions */
  const eda_mask *mask;
  const char *style_name, *markers_name;
  int64_t worst;
  sheet *sheets;
  size_t n_sheets;
} klayout;

/* Cell and layer of a layout to which shapes are added, and a buffer for the
   points of a polygon. */
typedef struct target {
  eda_layout *layout;
  int32_t cell, layer;
  int32_t times; /* units of the file per step of the mask's grid */
  double unit;   /* nm */
  eda_point *points;
  size_t capacity;
} target;

/* Contours of the level set `print`, as from eda_contours; no contours if
   `print` is NULL. */
typedef struct contours {
  const opc_context *context;
  const eda_field *print;
  double *points;
  uint32_t *start;
  size_t count;
  opc_error error;
} contours;

/* Add a layer of the file: content, index of the layer in eda_gates, and 1 for
   holes. */
void klayout_add_sheet(klayout *k, int group, size_t layer, int holes);

/* Append the outlines or holes of contours to a layer. Return OPC_OK or an
   error. */
int klayout_put_contours(target *t, const contours *c, int holes,
                         opc_error *error);

/* Functions for masks of a chip (mask->chip), whose gates stand for classes of
   equal transistors (classes.c). klayout_list_classes: list the layers.
   klayout_build_classes: build the layout, with drawn shapes and mask as cells
   and arrays, and with simulated contours around the worst classes; return NULL
   and *error on failure. */
void klayout_list_classes(klayout *k);
eda_layout *klayout_build_classes(klayout *k, opc_error *error);

/* Write the .lyp file with names, colours and groups of the layers. Return
   OPC_OK or an error. */
int klayout_put_style(const klayout *k, opc_error *error);

/* Write the .lyrdb file with the kinds and places of faults and of the worst
   transistors. Return OPC_OK or an error. */
int klayout_put_markers(const klayout *k, opc_error *error);

/* Write a text as a file of the run folder. Return OPC_OK or an error. */
int klayout_put_text(const klayout *k, const char *name, const GString *text,
                     opc_error *error);
