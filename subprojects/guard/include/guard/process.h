/* SPDX-License-Identifier: BSD-3-Clause */
/* What all of the process shares, and plugins have to leave as it was: the
   working folder, the standard streams, the locale, the modes of new files,
   handlers of signals; and of each thread its floating-point control and the
   signals that it blocks. */
#ifndef GUARD_PROCESS_H
#define GUARD_PROCESS_H

#include <stddef.h>

/* A signal that plugins leave alone; `means` is NULL of one that is no crash.
   The list ends with the number 0. */
typedef struct process_signal {
  int number;
  const char *name, *means;
} process_signal;
extern const process_signal process_signals[];

/* As it is now, it has to stay: again after each change of the command's own.
   [main] */
void process_settle(void);

/* What of this thread is not as it was, after the name of who did it: "changed
   the locale"; NULL if all is. Takes no system call. [any] */
const char *process_thread_change(void);

/* Whether this thread takes other signals than it did. [any] */
int process_signals_change(void);

/* What of the process is not as it was. `*detail` is more of that text, or
   empty. [any] */
const char *process_change(const char **detail);

/* The working folder as it was, whatever became of it: for renameat(). */
int process_folder(void);

/* Write n bytes to a descriptor. May be called by a signal handler. */
void process_write(int out, const char *bytes, size_t n);

/* Write to standard error as it was, whatever became of it. */
void process_say(const char *text);

#endif
