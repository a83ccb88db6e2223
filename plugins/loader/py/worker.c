/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts and ends the Python process. The process ends with its host: the
   process requests SIGIO (O_ASYNC), which ends the process when the host's end
   of a second socket closes. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "py.h"

extern char **environ;

/* ---- places ---- */

/* Folder of the package relative to the folder of this shared object: when
   installed, and in a build folder. */
static const char *const places[] = {"../python", "../subprojects/python"};

/* Return the path of start.py of the package (g_free); NULL and *error if there
   is none. */
static char *package_program(opc_error *error) {
  Dl_info about;
  if (!dladdr(places, &about) || !about.dli_fname) about.dli_fname = "";
  g_autofree char *folder = g_path_get_dirname(about.dli_fname);
  for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
    g_autofree char *file =
        g_build_filename(folder, places[i], "opcflow", "start.py", NULL);
    if (!g_file_test(file, G_FILE_TEST_EXISTS)) continue;
    return g_canonicalize_filename(file, NULL);
  }
  opc_fail(error, OPC_NO_PLUGIN, NULL,
           "the Python package opcflow is missing: expected '%s/%s/opcflow'",
           folder, places[0]);
  return NULL;
}

/* ---- the process ---- */

/* Return the environment of the process: unless set by the user, one thread for
   linear algebra and fixed hashes; no bytecode beside the plugin. */
static char **worker_environment(void) {
  char **list = g_strdupv(environ);
  static const char *const names[] = {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS",
                                      "MKL_NUM_THREADS"};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    list = g_environ_setenv(list, names[i], "1", FALSE);
  list = g_environ_setenv(list, "PYTHONHASHSEED", "0", FALSE);
  return g_environ_setenv(list, "PYTHONDONTWRITEBYTECODE", "1", TRUE);
}

/* Start the process with `talk` as descriptor 3, `life` as 4, the log as 1 and
   2. Return an error number of the C library; 0 on success. */
static int worker_spawn(py_worker *w, const char *const *argv, int talk,
                        int life) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  sigset_t none, all;
  g_auto(GStrv) environment = worker_environment();
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, w->log, 1);
  posix_spawn_file_actions_adddup2(&files, w->log, 2);
  posix_spawn_file_actions_adddup2(&files, talk, 3);
  posix_spawn_file_actions_adddup2(&files, life, 4);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0); /* Ctrl-C stops the host only */
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK |
                                            POSIX_SPAWN_SETSIGDEF |
                                            POSIX_SPAWN_SETPGROUP);
  int fault = posix_spawnp(&w->pid, argv[0], &files, &attributes,
                           (char *const *)argv, environment);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return fault;
}

/* Create a pair of sockets. The worker's end is above the descriptors that
   worker_spawn assigns. */
static int worker_pair(int *own, int *other) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) return -1;
  *own = ends[0];
  *other = fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
  close(ends[1]);
  return *other < 0 ? -1 : 0;
}

static void close_open(int descriptor) {
  if (descriptor >= 0) close(descriptor);
}

static py_worker *worker_run(py_worker *w, const char *package,
                             const char *path, const char *python,
                             opc_error *error) {
  g_autofree char *cache = py_cache_folder();
  if (!python) python = g_getenv("OPCFLOW_PYTHON");
  const char *const argv[] = {python && *python ? python : "python3",
                              "-u",
                              package,
                              cache ? cache : "",
                              path,
                              w->id,
                              NULL};
  int talk = -1, life = -1;
  int log = memfd_create("opcflow-log", MFD_CLOEXEC);
  w->log = fcntl(log, F_DUPFD_CLOEXEC, 10);
  close_open(log);
  int fault = w->log < 0 || worker_pair(&w->socket, &talk) ||
                      worker_pair(&w->alive, &life)
                  ? errno
                  : worker_spawn(w, argv, talk, life);
  close_open(talk);
  close_open(life);
  if (!fault) return w;
  w->pid = 0;
  opc_fail(error, OPC_NO_PLUGIN, NULL,
           "cannot start the Python interpreter '%s': %s (set OPCFLOW_PYTHON "
           "to another interpreter)",
           argv[0], g_strerror(fault));
  py_worker_free(w);
  return NULL;
}

py_worker *py_worker_start(const char *path, const char *id, const char *python,
                           opc_error *error) {
  g_autofree char *package = package_program(error);
  g_autofree char *whole = g_canonicalize_filename(path, NULL);
  if (!package) return NULL;
  py_worker *w = g_new0(py_worker, 1);
  w->id = g_strdup(id);
  w->host = getpid();
  w->socket = w->alive = w->log = w->memory = -1;
  w->input = g_string_new(NULL);
  w->request = g_string_new(NULL);
  w->files = g_array_new(FALSE, FALSE, sizeof(py_file));
  w->lent = g_array_new(FALSE, FALSE, sizeof(py_loan));
  return worker_run(w, package, whole, python, error);
}

/* Wait at most `seconds` for the end of the process. Return whether the process
   ended; *status as from waitpid. */
static gboolean worker_wait(py_worker *w, double seconds, int *status) {
  enum { STEP = 2000 }; /* us */
  for (gint64 us = 0;; us += STEP) {
    pid_t ended = waitpid(w->pid, status, WNOHANG);
    if (ended == w->pid) return TRUE;
    if ((double)us > seconds * 1e6) return FALSE;
    g_usleep(STEP);
  }
}

int py_worker_end(py_worker *w, double patience) {
  int status = 0;
  if (!w->pid || w->host != getpid()) return 0;
  if (!worker_wait(w, patience, &status)) {
    kill(w->pid, SIGKILL);
    while (waitpid(w->pid, &status, 0) < 0 && errno == EINTR) continue;
  }
  w->pid = 0;
  return status;
}

void py_worker_free(py_worker *w) {
  if (!w) return;
  if (w->pid && w->host == getpid()) kill(w->pid, SIGKILL);
  (void)py_worker_end(w, 0);
  close_open(w->socket);
  close_open(w->alive);
  close_open(w->log);
  close_open(w->memory);
  if (w->base) munmap(w->base, w->size);
  if (w->reply) json_node_unref(w->reply);
  g_string_free(w->input, TRUE);
  g_string_free(w->request, TRUE);
  g_array_free(w->files, TRUE);
  g_array_free(w->lent, TRUE);
  g_free(w->id);
  g_free(w);
}

/* ---- the log ---- */

char *py_worker_log(py_worker *w) {
  enum { MOST = 64 * 1024 };
  off_t size = lseek(w->log, 0, SEEK_END), from = MAX(0, size - MOST);
  char *text = g_malloc0((gsize)(size - from) + 1);
  ssize_t n = pread(w->log, text, (size_t)(size - from), from);
  text[MAX(n, 0)] = 0;
  /* The process shares the position in the file. */
  if (ftruncate(w->log, 0) == 0) lseek(w->log, 0, SEEK_SET);
  return g_strchomp(text);
}
