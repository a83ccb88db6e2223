/* SPDX-License-Identifier: BSD-3-Clause */
/* What becomes of a crash: whose it was is said, what was written is kept, and
   the command ends with an exit code; and of a run that does not stop when
   asked. docs/architecture.md tells why this is a
   signal handler. */
#ifndef OPCFLOW_CORE_GUARD_H
#define OPCFLOW_CORE_GUARD_H

/* Around every call of a plugin's function: the id of the plugin that this
   thread is in. `before = opc_guard_enter(id); ...; opc_guard_leave(before)`.
   The text outlives the call. */
const char *opc_guard_enter(const char *id);
void opc_guard_leave(const char *before);

/* That id, NULL outside of plugins. */
const char *opc_guard_inside(void);

/* Catch SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT while a thread is inside a
   plugin; elsewhere they do what they always did. `wipe` goes out before the
   message, NULL for nothing. */
void opc_guard_install(const char *wipe);
void opc_guard_remove(void);

/* Exit codes of the command. */
enum { OPC_CRASH_LOADING = 3, OPC_CRASH_RUNNING = 4 };

/* What is being done, for the message: "WHERE: crashed in plugin 'ID':
   segmentation fault"; the command then ends with `code`. Copied; NULL for
   "error", with OPC_CRASH_RUNNING. */
void opc_guard_where(const char *where, int code);

/* The run folder that is being written, which gets the name `failed` or
   FAILED-2, -3 ... if the command crashes, or is removed if it is empty.
   Copied; NULL for none. */
void opc_guard_folder(const char *work, const char *failed);

/* End the command now, "WHERE: stopped", with that folder kept as after a
   crash. May be called by a signal handler. */
_Noreturn void opc_guard_end(int code);

#endif
