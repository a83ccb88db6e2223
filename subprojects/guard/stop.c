/* SPDX-License-Identifier: BSD-3-Clause */
/* Handles requests to stop and time limits, and ends the process if a plugin
   continues. */
#include <guard/guard.h>
#include <guard/process.h>
#include <guard/stop.h>
#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <time.h>

/* Time from the request to the forced end. The total must not exceed 1 s; a
   busy machine adds up to 0.4 s. */
static const struct timespec patience = {0, 500000000};

static volatile sig_atomic_t asked;
static sem_t request; /* posted by the signal handler and by limits_set, to wake
                         the watching thread */
static int exit_code;

static void take_signal(int number) {
  (void)number;
  if (asked) guard_end(exit_code);
  asked = 1;
  sem_post(&request);
}

/* ---- time limits ---- */

static pthread_mutex_t limits_lock = PTHREAD_MUTEX_INITIALIZER;
static stop_limit *limits; /* innermost limit */

static double time_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Replace the innermost limit, and wake the watching thread. */
static void limits_set(stop_limit *limit) {
  pthread_mutex_lock(&limits_lock);
  limits = limit;
  pthread_mutex_unlock(&limits_lock);
  sem_post(&request);
}

void stop_limit_begin(stop_limit *limit, double seconds, const char *where) {
  limit->end = time_now() + seconds;
  limit->outer = limits;
  snprintf(limit->where, sizeof limit->where, "%s", where);
  limits_set(limit);
}

void stop_limit_end(const stop_limit *limit) { limits_set(limit->outer); }

/* End the process if a limit is exceeded; return the earliest end, s. */
static double limits_check(void) {
  double earliest = time_now() + 1e6;
  pthread_mutex_lock(&limits_lock);
  for (const stop_limit *l = limits; l; l = l->outer) {
    if (l->end < earliest) earliest = l->end;
    if (l->end > time_now()) continue;
    guard_where(l->where, GUARD_CRASH_RUNNING);
    guard_end(GUARD_CRASH_RUNNING);
  }
  pthread_mutex_unlock(&limits_lock);
  return earliest;
}

/* ---- requests ---- */

static void *watch_requests(void *unused) {
  while (!asked) {
    double end = limits_check(), whole = floor(end);
    const struct timespec until = {(time_t)whole, (long)((end - whole) * 1e9)};
    sem_clockwait(&request, CLOCK_MONOTONIC, &until);
  }
  struct timespec left = patience;
  while (clock_nanosleep(CLOCK_MONOTONIC, 0, &left, &left)) continue;
  guard_end(exit_code);
  return unused;
}

void stop_on_signals(int code) {
  struct sigaction action = {.sa_handler = take_signal};
  struct sigaction before;
  pthread_t watcher;
  exit_code = code;
  sem_init(&request, 0, 0);
  if (!pthread_create(&watcher, NULL, watch_requests, NULL))
    pthread_detach(watcher);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  /* SIGHUP: the terminal was closed. nohup ignores this signal. */
  if (!sigaction(SIGHUP, NULL, &before) && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, NULL);
  process_settle();
}

int stop_is_asked(void) { return asked; }
