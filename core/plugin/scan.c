/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads a plugin in a child process. A plugin that crashes or exceeds the time
   limit during loading is reported as not usable, with the reason. */
#include <errno.h>
#include <guard/child.h>
#include <guard/process.h>
#include <string.h>

#include "core/plugin/registry.h"

typedef struct trial {
  opc_registry *registry;
  const opc_candidate *candidate;
} trial;

/* Write the report: 'E' and the reason, or 'K', kind, version, licence and
   summary, each terminated by NUL. */
static void candidate_try(int out, void *data) {
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

/* Return the NUL-terminated texts of a report. */
static GPtrArray *report_texts(const GString *report) {
  GPtrArray *texts = g_ptr_array_new();
  char *at = report->str, *last = at + report->len;
  for (char *end; (end = memchr(at, 0, (size_t)(last - at))); at = end + 1)
    g_ptr_array_add(texts, at);
  return texts;
}

static void candidate_read_report(opc_candidate *c, const GString *report) {
  g_autoptr(GPtrArray) texts = report_texts(report);
  const char *first = texts->len ? texts->pdata[0] : "";
  if (texts->len != 5) {
    c->reason =
        g_strdup(*first == 'E' ? first + 1 : "the process ended while loading");
    return;
  }
  c->kind = g_strdup(texts->pdata[1]);
  c->version = g_strdup(texts->pdata[2]);
  c->licence = g_strdup(texts->pdata[3]);
  c->summary = g_strdup(texts->pdata[4]);
}

void opc_candidate_try(opc_registry *registry, opc_candidate *c,
                       double seconds) {
  trial t = {registry, c};
  int end;
  g_autoptr(GString) report = child_run(candidate_try, &t, seconds, &end);
  if (end == CHILD_NONE)
    c->reason = g_strdup(g_strerror(errno));
  else if (end == CHILD_LATE)
    c->reason = g_strdup_printf("did not load within %g s", seconds);
  else if (end != CHILD_ENDED)
    c->reason = g_strdup_printf("crashed while loading (%s)", g_strsignal(end));
  else
    candidate_read_report(c, report);
}
