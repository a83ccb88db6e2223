/* SPDX-License-Identifier: BSD-3-Clause */
/* A Python process that executes the functions of one plugin instance. Requests
   and replies are lines of JSON on a socket; arrays are in memory that both
   processes map. All functions are [main] for one worker. */
#pragma once

#include <json-glib/json-glib.h>
#include <opcflow/plugin.h>

/* A file that the worker maps: its number (eda_shared.id; 0: py_worker.memory)
   and descriptor. */
typedef struct py_file {
  uint64_t id;
  int file;
} py_file;

/* An array of `bytes` bytes that is copied after the call from offset `at` of
   the worker's memory to `to`. */
typedef struct py_loan {
  void *to;
  size_t at, bytes;
} py_loan;

/* The fields are private to worker.c and call.c. */
typedef struct py_worker {
  char *id;
  pid_t pid;  /* the Python process; 0: ended */
  pid_t host; /* the process that started the Python process */
  /* Descriptors; -1: none. */
  int socket; /* of the messages */
  int alive;  /* of a connection that ends with this process */
  int log;    /* of a file with the output of the Python process */
  int memory; /* of the memory for arrays, which both processes map */
  char *base; /* mapped memory of `size` bytes */
  size_t size, used;
  int is_kept;      /* 1: the Python code still uses arrays in `memory` */
  GArray *files;    /* py_file */
  guint sent;       /* number of `files` that were sent */
  const char *call; /* name of the method */
  GString *request; /* JSON */
  GArray *lent;     /* py_loan */
  GString *input;   /* bytes after the last message */
  JsonNode *reply;
} py_worker;

/* Start the interpreter `python` (NULL: OPCFLOW_PYTHON or python3) with the
   package opcflow and the plugin `id` in the file `path`. NULL and *error if
   the process cannot be started. */
py_worker *py_worker_start(const char *path, const char *id, const char *python,
                           opc_error *error);

/* End the process and free the worker; NULL: do nothing. */
void py_worker_free(py_worker *worker);

/* Wait at most `patience` s for the end of the process, then kill it. Returns
   the status as waitpid. */
int py_worker_end(py_worker *worker, double patience);

/* Return the text that the process wrote to its standard output and error, and
   empty the log (g_free). Only the end of a long text is returned. */
char *py_worker_log(py_worker *worker);

/* Begin a request. `call` is the name of the method, a constant text. The
   functions below add values: with a name, or with the name NULL as elements of
   a list. */
void py_request(py_worker *worker, const char *call);

/* Begin and end an object '{' or a list '['. */
void py_begin(py_worker *worker, const char *name, char bracket);
void py_end(py_worker *worker, char bracket);

/* Add a value: JSON text; an integer; a number, null if not finite; a text,
   null if NULL. */
void py_put(py_worker *worker, const char *name, const char *json);
void py_put_int(py_worker *worker, const char *name, int64_t value);
void py_put_number(py_worker *worker, const char *name, double value);
void py_put_text(py_worker *worker, const char *name, const char *text);

/* Add an array of `count` rows of `width` elements; width 0: an array of one
   dimension. `type` is the notation of NumPy: "f8", "f4", "i4", "u4", "u1".
   If `data` is NULL and the array is not empty, the value is None.
   py_lend_array: the Python function can change the array, and the changes are
   copied to `data` after the call. */
void py_put_array(py_worker *worker, const char *name, const char *type,
                  size_t count, size_t width, const void *data);
void py_lend_array(py_worker *worker, const char *name, const char *type,
                   size_t count, size_t width, void *data);

/* Function that answers a message of the worker during a call. `what`: kind of
   the message; `asked`: the whole message; *answer receives a text or NULL.
   Returns 0, or an error code and *error. */
typedef int py_answer(const opc_host *host, const char *what, JsonObject *asked,
                      const char **answer, opc_error *error);

/* Send the request and wait for the reply, at most `limit` s. Returns OPC_OK,
   or an error code and *error: the exception with file and line, the end of the
   process, OPC_CANCELLED. The traceback is logged. After a failure other than
   an exception the process is gone, and each later call fails. */
int py_call(py_worker *worker, const opc_host *host, double limit,
            py_answer *answer, opc_error *error);

/* Return the values that the method returned. */
JsonObject *py_result(const py_worker *worker);

/* Return an array of the result, and its number of elements; NULL if there is
   none of this name and type. Valid until the next request. */
const void *py_new_array(const py_worker *worker, const char *name,
                         const char *type, size_t *count);

/* ---- members of JSON objects ---- */

/* Return a text, a number, a list or an object; NULL, 0, an empty list and NULL
   if the object has no such member. */
const char *py_text(JsonObject *object, const char *name);
double py_number(JsonObject *object, const char *name);
JsonArray *py_list(JsonObject *object, const char *name);
JsonObject *py_member(JsonObject *object, const char *name);
