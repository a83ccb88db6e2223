/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of a plugin: the declaration, instances at the bounds of the
   parameters, equal results of repeated, concurrent and multi-threaded runs,
   and memory. The kind of the plugin runs the plugin and judges the results. */
#include "tools/devel/lint.h"

#include <guard/child.h>
#include <guard/guard.h>
#include <guard/process.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/plugin/declaration.h"
#include "core/plugin/kind.h"
#include "tools/devel/instance.h"
#include "tools/devel/published.h"

/* Fraction of opc_lint.seconds after which a call is cancelled. */
static const double part = 2.0 / 3;

enum {
  THREADS = 4,
  TOGETHER = 2,       /* number of concurrent instances */
  CYCLES = 64,        /* instances of a series, which are made one by one */
  SEGMENT = 2,        /* s */
  SMALLEST_LEAK = 256 /* bytes in CYCLES cycles */
};

/* ---- reports ---- */

/* State of a check. The kind's `exercise` receives `hears`, the inspector. */
struct opc_inspection {
  opc_inspector hears;
  const opc_lint *lint;
  const opc_plugin *plugin;
  const opc_kind *kind; /* kind with the samples and `exercise` */
  size_t check;
  size_t sample;     /* number of the sample file for the plugin */
  int out;           /* file descriptor of the report; -1 if nothing is
                        reported */
  guint notes;       /* number of notes so far */
  GChecksum *digest; /* digest of all results */
};
typedef struct opc_inspection inspector;

static void report_text(const inspector *in, char letter, const char *text) {
  g_autofree char *line = g_strdup_printf("%c%s", letter, text);
  g_strdelimit(line, "\n\r", ' ');
  g_autofree char *whole = g_strconcat(line, "\n", NULL);
  if (in->out >= 0) process_write(in->out, whole, strlen(whole));
}

static void report_format(const inspector *in, char letter, const char *format,
                          va_list args) {
  g_autofree char *text = g_strdup_vprintf(format, args);
  report_text(in, letter, text);
}

static void digest_add(opc_inspector *hears, const void *data, size_t size) {
  g_checksum_update(((inspector *)hears)->digest, data, (gssize)size);
}

static void report_finding(opc_inspector *hears, const char *format, ...) {
  va_list args;
  va_start(args, format);
  report_format((inspector *)hears, 'F', format, args);
  va_end(args);
}

static void report_note(opc_inspector *hears, const char *format, ...) {
  va_list args;
  va_start(args, format);
  ((inspector *)hears)->notes++;
  report_format((inspector *)hears, 'N', format, args);
  va_end(args);
}

/* ---- the guard ---- */

/* State of the check that this process runs. Static, because the guard also
   reports after the thread has ended. */
static inspector listening;

/* Report a change of the process, except that the plugin ended the process,
   which the parent process reports. */
static void report_process_change(const char *id, const char *what) {
  const opc_lint *lint = listening.lint;
  gboolean own = !g_strcmp0(id, lint->id);
  if (!strcmp(what, "ended the process") && own) return;
  g_autofree char *text =
      g_strdup_printf("%s%s%s%s: %s", own ? "" : "plugin '", own ? "" : id,
                      own ? "" : "' ", what, opc_checks[listening.check].name);
  report_text(&listening, 'F', text);
  report_text(&listening, 'B', "");
}

static void report_alive(void) { report_text(&listening, 'T', ""); }

static const guard_listener process_listener = {report_process_change,
                                                report_alive};

/* ---- instances ---- */

/* Start and time limit of the current check, us. */
static gint64 begun, granted;

/* Return whether the check exceeds the limit. Time spent waiting for a
   processor does not count, up to twice the limit. */
static int is_late(void *unused) {
  (void)unused;
  gint64 since = g_get_monotonic_time() - begun;
  return since > granted &&
         (since > 3 * granted || since - child_waited(0) > granted);
}

static const opc_watch hurry = {.cancelled = is_late};

static char *sample_path(const inspector *in, size_t i) {
  return i < in->kind->n_samples
             ? g_build_filename(in->lint->folder, in->kind->samples[i].name,
                                NULL)
             : NULL;
}

static gboolean instance_make(const inspector *in, const opc_parameter *changed,
                              double number, const opc_host *like,
                              opc_problems *problems, opc_instance *made) {
  size_t n = in->kind->n_samples;
  g_autofree char *file =
      sample_path(in, in->sample < 2 * n ? in->sample % n : in->sample);
  report_alive();
  /* Without sample files, pass the path of the plugin itself: `check` does not
     read the content. */
  const opc_making making = {in->lint->registry,
                             in->plugin,
                             file ? file : in->lint->path,
                             in->lint->parameters,
                             changed,
                             number,
                             &hurry};
  return opc_instance_make(&making, like, problems, made);
}

/* ---- declaration and check ---- */

static void check_stop(inspector *in, const char *what, const char *text) {
  if (g_str_has_suffix(text, ".") || strchr(text, '\n'))
    report_finding(&in->hears,
                   "the summary of %s is not one line without a full stop",
                   what);
}

/* Report each bound of a parameter without its flag. */
static void check_bounds(inspector *in, const opc_parameter *p) {
  if (p->min != 0 && !(p->flags & (OPC_AT_LEAST | OPC_ABOVE)))
    report_finding(&in->hears,
                   "'min' of %s has no effect without OPC_AT_LEAST or "
                   "OPC_ABOVE",
                   p->name);
  if (p->max != 0 && !(p->flags & (OPC_AT_MOST | OPC_BELOW)))
    report_finding(&in->hears,
                   "'max' of %s has no effect without OPC_AT_MOST or OPC_BELOW",
                   p->name);
}

static void check_declaration(inspector *in) {
  const opc_plugin *plugin = in->plugin;
  check_stop(in, "the plugin", plugin->summary);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    check_stop(in, plugin->parameters[i].name, plugin->parameters[i].summary);
    check_bounds(in, &plugin->parameters[i]);
  }
  for (size_t i = 0; i < plugin->n_metrics; i++)
    check_stop(in, plugin->metrics[i].name, plugin->metrics[i].summary);
}

/* Check an instance with a changed parameter. An error must have a message. For
   default values, the message is a note. */
static void check_with(inspector *in, const opc_parameter *p, double number) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_instance made;
  if (!instance_make(in, p, number, NULL, problems, &made)) {
    g_autofree char *text = opc_problems_text(problems);
    if (strstr(text, "no error message"))
      report_finding(&in->hears, "check fails without a message%s%s",
                     p ? " for " : "", p ? p->name : "");
    else if (!p)
      report_note(&in->hears, "check: %s, see --with", text);
  }
  opc_instance_clear(&made);
}

/* Return the valid number nearest to a bound. */
static double bound_inside(const opc_parameter *p, double bound, gboolean open,
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
      check_with(in, p,
                 bound_inside(p, p->min, (p->flags & OPC_ABOVE) != 0, 1));
    if (p->flags & (OPC_AT_MOST | OPC_BELOW))
      check_with(in, p,
                 bound_inside(p, p->max, (p->flags & OPC_BELOW) != 0, -1));
  }
}

/* ---- steps ---- */

/* Return an example for an input; `choices` lists data kinds separated by |. */
static const opc_example *find_example(const inspector *in,
                                       const opc_parameter *p) {
  g_auto(GStrv) kinds = opc_choice_list(p->choices);
  for (size_t i = 0; i < in->kind->n_examples; i++)
    if (g_strv_contains((const char *const *)kinds, in->kind->examples[i].kind))
      return &in->kind->examples[i];
  return NULL;
}

/* Return TRUE for the inputs that receive example data: the required ones or,
   if none is required, the first one. A sample number of n_samples or more
   means all inputs. */
static gboolean is_given(const inspector *in, size_t i) {
  const opc_parameter *p = in->plugin->parameters;
  if (p[i].type != OPC_INPUT) return FALSE;
  if (p[i].flags & OPC_REQUIRED) return TRUE;
  if (in->kind->n_samples && in->sample != OPC_NO_SAMPLE &&
      in->sample >= in->kind->n_samples)
    return TRUE;
  for (size_t k = 0; k < in->plugin->n_parameters; k++)
    if (p[k].type == OPC_INPUT && (k < i || p[k].flags & OPC_REQUIRED))
      return FALSE;
  return TRUE;
}

/* Set the inputs to example data. Return FALSE and add a note if an example is
   missing. */
static gboolean give_inputs(inspector *in, opc_binding *b) {
  for (size_t i = 0; i < in->plugin->n_parameters; i++) {
    const opc_parameter *p = &in->plugin->parameters[i];
    if (!is_given(in, i)) continue;
    opc_error error = {.message = "no example data exist"};
    const opc_example *example = find_example(in, p);
    const void *data = example ? example->give(&error) : NULL;
    if (data)
      opc_binding_set(b, i, data);
    else
      report_note(&in->hears, "run: requires an input '%s' (%s): %s", p->name,
                  p->choices ? p->choices : "anything", error.message);
    if (!data) return FALSE;
  }
  return TRUE;
}

static int output_check(const inspector *in, const opc_port *port,
                        const void *output, opc_error *error) {
  const char *before = guard_enter(in->plugin->id);
  int code = port->check(output, error);
  guard_leave(before);
  return code;
}

/* Return FALSE if the step's forecast reports an error for these inputs. */
static gboolean forecast_step(inspector *in, const opc_module *m) {
  const opc_step *step = m->functions;
  opc_forecast forecast = {0};
  opc_error error = {0};
  if (!step->forecast) return TRUE;
  const char *before = guard_enter(in->plugin->id);
  int code = step->forecast(m->self, &forecast, &error);
  guard_leave(before);
  error.message[sizeof error.message - 1] = 0;
  if (code && !*error.message)
    report_finding(&in->hears, "forecast failed without a message");
  else if (code)
    report_note(&in->hears, "forecast: %s", error.message);
  return !code;
}

static void run_step(inspector *in, const opc_module *m) {
  const opc_step *step = m->functions;
  g_autofree void **outputs = g_new0(void *, step->n_outputs);
  opc_error error = {0};
  const char *before = guard_enter(in->plugin->id);
  int code = step->run(m->self, outputs, &error);
  guard_leave(before);
  error.message[sizeof error.message - 1] = 0;
  if (code == OPC_CANCELLED && is_late(NULL))
    report_note(&in->hears, "run: stopped after %g s, see --with",
                in->lint->seconds * part);
  else if (code && !*error.message)
    report_finding(&in->hears, "run failed without a message");
  else if (code)
    report_note(&in->hears, "run: %s", error.message);
  for (size_t i = 0; i < step->n_outputs; i++) {
    if (!code && !outputs[i])
      report_finding(&in->hears, "run returned no output '%s'",
                     step->outputs[i].name);
    else if (!code && output_check(in, &step->outputs[i], outputs[i], &error))
      report_finding(&in->hears, "run: output '%s': %s", step->outputs[i].name,
                     error.message);
  }
  before = guard_enter(in->plugin->id);
  for (size_t i = step->n_outputs; i-- > 0;)
    if (outputs[i]) step->outputs[i].release(outputs[i]);
  guard_leave(before);
}

/* ---- work ---- */

static gboolean is_step(const inspector *in) {
  return !strcmp(in->plugin->kind, OPC_KIND_STEP);
}

static gboolean can_try(const inspector *in) {
  return (in->kind->exercise || is_step(in)) && in->sample != OPC_NO_SAMPLE;
}

/* An instance under test, and the results. */
typedef struct trial {
  inspector in;
  opc_instance made;
  opc_published published;
  gboolean ready;
} trial;

static void trial_begin(const inspector *in, trial *t) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  t->in = *in;
  opc_published_init(&t->published, in->lint->folder);
  t->in.digest = g_checksum_new(G_CHECKSUM_SHA256);
  t->ready =
      instance_make(in, NULL, 0, &t->published.host, problems, &t->made) &&
      (!is_step(in) || give_inputs(&t->in, t->made.binding));
  if (t->ready) t->in.hears.context = t->made.binding->host->context;
}

/* Run the instance. `exercise` may call the plugin without guard_enter; the
   last guard_leave detects changes of the process by such calls. */
static gpointer trial_work(gpointer data) {
  trial *t = data;
  const opc_module *m = &t->made.binding->module;
  report_alive();
  if (is_step(&t->in)) {
    if (forecast_step(&t->in, m)) run_step(&t->in, m);
  } else
    t->in.kind->exercise(m, &t->in.hears);
  guard_leave(guard_enter(t->in.plugin->id));
  return NULL;
}

/* Return the digest; NULL if the instance was not ready or notes were added. */
static char *trial_end(trial *t) {
  opc_instance_clear(&t->made);
  g_autofree char *published = opc_published_digest(&t->published);
  digest_add(&t->in.hears, published, strlen(published));
  char *digest = g_strdup(g_checksum_get_string(t->in.digest));
  opc_published_clear(&t->published);
  g_checksum_free(t->in.digest);
  if (!t->ready || t->in.notes) g_clear_pointer(&digest, g_free);
  return digest;
}

/* Run a new instance and return the digest of its results. Return NULL if the
   kind has no test or the instance cannot run. */
static char *instance_work(inspector *in) {
  trial t;
  if (!can_try(in)) return NULL;
  trial_begin(in, &t);
  if (t.ready) trial_work(&t);
  return trial_end(&t);
}

static void say_digest(inspector *in) {
  g_autofree char *digest = instance_work(in);
  if (digest) report_text(in, 'D', digest);
}

/* Select the first sample file that the plugin accepts or still reads at the
   time limit: first with the required inputs only, then with all inputs. Add a
   note if there is none. */
static void choose_sample(inspector *in, const char *parameter) {
  inspector nowhere = *in;
  nowhere.out = -1;
  in->sample = OPC_NO_SAMPLE;
  for (size_t i = 0; i < 2 * in->kind->n_samples; i++) {
    nowhere.sample = i;
    g_autofree char *digest = instance_work(&nowhere);
    if (!digest && !is_late(NULL)) continue;
    in->sample = i;
    break;
  }
  g_autofree char *number = g_strdup_printf("%zu", in->sample);
  report_text(in, 'S', number);
  if (in->sample == OPC_NO_SAMPLE)
    report_note(&in->hears,
                "work: requires a file '%s' and no example file "
                "is accepted, see --with",
                parameter);
}

/* Return the first required file parameter that the user did not set; NULL if
   there is none or no instance can be made. */
static char *wanted_file(const inspector *in) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_instance made;
  gboolean good = instance_make(in, NULL, 0, NULL, problems, &made);
  char *found = good ? g_steal_pointer(&made.file) : NULL;
  opc_instance_clear(&made);
  return found;
}

static void check_work(inspector *in) {
  g_autofree char *file = can_try(in) ? wanted_file(in) : NULL;
  if (!can_try(in))
    report_note(&in->hears, "work: the kind '%s' has no test of plugins",
                in->plugin->kind);
  if (file) choose_sample(in, file);
  say_digest(in);
}

/* Report the digest of a second instance in the same process. */
static void check_again(inspector *in) {
  g_free(instance_work(in));
  say_digest(in);
}

static void check_threads(inspector *in) {
  opc_set_threads(THREADS);
  say_digest(in);
}

/* Run two instances at once, each in a thread. Findings are not reported again
   after check_work. */
static void check_together(inspector *in) {
  trial t[TOGETHER];
  GThread *thread[TOGETHER] = {NULL};
  inspector nowhere = *in;
  if (!can_try(in)) return;
  if (!(in->plugin->flags & OPC_REENTRANT)) {
    report_note(&in->hears,
                "two instances at once: the plugin is not OPC_REENTRANT");
    return;
  }
  nowhere.out = -1;
  for (int i = 0; i < TOGETHER; i++) trial_begin(&nowhere, &t[i]);
  for (int i = 0; i < TOGETHER; i++)
    if (t[i].ready) thread[i] = g_thread_new("trial", trial_work, &t[i]);
  for (int i = 0; i < TOGETHER; i++)
    if (thread[i]) g_thread_join(thread[i]);
  for (int i = 0; i < TOGETHER; i++) {
    g_autofree char *digest = trial_end(&t[i]);
    if (digest) report_text(in, 'D', digest);
  }
}

/* ---- memory ---- */

/* Return the growth of memory, bytes per instance, in a series of up to `most`
   instances or SEGMENT seconds; 0 below SMALLEST_LEAK. If `working` is TRUE,
   the instances also run. */
static double memory_growth(const inspector *in, gboolean working, int most) {
  inspector nowhere = *in;
  nowhere.out = -1;
  gint64 end = g_get_monotonic_time() + SEGMENT * G_USEC_PER_SEC;
  struct mallinfo2 before = mallinfo2();
  int n = 0;
  for (; n < most && g_get_monotonic_time() < end; n++) {
    if (working) {
      g_free(instance_work(&nowhere));
      continue;
    }
    g_autoptr(opc_problems) problems = opc_problems_new();
    opc_instance made;
    instance_make(in, NULL, 0, NULL, problems, &made);
    opc_instance_clear(&made);
  }
  struct mallinfo2 after = mallinfo2();
  double more = (double)after.uordblks + (double)after.hblkhd -
                (double)before.uordblks - (double)before.hblkhd;
  return more < SMALLEST_LEAK ? 0 : more / n;
}

/* Report a leak if memory grows in two successive series. One instance before
   the series fills caches. */
static void check_leaks(inspector *in) {
  for (int working = 0; working < 2; working++) {
    memory_growth(in, working, 1);
    if (is_late(NULL)) return;
    double one = memory_growth(in, working, CYCLES);
    double two = one > 0 ? memory_growth(in, working, CYCLES) : 0;
    if (!(two > 0)) continue;
    report_finding(
        &in->hears,
        "leaks %.0f bytes each time an instance is created%s and freed",
        MIN(one, two), working ? ", used" : "");
    return;
  }
}

/* ---- all checks ---- */

const opc_check opc_checks[] = {
    {"loading", FALSE, NULL, check_declaration},
    {"check", FALSE, NULL, check_instances},
    {"work", TRUE, NULL, check_work},
    {"the same work again", TRUE,
     "returns different bits the second time, for the same input", check_again},
    {"work on several threads", TRUE,
     "returns different bits on several threads than on one", check_threads},
    {"two instances at once", TRUE,
     "returns different bits while another instance works", check_together},
    {"creating and freeing", FALSE, NULL, check_leaks},
    {NULL, FALSE, NULL, NULL},
};

/* Write the sample files into the folder of the lint. */
static gboolean write_samples(inspector *in) {
  for (size_t i = 0; i < in->kind->n_samples; i++) {
    const opc_sample *sample = &in->kind->samples[i];
    g_autofree char *path = sample_path(in, i);
    g_autoptr(GError) error = NULL;
    if (g_file_set_contents(path, sample->bytes, (gssize)sample->size, &error))
      continue;
    report_finding(&in->hears, "%s", error->message);
    return FALSE;
  }
  return TRUE;
}

/* Only check_threads and check_together use several threads. */
void opc_check_do(const opc_lint *lint, size_t i, int out) {
  opc_error error = {0};
  inspector in = {
      .hears = {.add = digest_add, .find = report_finding, .note = report_note},
      .lint = lint,
      .check = i,
      .sample = lint->sample,
      .out = out};
  listening = in;
  guard_listen(&process_listener);
  begun = g_get_monotonic_time();
  granted = (gint64)(lint->seconds * part * 1e6);
  opc_set_threads(1);
  in.plugin = opc_registry_find(lint->registry, lint->id, &error);
  in.kind = in.plugin ? opc_kind_trials(lint->registry, in.plugin->kind) : NULL;
  if (!in.kind)
    report_finding(&in.hears, "%s", error.message);
  else if (write_samples(&in))
    opc_checks[i].work(&in);
  report_text(&in, 'E', "");
}
