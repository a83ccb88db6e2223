/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts a child process and reads the output of the child, until the child
   ends or exceeds the time limit. */
#include <guard/child.h>

#include <errno.h>
#include <fcntl.h>
#include <guard/guard.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LONGEST_REPORT = 1 << 20 };

gint64 child_waited(int pid) {
  unsigned long long ran, waits = 0; /* ns */
  char path[64] = "/proc/self/schedstat";
  if (pid) g_snprintf(path, sizeof path, "/proc/%d/schedstat", pid);
  FILE *f = fopen(path, "r");
  if (!f) return 0;
  if (fscanf(f, "%llu %llu", &ran, &waits) != 2) waits = 0;
  fclose(f);
  return (gint64)(waits / 1000);
}

/* Times of a child, us: `granted`, the longest time without output; `seen`,
   when the last output was read; `waited`, the waiting time for a processor up
   to `seen`. */
typedef struct sign_of_life {
  int pid;
  gint64 granted, seen, waited;
} sign_of_life;

static void child_seen(sign_of_life *s) {
  s->seen = g_get_monotonic_time();
  s->waited = child_waited(s->pid);
}

/* Return the remaining time, us. */
static gint64 child_time(const sign_of_life *s) {
  gint64 left = s->granted - (g_get_monotonic_time() - s->seen);
  if (left > 0) return left;
  return left + MIN(child_waited(s->pid) - s->waited, 2 * s->granted);
}

/* Read the output of the child. Return FALSE if the time is exceeded. */
static gboolean read_report(int in, sign_of_life *child, GString *report) {
  child_seen(child);
  for (;;) {
    gint64 left = child_time(child) / 1000;
    struct pollfd wait = {in, POLLIN, 0};
    if (left <= 0 || report->len > LONGEST_REPORT) return FALSE;
    if (poll(&wait, 1, (int)MIN(left, 1000)) <= 0) continue;
    char buffer[4096];
    ssize_t n = read(in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return TRUE;
    g_string_append_len(report, buffer, n);
    child_seen(child);
  }
}

/* End this child when the parent ends for any reason. Processes started by the
   child inherit only the limit of processor time, so that a forgotten process
   ends. The limit exceeds the granted time, even for work with several outputs,
   so that the parent reports first. */
static void bind_to_parent(pid_t parent, double seconds) {
  enum { SPARE = 1 /* s */, PARTS = 16 };
  rlim_t most = (rlim_t)(seconds * PARTS * g_get_num_processors()) + SPARE;
  struct rlimit limit = {most, most};
  setrlimit(RLIMIT_CPU, &limit);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1); /* the parent has already ended */
}

void child_kill_all(void) {
  g_autoptr(GDir) threads = g_dir_open("/proc/self/task", 0, NULL);
  for (const char *name; threads && (name = g_dir_read_name(threads));) {
    g_autofree char *path =
        g_strdup_printf("/proc/self/task/%s/children", name);
    g_autofree char *text = NULL;
    if (!g_file_get_contents(path, &text, NULL, NULL)) continue;
    char *at = text;
    for (long pid; (pid = strtol(at, &at, 10)) > 0;) kill((pid_t)pid, SIGKILL);
  }
}

GString *child_run(void (*work)(int out, void *data), void *data,
                   double seconds, int *end) {
  GString *report = g_string_new(NULL);
  int ends[2];
  *end = CHILD_NONE;
  if (pipe2(ends, O_CLOEXEC)) return report;
  fflush(NULL);
  pid_t parent = getpid(), pid = fork();
  if (!pid) {
    bind_to_parent(parent, seconds);
    close(ends[0]);
    guard_remove();
    work(ends[1], data);
    _exit(0);
  }
  close(ends[1]);
  if (pid > 0) {
    sign_of_life child = {.pid = pid, .granted = (gint64)(seconds * 1e6)};
    gboolean in_time = read_report(ends[0], &child, report);
    if (!in_time) kill(pid, SIGKILL);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
    *end = !in_time              ? CHILD_LATE
           : WIFSIGNALED(status) ? WTERMSIG(status)
                                 : CHILD_ENDED;
  }
  close(ends[0]);
  return report;
}
