/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints progress. */
#include "core/cli/progress.h"

#include <guard/stop.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/cli/cli.h"

int cli_is_stopped(void *unused) {
  (void)unused;
  return stop_is_asked();
}

/* Shortest time between two lines, us. */
enum { PAUSE = 100000 };

/* Shortest time of a step that gets a line, us. */
enum { LONG = 1000000 };

void cli_progress_start(cli_progress *p, int level, gboolean steps) {
  memset(p, 0, sizeof *p);
  g_mutex_init(&p->lock);
  p->level = level;
  p->steps = steps;
  p->shown = steps && cli_is_terminal();
}

/* Replace the progress line on the terminal. */
static void progress_show_line(const cli_progress *p, const char *line) {
  if (!p->shown) return;
  fprintf(stderr, "\r\033[K%s", line);
  fflush(stderr);
}

/* Append the point and the step, such as "point 3/12 [2/5] first". */
static void append_step(GString *line, const cli_progress *p) {
  if (p->points)
    g_string_append_printf(line, "point %zu/%zu ", p->point, p->points);
  g_string_append_printf(line, "[%zu/%zu] %s", p->number, p->count, p->step);
}

/* End the current step, if any, and print its time. */
static void step_end(cli_progress *p) {
  gint64 time = g_get_monotonic_time() - p->began;
  if (p->steps && p->step && time >= LONG) {
    g_autoptr(GString) line = g_string_new(NULL);
    append_step(line, p);
    progress_show_line(p, "");
    fprintf(stderr, "%s: %.1f s\n", line->str, (double)time * 1e-6);
  }
  g_clear_pointer(&p->step, g_free);
}

void cli_progress_end(cli_progress *p) {
  step_end(p);
  progress_show_line(p, "");
  g_mutex_clear(&p->lock);
}

void cli_progress_log(void *data, const char *path, int level,
                      const char *message) {
  cli_progress *p = data;
  if (level < p->level) return;
  g_mutex_lock(&p->lock);
  progress_show_line(p, "");
  if (level >= OPC_LOG_WARNING)
    cli_message("warning", "%s: %s", path, message);
  else
    fprintf(stderr, "%s: %s%s\n", path, level == OPC_LOG_DEBUG ? "debug: " : "",
            message);
  g_mutex_unlock(&p->lock);
}

void cli_progress_point(void *data, size_t number, size_t count) {
  cli_progress *p = data;
  g_mutex_lock(&p->lock);
  step_end(p);
  p->point = number;
  p->points = count;
  g_mutex_unlock(&p->lock);
}

void cli_progress_step(void *data, const char *name, size_t number,
                       size_t count) {
  cli_progress *p = data;
  g_mutex_lock(&p->lock);
  step_end(p);
  p->step = g_strdup(name);
  p->number = number;
  p->count = count;
  p->began = g_get_monotonic_time();
  p->last = 0;
  g_autoptr(GString) line = g_string_new(NULL);
  append_step(line, p);
  progress_show_line(p, line->str);
  g_mutex_unlock(&p->lock);
}

static void append_time_left(GString *line, const cli_progress *p,
                             const opc_progress *at, gint64 now) {
  if (!(at->done > 0) || !(at->total >= at->done)) return;
  double past = (double)(now - p->began) * 1e-6;
  double left = past * (at->total - at->done) / at->done;
  if (left > 1e6) return;
  long seconds = lround(left);
  g_string_append_printf(line, "  %ld:%02ld left", seconds / 60, seconds % 60);
}

void cli_progress_show(void *data, const char *path, const opc_progress *at) {
  cli_progress *p = data;
  (void)path;
  if (!p->shown) return;
  g_mutex_lock(&p->lock);
  gint64 now = g_get_monotonic_time();
  if (p->step && now - p->last >= PAUSE) {
    p->last = now;
    g_autoptr(GString) line = g_string_new(NULL);
    append_step(line, p);
    if (isfinite(at->done)) g_string_append_printf(line, "  %g", at->done);
    if (isfinite(at->done) && isfinite(at->total))
      g_string_append_printf(line, "/%g", at->total);
    if (isfinite(at->worst))
      g_string_append_printf(line, "  worst %.3g%s%s", at->worst,
                             at->worst_unit ? " " : "",
                             at->worst_unit ? at->worst_unit : "");
    append_time_left(line, p, at, now);
    progress_show_line(p, line->str);
  }
  g_mutex_unlock(&p->lock);
}
