/* SPDX-License-Identifier: BSD-3-Clause */
/* The child is a fork without exec: it takes the library for itself, so that
   whatever ngspice does to its process (handlers, exit(), log files, a crash)
   is done to one that is thrown away. What it says and finds comes back as
   records through a pipe, as it comes, so that a child that dies has said why.
 */
#include <stdbool.h>

#include "spice.h"

#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <locale.h>
#include <ngspice/sharedspice.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A record: its kind, the bytes that follow, these. */
enum {
  WORDS = 'w',   /* a line that the simulator said */
  TROUBLE = 't', /* what went wrong; ends the run */
  MISSING = 'm', /* the library is not there, and why */
  PLOT = 'p',    /* its name */
  NAME = 'n',    /* of a vector of that plot */
  VALUES = 'v',  /* of that vector */
  DONE = 'd'
};

typedef struct record {
  uint64_t kind, bytes;
} record;

enum { PIPE = 3, MOST_TROUBLE = 600, MOST_SAID = 200 };
static const uint64_t most_bytes = UINT64_C(1) << 31;
static const double patience = 0.05; /* between two looks at `cancelled`, s */

/* ---- the child ---- */

/* Of the one circuit of this process; ngspice's callbacks know no other. */
static char trouble[MOST_TROUBLE];

typedef struct library {
  int (*init)(SendChar *, SendStat *, ControlledExit *, SendData *,
              SendInitData *, BGThreadRunning *, void *);
  int (*circuit)(char **);
  int (*command)(char *);
  char **(*plots)(void);
  char **(*vectors)(char *);
  pvector_info (*vector)(char *);
} library;

static void send_bytes(const void *from, size_t bytes) {
  const char *at = from;
  while (bytes) {
    ssize_t n = write(PIPE, at, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(1);
    at += n;
    bytes -= (size_t)n;
  }
}

static void send_record(int kind, const void *data, size_t bytes) {
  const record r = {(uint64_t)kind, bytes};
  send_bytes(&r, sizeof r);
  send_bytes(data, bytes);
}

static void send_text(int kind, const char *text) {
  send_record(kind, text, strlen(text));
}

_Noreturn static void give_up(const char *what) {
  send_text(TROUBLE, what);
  _exit(0);
}

/* ngspice's functions tell of no failure, its words do. */
static int is_trouble(const char *line) {
  return !strncasecmp(line, "error", 5) || !strncasecmp(line, "fatal", 5) ||
         !strncmp(line, "doAnalyses:", 11) || strstr(line, " aborted") ||
         strstr(line, "no such command") || strstr(line, " failed!") ||
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

static int on_exit_wish(int status, NG_BOOL at_once, NG_BOOL quit, int id,
                        void *user) {
  (void)at_once, (void)id, (void)user;
  char text[MOST_TROUBLE + 64];
  snprintf(text, sizeof text, "%s with status %d%s%s",
           quit ? "it was told to quit," : "it ended", status,
           *trouble ? ": " : "", trouble);
  give_up(text);
}

static int on_thread(NG_BOOL idle, int id, void *user) {
  (void)idle, (void)id, (void)user;
  return 0;
}

static void reset_signals(void) {
  sigset_t none;
  for (int i = 1; i < NSIG; i++) signal(i, SIG_DFL);
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
}

/* Nothing of the parent's is left open, said or asked; a user's start-up files
   are not read. */
static void stand_alone(int out, const char *folder) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  reset_signals();
  if (out != PIPE) dup2(out, PIPE);
  fcntl(PIPE, F_SETFD, FD_CLOEXEC);
  closefrom(PIPE + 1);
  int nothing = open("/dev/null", O_RDWR);
  for (int i = 0; i < PIPE; i++) dup2(nothing, i);
  if (nothing > PIPE) close(nothing);
  if (chdir(folder)) give_up("it cannot enter its folder");
  setenv("SPICE_SCRIPTS", folder, 1);
  setenv("HOME", folder, 1);
  setenv("OMP_NUM_THREADS", "1", 1);
  setlocale(LC_ALL, "C");
}

static void *symbol(void *handle, const char *name) {
  void *found = dlsym(handle, name);
  if (found) return found;
  send_text(MISSING, dlerror());
  _exit(0);
}

static library load(void) {
  const char *own = getenv("OPCFLOW_NGSPICE");
  void *handle = dlopen(own ? own : "libngspice.so.0", RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    send_text(MISSING, dlerror());
    _exit(0);
  }
  library l;
  *(void **)&l.init = symbol(handle, "ngSpice_Init");
  *(void **)&l.circuit = symbol(handle, "ngSpice_Circ");
  *(void **)&l.command = symbol(handle, "ngSpice_Command");
  *(void **)&l.plots = symbol(handle, "ngSpice_AllPlots");
  *(void **)&l.vectors = symbol(handle, "ngSpice_AllVecs");
  *(void **)&l.vector = symbol(handle, "ngGet_Vec_Info");
  return l;
}

/* Cut a text into its lines, which stay in it. NULL-terminated. */
static char **lines_of(char *text) {
  size_t count = 2;
  for (const char *c = text; *c; c++) count += *c == '\n';
  char **lines = calloc(count, sizeof *lines);
  if (!lines) give_up("out of memory");
  for (size_t i = 0; text; i++) {
    char *end = strchr(text, '\n');
    lines[i] = text;
    if (end) *end++ = 0;
    lines[i][strcspn(lines[i], "\r")] = 0;
    text = end && *end ? end : NULL;
  }
  return lines;
}

static char *copy(const char *text) {
  char *own = strdup(text);
  if (!own) give_up("out of memory");
  return own;
}

static size_t length_of(char **list) {
  size_t n = 0;
  while (list && list[n]) n++;
  return n;
}

/* What the netlist calls it: "v(out)" for ngspice's "out", "i(vdd)" for
   "vdd#branch". */
static void send_name(const char *name, int voltage) {
  size_t n = strlen(name);
  char *own = malloc(n + 4);
  if (!own) give_up("out of memory");
  if (n > 7 && !strcmp(name + n - 7, "#branch"))
    sprintf(own, "i(%.*s)", (int)n - 7, name);
  else if (voltage && !strpbrk(name, "(@") && !strstr(name, "-sweep"))
    sprintf(own, "v(%s)", name);
  else
    strcpy(own, name);
  for (char *c = own; *c; c++) *c = (char)tolower((unsigned char)*c);
  send_text(NAME, own);
  free(own);
}

static void send_values(const vector_info *v) {
  size_t n = (size_t)v->v_length;
  const record r = {VALUES, n * sizeof(double)};
  if (v->v_realdata) {
    send_record(VALUES, v->v_realdata, n * sizeof(double));
    return;
  }
  send_bytes(&r, sizeof r);
  for (size_t i = 0; i < n; i++)
    send_bytes(&v->v_compdata[i].cx_real, sizeof(double));
}

/* All vectors of a plot that have values; returns how many. */
static size_t send_plot(const library *l, char *plot) {
  enum { VOLTAGE = 3 }; /* ngspice's SV_VOLTAGE */
  char **names = l->vectors(plot);
  size_t sent = 0;
  for (size_t i = length_of(names); i-- > 0;) {
    char *path = malloc(strlen(plot) + strlen(names[i]) + 2);
    if (!path) give_up("out of memory");
    sprintf(path, "%s.%s", plot, names[i]);
    const vector_info *v = l->vector(path);
    free(path);
    if (!v || v->v_length <= 0 || !(v->v_realdata || v->v_compdata)) continue;
    if (!sent++) send_text(PLOT, plot);
    send_name(names[i], v->v_type == VOLTAGE);
    send_values(v);
  }
  return sent;
}

/* Send the plots that were made since there were `before`; the newest comes
   first in ngspice's list. Returns how many there are now. */
static size_t send_plots(const library *l, size_t before) {
  char **plots = l->plots();
  size_t n = length_of(plots);
  for (size_t i = n > before ? n - before : 0; i-- > 0;)
    if (!send_plot(l, plots[i]) && !*trouble)
      snprintf(trouble, sizeof trouble, "it gave no values");
  return n;
}

static void check(const char *command) {
  char text[MOST_TROUBLE + 128];
  if (!*trouble) return;
  if (command)
    snprintf(text, sizeof text, "'%.100s': %s", command, trouble);
  else
    snprintf(text, sizeof text, "in the deck: %s", trouble);
  give_up(text);
}

_Noreturn static void work(const char *deck, const char *commands) {
  library l = load();
  l.init(on_words, NULL, on_exit_wish, NULL, NULL, on_thread, NULL);
  *trouble = 0;
  reset_signals(); /* ngspice's would take a crash for an exit */
  l.command((char[]){"set num_threads=1"});
  l.command((char[]){"set rndseed=1"});
  size_t plots = length_of(l.plots());
  l.circuit(lines_of(copy(deck)));
  check(NULL);
  plots = send_plots(&l, plots);
  char **list = lines_of(copy(commands));
  for (char **c = list; *c; c++) {
    if (!(*c)[strspn(*c, " \t")]) continue;
    char *own = copy(*c);
    l.command(own);
    free(own);
    if (!*trouble) plots = send_plots(&l, plots);
    check(*c);
  }
  send_record(DONE, "", 0);
  _exit(0);
}

/* ---- the parent: what came back ---- */

typedef struct reading {
  const opc_host *host;
  opc_spice_result *out;
  char *data; /* of records, whole ones first */
  size_t used, room, words;
  uint64_t taken;
  char *trouble;
  int missing, done;
} reading;

static void *grow(void *array, size_t count, size_t size) {
  /* Room is doubled at powers of two. */
  if (count & (count - 1)) return array;
  return realloc(array, (count ? 2 * count : 1) * size);
}

static char *take_text(const char *text, size_t bytes) {
  char *own = malloc(bytes + 1);
  if (!own) return NULL;
  memcpy(own, text, bytes);
  own[bytes] = 0;
  return own;
}

static int take_words(reading *r, const char *text, size_t bytes) {
  char *words = realloc(r->out->words, r->words + bytes + 2);
  if (!words) return 0;
  memcpy(words + r->words, text, bytes);
  r->words += bytes;
  words[r->words++] = '\n';
  words[r->words] = 0;
  r->out->words = words;
  return 1;
}

static int take_plot(opc_spice_result *out, const char *name, size_t bytes) {
  opc_spice_plot *plot = grow(out->plot, out->count, sizeof *plot);
  if (!plot) return 0;
  out->plot = plot;
  plot += out->count++;
  *plot = (opc_spice_plot){.name = take_text(name, bytes)};
  return plot->name != NULL;
}

static int take_name(opc_spice_result *out, const char *name, size_t bytes) {
  if (!out->count) return 0;
  opc_spice_plot *plot = &out->plot[out->count - 1];
  opc_spice_vector *v = grow(plot->vector, plot->count, sizeof *v);
  if (!v) return 0;
  plot->vector = v;
  v += plot->count++;
  *v = (opc_spice_vector){.name = take_text(name, bytes)};
  return v->name != NULL;
}

static int take_values(opc_spice_result *out, const char *data, size_t bytes) {
  opc_spice_plot *plot = out->count ? &out->plot[out->count - 1] : NULL;
  if (!plot || !plot->count) return 0;
  opc_spice_vector *v = &plot->vector[plot->count - 1];
  v->value = malloc(bytes + 1);
  if (!v->value) return 0;
  memcpy(v->value, data, bytes);
  v->count = bytes / sizeof(double);
  return 1;
}

static int take_record(reading *r, record head, const char *data) {
  size_t bytes = (size_t)head.bytes;
  switch (head.kind) {
    case WORDS:
      return take_words(r, data, bytes);
    case PLOT:
      return take_plot(r->out, data, bytes);
    case NAME:
      return take_name(r->out, data, bytes);
    case VALUES:
      return take_values(r->out, data, bytes);
    case DONE:
      r->done = 1;
      return 1;
    default:
      r->missing = head.kind == MISSING;
      free(r->trouble);
      r->trouble = take_text(data, bytes);
      return r->trouble != NULL;
  }
}

/* Take the records that are whole. */
static int take_records(reading *r, opc_error *error) {
  size_t at = 0;
  record head;
  while (r->used - at >= sizeof head) {
    memcpy(&head, r->data + at, sizeof head);
    if (head.bytes > r->used - at - sizeof head) break;
    if (!take_record(r, head, r->data + at + sizeof head))
      return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
    at += sizeof head + (size_t)head.bytes;
  }
  memmove(r->data, r->data + at, r->used - at);
  r->used -= at;
  return OPC_OK;
}

/* Read what is there: 0 at the end, -1 and *error if that fails. */
static int read_some(reading *r, int in, opc_error *error) {
  enum { PIECE = 1 << 16 };
  if (r->room - r->used < PIECE) {
    size_t room = 2 * r->room + PIECE;
    char *data = realloc(r->data, room);
    if (!data) {
      r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
      return -1;
    }
    r->data = data;
    r->room = room;
  }
  ssize_t n = read(in, r->data + r->used, r->room - r->used);
  if (n < 0 && errno == EINTR) return 1;
  if (n <= 0) return 0;
  r->used += (size_t)n;
  r->taken += (uint64_t)n;
  if (r->taken > most_bytes) {
    r->host->fail(r->host, error, OPC_FAILED, NULL,
                  "'ngspice' gave more than %llu MB of values",
                  (unsigned long long)(most_bytes >> 20));
    return -1;
  }
  return take_records(r, error) ? -1 : 1;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Read until the child has closed its end. */
static int listen_to(reading *r, int in, double limit, opc_error *error) {
  double end = now() + limit;
  struct pollfd wait = {.fd = in, .events = POLLIN};
  for (;;) {
    if (r->host->cancelled(r->host))
      return r->host->fail(r->host, error, OPC_CANCELLED, NULL, "stopped");
    if (now() > end)
      return r->host->fail(r->host, error, OPC_FAILED, NULL,
                           "'ngspice' was not done after %g s", limit);
    if (poll(&wait, 1, (int)(1000 * patience)) <= 0) continue;
    int more = read_some(r, in, error);
    if (more < 0) return error->code;
    if (!more) return OPC_OK;
  }
}

/* The last of what was said, on one line. */
static void last_words(const reading *r, char text[MOST_SAID + 1]) {
  size_t n = r->words < MOST_SAID ? r->words : MOST_SAID;
  *text = 0;
  if (!n) return;
  memcpy(text, r->out->words + r->words - n, n);
  text[n] = 0;
  for (char *c = text; *c; c++)
    if (*c == '\n') *c = c[1] ? ' ' : 0;
}

static int judge(const reading *r, int status, opc_error *error) {
  const opc_host *host = r->host;
  char said[MOST_SAID + 1];
  if (r->missing)
    return host->fail(host, error, OPC_NO_PLUGIN, NULL,
                      "the library of ngspice is not installed (Debian "
                      "package 'libngspice0'): %s",
                      r->trouble);
  if (r->trouble)
    return host->fail(host, error, OPC_FAILED, NULL, "'ngspice' failed: %s",
                      r->trouble);
  if (r->done) return OPC_OK;
  last_words(r, said);
  if (WIFSIGNALED(status))
    return host->fail(host, error, OPC_FAILED, NULL,
                      "'ngspice' crashed (%s); it last said: %s",
                      strsignal(WTERMSIG(status)), said);
  return host->fail(host, error, OPC_FAILED, NULL,
                    "'ngspice' ended by itself with status %d; it last said: "
                    "%s",
                    WEXITSTATUS(status), said);
}

/* ---- the parent: the child's life ---- */

static int unlink_one(const char *path, const struct stat *info, int type,
                      struct FTW *place) {
  (void)info, (void)type, (void)place;
  (void)remove(path);
  return 0;
}

/* For the log files that models leave where they stand. */
static int make_folder(const opc_host *host, char path[PATH_MAX],
                       opc_error *error) {
  const char *parent = getenv("TMPDIR");
  int n = snprintf(path, PATH_MAX, "%s/opcflow-spice-XXXXXX",
                   parent && *parent == '/' ? parent : "/tmp");
  if (n < PATH_MAX && mkdtemp(path)) return OPC_OK;
  return host->fail(host, error, OPC_IO, NULL, "cannot make '%s': %s", path,
                    strerror(errno));
}

static int run_in(const opc_host *host, const char *folder, const char *deck,
                  const char *commands, double limit, opc_spice_result *out,
                  opc_error *error) {
  int ends[2], status = 0;
  if (pipe2(ends, O_CLOEXEC))
    return host->fail(host, error, OPC_FAILED, NULL, "no pipe: %s",
                      strerror(errno));
  pid_t child = fork();
  if (!child) {
    stand_alone(ends[1], folder);
    work(deck, commands);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return host->fail(host, error, OPC_FAILED, NULL, "no process: %s",
                      strerror(errno));
  }
  setpgid(child, child);
  reading r = {.host = host, .out = out};
  int code = listen_to(&r, ends[0], limit, error);
  kill(-child, SIGKILL); /* and what it has started itself */
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!code) code = judge(&r, status, error);
  close(ends[0]);
  free(r.data);
  free(r.trouble);
  return code;
}

int opc_spice_run(const opc_host *host, const char *deck, const char *commands,
                  double limit, opc_spice_result *out, opc_error *error) {
  char folder[PATH_MAX];
  memset(out, 0, sizeof *out);
  int code = make_folder(host, folder, error);
  if (code) return code;
  code = run_in(host, folder, deck, commands, limit, out, error);
  nftw(folder, unlink_one, 16, FTW_DEPTH | FTW_PHYS);
  return code;
}

#ifdef __has_feature /* clang */
#define HAS_FEATURE(name) __has_feature(name)
#else
#define HAS_FEATURE(name) 0
#endif

void opc_spice_parallel(const opc_host *host, size_t n,
                        void (*task)(void *data, size_t i), void *data) {
#if defined __SANITIZE_ADDRESS__ || HAS_FEATURE(address_sanitizer)
  (void)host;
  for (size_t i = 0; i < n; i++) task(data, i);
#else
  host->parallel(host, n, task, data);
#endif
}

void opc_spice_release(opc_spice_result *result) {
  for (size_t i = 0; i < result->count; i++) {
    opc_spice_plot *p = &result->plot[i];
    for (size_t j = 0; j < p->count; j++) {
      free(p->vector[j].name);
      free(p->vector[j].value);
    }
    free(p->name);
    free(p->vector);
  }
  free(result->plot);
  free(result->words);
  memset(result, 0, sizeof *result);
}

const opc_spice_vector *opc_spice_vector_find(const opc_spice_plot *plot,
                                              const char *name) {
  for (size_t i = 0; i < plot->count; i++)
    if (!strcmp(plot->vector[i].name, name)) return &plot->vector[i];
  return NULL;
}
