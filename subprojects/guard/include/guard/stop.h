/* SPDX-License-Identifier: BSD-3-Clause */
/* Requests of the user to stop the command. */
#pragma once

/* Take the first SIGINT, SIGTERM or SIGHUP as a request to stop (SIGHUP only if
   the process does not ignore SIGHUP). A second signal, or the end of 0.5 s,
   ends the process by guard_end(code). [main] */
void stop_on_signals(int code);

/* Time limits of nested calls of plugins. A call that exceeds its limit ends
   the process as guard_end does, with the exit code GUARD_CRASH_RUNNING and
   `where` in the message. Limits act after stop_on_signals. The struct belongs
   to the caller until stop_limit_end. [main] */
typedef struct stop_limit stop_limit;
struct stop_limit {
  double end; /* time of the monotonic clock, s */
  char where[1024];
  stop_limit *outer;
};
/* Begin and end the time limit of a call of `seconds`. */
void stop_limit_begin(stop_limit *limit, double seconds, const char *where);
void stop_limit_end(const stop_limit *limit);

/* Return whether a stop is requested. [any] ([main]: opcflow/plugin.h) */
int stop_is_asked(void);
