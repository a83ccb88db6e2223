/* SPDX-License-Identifier: BSD-3-Clause */
/* Forks, and reads the output of the child until it ends or is too late. */
#include <guard/child.h>

#include <errno.h>
#include <fcntl.h>
#include <guard/guard.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LONGEST_REPORT = 1 << 20 };

/* All that comes before the end or the deadline (g_get_monotonic_time); FALSE
   if that came first. */
static gboolean read_report(int in, gint64 deadline, GString *report) {
  for (;;) {
    gint64 left = (deadline - g_get_monotonic_time()) / 1000;
    struct pollfd wait = {in, POLLIN, 0};
    if (left <= 0 || report->len > LONGEST_REPORT) return FALSE;
    if (poll(&wait, 1, (int)MIN(left, 1000)) <= 0) continue;
    char buffer[4096];
    ssize_t n = read(in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return TRUE;
    g_string_append_len(report, buffer, n);
  }
}

/* In the child: end with the parent, however the parent ends. A limit of
   processor time, which children of the child inherit, ends work that nobody
   waits for. It is a second longer than granted, so that the parent is the one
   to report. */
static void bind_to_parent(pid_t parent, double seconds) {
  enum { SPARE = 1 /* s */ };
  rlim_t most = (rlim_t)(seconds * g_get_num_processors()) + SPARE;
  struct rlimit limit = {most, most};
  setrlimit(RLIMIT_CPU, &limit);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1); /* it ended in between */
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
  gint64 deadline = g_get_monotonic_time() + (gint64)(seconds * 1e6);
  if (pid > 0) {
    gboolean in_time = read_report(ends[0], deadline, report);
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
