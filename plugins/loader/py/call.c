/* SPDX-License-Identifier: BSD-3-Clause */
/* Requests to a worker: arrays in shared memory, the exchange of messages, and
   reports of exceptions, of ended processes and of calls that do not end. */
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <eda/memory.h>

#include "private.h"

/* Time for the start of the process, added to the limit of the first call, s:
   the import of NumPy takes 0.1 s, of PyTorch several seconds. */
static const double start_limit = 60;

enum {
  MOST_FILES = 253
}; /* descriptors in a message: the limit of Linux;
      blocks of eda_alloc_shared are fewer */

/* ---- requests ---- */

JsonObject *py_values(py_worker *w) {
  return json_object_get_object_member(w->request, "values");
}

JsonObject *py_object(JsonObject *to, const char *name) {
  JsonObject *o = json_object_new();
  json_object_set_object_member(to, name, o);
  return o;
}

void py_set_number(JsonObject *object, const char *name, double value) {
  if (value - value == 0)
    json_object_set_double_member(object, name, value);
  else
    json_object_set_null_member(object, name);
}

/* ---- shared memory ---- */

/* Return the array `name` of the request: numbers of files. */
static JsonArray *numbers(py_worker *w, const char *name) {
  return json_object_get_array_member(w->request, name);
}

/* Send a file with the request, if the worker does not map it yet. */
static void file_send(py_worker *w, uint64_t id, int file) {
  for (guint i = 0; i < w->blocks->len; i++)
    if (g_array_index(w->blocks, uint64_t, i) == id) return;
  g_array_append_val(w->blocks, id);
  g_array_append_val(w->files, file);
  json_array_add_int_element(numbers(w, "files"), (gint64)id);
}

/* Let the worker close the files that exist no more: blocks that were freed or
   renewed, and memory in which the worker keeps arrays. */
static void files_drop(py_worker *w) {
  for (guint i = w->blocks->len; i-- > 0;) {
    uint64_t id = g_array_index(w->blocks, uint64_t, i);
    if (id ? eda_shared_exists(id) : w->memory >= 0) continue;
    json_array_add_int_element(numbers(w, "drop"), (gint64)id);
    g_array_remove_index_fast(w->blocks, i);
  }
}

/* Map `size` bytes of the memory; without memory, all later calls fail. */
static void memory_map(py_worker *w, size_t size) {
  if (w->base) munmap(w->base, w->size);
  w->base = NULL;
  w->size = size;
  void *base =
      mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, w->memory, 0);
  if (base == MAP_FAILED) g_error("cannot map %zu bytes", size);
  w->base = base;
}

/* Make space for `size` bytes in total. */
static void memory_reserve(py_worker *w, size_t size) {
  enum { LEAST = 1 << 20 };
  if (w->memory < 0) {
    w->memory = memfd_create("opcflow-arrays", MFD_CLOEXEC);
    w->size = 0;
  }
  if (size <= w->size) return;
  size_t grown = MAX(MAX(size, 2 * w->size), LEAST);
  if (w->memory < 0 || ftruncate(w->memory, (off_t)grown))
    g_error("cannot reserve %zu bytes of shared memory", grown);
  memory_map(w, grown);
}

/* Forget the memory because the worker keeps arrays in it. */
static void memory_leave(py_worker *w) {
  if (w->base) munmap(w->base, w->size);
  if (w->memory >= 0) close(w->memory);
  w->base = NULL;
  w->memory = -1;
  w->size = 0;
}

/* Separate the arrays that the worker keeps after a call from those of the
   caller, which will change. */
static void arrays_leave(py_worker *w) {
  JsonArray *kept = json_object_get_array_member(py_reply(w), "kept");
  for (guint i = 0; i < json_array_get_length(kept); i++) {
    uint64_t id = (uint64_t)json_array_get_int_element(kept, i);
    if (id && !eda_shared_renew(id) && eda_shared_exists(id))
      g_error("no memory for a copy of an array");
  }
}

/* Return whether the worker keeps arrays in the memory of the last call. */
static int memory_is_kept(py_worker *w) {
  JsonArray *kept =
      w->reply ? json_object_get_array_member(py_reply(w), "kept") : NULL;
  for (guint i = 0; kept && i < json_array_get_length(kept); i++)
    if (!json_array_get_int_element(kept, i)) return 1;
  return 0;
}

void py_request(py_worker *w, const char *call) {
  if (memory_is_kept(w)) memory_leave(w);
  if (w->request) json_object_unref(w->request);
  w->request = json_object_new();
  json_object_set_string_member(w->request, "call", call);
  json_object_set_array_member(w->request, "files", json_array_new());
  json_object_set_array_member(w->request, "drop", json_array_new());
  g_array_set_size(w->files, 0);
  files_drop(w);
  (void)py_object(w->request, "values");
  w->used = 0;
}

static size_t type_size(const char *type) { return (size_t)(type[1] - '0'); }

/* Return the description of an array, {"array": [type, offset, count, width,
   number of the file]}; NULL if the object has no array of this name. */
static JsonArray *array_about(JsonObject *from, const char *name) {
  JsonNode *node = json_object_get_member(from, name);
  return node && JSON_NODE_HOLDS_OBJECT(node)
             ? json_object_get_array_member(json_node_get_object(node), "array")
             : NULL;
}

void py_add_array(py_worker *w, JsonObject *to, const char *name,
                  const char *type, size_t count, size_t width,
                  const void *data) {
  enum { ALIGN = 64 };
  size_t at = (w->used + ALIGN - 1) / ALIGN * ALIGN;
  size_t bytes = count * MAX(width, 1) * type_size(type);
  eda_shared place = {0};
  if (bytes && !data) {
    json_object_set_null_member(to, name);
    return;
  }
  if (bytes >= EDA_SHARED && eda_shared_find(data, bytes, &place)) {
    file_send(w, place.id, place.file);
    at = place.offset;
  } else {
    memory_reserve(w, at + bytes);
    if (bytes) memcpy(w->base + at, data, bytes);
    w->used = at + bytes;
  }
  JsonArray *about = json_array_new();
  json_array_add_string_element(about, type);
  json_array_add_int_element(about, (gint64)at);
  json_array_add_int_element(about, (gint64)count);
  json_array_add_int_element(about, (gint64)width);
  json_array_add_int_element(about, (gint64)place.id);
  json_object_set_array_member(py_object(to, name), "array", about);
}

/* Return the size of a described array in bytes. */
static size_t array_bytes(JsonArray *about) {
  return (size_t)(json_array_get_int_element(about, 2) *
                  MAX(json_array_get_int_element(about, 3), 1)) *
         type_size(json_array_get_string_element(about, 0));
}

void py_get_array(const py_worker *w, JsonObject *from, const char *name,
                  void *to) {
  JsonArray *about = array_about(from, name);
  size_t bytes = about ? array_bytes(about) : 0;
  if (!bytes || json_array_get_int_element(about, 4)) return; /* in place */
  memcpy(to, w->base + json_array_get_int_element(about, 1), bytes);
}

const void *py_new_array(const py_worker *w, const char *name, const char *type,
                         size_t *count) {
  JsonArray *about = array_about(py_result(w), name);
  if (!about || strcmp(json_array_get_string_element(about, 0), type))
    return NULL;
  size_t at = (size_t)json_array_get_int_element(about, 1);
  size_t bytes = array_bytes(about);
  *count = bytes / type_size(type);
  return at + bytes <= w->size ? w->base + at : NULL;
}

/* ---- reports ---- */

/* Log the output of the process line by line; at the level of warnings, if the
   output explains a failure. */
static void worker_report(const opc_host *host, int level, const char *text) {
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  for (guint i = 0; host && lines[i]; i++)
    if (*lines[i]) host->log(host, level, "%s", lines[i]);
}

/* Return the last line of a text. */
static const char *last_line(const char *text) {
  const char *end = strrchr(text, '\n');
  return end ? end + 1 : text;
}

/* Report that the process ended during a call. */
static int worker_died(py_worker *w, const opc_host *host, opc_error *error) {
  const char *call = json_object_get_string_member(w->request, "call");
  int status = py_worker_end(w, 1);
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_WARNING, log);
  g_autofree char *how =
      WIFSIGNALED(status)
          ? g_strdup_printf("ended by signal %d (%s)", WTERMSIG(status),
                            g_strsignal(WTERMSIG(status)))
          : g_strdup_printf("exited with status %d", WEXITSTATUS(status));
  return opc_fail(error, OPC_FAILED, NULL, "the Python process %s in %s%s%s",
                  how, call, *log ? ": " : "", last_line(log));
}

/* Stop a call that does not end: write the traceback to the log, then kill the
   process. */
static void worker_stop(py_worker *w, const opc_host *host) {
  enum { TIME = 100000 }; /* us, for writing the traceback */
  kill(w->pid, SIGUSR1);
  g_usleep(TIME);
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_WARNING, log);
  kill(w->pid, SIGKILL);
  (void)py_worker_end(w, 1);
}

/* Report an exception: {"message", "place", "parameter", "traceback"}. */
static int worker_raised(const opc_host *host, JsonObject *fault,
                         opc_error *error) {
  const char *parameter =
      json_object_get_string_member_with_default(fault, "parameter", NULL);
  const char *place =
      json_object_get_string_member_with_default(fault, "place", "");
  if (!parameter)
    worker_report(
        host, OPC_LOG_WARNING,
        json_object_get_string_member_with_default(fault, "traceback", ""));
  return opc_fail(error, parameter ? OPC_INVALID : OPC_FAILED,
                  parameter && *parameter ? parameter : NULL, "%s%s%s%s",
                  json_object_get_string_member_with_default(fault, "message",
                                                             "no message"),
                  *place ? " (" : "", place, *place ? ")" : "");
}

/* ---- messages ---- */

/* Send a text, with the descriptors in w->files. */
static int message_send(py_worker *w, const char *text, size_t size) {
  union {
    struct cmsghdr header;
    char space[CMSG_SPACE(MOST_FILES * sizeof(int))];
  } control = {.header = {.cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS}};
  while (size) {
    struct iovec part = {(void *)text, size};
    struct msghdr m = {.msg_iov = &part, .msg_iovlen = 1};
    size_t files = w->files->len * sizeof(int);
    if (files) {
      memcpy(CMSG_DATA(&control.header), w->files->data, files);
      control.header.cmsg_len = CMSG_LEN(files);
      m.msg_control = &control;
      m.msg_controllen = CMSG_SPACE(files);
    }
    ssize_t n = sendmsg(w->socket, &m, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    g_array_set_size(w->files, 0);
    text += n;
    size -= (size_t)n;
  }
  return 1;
}

static int object_send(py_worker *w, JsonObject *object) {
  JsonNode *node = json_node_init_object(json_node_alloc(), object);
  g_autofree char *text = json_to_string(node, FALSE);
  g_autofree char *line = g_strconcat(text, "\n", NULL);
  json_node_unref(node);
  return message_send(w, line, strlen(line));
}

/* Wait for the next line. Returns 1, 0 at the end of the process, or an error
   code below 0. */
static int message_wait(py_worker *w, const opc_host *host, gint64 deadline,
                        size_t *length) {
  enum { PERIOD = 50 }; /* ms between checks for cancellation */
  size_t seen = 0;
  for (;;) {
    const char *end = memchr(w->input->str + seen, '\n', w->input->len - seen);
    if (end) {
      *length = (size_t)(end - w->input->str);
      return 1;
    }
    seen = w->input->len;
    struct pollfd wait = {.fd = w->socket, .events = POLLIN};
    if (poll(&wait, 1, PERIOD) > 0) {
      char bytes[65536];
      ssize_t n = recv(w->socket, bytes, sizeof bytes, 0);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return 0;
      g_string_append_len(w->input, bytes, n);
    } else if (host && opc_cancelled(host->context)) {
      return -OPC_CANCELLED;
    } else if (g_get_monotonic_time() > deadline) {
      return -OPC_FAILED;
    }
  }
}

/* Receive one message as w->reply. */
static int message_receive(py_worker *w, const opc_host *host, double limit,
                           gint64 deadline, opc_error *error) {
  const char *call = json_object_get_string_member(w->request, "call");
  size_t length = 0;
  int got = message_wait(w, host, deadline, &length);
  if (!got) return worker_died(w, host, error);
  if (got < 0) {
    worker_stop(w, host);
    return got == -OPC_CANCELLED
               ? opc_fail(error, OPC_CANCELLED, NULL, "stopped in %s", call)
               : opc_fail(error, OPC_FAILED, NULL,
                          "%s did not end within call_limit, %g s", call,
                          limit);
  }
  g_autoptr(GError) fault = NULL;
  w->input->str[length] = 0;
  if (w->reply) json_node_unref(w->reply);
  w->reply = json_from_string(w->input->str, &fault);
  g_string_erase(w->input, 0, (gssize)length + 1);
  if (w->reply && JSON_NODE_HOLDS_OBJECT(w->reply)) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL, "%s returned no JSON object", call);
}

/* ---- a call ---- */

/* Answer messages of the worker until the reply. */
static int call_exchange(py_worker *w, const opc_host *host, double limit,
                         gint64 deadline, py_answer *answer, opc_error *error) {
  for (;;) {
    int code = message_receive(w, host, limit, deadline, error);
    if (code) return code;
    JsonObject *o = py_reply(w);
    const char *what =
        json_object_get_string_member_with_default(o, "ask", NULL);
    if (!what) return OPC_OK;
    opc_error fault = {0};
    const char *text = NULL;
    JsonObject *back = json_object_new();
    if (answer && answer(host, what, o, &text, &fault))
      json_object_set_string_member(back, "error", fault.message);
    json_object_set_string_member(back, "answer", text);
    int sent = object_send(w, back);
    json_object_unref(back);
    if (!sent) return worker_died(w, host, error);
  }
}

/* Map memory that the worker enlarged for new arrays. */
static void call_remap(py_worker *w) {
  struct stat about;
  if (w->memory >= 0 && !fstat(w->memory, &about) &&
      (size_t)about.st_size > w->size)
    memory_map(w, (size_t)about.st_size);
}

int py_call(py_worker *w, const opc_host *host, double limit, py_answer *answer,
            opc_error *error) {
  double patience = limit + (w->reply ? 0 : start_limit);
  gint64 deadline = g_get_monotonic_time() + (gint64)(patience * 1e6);
  if (!w->pid)
    return opc_fail(error, OPC_FAILED, NULL, "the Python process has ended");
  if (w->host != getpid())
    return opc_fail(error, OPC_FAILED, NULL,
                    "the Python process belongs to another process");
  memory_reserve(w, 1);
  file_send(w, 0, w->memory);
  json_object_set_int_member(w->request, "size", (gint64)w->size);
  json_object_set_int_member(w->request, "used", (gint64)w->used);
  int code = object_send(w, w->request)
                 ? call_exchange(w, host, limit, deadline, answer, error)
                 : worker_died(w, host, error);
  if (code) return code;
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_INFO, log);
  JsonObject *o = py_reply(w);
  arrays_leave(w);
  call_remap(w);
  return json_object_has_member(o, "error")
             ? worker_raised(host, json_object_get_object_member(o, "error"),
                             error)
             : OPC_OK;
}

JsonObject *py_reply(const py_worker *w) {
  return json_node_get_object(w->reply);
}

JsonObject *py_result(const py_worker *w) {
  return json_object_get_object_member(py_reply(w), "values");
}
