/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of write.klayout have in common. */
#ifndef WRITE_KLAYOUT_H
#define WRITE_KLAYOUT_H

#include "../oasis/stream.h"

/* What a layer of the file shows of a layer of the gates; groups of the layer
   list, the later ones drawn upon the earlier. */
enum { DRAWN, MASK, BEFORE, AFTER, GROUPS };

/* A layer of the file. */
typedef struct sheet {
  int group;
  size_t layer; /* of the gates */
  int holes;    /* of a print: what lies inside of it and does not print */
  int empty;    /* there is none of it in the file */
  char number[32], name[64];
} sheet;

typedef struct klayout {
  oasis file; /* first: the stream's functions get it */
  const eda_mask *mask;
  const char *style_name, *markers_name;
  int64_t worst;
  sheet *sheets;
  size_t n_sheets;
} klayout;

/* The .lyp: names, colours and groups of the sheets. */
int klayout_put_style(const klayout *k, opc_error *error);

/* The .lyrdb: what is wrong and where. */
int klayout_put_markers(const klayout *k, opc_error *error);

/* A text as a file of the run folder. */
int klayout_put_text(const klayout *k, const char *name, const GString *text,
                     opc_error *error);

#endif
