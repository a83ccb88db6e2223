/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of the process that plugins have to leave as it was: the working
   folder, the standard streams, the locale, the modes of new files and handlers
   of signals. Each thread also has its floating-point control and the signals
   that it blocks. */
#pragma once

#include <stddef.h>

/* A signal that plugins leave alone; `means` is NULL of one that is no crash.
   The list ends with the number 0. */
typedef struct process_signal {
  int number;
  const char *name, *means;
} process_signal;
extern const process_signal process_signals[];

/* Record the state that has to stay. Called again after each change by the
   command itself. [main] */
void process_settle(void);

/* Return the first change of this thread's state, as the predicate of a
   sentence: "changed the locale"; NULL if there is none. Makes no system call.
   [any] */
const char *process_thread_change(void);

/* Return whether this thread blocks other signals than before. [any] */
int process_signals_change(void);

/* Return the first change of the process in the same way. `*detail` is the rest
   of the sentence, or empty. [any] */
const char *process_change(const char **detail);

/* Return a descriptor of the recorded working folder, for renameat(). */
int process_folder(void);

/* Write n bytes to a descriptor. A signal handler may call this. */
void process_write(int out, const char *bytes, size_t n);

/* Write a text to the recorded standard error. A signal handler may call this.
 */
void process_say(const char *text);
