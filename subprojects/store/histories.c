/* SPDX-License-Identifier: BSD-3-Clause */
/* List of histories of steps. */
#include <store/histories.h>

#include <string.h>

enum { MOST_HISTORIES = 1000 };

static void history_free(gpointer item) {
  opc_history *h = item;
  g_free(h->path);
  g_free(h->key);
  g_free(h->reason);
  g_free(h);
}

void opc_histories_init(opc_histories *histories) {
  *histories =
      (opc_histories){.list = g_ptr_array_new_with_free_func(history_free)};
}

void opc_histories_clear(opc_histories *histories) {
  g_ptr_array_free(histories->list, TRUE);
}

static void history_insert(opc_histories *histories, gint at,
                           const opc_history *from) {
  if (histories->list->len >= MOST_HISTORIES) return;
  opc_history *h = g_memdup2(from, sizeof *h);
  h->path = g_strdup(h->path);
  h->key = g_strdup(h->key);
  h->reason = g_strdup(h->reason);
  g_ptr_array_insert(histories->list, at, h);
}

void opc_histories_add(opc_histories *histories, const opc_history *history) {
  histories->done++;
  histories->reused += (size_t)history->reused;
  history_insert(histories, -1, history);
}

void opc_histories_take(opc_histories *histories, const opc_histories *from) {
  histories->done += from->done;
  histories->reused += from->reused;
  for (guint i = 0; i < from->list->len; i++)
    history_insert(histories, (gint)i, from->list->pdata[i]);
}

void opc_histories_rerun(opc_histories *histories, const char *path,
                         const char *reason, double seconds) {
  histories->reused--;
  for (guint i = histories->list->len; i-- > 0;) {
    opc_history *h = histories->list->pdata[i];
    if (strcmp(h->path, path) || !h->reused) continue;
    h->reused = FALSE;
    h->reason = g_strdup(reason);
    h->seconds = seconds;
    return;
  }
}
