/* SPDX-License-Identifier: BSD-3-Clause */
/* Run a plugin in a child process, so that a crash or an endless loop of the
   plugin does not end the command. */
#pragma once

#include <glib.h>

/* End of a child: ended by itself, time exceeded, not started. Other values are
   the number of a signal. */
enum { CHILD_ENDED = 0, CHILD_LATE = -1, CHILD_NONE = -2 };

/* Call work(out, data) in a child of this process, without the guard. The child
   is killed (CHILD_LATE) after `seconds` without output, or after 1 MB of
   output. Time without a free processor does not count, up to 2 * `seconds`.
   The child ends when this process ends. Return the bytes written to `out`.
   *end receives CHILD_* or the number of a signal; errno has the cause of
   CHILD_NONE. */
GString *child_run(void (*work)(int out, void *data), void *data,
                   double seconds, int *end);

/* Kill all children of this process, if Linux lists the children. */
void child_kill_all(void);

/* Return the time for which the first thread of a process (0: this process) was
   ready but had no processor, us; 0 if Linux does not report the time. */
gint64 child_waited(int pid);
