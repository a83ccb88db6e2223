/* SPDX-License-Identifier: BSD-3-Clause */
/* What plugins do to the process. A handler of crashes only writes texts that
   were made before, renames the run folder and ends the process. */
#include "core/plugin/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "core/plugin/process.h"

enum { STACK = 32768, MOST_RUNS = 10000 };

static pid_t guarded; /* the process that is; 0: none */
static int forked;    /* this one is a copy of it */

/* ---- what is said and kept ---- */

/* Written where nothing runs that could crash; a handler only reads them. */
static char where[2 * PATH_MAX], work[PATH_MAX], failed[PATH_MAX];
static char lock[PATH_MAX], slot[PATH_MAX];
static char wipe[16];
static int exit_code = OPC_CRASH_RUNNING;

static void copy(char *to, size_t room, const char *from) {
  snprintf(to, room, "%s", from ? from : "");
}

void opc_guard_where(const char *text, int code) {
  copy(where, sizeof where, text);
  exit_code = text ? code : OPC_CRASH_RUNNING;
}

void opc_guard_folder(const char *folder, const char *name, const char *file) {
  copy(work, sizeof work, folder);
  copy(failed, sizeof failed, name);
  copy(lock, sizeof lock, file);
  copy(slot, sizeof slot, file);
  char *end = strrchr(slot, '/');
  if (end) *end = 0;
}

/* ---- the end: only what is safe in a handler ---- */

/* "-N" in decimal. */
static void put_number(char *to, int n) {
  int digits = 1;
  for (int rest = n; rest >= 10; rest /= 10) digits++;
  *to++ = '-';
  to[digits] = 0;
  for (; digits-- > 0; n /= 10) to[digits] = (char)('0' + n % 10);
}

/* Not onto something, but for the empty folder that is made where names cannot
   be kept from being taken. */
static int rename_folder(int here) {
  if (!renameat2(here, work, here, failed, RENAME_NOREPLACE)) return 1;
  if (errno != EINVAL && errno != ENOSYS) return 0;
  return !mkdirat(here, failed, 0777) && !renameat(here, work, here, failed);
}

/* The folder under its new name; 0 if there is nothing to keep. */
static int keep_folder(void) {
  int here = opc_process_folder();
  size_t length = strlen(failed);
  if (!*work || length + 8 > sizeof failed ||
      !unlinkat(here, work, AT_REMOVEDIR))
    return 0;
  for (int i = 1; i < MOST_RUNS; i++) {
    if (i > 1) put_number(failed + length, i);
    if (rename_folder(here)) return 1;
    if (errno != EEXIST) break;
  }
  if (errno == ENOENT) return 0; /* the run has just ended by itself */
  strcpy(failed, work);
  return 1;
}

/* Nothing hidden stays. */
static void remove_slot(void) {
  int here = opc_process_folder();
  if (!*slot) return;
  unlinkat(here, lock, 0);
  unlinkat(here, slot, AT_REMOVEDIR);
}

/* Says where, and the words, which end with NULL. */
_Noreturn static void end(const char *const *words, int code) {
  static int taken;
  /* The first thread speaks; others wait for the end. */
  while (__atomic_exchange_n(&taken, 1, __ATOMIC_SEQ_CST)) pause();
  opc_process_say(wipe);
  opc_process_say(*where ? where : "error");
  while (*words) opc_process_say(*words++);
  /* A copy that a plugin made of the process keeps nothing. */
  if (getpid() == guarded && keep_folder()) {
    opc_process_say("note: what was written so far is in '");
    opc_process_say(failed);
    opc_process_say("'\n");
  }
  if (getpid() == guarded) remove_slot();
  for (;;) syscall(SYS_exit_group, code); /* _exit() is a plugin's, below */
}

_Noreturn static void blame(const char *id, const char *what,
                            const char *detail) {
  const char *const words[] = {": plugin '", id,   "' ", what,
                               detail,       "\n", NULL};
  end(words, exit_code);
}

/* ---- which plugin ---- */

static _Thread_local const char *inside;
static _Thread_local int calls; /* enter without its leave */
static const char **inside_main = &(const char *){NULL};
static pthread_key_t ending;

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

/* A thread that ends in the middle of a call, which nobody would notice: others
   wait for it, or the command ends well. */
static void thread_ended(void *unused) {
  (void)unused;
  if (guarded && calls > 0) blame(inside, "ended its thread", "");
}

static void begin_thread(void) {
  if (has_stack) return;
  give_stack();
  if (guarded) pthread_setspecific(ending, "known");
}

/* ---- what it did ---- */

/* Between two looks at the same plugin, s: one takes 4 us, where system calls
   are slow 25, and extractors are called for each transistor. */
static const double pause_of_looks = 5e-3;

/* Tasks of a plugin, beside which others may do harm: it is looked at by itself
   when they are done. */
static _Thread_local int in_batch;

/* The plugin that was in this thread after the last look; and when that was. */
static _Thread_local const char *suspect;
static _Thread_local double looked;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* What costs nothing, after each call. */
static void glance(void) {
  const char *what = opc_process_thread_change();
  if (forked) blame(inside, "forked and went on", "");
  if (what) blame(inside, what, "");
}

/* Whatever is not as it was, that plugin did. */
static void look(const char *id) {
  const char *detail;
  const char *what = opc_process_change(&detail);
  if (what) blame(id, what, detail);
  suspect = NULL;
  looked = now();
}

const char *opc_guard_enter(const char *id) {
  const char *before = inside;
  const char *who = suspect || in_batch ? suspect : inside;
  begin_thread();
  if (guarded && inside) glance();
  /* Before another one can be taken for it. */
  if (guarded && id && who && id != who) look(who);
  calls++;
  inside = id;
  return before;
}

void opc_guard_leave(const char *before) {
  int last = !before && &inside == inside_main;
  if (guarded && inside) glance();
  if (guarded && inside && !suspect) suspect = inside;
  if (guarded && suspect && (last || now() - looked > pause_of_looks))
    look(suspect);
  calls--;
  inside = before;
}

void opc_guard_gather(void) {
  if (guarded && suspect) look(suspect);
}

const char *opc_guard_join(const char *id) {
  const char *before = inside;
  begin_thread();
  calls++;
  in_batch++;
  inside = id;
  return before;
}

void opc_guard_part(const char *before) {
  if (guarded && inside) glance();
  opc_guard_gather();
  in_batch--;
  calls--;
  inside = before;
}

void opc_guard_adopt(const char *id) {
  begin_thread();
  inside = id;
}

const char *opc_guard_inside(void) { return inside; }

/* ---- what ends it ---- */

void opc_guard_end(int code) {
  const char *id = *inside_main;
  const char *const words[] = {id ? ": stopped in plugin '" : ": stopped",
                               id ? id : "", id ? "'\n" : "\n", NULL};
  end(words, code);
}

void opc_guard_exit(void) {
  if (inside && getpid() == guarded) blame(inside, "ended the process", "");
}

/* Sent by another process, which no plugin can help. */
static int is_foreign(const siginfo_t *info) {
  int sent = info->si_code == SI_USER || info->si_code == SI_QUEUE ||
             info->si_code == SI_TKILL;
  return sent && info->si_pid != getpid();
}

static void crashed(int number, siginfo_t *info, void *unused) {
  (void)unused;
  const opc_signal *s = opc_signals;
  while (s->number != number) s++;
  if (!inside || is_foreign(info)) { /* as if there were no handler */
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  const char *const words[] = {
      ": crashed in plugin '", inside, "': ", s->means, "\n", NULL};
  end(words, exit_code);
}

static void has_forked(void) { forked = 1; }

void opc_guard_remove(void) {
  guarded = 0;
  for (const opc_signal *s = opc_signals; s->number; s++)
    if (s->means) signal(s->number, SIG_DFL);
}

void opc_guard_install(const char *text) {
  struct sigaction action = {.sa_sigaction = crashed,
                             .sa_flags = SA_ONSTACK | SA_SIGINFO};
  copy(wipe, sizeof wipe, text);
  for (const opc_signal *s = opc_signals; s->number; s++)
    if (s->means) sigaction(s->number, &action, NULL);
  opc_process_settle();
  pthread_key_create(&ending, thread_ended);
  pthread_atfork(NULL, NULL, has_forked);
  atexit(opc_guard_exit);
  at_quick_exit(opc_guard_exit);
  inside_main = &inside;
  guarded = getpid();
}
