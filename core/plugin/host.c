/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements opc_host, the functions of the host that plugins call. */
#include "core/plugin/host.h"

#include <base/shown.h>
#include <glib.h>
#include <guard/guard.h>
#include <guard/pool.h>
#include <string.h>

#include "core/plugin/pieces.h"

static unsigned wanted_threads;

void opc_set_threads(unsigned n) { wanted_threads = n; }

unsigned opc_threads(void) {
  return wanted_threads ? wanted_threads : MAX(1, g_get_num_processors());
}

/* Host of one instance, with the context passed to libraries. */
typedef struct instance_host {
  opc_host host; /* must be first: cast from opc_host */
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
  g_autofree char *text = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *message = opc_shown(text, "");
  const char *before = guard_enter(NULL);
  own->watch->log(own->watch->data, own->path, level, message);
  guard_leave(before);
}

static void host_progress(const opc_host *host, const opc_progress *progress) {
  const instance_host *own = (const instance_host *)host;
  if (!own->watch->progress) return;
  opc_progress copy = *progress; /* read before guard_enter, so that a crash by
                                    an invalid pointer names the plugin */
  char unit[16];
  g_snprintf(unit, sizeof unit, "%s", copy.worst_unit ? copy.worst_unit : "");
  g_autofree char *shown = opc_shown(unit, "");
  copy.worst_unit = copy.worst_unit ? shown : NULL;
  const char *before = guard_enter(NULL);
  own->watch->progress(own->watch->data, own->path, &copy);
  guard_leave(before);
}

static int is_cancelled(const opc_context *context) {
  const instance_host *own =
      (const instance_host *)((const char *)context -
                              offsetof(instance_host, context));
  return own->watch->cancelled && own->watch->cancelled(own->watch->data);
}

static const char *host_enter(const opc_context *context, const char *id) {
  (void)context;
  return guard_enter(id);
}

static void host_leave(const opc_context *context, const char *before) {
  (void)context;
  guard_leave(before);
}

static void host_parallel(const opc_context *context, size_t n,
                          void (*task)(void *, size_t), void *data) {
  (void)context;
  pool_run(opc_threads(), n, task, data);
}

/* ---- defaults without a run ---- */

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
  opc_fail(error, OPC_FAILED, NULL, "'%s': no run folder exists", name);
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
      .context = {.parallel = host_parallel,
                  .cancelled = is_cancelled,
                  .enter = host_enter,
                  .leave = host_leave},
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
