/* SPDX-License-Identifier: BSD-3-Clause */
/* A Python process that executes the functions of one plugin instance. Requests
   and replies are lines of JSON on a socket; arrays are in memory that both
   processes map. All functions are [main] for one worker. */
#pragma once

#include <json-glib/json-glib.h>
#include <opcflow/plugin.h>

typedef struct py_worker py_worker;

/* Start the interpreter `python` (NULL: OPCFLOW_PYTHON or python3) with the
   package opcflow and the plugin `id` in the file `path`. NULL and *error if
   the process cannot be started. */
py_worker *py_worker_start(const char *path, const char *id, const char *python,
                           opc_error *error);

/* End the process and free the worker; NULL: do nothing. */
void py_worker_free(py_worker *worker);

/* Begin a request. Its values and arrays are then added. */
void py_request(py_worker *worker, const char *call);

/* Return the values of the request, owned by the worker. */
JsonObject *py_values(py_worker *worker);

/* Set a number of a JSON object, null if it is not finite. */
void py_set_number(JsonObject *object, const char *name, double value);

/* Add an empty object and return it. */
JsonObject *py_object(JsonObject *to, const char *name);

/* Add an array of `count` rows of `width` elements to an object of the request;
   width 0: an array of one dimension.
   `type` is the notation of NumPy: "f8", "f4", "i4", "u4", "u1". `data` NULL:
   None, unless the array is empty. The Python function can change the
   elements. */
void py_add_array(py_worker *worker, JsonObject *to, const char *name,
                  const char *type, size_t count, size_t width,
                  const void *data);

/* Copy an array of the request, as changed by the call, to `to`. */
void py_get_array(const py_worker *worker, JsonObject *from, const char *name,
                  void *to);

/* Return an array of the reply, and its number of elements; NULL if there is
   none of this name and type. Valid until the next request. */
const void *py_new_array(const py_worker *worker, const char *name,
                         const char *type, size_t *count);

/* Answers a message of the worker during a call: *answer receives a text or
   NULL. Returns 0, or an error code and *error. */
typedef int py_answer(const opc_host *host, const char *what, JsonObject *asked,
                      const char **answer, opc_error *error);

/* Send the request and wait for the reply, at most `limit` s. Returns OPC_OK,
   or an error code and *error: the exception with file and line, the end of the
   process, OPC_CANCELLED. The traceback is logged. After a failure other than
   an exception the process is gone, and each later call fails. */
int py_call(py_worker *worker, const opc_host *host, double limit,
            py_answer *answer, opc_error *error);

/* Return the last message of the worker, and the values that a method
   returned. */
JsonObject *py_reply(const py_worker *worker);
JsonObject *py_result(const py_worker *worker);
