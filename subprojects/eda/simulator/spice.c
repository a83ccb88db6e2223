/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the helper program for a deck. The records of the program are read while
   it runs, so that all records before a crash are available. */
#include <eda/memory.h>
#include <eda/simulator.h>

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "simulator/deck.h"
#include "simulator/paths.h"
#include "simulator/record.h"

enum { MOST_SAID = 200 };
static const uint64_t most_bytes = UINT64_C(1) << 31;
static const double patience =
    0.05; /* interval of checks for cancellation, s */

/* ---- answer ---- */

typedef struct reading {
  const opc_context *context;
  eda_spice_result *out;
  char *data; /* unprocessed records */
  size_t used, capacity;
  uint64_t taken;
  GString *words;
  char *trouble, *command, *state; /* `state`: latest point of `command` */
  int missing, no_osdi, done;
} reading;

static char *text_of(const char *data, size_t bytes) {
  return g_strndup(data, bytes);
}

static void take_plot(eda_spice_result *out, const char *name, size_t bytes) {
  eda_grow(&out->plot, &out->capacity, out->count + 1, sizeof *out->plot);
  out->plot[out->count++] = (eda_spice_plot){.name = text_of(name, bytes)};
}

static void take_name(eda_spice_plot *plot, const char *name, size_t bytes) {
  eda_grow(&plot->vector, &plot->capacity, plot->count + 1,
           sizeof *plot->vector);
  plot->vector[plot->count++] =
      (eda_spice_vector){.name = text_of(name, bytes)};
}

static void take_values(eda_spice_vector *v, const char *data, size_t bytes) {
  g_free(v->value);
  v->value = eda_alloc(bytes, 1);
  v->count = bytes / sizeof(double);
  memcpy(v->value, data, bytes);
}

static void take_record(reading *r, record head, const char *data) {
  size_t bytes = (size_t)head.bytes;
  eda_spice_result *out = r->out;
  eda_spice_plot *plot = out->count ? &out->plot[out->count - 1] : NULL;
  if (head.kind == WORDS) {
    g_string_append_len(r->words, data, (gssize)bytes);
    g_string_append_c(r->words, '\n');
  } else if (head.kind == PLOT) {
    take_plot(out, data, bytes);
  } else if (head.kind == NAME) {
    if (plot) take_name(plot, data, bytes);
  } else if (head.kind == VALUES) {
    if (plot && plot->count)
      take_values(&plot->vector[plot->count - 1], data, bytes);
  } else if (head.kind == COMMAND) {
    g_free(r->command);
    r->command = text_of(data, bytes);
    g_clear_pointer(&r->state, g_free);
  } else if (head.kind == STATE) {
    g_free(r->state);
    r->state = text_of(data, bytes);
  } else if (head.kind == DONE) {
    r->done = 1;
  } else {
    r->missing = head.kind == MISSING;
    r->no_osdi = head.kind == NO_OSDI;
    g_free(r->trouble);
    r->trouble = text_of(data, bytes);
  }
}

/* Process all complete records in `data`. */
static void take_records(reading *r) {
  size_t at = 0;
  record head;
  while (r->used - at >= sizeof head) {
    memcpy(&head, r->data + at, sizeof head);
    if (head.bytes > r->used - at - sizeof head) break;
    take_record(r, head, r->data + at + sizeof head);
    at += sizeof head + (size_t)head.bytes;
  }
  memmove(r->data, r->data + at, r->used - at);
  r->used -= at;
}

/* Read available data. Return 1 after data, 0 at the end, or -1 and *error if
   the answer exceeds most_bytes. */
static int read_some(reading *r, int in, opc_error *error) {
  enum { PIECE = 1 << 16 };
  eda_grow(&r->data, &r->capacity, r->used + PIECE, 1);
  ssize_t n = read(in, r->data + r->used, r->capacity - r->used);
  if (n < 0 && errno == EINTR) return 1;
  if (n <= 0) return 0;
  r->used += (size_t)n;
  r->taken += (uint64_t)n;
  if (r->taken > most_bytes) {
    opc_fail(error, OPC_FAILED, NULL,
             "'ngspice' returned more than %llu MB of values",
             (unsigned long long)(most_bytes >> 20));
    return -1;
  }
  take_records(r);
  return 1;
}

/* Read until the program closes its output, `limit` seconds have passed, or the
   run is cancelled. */
static int listen_to(reading *r, int in, double limit, opc_error *error) {
  gint64 start = g_get_monotonic_time();
  struct pollfd wait = {.fd = in, .events = POLLIN};
  for (;;) {
    if (opc_cancelled(r->context))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if ((double)(g_get_monotonic_time() - start) > limit * G_USEC_PER_SEC)
      return opc_fail(error, OPC_FAILED, NULL,
                      "'ngspice' did not finish within %g s: %s%.80s%s %.150s",
                      limit, r->command ? "'" : "",
                      r->command ? r->command : "it reads the deck",
                      r->command ? "' is" : "",
                      r->state     ? r->state
                      : r->command ? "at its beginning"
                                   : "");
    if (poll(&wait, 1, (int)(1000 * patience)) <= 0) continue;
    int more = read_some(r, in, error);
    if (more < 0) return error->code;
    if (!more) return OPC_OK;
  }
}

/* Return the last printed text on one line (g_free). */
static char *last_words(const GString *words) {
  if (!words->len) return g_strdup("nothing");
  gsize n = MIN(words->len, MOST_SAID);
  return g_strdelimit(g_strchomp(g_strdup(words->str + words->len - n)), "\n",
                      ' ');
}

static int osdi_refuse(const reading *r, opc_error *error) {
  const char *version = strstr(r->words->str, "ngspice-");
  return opc_fail(error, OPC_NO_PLUGIN, NULL,
                  "the library of '%.*s' cannot load compiled models (OSDI): "
                  "install version 44 or later (Debian 13, or Debian 12 "
                  "backports), or name another library in OPCFLOW_NGSPICE",
                  version ? (int)strcspn(version, " \n") : 7,
                  version ? version : "ngspice");
}

static int child_judge(const reading *r, GSubprocess *child, opc_error *error) {
  if (r->missing)
    return opc_fail(error, OPC_NO_PLUGIN, NULL,
                    "the library of ngspice is not installed (Debian "
                    "package 'libngspice0'): %s",
                    r->trouble);
  if (r->no_osdi) return osdi_refuse(r, error);
  if (r->trouble)
    return opc_fail(error, OPC_FAILED, NULL, "'ngspice' failed: %s",
                    r->trouble);
  if (r->done) return OPC_OK;
  g_autofree char *output = last_words(r->words);
  if (g_subprocess_get_if_signaled(child) &&
      g_subprocess_get_term_sig(child) == SIGSYS)
    return opc_fail(error, OPC_FAILED, NULL,
                    "'ngspice' was stopped, because the simulation tried to "
                    "start a program or to write a file; last message: %s",
                    output);
  if (g_subprocess_get_if_signaled(child))
    return opc_fail(error, OPC_FAILED, NULL,
                    "'ngspice' crashed (%s); last message: %s",
                    strsignal(g_subprocess_get_term_sig(child)), output);
  return opc_fail(error, OPC_FAILED, NULL,
                  "'ngspice' ended with status %d; last message: %s",
                  g_subprocess_get_exit_status(child), output);
}

/* ---- the process ---- */

/* Return the path of the helper program (g_free): that of the environment
   variable OPCFLOW_SIMULATOR if it is set. Otherwise, if this library is in a
   library folder, return the path in the same installation. Otherwise return
   the program of the build folder, or that of the installation prefix. */
static char *find_program(void) {
  const char *own = g_getenv("OPCFLOW_SIMULATOR");
  Dl_info here;
  if (own) return g_strdup(own);
  if (dladdr((void *)(uintptr_t)&eda_spice_run, &here) && here.dli_fname) {
    g_autofree char *path = g_canonicalize_filename(here.dli_fname, NULL);
    g_autofree char *folder = g_path_get_dirname(path);
    if (g_str_has_suffix(folder, "/" EDA_LIBDIR)) {
      folder[strlen(folder) - strlen("/" EDA_LIBDIR)] = 0;
      return g_build_filename(*folder ? folder : "/", EDA_SIMULATOR, NULL);
    }
  }
  int built = g_file_test(EDA_SIMULATOR_BUILT, G_FILE_TEST_EXISTS);
  return g_strdup(built ? EDA_SIMULATOR_BUILT : EDA_SIMULATOR_INSTALLED);
}

/* Return a memory file with deck and commands. Unlike a pipe, the file neither
   blocks nor raises SIGPIPE if the program is slow or ends. */
static int open_request(const char *deck, const char *commands,
                        opc_error *error) {
  int file = memfd_create("deck", MFD_CLOEXEC);
  FILE *out = file < 0 ? NULL : fdopen(dup(file), "wb");
  int good = out && fwrite(deck, 1, strlen(deck) + 1, out) > strlen(deck) &&
             fputs(commands, out) >= 0;
  if (out && fclose(out)) good = 0;
  if (good && !lseek(file, 0, SEEK_SET)) return file;
  opc_fail(error, OPC_FAILED, NULL, "cannot send the deck: %s",
           g_strerror(errno));
  if (file >= 0) close(file);
  return -1;
}

/* Start the helper program. Write the descriptor of its output to *answer. */
static GSubprocess *helper_start(const char *deck, const char *osdi,
                                 const char *commands, double limit,
                                 int *answer, opc_error *error) {
  g_autofree char *program = find_program();
  g_autofree char *seconds = g_strdup_printf("%.0f", ceil(limit) + 1);
  g_autofree char *parent = g_strdup_printf("%ld", (long)getpid());
  g_autoptr(GError) why = NULL;
  if (!g_file_test(program, G_FILE_TEST_IS_EXECUTABLE)) {
    opc_fail(error, OPC_NO_PLUGIN, NULL,
             "the program that loads ngspice is not installed: '%s'", program);
    return NULL;
  }
  int ends[2], request = open_request(deck, commands, error);
  if (request < 0) return NULL;
  if (pipe2(ends, O_CLOEXEC)) {
    opc_fail(error, OPC_FAILED, NULL, "cannot create a pipe: %s",
             g_strerror(errno));
    close(request);
    return NULL;
  }
  /* The helper program closes inherited descriptors, so GLib can spawn without
     fork. */
  g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(
      G_SUBPROCESS_FLAGS_INHERIT_FDS | G_SUBPROCESS_FLAGS_STDERR_SILENCE);
  g_subprocess_launcher_take_stdin_fd(launcher, request);
  g_subprocess_launcher_take_stdout_fd(launcher, ends[1]);
  GSubprocess *child = g_subprocess_launcher_spawn(launcher, &why, program,
                                                   seconds, parent, osdi, NULL);
  if (child) {
    *answer = ends[0];
    return child;
  }
  close(ends[0]);
  opc_fail(error, OPC_FAILED, NULL, "cannot start a process: %s", why->message);
  return NULL;
}

static int helper_run(const opc_context *context, const char *deck,
                      const char *osdi, const char *commands, double limit,
                      eda_spice_result *out, opc_error *error) {
  int answer;
  g_autoptr(GSubprocess) child =
      helper_start(deck, osdi, commands, limit, &answer, error);
  if (!child) return error->code;
  reading r = {.context = context, .out = out, .words = g_string_new(NULL)};
  int code = listen_to(&r, answer, limit, error);
  close(answer);
  g_subprocess_force_exit(child);
  g_subprocess_wait(child, NULL, NULL);
  if (!code) code = child_judge(&r, child, error);
  out->words = g_string_free(r.words, FALSE);
  free(r.data);
  g_free(r.trouble);
  g_free(r.command);
  g_free(r.state);
  return code;
}

int eda_spice_run(const opc_context *context, const char *deck,
                  const char *commands, double limit, eda_spice_result *out,
                  opc_error *error) {
  *out = (eda_spice_result){0};
  char *osdi, *harmless = deck_write(deck, &osdi, error);
  if (!harmless) return error->code;
  int code = helper_run(context, harmless, osdi, commands, limit, out, error);
  free(harmless);
  g_free(osdi);
  return code;
}

void eda_spice_clear(eda_spice_result *result) {
  for (size_t i = 0; i < result->count; i++) {
    eda_spice_plot *p = &result->plot[i];
    for (size_t j = 0; j < p->count; j++) {
      free(p->vector[j].name);
      free(p->vector[j].value);
    }
    free(p->name);
    free(p->vector);
  }
  free(result->plot);
  free(result->words);
  *result = (eda_spice_result){0};
}

const eda_spice_vector *eda_spice_vector_find(const eda_spice_plot *plot,
                                              const char *name) {
  for (size_t i = 0; i < plot->count; i++)
    if (!strcmp(plot->vector[i].name, name)) return &plot->vector[i];
  return NULL;
}

int eda_spice_is_name(const char *text) {
  return *text && strspn(text,
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_.-") == strlen(text);
}
