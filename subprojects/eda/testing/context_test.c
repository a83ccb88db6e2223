/* SPDX-License-Identifier: BSD-3-Clause */
/* A context for tests, with threads of GLib. */
#include <glib.h>

#include "testing/testing.h"

typedef struct test_context {
  opc_context context; /* first field: the public part */
  unsigned threads;
} test_context;

typedef struct work {
  size_t n;
  size_t next; /* atomic */
  void (*task)(void *data, size_t i);
  void *data;
} work;

static gpointer context_take(gpointer shared) {
  work *w = shared;
  for (;;) {
    size_t i = __atomic_fetch_add(&w->next, 1, __ATOMIC_SEQ_CST);
    if (i >= w->n) return NULL;
    /* Run tasks in reverse order, because no caller may rely on an order. */
    w->task(w->data, w->n - 1 - i);
  }
}

static void parallel(const opc_context *context, size_t n,
                     void (*task)(void *data, size_t i), void *data) {
  const test_context *t = (const test_context *)context;
  work w = {.n = n, .task = task, .data = data};
  g_autoptr(GPtrArray) threads = g_ptr_array_new();
  for (unsigned i = 1; i < t->threads && i < n; i++)
    g_ptr_array_add(threads, g_thread_new("test", context_take, &w));
  context_take(&w);
  for (guint i = 0; i < threads->len; i++) g_thread_join(threads->pdata[i]);
}

static int cancelled(const opc_context *context) {
  (void)context;
  return 0;
}

static const char *context_enter(const opc_context *context, const char *id) {
  (void)context;
  (void)id;
  return NULL;
}

static void context_leave(const opc_context *context, const char *before) {
  (void)context;
  (void)before;
}

const opc_context *eda_test_context_new(unsigned threads) {
  test_context *t = g_new(test_context, 1);
  *t = (test_context){{parallel, cancelled, context_enter, context_leave},
                      threads};
  return &t->context;
}

void eda_test_context_free(const opc_context *context) {
  g_free((test_context *)context);
}
