/* SPDX-License-Identifier: BSD-3-Clause */
/* Thread pool. A crash in a task is attributed to the plugin that called
   pool_run. */
#include <glib.h>
#include <guard/guard.h>
#include <guard/pool.h>

enum { TURNS = 64 }; /* largest number of parts per thread, for load balance */

/* One call of pool_run(). Each free thread takes the next `step` indices. The
   calling thread also takes indices, and waits only for those that other
   threads have taken, never for a free thread: nested calls cannot block each
   other. A thread that starts after all indices were taken only releases its
   reference. */
typedef struct batch {
  void (*task)(void *, size_t);
  void *data;
  const char *inside; /* calling plugin */
  size_t n, step;     /* number of indices; number taken at a time */
  size_t next;        /* atomic: the next index to take */
  size_t done;        /* completed indices; protected by the lock */
  gatomicrefcount references;
  GMutex lock;
  GCond finished;
} batch;

static void batch_work(batch *b) {
  size_t first, mine = 0;
  const char *before = guard_join(b->inside);
  while ((first = __atomic_fetch_add(&b->next, b->step, __ATOMIC_RELAXED)) <
         b->n) {
    size_t end = MIN(first + b->step, b->n);
    for (size_t i = first; i < end; i++) b->task(b->data, i);
    mine += end - first;
  }
  guard_part(before);
  if (!mine) return;
  g_mutex_lock(&b->lock);
  b->done += mine;
  if (b->done == b->n) g_cond_signal(&b->finished);
  g_mutex_unlock(&b->lock);
}

static void batch_release(batch *b) {
  if (!g_atomic_ref_count_dec(&b->references)) return;
  g_mutex_clear(&b->lock);
  g_cond_clear(&b->finished);
  g_free(b);
}

static void batch_help(gpointer item, gpointer unused) {
  (void)unused;
  batch_work(item);
  batch_release(item);
}

static GThreadPool *pool_of(unsigned threads) {
  static GThreadPool *instance;
  if (g_once_init_enter(&instance)) {
    GThreadPool *p = g_thread_pool_new(batch_help, NULL,
                                       (int)MAX(1, threads - 1), FALSE, NULL);
    g_once_init_leave(&instance, p);
  }
  return instance;
}

void pool_run(unsigned threads, size_t n, void (*task)(void *data, size_t i),
              void *data) {
  size_t workers = MIN(n, threads);
  guard_gather();
  if (workers <= 1) {
    for (size_t i = 0; i < n; i++) task(data, i);
    return;
  }
  batch *b = g_new0(batch, 1);
  b->task = task;
  b->data = data;
  b->inside = guard_inside();
  b->n = n;
  b->step = n / (workers * TURNS) + 1;
  g_atomic_ref_count_init(&b->references);
  g_mutex_init(&b->lock);
  g_cond_init(&b->finished);
  /* GLib's pool may start threads here: attribute these threads to the command,
     not to the calling plugin. */
  const char *before = guard_enter(NULL);
  for (size_t i = 1; i < workers; i++) {
    g_atomic_ref_count_inc(&b->references);
    g_thread_pool_push(pool_of(threads), b, NULL);
  }
  guard_leave(before);
  batch_work(b);
  guard_wait(1);
  g_mutex_lock(&b->lock);
  while (b->done < b->n) g_cond_wait(&b->finished, &b->lock);
  g_mutex_unlock(&b->lock);
  guard_wait(0);
  batch_release(b);
}
