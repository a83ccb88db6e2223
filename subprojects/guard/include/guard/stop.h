/* SPDX-License-Identifier: BSD-3-Clause */
/* Stopping when the user asks for it. */
#pragma once

/* From now on the first SIGINT, SIGTERM or SIGHUP asks to stop. A second one of
   any kind, or half a second, ends the process with that exit code. [main] */
void stop_on_signals(int code);

/* Return whether one came. [any] */
int stop_is_asked(void);
