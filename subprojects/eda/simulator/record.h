/* SPDX-License-Identifier: BSD-3-Clause */
/* What passes between the library and its helper program. The library writes a
   deck, a zero byte and commands to its standard input. The program answers on
   its standard output by records: a head, then its bytes. */
#pragma once

#include <stdint.h>

enum {
  WORDS = 'w',   /* a line that the simulator said */
  TROUBLE = 't', /* what went wrong; ends the run */
  MISSING = 'm', /* the library is not there, and why; ends the run */
  NO_OSDI = 'o', /* the library knows no compiled models; ends the run */
  PLOT = 'p',    /* its name */
  NAME = 'n',    /* of a vector of that plot */
  VALUES = 'v',  /* of that vector: doubles */
  DONE = 'd'     /* all commands were run */
};

typedef struct record {
  uint64_t kind, bytes;
} record;
