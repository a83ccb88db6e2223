/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports plugins that crash, end the process or change its shared state
   (process.h). The message names the plugin, the run folder is kept, and the
   command ends with an exit code. docs/background/architecture.md explains the
   use of a signal handler. */
#pragma once

/* Mark the plugin that this thread is in, around each call of a plugin's
   function: `before = guard_enter(id); ...; guard_leave(before)`. NULL is the
   command's own work; `id` outlives the call. Both look for changes of the
   process by the plugin that the thread was in, at most every 5 ms for the same
   plugin. [any] */
const char *guard_enter(const char *id);
void guard_leave(const char *before);

/* Do the same around each task of a plugin, where several threads work for it;
   call guard_gather before all of them. [any] */
void guard_gather(void);
const char *guard_join(const char *id);
void guard_part(const char *before);

/* Mark that this thread waits for tasks of others (1), or works again (0). */
void guard_wait(int waits);

/* Mark this thread, for its whole life, as started by that plugin. */
void guard_adopt(const char *id);

/* Return the plugin that this thread is in, NULL outside of plugins. */
const char *guard_inside(void);

/* Catch the signals of a crash (process_signals), once. Outside of plugins, or
   if another process sent one, they act as without the guard. `wipe`, or NULL,
   is written before the message. guard_remove undoes it. [main] */
void guard_install(const char *wipe);
void guard_remove(void);

/* Exit codes of the command. */
enum { GUARD_CRASH_LOADING = 3, GUARD_CRASH_RUNNING = 4 };

/* Receives the findings of the guard in a child of the command. */
typedef struct guard_listener {
  /* Take the rule that the plugin `id` broke, as a predicate: "changed the
     locale". The child ends when the function returns. */
  void (*change)(const char *id, const char *rule);
  /* Take note that a call of a plugin has returned; at most once a second. */
  void (*alive)(void);
} guard_listener;

/* In a child of the command (child.h), after guard_remove: find changes of the
   process as in the command, but after each call, and pass them to `to`.
   Signals act as without the guard. [main] */
void guard_listen(const guard_listener *to);

/* Set the place for messages, "WHERE: crashed in plugin 'ID': segmentation
   fault", and the exit code of a crash there. The text is copied; NULL stands
   for "error" and GUARD_CRASH_RUNNING. [main] */
void guard_where(const char *where, int code);

/* Set the run folder that is being written. If the command crashes, the folder
   is renamed to `failed` or FAILED-2, -3 ..., or removed if it is empty. Then
   the file `lock` is removed, and its folder if that is empty. The texts are
   copied; NULL: none. [main] */
void guard_folder(const char *work, const char *failed, const char *lock);

/* End the command now, "WHERE: stopped in plugin 'ID'", and keep the folder as
   after a crash. Names all plugins that threads are in. A signal handler may
   call this. */
_Noreturn void guard_end(int code);

/* Report the plugin that ends the process, if one does; returns only if none
   does. */
void guard_exit(void);

/* Fix the exit code: from now on only functions for the end of the process run,
   some of them of plugins. [main] */
void guard_done(int code);

/* Return the fixed exit code, or `code` if there is none yet. */
int guard_code(int code);
