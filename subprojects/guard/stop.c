/* SPDX-License-Identifier: BSD-3-Clause */
/* Handles requests to stop, and ends the process if a plugin continues. */
#include <guard/guard.h>
#include <guard/process.h>
#include <guard/stop.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stddef.h>
#include <time.h>

/* Time from the request to the forced end. The total must not exceed 1 s; a
   busy machine adds up to 0.4 s. */
static const struct timespec patience = {0, 500000000};

static volatile sig_atomic_t asked;
static sem_t request; /* posted by the signal handler */
static int exit_code;

static void take_signal(int number) {
  (void)number;
  if (asked) guard_end(exit_code);
  asked = 1;
  sem_post(&request);
}

static void *end_the_stubborn(void *unused) {
  while (sem_wait(&request)) continue; /* interrupted by a signal */
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
  if (!pthread_create(&watcher, NULL, end_the_stubborn, NULL))
    pthread_detach(watcher);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  /* SIGHUP: the terminal was closed. nohup ignores this signal. */
  if (!sigaction(SIGHUP, NULL, &before) && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, NULL);
  process_settle();
}

int stop_is_asked(void) { return asked; }
