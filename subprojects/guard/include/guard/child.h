/* SPDX-License-Identifier: BSD-3-Clause */
/* Work with a plugin in a process of its own: a crash or an endless loop is a
   result to report, not the end of the command. */
#pragma once

#include <glib.h>

/* How a child ended, if not of itself; else the number of a signal. */
enum { CHILD_ENDED = 0, CHILD_LATE = -1, CHILD_NONE = -2 };

/* Call work(out, data) in a child of this process, where the guard is off. The
   child is killed (CHILD_LATE) when it has written nothing for that many
   seconds; seconds without a free processor do not count, up to twice as many.
   The child ends with this process. Returns the bytes that it wrote to `out`,
   and in *end how it ended. CHILD_NONE: no child
   could be started (errno). */
GString *child_run(void (*work)(int out, void *data), void *data,
                   double seconds, int *end);

/* Return the time for which the first thread of a process (0: this one) wanted
   a processor and had none, us; 0 where the kernel does not report it. */
gint64 child_waited(int pid);
