/* SPDX-License-Identifier: BSD-3-Clause */
/* The handler of crashes: it only writes texts that were made before, renames
   the run folder and ends the process. */
#include "core/plugin/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "core/plugin/child.h"

enum { STACK = 32768, MOST_RUNS = 10000 };

/* ---- which plugin ---- */

static _Thread_local const char *inside;

/* A handler needs a stack of its own, as that of the thread may be used up. */
static _Thread_local char stack[STACK];
static _Thread_local int has_stack;

static void give_stack(void) {
  stack_t present;
  has_stack = 1;
  if (sigaltstack(NULL, &present) || !(present.ss_flags & SS_DISABLE)) return;
  const stack_t own = {.ss_sp = stack, .ss_size = sizeof stack};
  sigaltstack(&own, NULL);
}

const char *opc_guard_enter(const char *id) {
  const char *before = inside;
  if (!has_stack) give_stack();
  inside = id;
  return before;
}

void opc_guard_leave(const char *before) { inside = before; }

const char *opc_guard_inside(void) { return inside; }

/* ---- what is said and kept ---- */

/* Written where nothing runs that could crash; a handler only reads them. */
static char where[2 * PATH_MAX], work[PATH_MAX], failed[PATH_MAX];
static char wipe[16];
static int exit_code = OPC_CRASH_RUNNING;

static void copy(char *to, size_t room, const char *from) {
  snprintf(to, room, "%s", from ? from : "");
}

void opc_guard_where(const char *text, int code) {
  copy(where, sizeof where, text);
  exit_code = text ? code : OPC_CRASH_RUNNING;
}

void opc_guard_folder(const char *folder, const char *name) {
  copy(work, sizeof work, folder);
  copy(failed, sizeof failed, name);
}

/* ---- the handler: only what is safe in one ---- */

static const struct {
  int number;
  const char *name;
} signals[] = {
    {SIGSEGV, "segmentation fault"},
    {SIGBUS, "bus error"},
    {SIGFPE, "arithmetic error"},
    {SIGILL, "illegal instruction"},
    {SIGABRT, "aborted"},
};

static void say(const char *text) {
  opc_child_write(STDERR_FILENO, text, strlen(text));
}

/* "-N" in decimal. */
static void put_number(char *to, int n) {
  int digits = 1;
  for (int rest = n; rest >= 10; rest /= 10) digits++;
  *to++ = '-';
  to[digits] = 0;
  for (; digits-- > 0; n /= 10) to[digits] = (char)('0' + n % 10);
}

/* The folder under its new name; 0 if there is nothing to keep. */
static int keep_folder(void) {
  size_t length = strlen(failed);
  if (!*work || length + 8 > sizeof failed || !rmdir(work)) return 0;
  for (int i = 1; i < MOST_RUNS; i++) {
    if (i > 1) put_number(failed + length, i);
    if (!renameat2(AT_FDCWD, work, AT_FDCWD, failed, RENAME_NOREPLACE))
      return 1;
    if (errno != EEXIST) break;
  }
  if (errno == ENOENT) return 0; /* the run has just ended by itself */
  strcpy(failed, work);
  return 1;
}

/* Says where, and the words, which end with NULL. */
_Noreturn static void end(const char *const *words, int code) {
  static int taken;
  /* The first thread speaks; others wait for the end. */
  while (__atomic_exchange_n(&taken, 1, __ATOMIC_SEQ_CST)) pause();
  say(wipe);
  say(*where ? where : "error");
  while (*words) say(*words++);
  if (keep_folder()) {
    say("note: what was written so far is in '");
    say(failed);
    say("'\n");
  }
  _exit(code);
}

void opc_guard_end(int code) {
  static const char *const words[] = {": stopped\n", NULL};
  end(words, code);
}

static void crashed(int number) {
  if (!inside) { /* not a plugin's: as if there were no handler */
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  const char *name = "";
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
    if (signals[i].number == number) name = signals[i].name;
  const char *const words[] = {
      ": crashed in plugin '", inside, "': ", name, "\n", NULL};
  end(words, exit_code);
}

void opc_guard_remove(void) {
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
    signal(signals[i].number, SIG_DFL);
}

void opc_guard_install(const char *text) {
  struct sigaction action = {.sa_handler = crashed, .sa_flags = SA_ONSTACK};
  copy(wipe, sizeof wipe, text);
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
    sigaction(signals[i].number, &action, NULL);
}
