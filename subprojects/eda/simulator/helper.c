/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow-simulator SECONDS PARENT [OSDI]: runs one deck in ngspice. The
   library of ngspice keeps state in globals, calls exit() and prints. Therefore
   each deck runs in a separate process without rights (sandbox.h). record.h
   describes input and output. The program links few libraries, so that starting
   the program is fast. */
#include <stdbool.h> /* required by sharedspice.h */

#include "simulator/record.h"
#include "simulator/sandbox.h"

#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <gnu/lib-names.h>
#include <locale.h>
#include <math.h>
#include <ngspice/sharedspice.h>
#include <pwd.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { MOST_TROUBLE = 600 };

/* ---- output records ---- */

/* State of the only circuit of this process; callbacks of ngspice have no
   context argument. */
static FILE *answer;
static char trouble[MOST_TROUBLE];

static void send_head(int kind, size_t bytes) {
  const record r = {(uint64_t)kind, bytes};
  fwrite(&r, sizeof r, 1, answer);
}

/* Write a record and flush the stream, so that a crash loses no record. */
static void send_record(int kind, const void *data, size_t bytes) {
  send_head(kind, bytes);
  fwrite(data, 1, bytes, answer);
  if (fflush(answer)) _exit(1);
}

static void send_text(int kind, const char *text) {
  send_record(kind, text, strlen(text));
}

_Noreturn static void end_with(int kind, const char *what) {
  send_text(kind, what);
  _exit(0);
}

__attribute__((format(printf, 1, 2))) static char *text_of(const char *format,
                                                           ...) {
  char *text;
  va_list args;
  va_start(args, format);
  if (vasprintf(&text, format, args) < 0) end_with(TROUBLE, "out of memory");
  va_end(args);
  return text;
}

/* ---- output of ngspice ---- */

/* Return whether a line printed by ngspice reports a failure; functions of
   ngspice return no error codes. */
static int is_trouble(const char *line) {
  return !strncasecmp(line, "error", 5) || !strncasecmp(line, "fatal", 5) ||
         !strncmp(line, "doAnalyses:", 11) || strstr(line, " aborted") ||
         strstr(line, "no such command") || strstr(line, " failed!") ||
         strstr(line, "Undefined parameter") ||
         strstr(line, "is not available or has zero length");
}

static int on_words(char *text, int id, void *user) {
  (void)id, (void)user;
  int spoken = !strncmp(text, "stderr ", 7);
  const char *line = spoken || !strncmp(text, "stdout ", 7) ? text + 7 : text;
  send_text(WORDS, line);
  while (*line == ' ') line++;
  size_t used = strlen(trouble);
  if (spoken && *line && (used || is_trouble(line)))
    snprintf(trouble + used, sizeof trouble - used, "%s%s", used ? "; " : "",
             line);
  return 0;
}

/* Return a text (free()) such as "at 1e-09, in steps of 1e-12; 'y' changes
   most" about the latest point. `old` has the values of the preceding point and
   receives the new values. */
static char *state_of(const vecvaluesall *v, double *old) {
  double at = 0, step = 0, most = 0;
  const char *name = NULL;
  for (int i = 0; i < v->veccount; i++) {
    const vecvalues *one = v->vecsa[i];
    double change = fabs(one->creal - old[i]);
    old[i] = one->creal;
    if (one->is_scale) {
      at = one->creal;
      step = change;
    } else if (change > most) {
      most = change;
      name = one->name;
    }
  }
  return text_of("at %.6g, in steps of %.3g%s%.60s%s", at, step,
                 name ? "; '" : "", name ? name : "",
                 name ? "' changes most" : "");
}

/* ngspice calls on_values only if this callback exists. */
static int on_vectors(pvecinfoall v, int id, void *user) {
  (void)v, (void)id, (void)user;
  return 0;
}

/* Send the point that an analysis has reached, at most ten times a second. */
static int on_values(pvecvaluesall v, int count, int id, void *user) {
  static double *old;
  static int capacity;
  static struct timespec last;
  struct timespec now;
  (void)count, (void)id, (void)user;
  if (v->veccount > capacity) {
    old = realloc(old, (size_t)v->veccount * sizeof *old);
    if (!old) end_with(TROUBLE, "out of memory");
    memset(old + capacity, 0, (size_t)(v->veccount - capacity) * sizeof *old);
    capacity = v->veccount;
  }
  clock_gettime(CLOCK_MONOTONIC, &now);
  double seconds = (double)(now.tv_sec - last.tv_sec) +
                   1e-9 * (double)(now.tv_nsec - last.tv_nsec);
  if (seconds > 0.1) {
    char *text = state_of(v, old);
    send_text(STATE, text);
    free(text);
    last = now;
  } else {
    for (int i = 0; i < v->veccount; i++) old[i] = v->vecsa[i]->creal;
  }
  return 0;
}

static int on_exit_request(int status, NG_BOOL at_once, NG_BOOL quit, int id,
                           void *user) {
  (void)at_once, (void)id, (void)user;
  char text[MOST_TROUBLE + 64];
  snprintf(text, sizeof text, "%s with status %d%s%s",
           quit ? "ngspice ended by a quit command" : "ngspice ended", status,
           *trouble ? ": " : "", trouble);
  end_with(TROUBLE, text);
}

static int on_thread(NG_BOOL idle, int id, void *user) {
  (void)idle, (void)id, (void)user;
  return 0;
}

static void trouble_check(const char *command) {
  char text[MOST_TROUBLE + 128];
  if (!*trouble) return;
  if (command)
    snprintf(text, sizeof text, "'%.100s': %s", command, trouble);
  else
    snprintf(text, sizeof text, "in the deck: %s", trouble);
  end_with(TROUBLE, text);
}

/* ---- the process ---- */

static void reset_signals(void) {
  sigset_t none;
  for (int i = 1; i < NSIG; i++) signal(i, SIG_DFL);
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
}

static void limit_to(int resource, rlim_t most) {
  const struct rlimit limit = {most, most};
  setrlimit(resource, &limit);
}

/* Limit this process: the kernel ends the process with the thread that started
   it, and after SECONDS of processor time. The process has its own process
   group, so that Ctrl-C reaches only the parent. */
static void process_limit(const char *seconds, const char *parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != (pid_t)atol(parent)) _exit(1);
  limit_to(RLIMIT_CPU, (rlim_t)atol(seconds));
  limit_to(RLIMIT_CORE, 0);
  reset_signals();
}

/* Return standard input up to the next zero byte or the end. */
static char *read_text(void) {
  char *text = NULL;
  size_t capacity = 0;
  return getdelim(&text, &capacity, 0, stdin) < 0 ? text_of("%s", "") : text;
}

/* Move standard output to descriptor 3 for the records. Close all other
   inherited files. Open /dev/null as descriptors 0, 1 and 2 for ngspice. */
static void stand_alone(void) {
  int out = dup(1);
  if (out != 3) dup2(out, 3);
  closefrom(4);
  fcntl(3, F_SETFD, FD_CLOEXEC);
  answer = fdopen(3, "wb");
  if (!answer) _exit(1);
  int nothing = open("/dev/null", O_RDWR);
  for (int i = 0; i < 3; i++) dup2(nothing, i);
  close(nothing);
  setenv("OMP_NUM_THREADS", "1", 1);
  setlocale(LC_ALL, "C");
}

static int open_osdi(const char *path) {
  int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file >= 0) return file;
  end_with(TROUBLE, text_of("cannot read '%s': %s", path, strerror(errno)));
}

/* Clear the environment and enter the sandbox, so that ngspice opens no file
   other than `osdi`, not even its start-up files. */
static void lock_in(int osdi) {
  clearenv();
  const char *open = sandbox_enter(osdi);
  if (!open) return;
  char *text =
      text_of("the sandbox cannot be set up: %s: %s", open, strerror(errno));
  end_with(TROUBLE, text);
}

/* ---- ngspice ---- */

/* Replacements of C library functions for ngspice (also if the compiler calls
   fopen64). Models write logs and read parameter files in the current folder.
   The replacement of fopen discards written data, and fails for reading. */
#define FOR_NGSPICE __attribute__((visibility("default")))

FOR_NGSPICE FILE *open_nothing(const char *path,
                               const char *mode) __asm__("fopen");
FOR_NGSPICE FILE *open_nothing(const char *path, const char *mode) {
  (void)path;
  if (*mode != 'r') return fopencookie(NULL, "w", (cookie_io_functions_t){0});
  errno = EACCES;
  return NULL;
}

FOR_NGSPICE struct passwd *getpwuid(uid_t user) {
  static char nobody[] = "nobody", nowhere[] = "/";
  static struct passwd entry = {.pw_name = nobody, .pw_dir = nowhere};
  entry.pw_uid = user;
  return &entry;
}

typedef struct library {
  int (*init)(SendChar *, SendStat *, ControlledExit *, SendData *,
              SendInitData *, BGThreadRunning *, void *);
  int (*circuit)(char **);
  int (*command)(char *);
  char **(*plots)(void);
  char **(*vectors)(char *);
  pvector_info (*vector)(char *);
} library;

static void *library_symbol(void *handle, const char *name) {
  void *found = dlsym(handle, name);
  if (!found) end_with(MISSING, dlerror());
  return found;
}

static library library_load(void) {
  const char *own = getenv("OPCFLOW_NGSPICE");
  /* Compiled models require libm. */
  dlopen(LIBM_SO, RTLD_NOW | RTLD_GLOBAL);
  void *handle = dlopen(own ? own : "libngspice.so.0", RTLD_NOW | RTLD_LOCAL);
  if (!handle) end_with(MISSING, dlerror());
  library l;
  *(void **)&l.init = library_symbol(handle, "ngSpice_Init");
  *(void **)&l.circuit = library_symbol(handle, "ngSpice_Circ");
  *(void **)&l.command = library_symbol(handle, "ngSpice_Command");
  *(void **)&l.plots = library_symbol(handle, "ngSpice_AllPlots");
  *(void **)&l.vectors = library_symbol(handle, "ngSpice_AllVecs");
  *(void **)&l.vector = library_symbol(handle, "ngGet_Vec_Info");
  return l;
}

/* Split a text into lines in place. Return a NULL-terminated list. */
static char **lines_of(char *text) {
  size_t n = 0, most = 2;
  for (const char *c = text; *c; c++) most += *c == '\n';
  char **lines = calloc(most, sizeof *lines);
  if (!lines) end_with(TROUBLE, "out of memory");
  while (text && (*text || !n)) {
    char *line = lines[n++] = strsep(&text, "\n");
    line[strcspn(line, "\r")] = 0;
  }
  return lines;
}

static size_t length_of(char **list) {
  size_t n = 0;
  while (list && list[n]) n++;
  return n;
}

/* Send a name as in the netlist: "v(out)" for the ngspice vector "out",
   "i(vdd)" for "vdd#branch". */
static void send_name(const char *name, int voltage) {
  size_t n = strlen(name);
  int branch = n > 7 && !strcmp(name + n - 7, "#branch");
  int node = voltage && !strpbrk(name, "(@") && !strstr(name, "-sweep");
  char *own = branch ? text_of("i(%.*s)", (int)n - 7, name)
                     : text_of(node ? "v(%s)" : "%s", name);
  for (char *c = own; *c; c++) *c = (char)tolower((unsigned char)*c);
  send_text(NAME, own);
  free(own);
}

static void send_values(const vector_info *v) {
  size_t n = (size_t)v->v_length;
  if (v->v_realdata) {
    send_record(VALUES, v->v_realdata, n * sizeof(double));
    return;
  }
  send_head(VALUES, n * sizeof(double));
  for (size_t i = 0; i < n; i++)
    fwrite(&v->v_compdata[i].cx_real, sizeof(double), 1, answer);
}

/* Send all vectors of a plot that have values. Return the number of sent
   vectors. */
static size_t send_plot(const library *l, char *plot) {
  enum { VOLTAGE = 3 }; /* SV_VOLTAGE in ngspice */
  char **names = l->vectors(plot);
  size_t sent = 0;
  for (size_t i = length_of(names); i-- > 0;) {
    char *path = text_of("%s.%s", plot, names[i]);
    const vector_info *v = l->vector(path);
    free(path);
    if (!v || v->v_length <= 0 || !(v->v_realdata || v->v_compdata)) continue;
    if (!sent++) send_text(PLOT, plot);
    send_name(names[i], v->v_type == VOLTAGE);
    send_values(v);
  }
  return sent;
}

/* Send the plots created since the number of plots was `before`; ngspice lists
   the newest plot first. Return the current number of plots. */
static size_t send_plots(const library *l, size_t before) {
  char **plots = l->plots();
  size_t n = length_of(plots);
  for (size_t i = n > before ? n - before : 0; i-- > 0;)
    if (!send_plot(l, plots[i]) && !*trouble)
      snprintf(trouble, sizeof trouble, "the simulation returned no values");
  return n;
}

static void library_command(const library *l, const char *text) {
  char *own = text_of("%s", text);
  l->command(own);
  free(own);
}

/* Load compiled models before the deck. The file is passed as a descriptor,
   because ngspice splits file names at blanks. */
static void load_osdi(const library *l, const char *name, int file) {
  char *text = text_of("osdi /proc/self/fd/%d", file);
  library_command(l, text);
  free(text);
  if (strstr(trouble, "no such command")) end_with(NO_OSDI, "");
  trouble_check(name);
}

static void deck_run(const library *l, const char *osdi, int file, char *deck,
                     char *commands) {
  l->init(on_words, NULL, on_exit_request, on_values, on_vectors, on_thread,
          NULL);
  *trouble = 0;
  reset_signals(); /* signal handlers of ngspice would hide a crash */
  library_command(l, "set num_threads=1");
  library_command(l, "set rndseed=1");
  library_command(l, "set no_mem_check"); /* newer versions of ngspice would
                                             read /proc/meminfo */
  if (osdi) load_osdi(l, osdi, file);
  size_t plots = length_of(l->plots());
  l->circuit(lines_of(deck));
  trouble_check(NULL);
  plots = send_plots(l, plots);
  for (char **c = lines_of(commands); *c; c++) {
    if (!(*c)[strspn(*c, " \t")]) continue;
    send_text(COMMAND, *c);
    library_command(l, *c);
    if (!*trouble) plots = send_plots(l, plots);
    trouble_check(*c);
  }
}

int main(int argc, char **argv) {
  if (argc != 3 && argc != 4) {
    fputs("opcflow starts this program for circuits; see circuit.ngspice\n",
          stderr);
    return 2;
  }
  process_limit(argv[1], argv[2]);
  char *deck = read_text(), *commands = read_text();
  const char *osdi = argc == 4 ? argv[3] : NULL;
  stand_alone();
  int file = osdi ? open_osdi(osdi) : -1;
  library l = library_load();
  lock_in(file);
  deck_run(&l, osdi, file, deck, commands);
  end_with(DONE, "");
}
