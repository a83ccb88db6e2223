/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries a plugin in a child process: a crash or an endless loop while it loads
   becomes a reason. */
#include <errno.h>
#include <guard/child.h>
#include <guard/process.h>
#include <string.h>

#include "core/plugin/registry.h"

typedef struct trial {
  opc_registry *registry;
  const opc_candidate *candidate;
} trial;

/* The report: 'E' and the reason, or 'K', kind, version, licence and summary,
   each ended by NUL. */
static void try(int out, void *data) {
  const trial *t = data;
  g_autofree char *reason = NULL;
  const opc_plugin *plugin = opc_plugin_load(t->registry, t->candidate->path,
                                             t->candidate->id, &reason);
  if (!plugin) {
    process_write(out, "E", 1);
    process_write(out, reason, strlen(reason) + 1);
    return;
  }
  const char *texts[] = {"K", plugin->kind, plugin->version, plugin->licence,
                         plugin->summary};
  for (size_t i = 0; i < G_N_ELEMENTS(texts); i++)
    process_write(out, texts[i], strlen(texts[i]) + 1);
}

/* The next NUL-ended text of a report, NULL at its end. */
static char *next_text(const GString *report, size_t *at) {
  if (*at >= report->len) return NULL;
  const char *text = report->str + *at;
  size_t n = strnlen(text, report->len - *at);
  if (n == report->len - *at) return NULL;
  *at += n + 1;
  return g_strdup(text);
}

static void understand(opc_candidate *c, const GString *report) {
  size_t at = 0;
  g_autofree char *head = next_text(report, &at);
  if (head && *head == 'E') {
    c->reason = g_strdup(head + 1);
  } else if (head && *head == 'K') {
    c->kind = next_text(report, &at);
    c->version = next_text(report, &at);
    c->licence = next_text(report, &at);
    c->summary = next_text(report, &at);
  }
  if (!c->reason && !c->summary) c->reason = g_strdup("it ended while loading");
}

void opc_candidate_try(opc_registry *registry, opc_candidate *c,
                       double seconds) {
  trial t = {registry, c};
  int end;
  g_autoptr(GString) report = child_run(try, &t, seconds, &end);
  if (end == CHILD_NONE)
    c->reason = g_strdup(g_strerror(errno));
  else if (end == CHILD_LATE)
    c->reason = g_strdup_printf("did not load within %g s", seconds);
  else if (end != CHILD_ENDED)
    c->reason = g_strdup_printf("crashed while loading (%s)", g_strsignal(end));
  else
    understand(c, report);
}
