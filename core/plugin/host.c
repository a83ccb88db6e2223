/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions that instances call back, and the pool of threads behind
   `parallel`. */
#include "core/plugin/host.h"

#include <glib.h>

#include "core/plugin/guard.h"

static unsigned wanted_threads;

void opc_set_threads(unsigned n) { wanted_threads = n; }

unsigned opc_threads(void) {
  return wanted_threads ? wanted_threads : MAX(1, g_get_num_processors());
}

/* The host of one instance, with the context that libraries get. */
typedef struct instance_host {
  opc_host host; /* the first member */
  opc_context context;
  const opc_sink *sink; /* NULL: to nowhere */
} instance_host;

static const opc_sink *sink_of(const opc_host *host) {
  return ((const instance_host *)host)->sink;
}

/* ---- messages ---- */

static void host_log(const opc_host *host, int level, const char *format, ...) {
  const opc_sink *sink = sink_of(host);
  if (!sink || !sink->log) return;
  va_list args;
  va_start(args, format);
  g_autofree char *message = g_strdup_vprintf(format, args);
  va_end(args);
  sink->log(sink->data, level, message);
}

static void host_progress(const opc_host *host, const opc_progress *progress) {
  const opc_sink *sink = sink_of(host);
  if (sink && sink->progress) sink->progress(sink->data, progress);
}

static int is_cancelled(const opc_context *context) {
  const instance_host *own =
      (const instance_host *)((const char *)context -
                              offsetof(instance_host, context));
  return own->sink && own->sink->cancelled &&
         own->sink->cancelled(own->sink->data);
}

static const char *enter(const opc_context *context, const char *id) {
  (void)context;
  return opc_guard_enter(id);
}

static void leave(const opc_context *context, const char *before) {
  (void)context;
  opc_guard_leave(before);
}

/* ---- threads ---- */

/* One call of parallel(): whoever is free takes the next index. The caller
   works too and waits for tasks, never for threads, so that nested calls
   cannot wait for each other; a helper that comes too late finds nothing to
   do and drops its reference. */
typedef struct batch {
  void (*task)(void *, size_t);
  void *data;
  const char *inside; /* the plugin that called */
  size_t n;
  size_t next;       /* atomic: the next index to take */
  size_t done;       /* under lock */
  gatomicrefcount references;
  GMutex lock;
  GCond finished;
} batch;

static void batch_work(batch *b) {
  size_t i, mine = 0;
  const char *before = opc_guard_enter(b->inside);
  while ((i = __atomic_fetch_add(&b->next, 1, __ATOMIC_RELAXED)) < b->n) {
    b->task(b->data, i);
    mine++;
  }
  opc_guard_leave(before);
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

static GThreadPool *pool(void) {
  static GThreadPool *instance;
  if (g_once_init_enter(&instance)) {
    GThreadPool *p = g_thread_pool_new(batch_help, NULL,
                                       (int)MAX(1, opc_threads() - 1), FALSE,
                                       NULL);
    g_once_init_leave(&instance, p);
  }
  return instance;
}

static void parallel(const opc_context *context, size_t n,
                     void (*task)(void *, size_t), void *data) {
  (void)context;
  size_t workers = MIN(n, opc_threads());
  if (workers <= 1) {
    for (size_t i = 0; i < n; i++) task(data, i);
    return;
  }
  batch *b = g_new0(batch, 1);
  b->task = task;
  b->data = data;
  b->inside = opc_guard_inside();
  b->n = n;
  g_atomic_ref_count_init(&b->references);
  g_mutex_init(&b->lock);
  g_cond_init(&b->finished);
  for (size_t i = 1; i < workers; i++) {
    g_atomic_ref_count_inc(&b->references);
    g_thread_pool_push(pool(), b, NULL);
  }
  batch_work(b);
  g_mutex_lock(&b->lock);
  while (b->done < b->n) g_cond_wait(&b->finished, &b->lock);
  g_mutex_unlock(&b->lock);
  batch_release(b);
}

/* ---- what a running step publishes ---- */

static int host_table(const opc_host *host, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n_columns,
                      opc_error *error) {
  const opc_sink *sink = sink_of(host);
  if (!sink || !sink->table) return OPC_OK;
  return sink->table(sink->data, name, flags, rows, columns, n_columns, error);
}

static int host_metric(const opc_host *host, const char *name, double value,
                       opc_error *error) {
  const opc_sink *sink = sink_of(host);
  if (!sink || !sink->metric) return OPC_OK;
  return sink->metric(sink->data, name, value, error);
}

static const char *host_output_path(const opc_host *host, const char *name,
                                    opc_error *error) {
  const opc_sink *sink = sink_of(host);
  if (!sink || !sink->output_path) {
    opc_fail(error, OPC_FAILED, NULL, "'%s': there is no run folder", name);
    return NULL;
  }
  return sink->output_path(sink->data, name, error);
}

opc_host *opc_host_new(const opc_sink *sink) {
  instance_host *own = g_new(instance_host, 1);
  *own = (instance_host){
      .context = {.parallel = parallel,
                  .cancelled = is_cancelled,
                  .enter = enter,
                  .leave = leave},
      .host = {.context = &own->context,
               .log = host_log,
               .progress = host_progress,
               .table = host_table,
               .metric = host_metric,
               .output_path = host_output_path},
      .sink = sink,
  };
  return &own->host;
}

void opc_host_free(opc_host *host) { g_free(host); }
