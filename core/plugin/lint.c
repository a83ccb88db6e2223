/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/plugin/lint.h"

#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/flow/layers.h"
#include "core/flow/value.h"
#include "core/plugin/declaration.h"
#include "core/plugin/guard.h"

enum {
  THREADS = 4,
  CYCLES = 64,
  SEGMENT = 2,        /* s */
  SMALLEST_LEAK = 256 /* bytes in that many cycles */
};

/* ---- what a check says: lines of a letter and a text ---- */

static void say(const opc_inspector *in, char letter, const char *text) {
  g_autofree char *line = g_strdup_printf("%c%s\n", letter, text);
  g_strdelimit(line, "\n\r", ' ');
  size_t n = strlen(line);
  line[n - 1] = '\n';
  for (size_t done = 0; done < n;) {
    ssize_t k = write(in->out, line + done, n - done);
    if (k < 0 && errno != EINTR) return;
    if (k > 0) done += (size_t)k;
  }
}

static void vsay(const opc_inspector *in, char letter, const char *format,
                 va_list args) {
  g_autofree char *text = g_strdup_vprintf(format, args);
  say(in, letter, text);
}

void opc_find(opc_inspector *in, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsay(in, 'F', format, args);
  va_end(args);
}

void opc_note(opc_inspector *in, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsay(in, 'N', format, args);
  va_end(args);
}

/* ---- parameters, made up where there is no default ---- */

static double sample_number(const opc_parameter *p) {
  gboolean low = p->flags & (OPC_AT_LEAST | OPC_ABOVE);
  gboolean high = p->flags & (OPC_AT_MOST | OPC_BELOW);
  if (low && high) return p->type == OPC_INT ? p->max : (p->min + p->max) / 2;
  if (low) return p->min + 1;
  return high ? p->max - 1 : 1;
}

static char *number_text(const opc_parameter *p, double number) {
  g_autofree char *text = opc_number_text(number);
  return g_strdup_printf("%s%s%s", text, p->unit ? " " : "",
                         p->unit ? p->unit : "");
}

/* NULL for what cannot be made up. */
static char *sample_text(const opc_lint *lint, const opc_parameter *p) {
  g_autofree char *number = number_text(p, sample_number(p));
  g_auto(GStrv) words = opc_choice_list(p->choices);
  switch (p->type) {
    case OPC_BOOL:
      return g_strdup("true");
    case OPC_INT:
    case OPC_REAL:
      return g_steal_pointer(&number);
    case OPC_REALS:
      return g_strdup_printf("[%s]", number);
    case OPC_CHOICE:
      return g_strdup(words[0]);
    case OPC_FILE: /* its content is for later than create */
      return g_strdup_printf("'%s'", lint->path);
    case OPC_TEXT:
    case OPC_OUTPUT:
      return g_strdup("sample");
    case OPC_MAP:
      return g_strdup_printf("{ %s: sample }", words[0] ? words[0] : "sample");
    default:
      return NULL;
  }
}

/* Lay the value of a parameter, written as in a flow, over a map. */
static void put(opc_node *map, const opc_source *source, const char *name,
                const char *text, opc_problems *problems) {
  g_auto(GStrv) words = g_strsplit(name, ".", -1);
  g_autoptr(GString) flow = g_string_new(text);
  for (guint i = g_strv_length(words); i-- > 0;) {
    g_autofree char *inner = g_string_free(flow, FALSE);
    flow = g_string_new(NULL);
    g_string_printf(flow, "{ %s: %s }", words[i], inner);
  }
  g_autoptr(opc_node) over =
      opc_node_parse(source, flow->str, flow->len, problems);
  if (over) opc_lay(map, over, NULL, problems);
}

/* An instance, with one parameter set to a number if `p` is not NULL. */
typedef struct instance {
  opc_source *source;
  opc_node *map, *given;
  opc_binding *binding;
} instance;

static void instance_clear(instance *made) {
  opc_binding_free(made->binding);
  opc_node_free(made->map);
  opc_node_free(made->given);
  opc_source_free(made->source);
}

static gboolean instance_make(const opc_lint *lint, const opc_plugin *plugin,
                              const opc_parameter *p, double number,
                              opc_problems *problems, instance *made) {
  static const opc_sink sink = {0};
  const opc_place at = {NULL, 0, 0};
  *made = (instance){.source = opc_source_new("lint", "")};
  made->map = opc_node_map_new(made->source, &at);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *q = opc_parameter_at(plugin, i);
    g_autofree char *text =
        q->flags & OPC_REQUIRED ? sample_text(lint, q) : NULL;
    if (text) put(made->map, made->source, q->name, text, problems);
  }
  made->given = opc_node_parse(made->source, lint->parameters,
                               strlen(lint->parameters), problems);
  if (made->given && made->given->type == OPC_NODE_MAP)
    opc_lay(made->map, made->given, NULL, problems);
  if (p) {
    g_autofree char *text = number_text(p, number);
    put(made->map, made->source, p->name, text, problems);
  }
  if (!problems->list->len)
    made->binding =
        opc_bind_plugin(lint->registry, plugin, made->map, plugin->id, &at,
                        OPC_BIND_NO_INPUTS, problems);
  return !problems->list->len &&
         opc_binding_create(made->binding, &sink, NULL, problems);
}

/* ---- checks, each in a process of its own ---- */

static const opc_plugin *load(const opc_lint *lint, opc_inspector *in) {
  opc_error error = {0};
  const opc_plugin *plugin =
      opc_registry_find(lint->registry, lint->id, &error);
  if (!plugin) opc_find(in, "%s", error.message);
  return plugin;
}

static void check_stop(opc_inspector *in, const char *what, const char *text) {
  if (g_str_has_suffix(text, ".") || strchr(text, '\n'))
    opc_find(in, "the summary of %s is not one line without a full stop", what);
}

static void check_declaration(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  if (!plugin) return;
  check_stop(in, "the plugin", plugin->summary);
  for (size_t i = 0; i < plugin->n_parameters; i++)
    check_stop(in, opc_parameter_at(plugin, i)->name,
               opc_parameter_at(plugin, i)->summary);
  for (size_t i = 0; i < plugin->n_metrics; i++)
    check_stop(in, opc_metric_at(plugin, i)->name,
               opc_metric_at(plugin, i)->summary);
  if (plugin->get_extension && plugin->get_extension("opcflow.nothing/0"))
    opc_find(in, "get_extension knows an extension that does not exist");
}

/* A refusal must have a message; what it says is noted for the defaults. */
static void create_with(const opc_lint *lint, opc_inspector *in,
                        const opc_plugin *plugin, const opc_parameter *p,
                        double number) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  instance made;
  if (!instance_make(lint, plugin, p, number, problems, &made)) {
    g_autofree char *text = opc_problems_text(problems);
    if (strstr(text, "gave no reason"))
      opc_find(in, "create fails without a message%s%s", p ? " for " : "",
               p ? p->name : "");
    else if (!p)
      opc_note(in, "create: %s; see --with", text);
  }
  instance_clear(&made);
}

/* The nearest number to a bound that fits. */
static double inside(const opc_parameter *p, double bound, gboolean open,
                     int sign) {
  if (!open) return bound;
  if (p->type == OPC_INT) return bound + sign;
  return bound + sign * 1e-9 * (bound ? fabs(bound) : 1);
}

static void check_create(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  if (!plugin) return;
  create_with(lint, in, plugin, NULL, 0);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = opc_parameter_at(plugin, i);
    if (p->type != OPC_INT && p->type != OPC_REAL) continue;
    if (p->flags & (OPC_AT_LEAST | OPC_ABOVE))
      create_with(lint, in, plugin, p,
                  inside(p, p->min, (p->flags & OPC_ABOVE) != 0, 1));
    if (p->flags & (OPC_AT_MOST | OPC_BELOW))
      create_with(lint, in, plugin, p,
                  inside(p, p->max, (p->flags & OPC_BELOW) != 0, -1));
  }
}

/* The digest of what an instance gives; NULL if it cannot be made, of which
   check_create tells. */
static char *work(const opc_lint *lint, opc_inspector *in,
                  const opc_plugin *plugin) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  instance made;
  char *digest = NULL;
  if (instance_make(lint, plugin, NULL, 0, problems, &made)) {
    in->digest = g_checksum_new(G_CHECKSUM_SHA256);
    opc_exercise(in, &made.binding->module);
    digest = g_strdup(g_checksum_get_string(in->digest));
    g_checksum_free(in->digest);
  }
  instance_clear(&made);
  return digest;
}

static void check_work(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  opc_set_threads(1);
  g_autofree char *digest = plugin ? work(lint, in, plugin) : NULL;
  if (digest) say(in, 'D', digest);
}

/* By a second instance, in a process where another one has worked. */
static void check_again(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  opc_set_threads(1);
  if (plugin) g_free(work(lint, in, plugin));
  g_autofree char *again = plugin ? work(lint, in, plugin) : NULL;
  if (again) say(in, 'D', again);
}

static void check_threads(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  opc_set_threads(THREADS);
  g_autofree char *digest = plugin ? work(lint, in, plugin) : NULL;
  if (digest) say(in, 'D', digest);
}

/* By how many bytes each life of an instance makes the memory in use grow, of
   up to CYCLES lives in SEGMENT seconds; 0 where it is little. */
static double growth(const opc_lint *lint, const opc_plugin *plugin,
                     gboolean working) {
  opc_inspector nowhere = {.out = -1};
  gint64 start = g_get_monotonic_time();
  struct mallinfo2 before = mallinfo2();
  int n = 0;
  for (;
       n < CYCLES && g_get_monotonic_time() - start < SEGMENT * G_USEC_PER_SEC;
       n++) {
    if (working) {
      g_free(work(lint, &nowhere, plugin));
      continue;
    }
    g_autoptr(opc_problems) problems = opc_problems_new();
    instance made;
    instance_make(lint, plugin, NULL, 0, problems, &made);
    instance_clear(&made);
  }
  struct mallinfo2 after = mallinfo2();
  double more = (double)after.uordblks + (double)after.hblkhd -
                (double)before.uordblks - (double)before.hblkhd;
  return more < SMALLEST_LEAK ? 0 : more / n;
}

/* What grows again and again, after a start, goes on growing. */
static void check_leaks(const opc_lint *lint, opc_inspector *in) {
  const opc_plugin *plugin = load(lint, in);
  if (!plugin) return;
  opc_set_threads(1);
  for (int working = 0; working < 2; working++) {
    growth(lint, plugin, working);
    double one = growth(lint, plugin, working);
    double two = one > 0 ? growth(lint, plugin, working) : 0;
    if (!(two > 0)) continue;
    opc_find(in, "leaks %.0f bytes each time it is made%s and destroyed",
             MIN(one, two), working ? ", used" : "");
    return;
  }
}

static const struct {
  const char *name;
  void (*run)(const opc_lint *lint, opc_inspector *in);
  const char *differs; /* than the digest of the work on one thread */
} checks[] = {
    {"loading", check_declaration, NULL},
    {"create", check_create, NULL},
    {"work", check_work, NULL},
    {"the same work again", check_again,
     "gives other bits the second time, for the same input"},
    {"work on several threads", check_threads,
     "gives other bits on several threads than on one"},
    {"being made and destroyed", check_leaks, NULL},
};

/* ---- the parent ---- */

/* Take a line of a report; a text is kept once. */
static void take_line(opc_lint *lint, const char *line, char **digest) {
  if (*line == 'D') {
    g_free(*digest);
    *digest = g_strdup(line + 1);
    return;
  }
  GPtrArray *list = *line == 'F' ? lint->findings : lint->notes;
  if ((*line != 'F' && *line != 'N') ||
      g_ptr_array_find_with_equal_func(list, line + 1, g_str_equal, NULL))
    return;
  g_ptr_array_add(list, g_strdup(line + 1));
}

static GString *read_all(int in, gint64 deadline, gboolean *late) {
  GString *text = g_string_new(NULL);
  for (*late = FALSE;;) {
    gint64 left = (deadline - g_get_monotonic_time()) / 1000;
    struct pollfd wait = {in, POLLIN, 0};
    if (left <= 0 || text->len > 1 << 20) {
      *late = TRUE;
      return text;
    }
    if (poll(&wait, 1, (int)MIN(left, 1000)) <= 0) continue;
    char buffer[4096];
    ssize_t n = read(in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return text;
    g_string_append_len(text, buffer, n);
  }
}

/* FALSE if the plugin did not survive the check. */
static gboolean run_check(opc_lint *lint, size_t i, char **digest) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC)) return FALSE;
  fflush(NULL);
  pid_t pid = fork();
  if (!pid) {
    close(ends[0]);
    opc_guard_remove();
    opc_inspector in = {.out = ends[1]};
    checks[i].run(lint, &in);
    say(&in, 'E', "");
    _exit(0);
  }
  close(ends[1]);
  gboolean late, ended = FALSE;
  GString *text = read_all(
      ends[0], g_get_monotonic_time() + (gint64)(lint->seconds * 1e6), &late);
  close(ends[0]);
  if (late && pid > 0) kill(pid, SIGKILL);
  int status = 0;
  while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
    ;
  g_auto(GStrv) lines = g_strsplit(text->str, "\n", -1);
  for (guint k = 0; lines[k]; k++) {
    ended |= *lines[k] == 'E';
    take_line(lint, lines[k], digest);
  }
  g_string_free(text, TRUE);
  char *crash =
      late ? g_strdup_printf("does not end within %g s: %s", lint->seconds,
                             checks[i].name)
      : WIFSIGNALED(status)
          ? g_strdup_printf("crashes (%s): %s", g_strsignal(WTERMSIG(status)),
                            checks[i].name)
      : !ended ? g_strdup_printf("ends the process: %s", checks[i].name)
               : NULL;
  if (crash) g_ptr_array_add(lint->findings, crash);
  return !crash;
}

static gboolean check_exports(opc_lint *lint) {
  g_autofree char *reason = NULL;
  GPtrArray *names = opc_exports(lint->path, &reason);
  if (!names) {
    g_ptr_array_add(lint->findings, g_steal_pointer(&reason));
    return FALSE;
  }
  for (guint i = 0; i < names->len; i++) {
    const char *name = names->pdata[i];
    /* What linkers and compilers put there by themselves. */
    if (!strcmp(name, OPC_ENTRY_NAME) || *name == '_') continue;
    g_ptr_array_add(
        lint->findings,
        g_strdup_printf("exports '%s'; only " OPC_ENTRY_NAME " is to be seen",
                        name));
  }
  g_ptr_array_free(names, TRUE);
  return TRUE;
}

opc_lint *opc_lint_new(const char *path, opc_registry *registry,
                       const char *parameters, double seconds) {
  opc_lint *lint = g_new0(opc_lint, 1);
  g_autofree char *base = g_path_get_basename(path);
  lint->path = path;
  lint->id = g_str_has_suffix(base, ".so") ? g_strndup(base, strlen(base) - 3)
                                           : g_strdup(base);
  lint->registry = registry;
  lint->parameters = parameters;
  lint->seconds = seconds;
  lint->findings = g_ptr_array_new_with_free_func(g_free);
  lint->notes = g_ptr_array_new_with_free_func(g_free);
  return lint;
}

void opc_lint_run(opc_lint *lint) {
  if (!check_exports(lint)) return;
  g_autofree char *first = NULL;
  for (size_t i = 0; i < G_N_ELEMENTS(checks); i++) {
    guint before = lint->findings->len;
    g_autofree char *digest = NULL;
    if (!run_check(lint, i, &digest)) return;
    if (i == 0 && lint->findings->len > before &&
        strstr(lint->findings->pdata[before], "cannot use"))
      return;
    if (checks[i].differs && g_strcmp0(first, digest))
      g_ptr_array_add(lint->findings, g_strdup(checks[i].differs));
    if (!first) first = g_steal_pointer(&digest);
  }
}

void opc_lint_free(opc_lint *lint) {
  if (!lint) return;
  g_free(lint->id);
  g_ptr_array_free(lint->findings, TRUE);
  g_ptr_array_free(lint->notes, TRUE);
  g_free(lint);
}
