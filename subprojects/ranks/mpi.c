/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of MPI. MPI's blocking functions occupy a processor while waiting.
   Polling with pauses instead leaves the processor to other processes, and
   detects requests to stop. */
#include "calls.h"

#include <mpi.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

/* ---- state ---- */

static int own; /* rank */
static int (*is_stopped)(void);
static int over;        /* 1 if this rank no longer waits for other ranks */
static MPI_Comm asking; /* communicator of the requests for the counter */
static pthread_mutex_t lock =
    PTHREAD_MUTEX_INITIALIZER; /* one MPI call at a time */
static pthread_t server;
static int64_t turns; /* the counter that rank 0 holds for all ranks; atomic */
static int ended;     /* 1 to end the serving thread; protected by the lock */

/* ---- waiting ---- */

enum {
  AT_ONCE = 50,   /* polls without a pause */
  SHORTEST = 20,  /* first pause, us; a message on the same machine */
  LONGEST = 1000, /* longest pause, us; work units take seconds */
  SERVING = 200   /* pause between checks for requests, us */
};

static void sleep_briefly(long us) {
  const struct timespec t = {0, us * 1000};
  (void)nanosleep(&t, NULL);
}

static int wait_for(MPI_Request *request) {
  long us = SHORTEST;
  for (int i = 0;; i++) {
    int done;
    pthread_mutex_lock(&lock);
    MPI_Test(request, &done, MPI_STATUS_IGNORE);
    pthread_mutex_unlock(&lock);
    if (done) return 0;
    if (is_stopped()) return -1;
    if (i < AT_ONCE) continue;
    sleep_briefly(us);
    us = us * 2 < LONGEST ? us * 2 : LONGEST;
  }
}

/* ---- collective calls ---- */

int mpi_stop(opc_error *error) {
  over = 1;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}

int mpi_least(int64_t *values, size_t n, opc_error *error) {
  MPI_Request request;
  if (over) return mpi_stop(error);
  pthread_mutex_lock(&lock);
  MPI_Iallreduce(MPI_IN_PLACE, values, (int)n, MPI_INT64_T, MPI_MIN,
                 MPI_COMM_WORLD, &request);
  pthread_mutex_unlock(&lock);
  return wait_for(&request) ? mpi_stop(error) : OPC_OK;
}

int mpi_spread(void *bytes, size_t n, int from, opc_error *error) {
  MPI_Request request;
  if (over) return mpi_stop(error);
  pthread_mutex_lock(&lock);
  MPI_Ibcast(bytes, (int)n, MPI_BYTE, from, MPI_COMM_WORLD, &request);
  pthread_mutex_unlock(&lock);
  return wait_for(&request) ? mpi_stop(error) : OPC_OK;
}

/* ---- turns ---- */

enum { ASK = 1, REPLY = 2 };

static int64_t turns_add(int64_t by) {
  return __atomic_fetch_add(&turns, by, __ATOMIC_RELAXED);
}

void mpi_restart(void) { __atomic_store_n(&turns, 0, __ATOMIC_RELAXED); }

/* Answer all requests that have arrived. The caller holds the lock. */
static void turns_answer(void) {
  int asked = 1;
  while (asked) {
    MPI_Status status;
    int64_t value;
    MPI_Iprobe(MPI_ANY_SOURCE, ASK, asking, &asked, &status);
    if (!asked) return;
    MPI_Recv(&value, 1, MPI_INT64_T, status.MPI_SOURCE, ASK, asking,
             MPI_STATUS_IGNORE);
    value = turns_add(value);
    MPI_Send(&value, 1, MPI_INT64_T, status.MPI_SOURCE, REPLY, asking);
  }
}

static void *turns_serve(void *unused) {
  for (int going = 1; going;) {
    pthread_mutex_lock(&lock);
    going = !ended;
    if (going) turns_answer();
    pthread_mutex_unlock(&lock);
    sleep_briefly(SERVING);
  }
  return unused;
}

int64_t mpi_turn(int64_t by) {
  MPI_Request requests[2];
  int64_t got;
  if (over || is_stopped()) return -1;
  if (own == 0) return turns_add(by);
  pthread_mutex_lock(&lock);
  MPI_Irecv(&got, 1, MPI_INT64_T, 0, REPLY, asking, &requests[1]);
  MPI_Isend(&by, 1, MPI_INT64_T, 0, ASK, asking, &requests[0]);
  pthread_mutex_unlock(&lock);
  return wait_for(&requests[0]) || wait_for(&requests[1]) ? -1 : got;
}

/* ---- start and end ---- */

/* Wait by mpi_least until no rank can request the counter again. */
void mpi_end(void) {
  int64_t none = 0;
  opc_error stopped;
  if (mpi_least(&none, 1, &stopped)) return;
  pthread_mutex_lock(&lock);
  ended = 1;
  pthread_mutex_unlock(&lock);
  if (own == 0) pthread_join(server, NULL);
  MPI_Finalize();
}

int mpi_start(int (*stopped)(void), int *rank, int *size) {
  int level;
  /* The guard, not Open MPI, reports crashes. */
  (void)setenv("OMPI_MCA_opal_signal", "", 0);
  if (MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &level) ||
      level < MPI_THREAD_SERIALIZED)
    return -1;
  is_stopped = stopped;
  MPI_Comm_rank(MPI_COMM_WORLD, rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
  MPI_Comm_dup(MPI_COMM_WORLD, &asking);
  own = *rank;
  return own == 0 ? pthread_create(&server, NULL, turns_serve, NULL) : 0;
}
