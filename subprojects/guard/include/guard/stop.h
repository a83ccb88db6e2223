/* SPDX-License-Identifier: BSD-3-Clause */
/* Requests of the user to stop the command. */
#pragma once

/* Take the first SIGINT, SIGTERM or SIGHUP as a request to stop. A second
   signal, or 0.5 s, ends the process with the exit code `code`. [main] */
void stop_on_signals(int code);

/* Return whether a stop is requested. [any] ([main]: opcflow/plugin.h) */
int stop_is_asked(void);
