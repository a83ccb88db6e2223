/* SPDX-License-Identifier: BSD-3-Clause */
/* Protocol between the library and its helper program. The library writes a
   deck, a zero byte and commands to standard input. The program answers on
   standard output by records: a header followed by its bytes. */
#pragma once

#include <stdint.h>

enum {
  WORDS = 'w',   /* a line printed by the simulator */
  TROUBLE = 't', /* error message; ends the run */
  MISSING = 'm', /* the library cannot be loaded, and why; ends the run */
  NO_OSDI = 'o', /* the library does not support compiled models; ends the
                    run */
  COMMAND = 'c', /* command that begins */
  STATE = 's',   /* its latest point, as text */
  PLOT = 'p',    /* name of a plot */
  NAME = 'n',    /* name of a vector of that plot */
  VALUES = 'v',  /* values of that vector: doubles */
  DONE = 'd'     /* end of all commands */
};

typedef struct record {
  uint64_t kind, bytes;
} record;
