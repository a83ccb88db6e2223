/* SPDX-License-Identifier: BSD-3-Clause */
/* Work with a plugin in a process of its own: a crash or an endless loop in it
   becomes something to tell, not an end of the command. */
#ifndef GUARD_CHILD_H
#define GUARD_CHILD_H

#include <glib.h>

/* How a child ended, if not of itself; else the number of a signal. */
enum { CHILD_ENDED = 0, CHILD_LATE = -1, CHILD_NONE = -2 };

/* Call work(out, data) in a child of this process, in which the guard is off,
   and grant it that many seconds. It ends with this process. What it wrote to
   `out`; how it ended is put into *end. CHILD_NONE: there could be none
   (errno). */
GString *child_run(void (*work)(int out, void *data), void *data,
                   double seconds, int *end);

#endif
