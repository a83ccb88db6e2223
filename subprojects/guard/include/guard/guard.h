/* SPDX-License-Identifier: BSD-3-Clause */
/* What becomes of a crash, and of a plugin that ends the process or changes
   what all of it shares (process.h): whose it was is said, what was written is
   kept, and the command ends with an exit code; and of a run that does not stop
   when asked. docs/background/architecture.md tells why this is a signal
   handler. */
#ifndef GUARD_GUARD_H
#define GUARD_GUARD_H

/* Around every call of a plugin's function: the id of the plugin that this
   thread is in, NULL for the command's own work. `before = guard_enter(id);
   ...; guard_leave(before)`. Both look at what the plugin that this thread
   was in did to the process, or leave that to the next of them that comes 5 ms
   later, to another plugin. The text outlives the call. */
const char *guard_enter(const char *id);
void guard_leave(const char *before);

/* The same around tasks of a plugin, beside which other threads work for it;
   before all of them, gather. */
void guard_gather(void);
const char *guard_join(const char *id);
void guard_part(const char *before);

/* This thread waits for tasks that others do (1), and works again (0). */
void guard_wait(int waits);

/* This thread was started by that plugin, and is in it as long as it lives. */
void guard_adopt(const char *id);

/* That id, NULL outside of plugins. */
const char *guard_inside(void);

/* Catch what is a crash (process_signals) while a thread is inside a plugin,
   unless another process sent it; elsewhere they do what they always did. Once.
   `wipe` goes out before the message, NULL for nothing. */
void guard_install(const char *wipe);
void guard_remove(void);

/* Exit codes of the command. */
enum { GUARD_CRASH_LOADING = 3, GUARD_CRASH_RUNNING = 4 };

/* What is being done, for the message: "WHERE: crashed in plugin 'ID':
   segmentation fault"; the command then ends with `code`. Copied; NULL for
   "error", with GUARD_CRASH_RUNNING. */
void guard_where(const char *where, int code);

/* The run folder that is being written, which gets the name `failed` or
   FAILED-2, -3 ... if the command crashes, or is removed if it is empty; then
   the file `lock` is removed, and the folder it is in if that is empty. Copied;
   NULL for none. */
void guard_folder(const char *work, const char *failed, const char *lock);

/* End the command now, "WHERE: stopped in plugin 'ID'", with that folder kept
   as after a crash. Where threads are in several plugins, all are named. May be
   called by a signal handler. */
_Noreturn void guard_end(int code);

/* The process is about to end by itself: if it is a plugin that ends it, it is
   blamed, and this does not come back. */
void guard_exit(void);

/* The work is done, with that exit code, and only functions for the end of the
   process are still called, those of plugins among them: whatever they do, the
   code stays. */
void guard_done(int code);

/* The exit code instead of that one. */
int guard_code(int code);

#endif
