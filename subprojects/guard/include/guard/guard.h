/* SPDX-License-Identifier: BSD-3-Clause */
/* The guard of the process reports plugins that crash, end the process or
   change its state (process.h). A message names the plugin, the run folder is
   kept, and the command ends with an exit code. [any], [main]: see
   opcflow/plugin.h. docs/background/architecture.md explains the use of a
   signal handler. */
#pragma once

/* Set the running plugin of this thread around each call: `before =
   guard_enter(id); ...; guard_leave(before)`. `id` outlives the call, and is
   NULL for functions of the command. Both functions check whether the previous
   plugin changed the process, at most every 5 ms for one plugin. [any] */
const char *guard_enter(const char *id);
void guard_leave(const char *before);

/* Attribute tasks to the plugin `id`, which distributes the tasks over threads.
   Call guard_gather once before all tasks. In each thread, call guard_join
   before the first task, and guard_part with the result of guard_join after the
   last task. [any] */
void guard_gather(void);
const char *guard_join(const char *id);
void guard_part(const char *before);

/* Record whether this thread waits for tasks of other threads (1) or works
   (0). */
void guard_wait(int waits);

/* Set the running plugin of a thread that the plugin `id` has started. */
void guard_adopt(const char *id);

/* Return the running plugin of this thread; NULL for the command. */
const char *guard_inside(void);

/* Install handlers for the signals of a crash (process_signals). Call once. A
   signal sent by another process, or before any plugin was called, acts as
   without the guard. After a crash by invalid memory, the message also lists
   the plugins called before. `wipe` (may be NULL) is written before the
   message. guard_remove restores the default actions. [main] */
void guard_install(const char *wipe);
void guard_remove(void);

/* Exit codes of the command. */
enum { GUARD_CRASH_LOADING = 3, GUARD_CRASH_RUNNING = 4 };

/* Receives the findings of the guard in a child of the command. */
typedef struct guard_listener {
  /* Report the rule that the plugin `id` violated, as a predicate: "changed the
     locale". The child ends when the function returns. */
  void (*change)(const char *id, const char *rule);
  /* Report that a call of a plugin has returned, at most once a second. */
  void (*alive)(void);
} guard_listener;

/* In a child of the command (child.h), check for changes of the process after
   each call of a plugin, and report changes to `to`. Call after guard_remove.
   Signals have the same effect as without the guard. [main] */
void guard_listen(const guard_listener *to);

/* Set WHERE in messages, "WHERE: crashed in plugin 'ID': segmentation fault",
   and the exit code of a crash. The text is copied. If `where` is NULL, the
   message begins with "error" and the exit code is GUARD_CRASH_RUNNING.
   [main] */
void guard_where(const char *where, int code);

/* Set `work`, the folder of the present run. After a crash, the folder is
   removed if empty, else renamed to `failed` or FAILED-2, -3 ... The file
   `lock` is then removed with its folder, if empty. The texts are copied. All
   three are NULL if no run is present. [main] */
void guard_folder(const char *work, const char *failed, const char *lock);

/* End the command with the message "WHERE: stopped in plugin 'ID'", and keep
   the run folder as after a crash. The message names the running plugins of all
   threads. Safe in a signal handler. */
_Noreturn void guard_end(int code);

/* Report the plugin of this thread before a change of the thread's alternate
   signal stack: a stack overflow would end the process without a message.
   Threads that plugins start are excepted. [any] */
void guard_stack_check(void);
/* Give a thread that a plugin started the guard's signal stack again, if the
   thread has none. [any] */
void guard_stack_give(void);

/* If this thread runs a plugin, report that the plugin ended the process, and
   end the process; otherwise return. */
void guard_exit(void);

/* Set the final exit code, before exit handlers of plugins may run. If plugins
   left processes running, end these processes and the command, as after a
   crash. [main] */
void guard_done(int code);

/* Return the final exit code; `code` if guard_done was not called. */
int guard_code(int code);
