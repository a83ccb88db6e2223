/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds plugins that crash, end or change the process. The signal handler only
   writes prepared texts, renames the run folder and ends the process. */
#include <guard/guard.h>

#include <errno.h>
#include <fcntl.h>
#include <guard/child.h>
#include <guard/process.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { STACK = 32768, MOST_RUNS = 10000 };

static pid_t guarded; /* guarded process; 0 if none */
static int forked;    /* 1 if this process is a fork of the guarded one */

/* ---- the message and the folder ---- */

/* Texts for the signal handler, set while no plugin runs. */
static char where[2 * PATH_MAX], work[PATH_MAX], failed[PATH_MAX];
static char lock[PATH_MAX], slot[PATH_MAX];
static char wipe[16];
static int exit_code = GUARD_CRASH_RUNNING;

static void text_copy(char *to, size_t capacity, const char *from) {
  snprintf(to, capacity, "%s", from ? from : "");
}

void guard_where(const char *text, int code) {
  text_copy(where, sizeof where, text);
  exit_code = text ? code : GUARD_CRASH_RUNNING;
}

void guard_folder(const char *folder, const char *name, const char *file) {
  text_copy(work, sizeof work, folder);
  text_copy(failed, sizeof failed, name);
  text_copy(lock, sizeof lock, file);
  text_copy(slot, sizeof slot, file);
  char *end = strrchr(slot, '/');
  if (end) *end = 0;
}

/* ---- end of the process: functions that are safe in a signal handler ---- */

/* Write "-N" to `to`, with the decimal number n. */
static void put_number(char *to, int n) {
  int digits = 1;
  for (int rest = n; rest >= 10; rest /= 10) digits++;
  *to++ = '-';
  to[digits] = 0;
  for (; digits-- > 0; n /= 10) to[digits] = (char)('0' + n % 10);
}

/* Rename `work` to `failed` unless `failed` exists. If the file system does not
   support RENAME_NOREPLACE, reserve the name by an empty folder. */
static int rename_folder(int here) {
  if (!renameat2(here, work, here, failed, RENAME_NOREPLACE)) return 1;
  if (errno != EINVAL && errno != ENOSYS) return 0;
  return !mkdirat(here, failed, 0777) && !renameat(here, work, here, failed);
}

/* Rename the run folder and set `failed` to the new name. Return 0 if there is
   no folder to keep. */
static int keep_folder(void) {
  int here = process_folder();
  size_t length = strlen(failed);
  if (!*work || length + 8 > sizeof failed ||
      !unlinkat(here, work, AT_REMOVEDIR))
    return 0;
  for (int i = 1; i < MOST_RUNS; i++) {
    if (i > 1) put_number(failed + length, i);
    if (rename_folder(here)) return 1;
    if (errno != EEXIST) break;
  }
  if (errno == ENOENT) return 0; /* the run has just ended normally */
  strcpy(failed, work);
  return 1;
}

/* Remove the hidden folder in which the run was written, and its lock. */
static void remove_slot(void) {
  int here = process_folder();
  if (!*slot) return;
  unlinkat(here, lock, 0);
  unlinkat(here, slot, AT_REMOVEDIR);
}

/* The message of the guard, written by a single call, because other processes
   write to the same stream. */
static char message[4 * PATH_MAX];

static void add_text(const char *text) {
  size_t n = strlen(message), more = strlen(text),
         capacity = sizeof message - 1 - n;
  memcpy(message + n, text, more < capacity ? more : capacity);
}

/* Write `where` and the words (until NULL), keep the run folder, and exit. */
_Noreturn static void process_end(const char *const *words, int code) {
  static int taken;
  /* Only the first thread writes; other threads pause until the process
     ends. */
  while (__atomic_exchange_n(&taken, 1, __ATOMIC_SEQ_CST)) pause();
  add_text(wipe);
  add_text(*where ? where : "error");
  while (*words) add_text(*words++);
  process_say(message);
  /* A process forked by a plugin keeps no folder. */
  if (getpid() == guarded && keep_folder()) {
    process_say("note: files written so far are in '");
    process_say(failed);
    process_say("'\n");
  }
  if (getpid() == guarded) remove_slot();
  for (;;) syscall(SYS_exit_group, code); /* bypasses interpose.c */
}

/* Receiver of reports in a child after guard_listen; else NULL. */
static const guard_listener *listener;

_Noreturn static void listener_tell(const char *id, const char *what,
                                    const char *detail) {
  static int taken;
  while (__atomic_exchange_n(&taken, 1, __ATOMIC_SEQ_CST)) pause();
  add_text(what);
  add_text(detail);
  listener->change(id, message);
  for (;;) syscall(SYS_exit_group, 0);
}

_Noreturn static void plugin_blame(const char *id, const char *what,
                                   const char *detail) {
  if (listener) listener_tell(id, what, detail);
  const char *const words[] = {": plugin '", id,   "' ", what,
                               detail,       "\n", NULL};
  process_end(words, exit_code);
}

/* ---- present plugins ---- */

/* The first MOST_CALLED plugins, in the order of their first calls. Any of them
   may have damaged the memory of a plugin that crashes. `id` is the pointer
   passed to guard_enter, which may be freed after the call; `id` is NULL until
   `name`, a copy of at most LONGEST_NAME - 1 bytes, is complete. */
enum { MOST_CALLED = 64, LONGEST_NAME = 80 };
static struct called {
  const char *id;
  char name[LONGEST_NAME];
} called[MOST_CALLED];
static int n_called;

static int called_is(const struct called *c, const char *id) {
  return __atomic_load_n(&c->id, __ATOMIC_ACQUIRE) == id &&
         !strncmp(c->name, id, LONGEST_NAME - 1);
}

static void called_add(const char *id) {
  int n = __atomic_load_n(&n_called, __ATOMIC_ACQUIRE), i = 0;
  while (i < n && i < MOST_CALLED && !called_is(&called[i], id)) i++;
  if (i < n || i == MOST_CALLED) return;
  i = __atomic_fetch_add(&n_called, 1, __ATOMIC_ACQ_REL);
  if (i >= MOST_CALLED) return;
  text_copy(called[i].name, LONGEST_NAME, id);
  __atomic_store_n(&called[i].id, id, __ATOMIC_RELEASE);
}

/* State of a thread; other threads read the state. */
typedef struct worker {
  const char *inside;  /* plugin that runs in the thread; NULL for the
                          command */
  const char *suspect; /* plugin that ran since the last check; NULL if none */
  int waits;           /* 1 if the thread waits for tasks of other threads */
  struct worker *next;
} worker;

static _Thread_local worker me;
static _Thread_local int calls; /* calls of guard_enter without guard_leave */
static worker *main_worker = &(worker){NULL, NULL, 0, NULL}, *workers;
static pthread_mutex_t workers_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_key_t ending;

static void field_set(const char **field, const char *id) {
  __atomic_store_n(field, id, __ATOMIC_RELAXED);
}

/* Add a plugin to a list of distinct names, "'A', 'B'", of n names. Return the
   new number. */
static int add_name(char *list, size_t capacity, int n, const char *id) {
  char name[256];
  size_t length = strlen(list);
  if (!id) return n;
  snprintf(name, sizeof name, "'%s'", id);
  if (strstr(list, name)) return n;
  snprintf(list + length, capacity - length, "%s%s", n ? ", " : "", name);
  return n + 1;
}

/* Add the plugins that run in other threads, except in threads that wait. If
   `suspects` is 1, also add the plugins that ran since the last check. */
static int add_others(char *list, size_t capacity, int n, int suspects) {
  for (worker *w = workers; w; w = w->next) {
    if (w == &me) continue;
    if (!__atomic_load_n(&w->waits, __ATOMIC_RELAXED))
      n = add_name(list, capacity, n,
                   __atomic_load_n(&w->inside, __ATOMIC_RELAXED));
    if (suspects)
      n = add_name(list, capacity, n,
                   __atomic_load_n(&w->suspect, __ATOMIC_RELAXED));
  }
  return n;
}

/* Report a change of the process that the plugin `id` or a plugin in another
   thread has made. */
static void blame_all(const char *id, const char *what, const char *detail) {
  char list[1024] = "";
  if (listener) listener_tell(id, what, detail);
  int n = add_name(list, sizeof list, 0, id);
  pthread_mutex_lock(&workers_lock);
  n = add_others(list, sizeof list, n, 1);
  const char *const words[] = {n > 1 ? ": one of the plugins " : ": plugin ",
                               list,
                               " ",
                               what,
                               detail,
                               "\n",
                               NULL};
  process_end(words, exit_code);
}

/* Stack of the signal handler, because the stack of the thread may have
   overflowed. */
static _Thread_local char stack[STACK];
static _Thread_local int has_stack;

/* 1 if the plugin in `me.inside` started this thread. */
static _Thread_local int adopted;

static void give_stack(void) {
  stack_t present;
  has_stack = 1;
  if (sigaltstack(NULL, &present) || !(present.ss_flags & SS_DISABLE)) return;
  const stack_t own = {.ss_sp = stack, .ss_size = sizeof stack};
  sigaltstack(&own, NULL);
}

/* Report a thread that ends inside a plugin. Otherwise other threads would wait
   for the thread, or the command would end with success. */
static void thread_ended(void *unused) {
  (void)unused;
  if (guarded && calls > 0) plugin_blame(me.inside, "ended the thread", "");
  pthread_mutex_lock(&workers_lock);
  worker **at = &workers;
  while (*at && *at != &me) at = &(*at)->next;
  if (*at) *at = me.next;
  pthread_mutex_unlock(&workers_lock);
}

static void begin_thread(void) {
  if (has_stack) return;
  give_stack();
  if (!guarded) return;
  pthread_setspecific(ending, "known");
  pthread_mutex_lock(&workers_lock);
  me.next = workers;
  workers = &me;
  pthread_mutex_unlock(&workers_lock);
}

/* ---- changes of the process ---- */

/* Time between two checks of a plugin, s. A check takes 4 us, or 25 us if
   system calls are slow; some plugins are called 1000 times a second. */
static const double pause_of_looks = 5e-3;

/* Number of open guard_join calls. During tasks, another plugin may have made a
   change; the check is therefore done after the tasks. */
static _Thread_local int in_batch;

static _Thread_local double looked; /* time of the last check, s */

static double time_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Check the state of this thread. Called after each call of a plugin; makes no
   system call. */
static void guard_check_thread(void) {
  const char *what = process_thread_change();
  if (forked) plugin_blame(me.inside, "forked and continued", "");
  if (what) plugin_blame(me.inside, what, "");
}

/* ---- processes of plugins ---- */

static int had_child;    /* children existed at the start, because a shell
                            executed this program */
static char parent[256]; /* plugin after whose call a child existed, or "" */

/* Return whether this process has children. info->si_pid receives the id of an
   ended child, or 0. The ended child is removed, unless `keep` is WNOWAIT. */
static int has_child(siginfo_t *info, int keep) {
  *info = (siginfo_t){0};
  return !waitid(P_ALL, 0, info, WEXITED | WNOHANG | keep);
}

/* Record the plugin after whose call a child exists. Programs that a plugin
   uses only during a call have ended when the call returns. */
static void parent_note(const char *id) {
  siginfo_t info;
  if (listener || had_child) return;
  if (!has_child(&info, WNOWAIT))
    *parent = 0;
  else if (!*parent)
    text_copy(parent, sizeof parent, id);
}

/* End the processes that plugins left running, and report the plugin. */
static void children_end(void) {
  siginfo_t info;
  int has;
  while ((has = has_child(&info, 0)) && info.si_pid) continue;
  if (!has || !*parent) return;
  child_kill_all();
  plugin_blame(parent, "left a process running", "");
}

static void listener_wake(void) {
  static _Thread_local double last;
  if (looked - last < 1) return;
  last = looked;
  listener->alive();
}

/* Report a change of the process by the plugin `id` or by another thread. */
static void guard_check_process(const char *id) {
  const char *detail;
  if (process_signals_change()) plugin_blame(id, "changed the signal mask", "");
  const char *what = process_change(&detail);
  if (what) blame_all(id, what, detail);
  parent_note(id);
  field_set(&me.suspect, NULL);
  looked = time_now();
  if (listener) listener_wake();
}

const char *guard_enter(const char *id) {
  const char *before = me.inside;
  const char *who = me.suspect || in_batch ? me.suspect : before;
  begin_thread();
  if (guarded && before) guard_check_thread();
  /* Check first, so that the change is not attributed to the next plugin. */
  if (guarded && id && who && id != who) guard_check_process(who);
  calls++;
  if (id) called_add(id);
  field_set(&me.inside, id);
  return before;
}

void guard_leave(const char *before) {
  int last = listener || (!before && &me == main_worker);
  if (guarded && me.inside) guard_check_thread();
  if (guarded && me.inside && !me.suspect) field_set(&me.suspect, me.inside);
  if (guarded && me.suspect && (last || time_now() - looked > pause_of_looks))
    guard_check_process(me.suspect);
  calls--;
  field_set(&me.inside, before);
}

void guard_gather(void) {
  if (guarded && me.suspect) guard_check_process(me.suspect);
}

const char *guard_join(const char *id) {
  const char *before = me.inside;
  begin_thread();
  calls++;
  in_batch++;
  field_set(&me.inside, id);
  return before;
}

void guard_part(const char *before) {
  if (guarded && me.inside) guard_check_thread();
  guard_gather();
  in_batch--;
  calls--;
  field_set(&me.inside, before);
}

void guard_wait(int waits) {
  __atomic_store_n(&me.waits, waits, __ATOMIC_RELAXED);
}

void guard_adopt(const char *id) {
  begin_thread();
  adopted = 1;
  field_set(&me.inside, id);
}

const char *guard_inside(void) { return me.inside; }

/* ---- reasons to end ---- */

/* A signal handler cannot wait for the lock. If another thread holds the lock,
   the message names only the plugins of this thread and of the first thread. */
void guard_end(int code) {
  char list[1024] = "";
  int alone = pthread_mutex_trylock(&workers_lock);
  int n = add_name(list, sizeof list, 0, me.inside);
  if (alone)
    n = add_name(list, sizeof list, n, main_worker->inside);
  else
    n = add_others(list, sizeof list, n, 0);
  const char *const words[] = {n > 1   ? ": stopped in one of the plugins "
                               : n > 0 ? ": stopped in plugin "
                                       : ": stopped",
                               list, "\n", NULL};
  process_end(words, code);
}

void guard_stack_check(void) {
  if (me.inside && !adopted && getpid() == guarded)
    plugin_blame(me.inside, "changed the alternate signal stack", "");
}

void guard_stack_give(void) {
  if (adopted) give_stack();
}

void guard_exit(void) {
  if (me.inside && getpid() == guarded)
    plugin_blame(me.inside, "ended the process", "");
}

static int done = -1; /* exit code */

void guard_done(int code) {
  if (guarded) children_end();
  done = code;
}

int guard_code(int code) { return done < 0 ? code : done; }

/* Return whether another process sent the signal, so that no plugin is at
   fault. */
static int is_foreign(const siginfo_t *info) {
  int sent = info->si_code == SI_USER || info->si_code == SI_QUEUE ||
             info->si_code == SI_TKILL;
  return sent && info->si_pid != getpid();
}

/* Set `list` to the plugins that may have damaged the memory: the plugins
   called before, except `id`. Return their number. */
static int add_called(char *list, size_t capacity, const char *id) {
  int n = 0, all = n_called < MOST_CALLED ? n_called : MOST_CALLED;
  for (int i = 0; i < all; i++)
    if (__atomic_load_n(&called[i].id, __ATOMIC_ACQUIRE) &&
        (!id || strcmp(called[i].name, id) != 0))
      n = add_name(list, capacity, n, called[i].name);
  return n;
}

static int is_memory_fault(int number) {
  return number == SIGSEGV || number == SIGBUS || number == SIGABRT;
}

static void guard_crash(int number, siginfo_t *info, void *unused) {
  char list[MOST_CALLED * (LONGEST_NAME + 4)] =
      ""; /* local, because several threads may crash at once */
  (void)unused;
  const process_signal *s = process_signals;
  while (s->number != number) s++;
  const char *const late[] = {": crashed while the command ended: ", s->means,
                              "\n", NULL};
  if (!me.inside && done >= 0 && !is_foreign(info))
    process_end(late, exit_code);
  int n =
      is_memory_fault(number) ? add_called(list, sizeof list, me.inside) : 0;
  if ((!me.inside && !n) || is_foreign(info)) { /* default action */
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  const char *const words[] = {
      me.inside ? ": crashed in plugin '" : ": crashed outside of plugins",
      me.inside ? me.inside : "",
      me.inside ? "': " : ": ",
      s->means,
      n ? "\nnote: plugins called before may have damaged the memory: " : "",
      list,
      n ? "; OPCFLOW_GUARD=pages detects more of such writes\n" : "\n",
      NULL};
  process_end(words, exit_code);
}

static void has_forked(void) { forked = 1; }

void guard_remove(void) {
  guarded = 0;
  for (const process_signal *s = process_signals; s->number; s++)
    if (s->means) signal(s->number, SIG_DFL);
}

void guard_listen(const guard_listener *to) {
  listener = to;
  process_settle();
  workers = NULL; /* the list has threads of the parent */
  me = (worker){NULL, NULL, 0, NULL};
  main_worker = &me;
  calls = forked = has_stack = 0;
  guarded = getpid();
}

void guard_install(const char *text) {
  struct sigaction action = {.sa_sigaction = guard_crash,
                             .sa_flags = SA_ONSTACK | SA_SIGINFO};
  text_copy(wipe, sizeof wipe, text);
  for (const process_signal *s = process_signals; s->number; s++)
    if (s->means) sigaction(s->number, &action, NULL);
  process_settle();
  pthread_key_create(&ending, thread_ended);
  pthread_atfork(NULL, NULL, has_forked);
  siginfo_t info;
  had_child = has_child(&info, WNOWAIT);
  /* Orphans of a child that a plugin starts become children, too. */
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  atexit(guard_exit);
  at_quick_exit(guard_exit);
  main_worker = &me;
  guarded = getpid();
}
