/* SPDX-License-Identifier: BSD-3-Clause */
/* OASIS files as a format of ../writer.h; compiled into each OASIS writer. */
#pragma once

#include <eda/oasis.h>
#include <glib.h>

#include "../writer.h"

/* Distinct strings, numbered from 0 in order of appearance. */
typedef struct strings {
  GHashTable *numbers; /* text -> number */
  GPtrArray *texts;    /* owned by the layout */
} strings;

/* An OASIS file under construction. */
typedef struct oasis {
  writer w;
  eda_layer_number layer;
  eda_oasis *out;
  strings texts, names; /* texts of the layout; names of instances */
  const eda_layout *layout;
  uint64_t *places; /* place of each cell in the file, bytes */
  size_t n_places;
  /* Names of the layout's layers, in the order of the layers, printable and
     without blanks; NULL for a layer without a name. If layer_names itself is
     NULL, the file has no layer names. */
  const char *const *layer_names;
} oasis;

/* Format of writers whose instance begins with an `oasis`. */
extern const write_format oasis_stream;
