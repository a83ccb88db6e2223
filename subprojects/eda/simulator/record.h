/* SPDX-License-Identifier: BSD-3-Clause */
/* Protocol between the library and the helper program. The library writes a
   deck, a zero byte and commands to standard input of the program. The program
   answers with records on standard output: a header followed by `bytes`
   bytes. */
#pragma once

#include <stdint.h>

/* Kinds of records. */
enum {
  WORDS = 'w',   /* line printed by the simulator */
  TROUBLE = 't', /* error message; ends the run */
  MISSING = 'm', /* reason why the library of ngspice cannot be loaded; ends the
                    run */
  NO_OSDI = 'o', /* the library of ngspice has no OSDI support; ends the run */
  COMMAND = 'c', /* command that is about to run */
  STATE = 's',   /* progress of the running command, as text */
  PLOT = 'p',    /* name of a plot */
  NAME = 'n',    /* name of a vector of the last plot */
  VALUES = 'v',  /* values of the last vector: doubles */
  DONE = 'd'     /* all commands have finished */
};

/* Header of a record. */
typedef struct record {
  uint64_t kind, bytes;
} record;
