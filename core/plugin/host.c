/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions that instances call back, and the pool of threads behind
   `parallel`. */
#include "core/plugin/host.h"

#include <base/shown.h>
#include <glib.h>
#include <guard/guard.h>
#include <string.h>

#include "core/plugin/pieces.h"

static unsigned wanted_threads;

void opc_set_threads(unsigned n) { wanted_threads = n; }

unsigned opc_threads(void) {
  return wanted_threads ? wanted_threads : MAX(1, g_get_num_processors());
}

/* The host of one instance, with the context that libraries get. */
typedef struct instance_host {
  opc_host host; /* the first member */
  opc_context context;
  const char *path;
  const opc_watch *watch;
} instance_host;

/* ---- messages ---- */

static void host_log(const opc_host *host, int level, const char *format, ...) {
  const instance_host *own = (const instance_host *)host;
  if (!own->watch->log) return;
  va_list args;
  va_start(args, format);
  g_autofree char *said = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *message = opc_shown(said, "");
  const char *before = guard_enter(NULL);
  own->watch->log(own->watch->data, own->path, level, message);
  guard_leave(before);
}

static void host_progress(const opc_host *host, const opc_progress *progress) {
  const instance_host *own = (const instance_host *)host;
  if (!own->watch->progress) return;
  opc_progress told = *progress; /* read while the plugin is to blame */
  char unit[16];
  g_snprintf(unit, sizeof unit, "%s", told.worst_unit ? told.worst_unit : "");
  g_autofree char *shown = opc_shown(unit, "");
  told.worst_unit = told.worst_unit ? shown : NULL;
  const char *before = guard_enter(NULL);
  own->watch->progress(own->watch->data, own->path, &told);
  guard_leave(before);
}

static int is_cancelled(const opc_context *context) {
  const instance_host *own =
      (const instance_host *)((const char *)context -
                              offsetof(instance_host, context));
  return own->watch->cancelled && own->watch->cancelled(own->watch->data);
}

static const char *enter(const opc_context *context, const char *id) {
  (void)context;
  return guard_enter(id);
}

static void leave(const opc_context *context, const char *before) {
  (void)context;
  guard_leave(before);
}

/* ---- threads ---- */

enum { TURNS = 64 }; /* of each thread at least, so that all end together */

/* One call of parallel(): whoever is free takes the next indices, several if
   there are many, as taking costs time too. The caller
   works too and waits for tasks, never for threads, so that nested calls
   cannot wait for each other; a helper that comes too late finds nothing to
   do and drops its reference. */
typedef struct batch {
  void (*task)(void *, size_t);
  void *data;
  const char *inside; /* the plugin that called */
  size_t n, step;     /* indices in all, and taken at a time */
  size_t next;        /* atomic: the next index to take */
  size_t done;        /* under lock */
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

static GThreadPool *pool(void) {
  static GThreadPool *instance;
  if (g_once_init_enter(&instance)) {
    GThreadPool *p = g_thread_pool_new(
        batch_help, NULL, (int)MAX(1, opc_threads() - 1), FALSE, NULL);
    g_once_init_leave(&instance, p);
  }
  return instance;
}

static void parallel(const opc_context *context, size_t n,
                     void (*task)(void *, size_t), void *data) {
  (void)context;
  size_t workers = MIN(n, opc_threads());
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
  /* Threads that the pool starts here are nobody's. */
  const char *before = guard_enter(NULL);
  for (size_t i = 1; i < workers; i++) {
    g_atomic_ref_count_inc(&b->references);
    g_thread_pool_push(pool(), b, NULL);
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

/* ---- where nothing is published ---- */

static int ignore_table(const opc_host *host, const char *name, uint32_t flags,
                        size_t rows, const opc_column *columns,
                        size_t n_columns, size_t column_size,
                        opc_error *error) {
  (void)host, (void)name, (void)flags, (void)rows;
  (void)columns, (void)n_columns, (void)column_size, (void)error;
  return OPC_OK;
}

static int ignore_metric(const opc_host *host, const char *name, double value,
                         opc_error *error) {
  (void)host, (void)name, (void)value, (void)error;
  return OPC_OK;
}

static const char *refuse_path(const opc_host *host, const char *name,
                               opc_error *error) {
  (void)host;
  opc_fail(error, OPC_FAILED, NULL, "'%s': there is no run folder", name);
  return NULL;
}

static const void *basic_service(const opc_host *host, const char *name) {
  (void)host;
  return strcmp(name, OPC_PIECES) ? NULL : &opc_pieces_alone;
}

static const opc_watch nobody;

opc_host *opc_host_new(const char *path, const opc_watch *watch,
                       const opc_host *like) {
  static const opc_host nowhere = {.table = NULL};
  const opc_host *to = like ? like : &nowhere;
  instance_host *own = g_new(instance_host, 1);
  *own = (instance_host){
      .context = {.parallel = parallel,
                  .cancelled = is_cancelled,
                  .enter = enter,
                  .leave = leave},
      .host = {.size = sizeof(opc_host),
               .context = &own->context,
               .log = host_log,
               .progress = host_progress,
               .table = to->table ? to->table : ignore_table,
               .metric = to->metric ? to->metric : ignore_metric,
               .output_path = to->output_path ? to->output_path : refuse_path,
               .service = to->service ? to->service : basic_service},
      .path = path,
      .watch = watch ? watch : &nobody,
  };
  return &own->host;
}

void opc_host_ignore(opc_host *host) {
  ((instance_host *)host)->watch = &nobody;
}

void opc_host_free(opc_host *host) { g_free(host); }
