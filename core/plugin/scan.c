/* SPDX-License-Identifier: BSD-3-Clause */
/* Trying a plugin in a child process: a crash or an endless loop while it
   loads becomes a reason, not an end of the command. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/plugin/guard.h"
#include "core/plugin/registry.h"

enum { LONGEST_REPORT = 1 << 20 };

/* The child's report: 'E' reason, or 'K' kind, version, licence, summary, each
   ended by NUL. */
static void child(const opc_candidate *candidate, int out) {
  g_autofree char *reason = NULL;
  opc_guard_remove(); /* the parent tells of a crash */
  const opc_plugin *plugin =
      opc_plugin_load(candidate->path, candidate->id, &reason);
  GString *report = g_string_new(NULL);
  if (!plugin) {
    g_string_append_c(report, 'E');
    g_string_append_len(report, reason, (gssize)strlen(reason) + 1);
  } else {
    g_string_append_printf(report, "K%u", plugin->kind);
    const char *texts[] = {"", plugin->version, plugin->licence,
                           plugin->summary};
    for (size_t i = 0; i < G_N_ELEMENTS(texts); i++)
      g_string_append_len(report, texts[i], (gssize)strlen(texts[i]) + 1);
  }
  size_t done = 0;
  while (done < report->len) {
    ssize_t n = write(out, report->str + done, report->len - done);
    if (n < 0 && errno != EINTR) break;
    if (n > 0) done += (size_t)n;
  }
  _exit(0);
}

/* All that comes before the end or the deadline (g_get_monotonic_time). */
static GByteArray *read_report(int in, gint64 deadline, gboolean *late) {
  GByteArray *report = g_byte_array_new();
  *late = FALSE;
  for (;;) {
    gint64 left = (deadline - g_get_monotonic_time()) / 1000;
    struct pollfd wait = {in, POLLIN, 0};
    int ready = left <= 0 ? 0 : poll(&wait, 1, (int)MIN(left, 1000));
    if (ready == 0 && left <= 0) {
      *late = TRUE;
      return report;
    }
    if (ready <= 0) continue;
    guint8 buffer[4096];
    ssize_t n = read(in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 || report->len > LONGEST_REPORT) return report;
    g_byte_array_append(report, buffer, (guint)n);
  }
}

/* The next NUL-ended text of a report, NULL at its end. */
static char *next_text(const GByteArray *report, size_t *at) {
  if (*at >= report->len) return NULL;
  const char *text = (const char *)report->data + *at;
  size_t n = strnlen(text, report->len - *at);
  if (n == report->len - *at) return NULL;
  *at += n + 1;
  return g_strdup(text);
}

static void understand(opc_candidate *c, const GByteArray *report) {
  size_t at = 0;
  g_autofree char *head = next_text(report, &at);
  if (head && *head == 'E') {
    c->reason = g_strdup(head + 1);
  } else if (head && *head == 'K') {
    c->kind = (uint32_t)g_ascii_strtoull(head + 1, NULL, 10);
    c->version = next_text(report, &at);
    c->licence = next_text(report, &at);
    c->summary = next_text(report, &at);
  }
  if (!c->reason && !c->summary) c->reason = g_strdup("it ended while loading");
}

void opc_candidate_try(opc_candidate *c, double seconds) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC)) {
    c->reason = g_strdup(g_strerror(errno));
    return;
  }
  pid_t pid = fork();
  if (!pid) {
    close(ends[0]);
    child(c, ends[1]);
  }
  close(ends[1]);
  if (pid < 0) {
    c->reason = g_strdup(g_strerror(errno));
    close(ends[0]);
    return;
  }
  gboolean late;
  gint64 deadline = g_get_monotonic_time() + (gint64)(seconds * 1e6);
  GByteArray *report = read_report(ends[0], deadline, &late);
  close(ends[0]);
  if (late) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
    ;
  if (late)
    c->reason = g_strdup_printf("did not load within %g s", seconds);
  else if (WIFSIGNALED(status))
    c->reason = g_strdup_printf("crashed while loading (%s)",
                                g_strsignal(WTERMSIG(status)));
  else
    understand(c, report);
  g_byte_array_unref(report);
}
