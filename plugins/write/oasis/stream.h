/* SPDX-License-Identifier: BSD-3-Clause */
/* OASIS files, as a format of ../writer.h; compiled into each plugin that
   writes them. */
#ifndef OPCFLOW_WRITE_STREAM_H
#define OPCFLOW_WRITE_STREAM_H

#include <eda/oasis.h>
#include <glib.h>

#include "../writer.h"

/* Different strings, numbered from 0 in the order in which they come. */
typedef struct strings {
  GHashTable *numbers; /* text: its number */
  GPtrArray *texts;    /* the layout's own */
} strings;

typedef struct oasis {
  writer w;
  eda_layer_number layer;
  eda_oasis *out;
  strings texts, names; /* of instances */
  const eda_layout *layout;
  uint64_t *places; /* of the cells in the file */
  size_t n_places;
  /* Of the layout's layers, in its order, printable and without blanks, or
     NULL for none; NULL: the file names no layer. */
  const char *const *layer_names;
} oasis;

/* Of writers whose instance begins with an `oasis`. */
extern const write_format oasis_stream;

#endif
