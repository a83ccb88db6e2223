/* SPDX-License-Identifier: BSD-3-Clause */
/* Requests to a worker, the Python process of a plugin: arrays in shared
   memory, and the exchange of messages. Reports of exceptions, of ended
   processes and of calls that do not end. */
#include <eda/memory.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "py.h"

/* Time for the start of the process, added to the limit of the first call, s:
   the import of NumPy takes 0.1 s, of PyTorch several seconds. */
static const double start_limit = 60;

enum {
  MOST_FILES = 253
}; /* descriptors in a message: the limit of Linux;
      blocks of eda_alloc_shared are fewer */

/* ---- members ---- */

static JsonNode *member(JsonObject *o, const char *name, JsonNodeType type) {
  JsonNode *node = o ? json_object_get_member(o, name) : NULL;
  return node && JSON_NODE_TYPE(node) == type ? node : NULL;
}

const char *py_text(JsonObject *o, const char *name) {
  JsonNode *node = member(o, name, JSON_NODE_VALUE);
  return node ? json_node_get_string(node) : NULL;
}

double py_number(JsonObject *o, const char *name) {
  JsonNode *node = member(o, name, JSON_NODE_VALUE);
  return !node ? 0
         : json_node_get_value_type(node) == G_TYPE_BOOLEAN
             ? json_node_get_boolean(node)
             : json_node_get_double(node);
}

JsonArray *py_list(JsonObject *o, const char *name) {
  if (!member(o, name, JSON_NODE_ARRAY))
    json_object_set_array_member(o, name, json_array_new());
  return json_object_get_array_member(o, name);
}

JsonObject *py_member(JsonObject *o, const char *name) {
  JsonNode *node = member(o, name, JSON_NODE_OBJECT);
  return node ? json_node_get_object(node) : NULL;
}

/* ---- requests ---- */

static void quote(GString *s, const char *text) {
  g_string_append_c(s, '"');
  for (; *text; text++)
    if ((unsigned char)*text < ' ' || *text == '"' || *text == '\\')
      g_string_append_printf(s, "\\u%04x", (unsigned)*text);
    else
      g_string_append_c(s, *text);
  g_string_append_c(s, '"');
}

void py_put(py_worker *w, const char *name, const char *json) {
  if (name) quote(w->request, name);
  if (name) g_string_append_c(w->request, ':');
  g_string_append(w->request, json);
  g_string_append_c(w->request, ',');
}

void py_begin(py_worker *w, const char *name, char bracket) {
  py_put(w, name, (char[]){bracket, 0});
  g_string_truncate(w->request, w->request->len - 1); /* the comma */
}

void py_end(py_worker *w, char bracket) {
  if (w->request->str[w->request->len - 1] == ',')
    g_string_truncate(w->request, w->request->len - 1);
  g_string_append_c(w->request, bracket);
  g_string_append_c(w->request, ',');
}

void py_put_int(py_worker *w, const char *name, int64_t value) {
  char text[32];
  g_snprintf(text, sizeof text, "%" G_GINT64_FORMAT, value);
  py_put(w, name, text);
}

void py_put_number(py_worker *w, const char *name, double value) {
  char text[G_ASCII_DTOSTR_BUF_SIZE + 2];
  g_ascii_dtostr(text, G_ASCII_DTOSTR_BUF_SIZE, value);
  /* Without a point, Python would read an integer. */
  if (!strpbrk(text, ".e")) strcat(text, ".0");
  py_put(w, name, value - value == 0 ? text : "null");
}

void py_put_text(py_worker *w, const char *name, const char *text) {
  g_autoptr(GString) quoted = g_string_new(NULL);
  if (text) quote(quoted, text);
  py_put(w, name, text ? quoted->str : "null");
}

/* ---- shared memory ---- */

/* Map `size` bytes of the worker's memory (py_worker.memory), which this
   process and the worker share. */
static void memory_map(py_worker *w, size_t size) {
  if (w->base) munmap(w->base, w->size);
  w->size = size;
  void *base =
      mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, w->memory, 0);
  if (base == MAP_FAILED) g_error("cannot map %zu bytes", size);
  w->base = base;
}

/* Make space for `size` bytes in total. */
static void memory_reserve(py_worker *w, size_t size) {
  enum { LEAST = 1 << 20 };
  if (w->memory < 0) w->memory = memfd_create("opcflow-arrays", MFD_CLOEXEC);
  if (size <= w->size) return;
  size_t grown = MAX(MAX(size, 2 * w->size), LEAST);
  if (w->memory < 0 || ftruncate(w->memory, (off_t)grown))
    g_error("cannot reserve %zu bytes of shared memory", grown);
  memory_map(w, grown);
}

/* Keep the contents of arrays that the Python code still uses after a call. A
   block of eda_alloc_shared is moved to a new file, so that later changes by
   the owner do not reach the worker. If such an array is in py_worker.memory,
   the next request uses new memory. */
static void arrays_leave(py_worker *w) {
  JsonArray *kept = py_list(json_node_get_object(w->reply), "kept");
  for (guint i = 0; i < json_array_get_length(kept); i++) {
    uint64_t id = (uint64_t)json_array_get_int_element(kept, i);
    if (id && !eda_shared_renew(id) && eda_shared_exists(id))
      g_error("no memory for a copy of an array");
    if (!id) w->is_kept = 1;
  }
}

static void memory_leave(py_worker *w) {
  munmap(w->base, w->size);
  close(w->memory);
  w->base = NULL;
  w->memory = -1;
  w->size = 0;
  w->is_kept = 0;
}

/* Let the worker map a file. */
static void file_use(py_worker *w, uint64_t id, int file) {
  for (guint i = 0; i < w->files->len; i++)
    if (g_array_index(w->files, py_file, i).id == id) return;
  g_array_append_val(w->files, ((py_file){id, file}));
}

/* Let the worker close the files that exist no more: blocks that were freed or
   renewed, and memory in which the worker keeps arrays. */
static void files_drop(py_worker *w) {
  py_begin(w, "drop", '[');
  for (guint i = w->files->len; i-- > 0;) {
    uint64_t id = g_array_index(w->files, py_file, i).id;
    if (id ? eda_shared_exists(id) : w->memory >= 0) continue;
    py_put_int(w, NULL, (int64_t)id);
    g_array_remove_index(w->files, i);
  }
  py_end(w, ']');
  w->sent = w->files->len;
}

void py_request(py_worker *w, const char *call) {
  if (w->is_kept) memory_leave(w);
  w->call = call;
  w->used = 0;
  g_array_set_size(w->lent, 0);
  g_string_assign(w->request, "{");
  py_put_text(w, "call", call);
  files_drop(w);
  py_begin(w, "values", '{');
}

static size_t type_size(const char *type) { return (size_t)(type[1] - '0'); }

/* Add an array; `to` is NULL, or the array that receives the changes. */
static void array_add(py_worker *w, const char *name, const char *type,
                      size_t count, size_t width, const void *data, void *to) {
  enum { ALIGN = 64 };
  size_t bytes = count * MAX(width, 1) * type_size(type);
  eda_shared place = {.offset = (w->used + ALIGN - 1) / ALIGN * ALIGN};
  py_loan loan = {to, place.offset, bytes};
  if (bytes && !data) {
    py_put(w, name, "null");
    return;
  }
  if (bytes >= EDA_SHARED && eda_shared_find(data, bytes, &place)) {
    file_use(w, place.id, place.file);
  } else {
    place = (eda_shared){.offset = loan.at};
    w->used = loan.at + bytes;
    memory_reserve(w, w->used);
    if (bytes) memcpy(w->base + loan.at, data, bytes);
    if (bytes && to) g_array_append_val(w->lent, loan);
  }
  py_begin(w, name, '{');
  py_begin(w, "array", '[');
  py_put_text(w, NULL, type);
  py_put_int(w, NULL, (int64_t)place.offset);
  py_put_int(w, NULL, (int64_t)count);
  py_put_int(w, NULL, (int64_t)width);
  py_put_int(w, NULL, (int64_t)place.id);
  py_put(w, NULL, to ? "true" : "false");
  py_end(w, ']');
  py_end(w, '}');
}

void py_put_array(py_worker *w, const char *name, const char *type,
                  size_t count, size_t width, const void *data) {
  array_add(w, name, type, count, width, data, NULL);
}

void py_lend_array(py_worker *w, const char *name, const char *type,
                   size_t count, size_t width, void *data) {
  array_add(w, name, type, count, width, data, data);
}

const void *py_new_array(const py_worker *w, const char *name, const char *type,
                         size_t *count) {
  JsonObject *o = py_member(py_result(w), name);
  JsonArray *about = o ? py_list(o, "array") : NULL;
  *count = 0;
  if (!about || strcmp(json_array_get_string_element(about, 0), type))
    return NULL;
  size_t at = (size_t)json_array_get_int_element(about, 1);
  *count = (size_t)json_array_get_int_element(about, 2);
  return at + *count * type_size(type) <= w->size ? w->base + at : NULL;
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
  int status = py_worker_end(w, 1);
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_WARNING, log);
  g_autofree char *how =
      WIFSIGNALED(status)
          ? g_strdup_printf("ended by signal %d (%s)", WTERMSIG(status),
                            g_strsignal(WTERMSIG(status)))
          : g_strdup_printf("exited with status %d", WEXITSTATUS(status));
  return opc_fail(error, OPC_FAILED, NULL, "the Python process %s in %s%s%s",
                  how, w->call, *log ? ": " : "", last_line(log));
}

static off_t log_size(const py_worker *w) {
  struct stat about;
  return fstat(w->log, &about) ? 0 : about.st_size;
}

/* Stop a call that does not end: write the traceback to the log, then kill the
   process. The traceback is complete when the log has grown and does not change
   for a period. */
static void worker_stop(py_worker *w, const opc_host *host) {
  enum { PERIOD = 100000, MOST = 30 }; /* us; periods */
  off_t begin = log_size(w), before;
  int n = 0;
  kill(w->pid, SIGUSR1);
  do {
    before = log_size(w);
    g_usleep(PERIOD);
  } while (++n < MOST && (log_size(w) == begin || log_size(w) > before));
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_WARNING, log);
  kill(w->pid, SIGKILL);
  (void)py_worker_end(w, 1);
}

/* Report an exception: {"message", "place", "parameter", "traceback"}. */
static int worker_raised(const opc_host *host, JsonObject *fault,
                         opc_error *error) {
  const char *parameter = py_text(fault, "parameter");
  const char *place = py_text(fault, "place");
  if (!parameter)
    worker_report(host, OPC_LOG_WARNING, py_text(fault, "traceback"));
  return opc_fail(error, parameter ? OPC_INVALID : OPC_FAILED,
                  parameter && *parameter ? parameter : NULL, "%s%s%s%s",
                  py_text(fault, "message"), *place ? " (" : "", place,
                  *place ? ")" : "");
}

/* ---- messages ---- */

/* Send the request, with the descriptors of files that the worker lacks. */
static int message_send(py_worker *w) {
  union {
    struct cmsghdr header;
    char space[CMSG_SPACE(MOST_FILES * sizeof(int))];
  } control = {.header = {.cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS}};
  size_t files = (w->files->len - w->sent) * sizeof(int);
  for (guint i = w->sent; i < w->files->len; i++)
    memcpy(CMSG_DATA(&control.header) + (i - w->sent) * sizeof(int),
           &g_array_index(w->files, py_file, i).file, sizeof(int));
  control.header.cmsg_len = CMSG_LEN(files);
  for (size_t at = 0; at < w->request->len;) {
    struct iovec part = {w->request->str + at, w->request->len - at};
    struct msghdr m = {.msg_iov = &part, .msg_iovlen = 1};
    if (files) m.msg_control = &control;
    if (files) m.msg_controllen = CMSG_SPACE(files);
    ssize_t n = sendmsg(w->socket, &m, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    files = 0;
    at += (size_t)n;
  }
  w->sent = w->files->len;
  return 1;
}

/* End the JSON object of a message as a line, and send the line. */
static int object_send(py_worker *w) {
  py_end(w, '}');
  w->request->str[w->request->len - 1] = '\n'; /* in place of the comma */
  return message_send(w);
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
  size_t length = 0;
  int got = message_wait(w, host, deadline, &length);
  if (!got) return worker_died(w, host, error);
  if (got < 0) {
    worker_stop(w, host);
    return got == -OPC_CANCELLED
               ? opc_fail(error, OPC_CANCELLED, NULL, "stopped in %s", w->call)
               : opc_fail(error, OPC_FAILED, NULL,
                          "%s did not end within call_limit, %g s", w->call,
                          limit);
  }
  g_autoptr(GError) fault = NULL;
  w->input->str[length] = 0;
  if (w->reply) json_node_unref(w->reply);
  w->reply = json_from_string(w->input->str, &fault);
  g_string_erase(w->input, 0, (gssize)length + 1);
  if (w->reply && JSON_NODE_HOLDS_OBJECT(w->reply)) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL, "%s returned no JSON object",
                  w->call);
}

/* ---- a call ---- */

/* Answer messages of the worker until the reply. */
static int call_exchange(py_worker *w, const opc_host *host, double limit,
                         gint64 deadline, py_answer *answer, opc_error *error) {
  for (;;) {
    int code = message_receive(w, host, limit, deadline, error);
    if (code) return code;
    JsonObject *o = json_node_get_object(w->reply);
    const char *what = py_text(o, "ask"), *text = NULL;
    if (!what) return OPC_OK;
    opc_error fault = {0};
    g_string_assign(w->request, "{");
    if (answer && answer(host, what, o, &text, &fault))
      py_put_text(w, "error", fault.message);
    py_put_text(w, "answer", text);
    if (!object_send(w)) return worker_died(w, host, error);
  }
}

/* Complete the request: sizes, and numbers of the files that are sent. */
static int request_send(py_worker *w) {
  memory_reserve(w, 1);
  file_use(w, 0, w->memory);
  py_end(w, '}');
  py_put_int(w, "size", (int64_t)w->size);
  py_put_int(w, "used", (int64_t)w->used);
  py_begin(w, "files", '[');
  for (guint i = w->sent; i < w->files->len; i++)
    py_put_int(w, NULL, (int64_t)g_array_index(w->files, py_file, i).id);
  py_end(w, ']');
  return object_send(w);
}

/* Map memory that the worker enlarged for new arrays, and copy lent arrays
   back. */
static void arrays_take(py_worker *w) {
  struct stat about;
  if (!fstat(w->memory, &about) && (size_t)about.st_size > w->size)
    memory_map(w, (size_t)about.st_size);
  for (guint i = 0; i < w->lent->len; i++) {
    py_loan loan = g_array_index(w->lent, py_loan, i);
    memcpy(loan.to, w->base + loan.at, loan.bytes);
  }
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
  int code = request_send(w)
                 ? call_exchange(w, host, limit, deadline, answer, error)
                 : worker_died(w, host, error);
  if (code) return code;
  g_autofree char *log = py_worker_log(w);
  worker_report(host, OPC_LOG_INFO, log);
  JsonObject *fault = py_member(json_node_get_object(w->reply), "error");
  if (!fault) arrays_take(w);
  arrays_leave(w);
  return fault ? worker_raised(host, fault, error) : OPC_OK;
}

JsonObject *py_result(const py_worker *w) {
  return py_member(json_node_get_object(w->reply), "values");
}
