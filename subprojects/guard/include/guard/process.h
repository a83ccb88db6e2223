/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the process that plugins must not change: working folder, standard
   streams, locale, umask, signal handlers and the alarm timer; for each thread,
   floating-point control, locale and signal mask. [any], [main]:
   opcflow/plugin.h. */
#pragma once

#include <stddef.h>

/* A signal whose handler plugins must not change. `means` is the message of a
   crash by this signal; NULL if the signal is not a crash. The list ends with
   the number 0. */
typedef struct process_signal {
  int number;
  const char *name, *means;
} process_signal;
extern const process_signal process_signals[];

/* Record the present state. Call again after the command itself changes the
   state. [main] */
void process_settle(void);

/* Return a change of this thread's state, except the signal mask, as a
   predicate: "changed the locale"; NULL if nothing has changed. Makes no system
   call. [any] */
const char *process_thread_change(void);

/* Return whether this thread's signal mask differs from the recorded one.
   [any] */
int process_signals_change(void);

/* Return the first change of the process as a predicate; NULL if nothing has
   changed. *detail receives the end of the sentence, or "". [any] */
const char *process_change(const char **detail);

/* Record that this thread calls (1) or has called (-1) system(), which ignores
   SIGINT during the call. The check of handlers accepts this change. [any] */
void process_ignores_interrupt(int more);

/* Return a file descriptor of the recorded working folder, for renameat(). */
int process_folder(void);

/* Write n bytes to a file descriptor. Safe in a signal handler. */
void process_write(int out, const char *bytes, size_t n);

/* Write a text to the recorded stderr. Safe in a signal
   handler. */
void process_say(const char *text);
