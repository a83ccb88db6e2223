/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks at a plugin from outside and at work: its exports, its declaration,
   instances at the bounds of its parameters, its results and its memory. What
   its work is and what is wrong with it, its kind knows. */
#include "core/testing/lint.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/flow/layers.h"
#include "core/plugin/child.h"
#include "core/plugin/kind.h"
#include "core/text/value.h"

enum {
  THREADS = 4,
  CYCLES = 64,
  SEGMENT = 2,        /* s */
  SMALLEST_LEAK = 256 /* bytes in that many cycles */
};

/* ---- what a check says: lines of a letter and a text ---- */

/* What a check works with; `hears` is what the exerciser of the kind gets. */
typedef struct inspector {
  opc_inspector hears;
  const opc_lint *lint;
  const opc_plugin *plugin;
  const opc_kind *kind;
  int out;           /* -1: nobody listens */
  GChecksum *digest; /* of all that the plugin gave */
} inspector;

static void say(const inspector *in, char letter, const char *text) {
  g_autofree char *line = g_strdup_printf("%c%s", letter, text);
  g_strdelimit(line, "\n\r", ' ');
  if (in->out < 0) return;
  opc_child_write(in->out, line, strlen(line));
  opc_child_write(in->out, "\n", 1);
}

static void vsay(const inspector *in, char letter, const char *format,
                 va_list args) {
  g_autofree char *text = g_strdup_vprintf(format, args);
  say(in, letter, text);
}

static void add(opc_inspector *hears, const void *data, size_t size) {
  g_checksum_update(((inspector *)hears)->digest, data, (gssize)size);
}

static void find(opc_inspector *hears, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsay((inspector *)hears, 'F', format, args);
  va_end(args);
}

static void note(opc_inspector *hears, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsay((inspector *)hears, 'N', format, args);
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

/* NULL for what cannot be made up. */
static char *sample_text(const opc_lint *lint, const opc_parameter *p) {
  g_autofree char *number = opc_quantity_text(p, sample_number(p));
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
    case OPC_FILE: /* its content is for later than its check */
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
  if (over) opc_lay(map, over, problems);
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

static gboolean instance_make(const inspector *in, const opc_parameter *p,
                              double number, opc_problems *problems,
                              instance *made) {
  const opc_lint *lint = in->lint;
  const opc_plugin *plugin = in->plugin;
  const opc_place at = {NULL, 0, 0};
  *made = (instance){.source = opc_source_new("lint", "")};
  made->map = opc_node_map_new(made->source, &at);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *q = &plugin->parameters[i];
    g_autofree char *text =
        q->flags & OPC_REQUIRED ? sample_text(lint, q) : NULL;
    if (text) put(made->map, made->source, q->name, text, problems);
  }
  made->given = opc_node_parse(made->source, lint->parameters,
                               strlen(lint->parameters), problems);
  if (made->given && made->given->type == OPC_NODE_MAP)
    opc_lay(made->map, made->given, problems);
  if (p) {
    g_autofree char *text = opc_quantity_text(p, number);
    put(made->map, made->source, p->name, text, problems);
  }
  if (!problems->list->len)
    made->binding =
        opc_bind_plugin(lint->registry, plugin, made->map, plugin->id, &at,
                        OPC_BIND_NO_INPUTS, problems);
  return !problems->list->len &&
         opc_binding_create(made->binding, NULL, NULL, problems);
}

/* ---- checks, each in a process of its own ---- */

static void check_stop(inspector *in, const char *what, const char *text) {
  if (g_str_has_suffix(text, ".") || strchr(text, '\n'))
    find(&in->hears, "the summary of %s is not one line without a full stop",
         what);
}

static void check_declaration(inspector *in) {
  const opc_plugin *plugin = in->plugin;
  check_stop(in, "the plugin", plugin->summary);
  for (size_t i = 0; i < plugin->n_parameters; i++)
    check_stop(in, plugin->parameters[i].name, plugin->parameters[i].summary);
  for (size_t i = 0; i < plugin->n_metrics; i++)
    check_stop(in, plugin->metrics[i].name, plugin->metrics[i].summary);
}

/* A refusal must have a message; what it says is noted for the defaults. */
static void check_with(inspector *in, const opc_parameter *p, double number) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  instance made;
  if (!instance_make(in, p, number, problems, &made)) {
    g_autofree char *text = opc_problems_text(problems);
    if (strstr(text, "gave no reason"))
      find(&in->hears, "check fails without a message%s%s", p ? " for " : "",
           p ? p->name : "");
    else if (!p)
      note(&in->hears, "check: %s; see --with", text);
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

static void check_instances(inspector *in) {
  check_with(in, NULL, 0);
  for (size_t i = 0; i < in->plugin->n_parameters; i++) {
    const opc_parameter *p = &in->plugin->parameters[i];
    if (p->type != OPC_INT && p->type != OPC_REAL) continue;
    if (p->flags & (OPC_AT_LEAST | OPC_ABOVE))
      check_with(in, p, inside(p, p->min, (p->flags & OPC_ABOVE) != 0, 1));
    if (p->flags & (OPC_AT_MOST | OPC_BELOW))
      check_with(in, p, inside(p, p->max, (p->flags & OPC_BELOW) != 0, -1));
  }
}

/* The digest of what an instance gives; NULL if it cannot be made, of which
   check_instances tells, or is not to be tried. */
static char *work(inspector *in) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  instance made;
  char *digest = NULL;
  if (!in->kind->exercise) return NULL;
  if (instance_make(in, NULL, 0, problems, &made)) {
    in->digest = g_checksum_new(G_CHECKSUM_SHA256);
    in->hears.context = made.binding->host->context;
    in->kind->exercise(&made.binding->module, &in->hears);
    digest = g_strdup(g_checksum_get_string(in->digest));
    g_checksum_free(in->digest);
  }
  instance_clear(&made);
  return digest;
}

static void say_digest(inspector *in) {
  g_autofree char *digest = work(in);
  if (digest) say(in, 'D', digest);
}

static void check_work(inspector *in) {
  if (!in->kind->exercise)
    note(&in->hears, "work: the kind '%s' does not say how to try it",
         in->plugin->kind);
  say_digest(in);
}

/* By a second instance, in a process where another one has worked. */
static void check_again(inspector *in) {
  g_free(work(in));
  say_digest(in);
}

static void check_threads(inspector *in) {
  opc_set_threads(THREADS);
  say_digest(in);
}

/* By how many bytes each life of an instance makes the memory in use grow, of
   up to CYCLES lives in SEGMENT seconds; 0 where it is little. */
static double growth(const inspector *in, gboolean working) {
  inspector nowhere = *in;
  nowhere.out = -1;
  gint64 end = g_get_monotonic_time() + SEGMENT * G_USEC_PER_SEC;
  struct mallinfo2 before = mallinfo2();
  int n = 0;
  for (; n < CYCLES && g_get_monotonic_time() < end; n++) {
    if (working) {
      g_free(work(&nowhere));
      continue;
    }
    g_autoptr(opc_problems) problems = opc_problems_new();
    instance made;
    instance_make(in, NULL, 0, problems, &made);
    instance_clear(&made);
  }
  struct mallinfo2 after = mallinfo2();
  double more = (double)after.uordblks + (double)after.hblkhd -
                (double)before.uordblks - (double)before.hblkhd;
  return more < SMALLEST_LEAK ? 0 : more / n;
}

/* What grows again and again, after a start, goes on growing. */
static void check_leaks(inspector *in) {
  for (int working = 0; working < 2; working++) {
    growth(in, working);
    double one = growth(in, working);
    double two = one > 0 ? growth(in, working) : 0;
    if (!(two > 0)) continue;
    find(&in->hears, "leaks %.0f bytes each time it is made%s and freed",
         MIN(one, two), working ? ", used" : "");
    return;
  }
}

static const struct {
  const char *name;
  void (*run)(inspector *in);
  gboolean works;      /* gives a digest, if the kind says how to try it */
  const char *differs; /* what it means if that is not the first one */
} checks[] = {
    {"loading", check_declaration, FALSE, NULL},
    {"check", check_instances, FALSE, NULL},
    {"work", check_work, TRUE, NULL},
    {"the same work again", check_again, TRUE,
     "gives other bits the second time, for the same input"},
    {"work on several threads", check_threads, TRUE,
     "gives other bits on several threads than on one"},
    {"being made and freed", check_leaks, FALSE, NULL},
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

typedef struct job {
  const opc_lint *lint;
  size_t check;
} job;

/* On one thread, unless the check says otherwise. */
static void run_in_child(int out, void *data) {
  const job *j = data;
  opc_error error = {0};
  inspector in = {.hears = {.add = add, .find = find, .note = note},
                  .lint = j->lint,
                  .out = out};
  opc_set_threads(1);
  in.plugin = opc_registry_find(j->lint->registry, j->lint->id, &error);
  if (in.plugin) {
    in.kind = opc_kind_of(j->lint->registry, in.plugin->kind, &error);
    checks[j->check].run(&in);
  } else {
    find(&in.hears, "%s", error.message);
  }
  say(&in, 'E', "");
}

/* FALSE if the plugin did not survive the check. */
static gboolean run_check(opc_lint *lint, size_t i, char **digest) {
  const char *name = checks[i].name;
  gboolean ended = FALSE;
  int end;
  job j = {lint, i};
  g_autoptr(GString) text =
      opc_child_run(run_in_child, &j, lint->seconds, &end);
  g_auto(GStrv) lines = g_strsplit(text->str, "\n", -1);
  for (guint k = 0; lines[k]; k++) {
    ended |= *lines[k] == 'E';
    take_line(lint, lines[k], digest);
  }
  char *crash = NULL;
  if (end == OPC_CHILD_LATE)
    crash =
        g_strdup_printf("does not end within %g s: %s", lint->seconds, name);
  else if (end > 0)
    crash = g_strdup_printf("crashes (%s): %s", g_strsignal(end), name);
  else if (!ended)
    crash = g_strdup_printf("ends the process: %s", name);
  if (crash) g_ptr_array_add(lint->findings, crash);
  return !crash;
}

/* The names that a shared object exports, as `nm` says: looking at them must
   not run it. By g_spawn_sync, which leaves no thread behind in a process that
   forks. FALSE if it is no object. */
static gboolean check_exports(opc_lint *lint) {
  const char *const argv[] = {
      "nm", "-D", "--defined-only", "--format=posix", lint->path, NULL};
  g_autofree char *text = NULL;
  int status;
  if (!g_spawn_sync(NULL, (char **)argv, NULL,
                    G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL,
                    NULL, &text, NULL, &status, NULL)) {
    g_ptr_array_add(lint->notes, g_strdup("exports: there is no nm here"));
    return TRUE;
  }
  if (status) {
    g_ptr_array_add(lint->findings,
                    g_strdup("it is no shared object of this machine"));
    return FALSE;
  }
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  for (guint i = 0; lines[i]; i++) {
    g_autofree char *name = g_strndup(lines[i], strcspn(lines[i], " @"));
    /* What linkers and compilers put there by themselves. */
    if (!*name || !strcmp(name, OPC_ENTRY_NAME) || *name == '_') continue;
    g_ptr_array_add(
        lint->findings,
        g_strdup_printf("exports '%s'; only " OPC_ENTRY_NAME " is to be seen",
                        name));
  }
  g_ptr_array_add(lint->checked, g_strdup("exports"));
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
  lint->checked = g_ptr_array_new_with_free_func(g_free);
  lint->notes = g_ptr_array_new_with_free_func(g_free);
  return lint;
}

/* Work that is not tried gives no digest. */
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
    if (!checks[i].works || digest)
      g_ptr_array_add(lint->checked, g_strdup(checks[i].name));
    if (!first) first = g_steal_pointer(&digest);
  }
}

void opc_lint_free(opc_lint *lint) {
  if (!lint) return;
  g_free(lint->id);
  g_ptr_array_free(lint->findings, TRUE);
  g_ptr_array_free(lint->checked, TRUE);
  g_ptr_array_free(lint->notes, TRUE);
  g_free(lint);
}
