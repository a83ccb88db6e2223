/* SPDX-License-Identifier: BSD-3-Clause */
/* State of a worker, shared by the files that start it and that call it. */
#pragma once

#include <errno.h>
#include <signal.h>

#include "worker.h"

struct py_worker {
  char *id;
  pid_t pid,
      host; /* of the worker (0: ended), of the process that started it */
  int socket, alive, log, memory; /* descriptors; -1: none */
  char *base;                     /* mapped memory of `size` bytes */
  size_t size, used;
  GArray *blocks;      /* uint64_t: numbers of the files that the worker maps:
                          eda_shared.id, 0 for `memory` */
  GArray *files;       /* int: descriptors to send with the request */
  JsonObject *request; /* call, values, arrays */
  GString *input;      /* bytes after the last message */
  JsonNode *reply;
};

/* Wait at most `patience` s for the end of the process, then kill it. Returns
   the status as waitpid. */
int py_worker_end(py_worker *worker, double patience);

/* Return and remove the text that the process wrote to its standard output and
   error (g_free); of a long text the end. */
char *py_worker_log(py_worker *worker);
