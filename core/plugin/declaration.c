/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the copy and the check of a plugin's descriptor. */
#include "core/plugin/declaration.h"

#include <base/file.h>
#include <base/unit.h>
#include <math.h>
#include <string.h>

#include "core/plugin/value.h"

/* Limit of the number of elements and of the size of an element, bytes. Corrupt
   numbers are rejected before the array is read. */
enum { MOST = 4096 };

size_t opc_port_count(const opc_plugin *plugin) {
  if (strcmp(plugin->kind, OPC_KIND_STEP) != 0) return 0;
  return ((const opc_step *)plugin->functions)->n_outputs;
}

const opc_port *opc_port_at(const opc_plugin *plugin, size_t i) {
  return &((const opc_step *)plugin->functions)->outputs[i];
}

int opc_parameter_find(const opc_plugin *plugin, const char *name) {
  for (size_t i = 0; i < plugin->n_parameters; i++)
    if (!strcmp(plugin->parameters[i].name, name)) return (int)i;
  return -1;
}

const opc_metric *opc_metric_find(const opc_plugin *plugin, const char *name) {
  for (size_t i = 0; i < plugin->n_metrics; i++)
    if (!strcmp(plugin->metrics[i].name, name)) return &plugin->metrics[i];
  return NULL;
}

const opc_metric *opc_metric_check(const opc_plugin *plugin, const char *name,
                                   double value, opc_error *error) {
  const opc_metric *metric = opc_metric_find(plugin, name);
  if (metric && isfinite(value)) return metric;
  if (metric)
    opc_fail(error, OPC_FAILED, NULL,
             "metric '%s' of '%s' is %g, expected a finite number", name,
             plugin->id, value);
  else
    opc_fail(error, OPC_FAILED, NULL, "'%s' declares no metric '%s'",
             plugin->id, name);
  return NULL;
}

static const char timeout_name[] = "timeout";

const opc_plugin *opc_timeout_add(opc_plugin *plugin) {
  if (strcmp(plugin->kind, OPC_KIND_STEP) != 0 ||
      opc_parameter_find(plugin, timeout_name) >= 0)
    return plugin;
  size_t width = sizeof(double),
         offset = (plugin->instance_size + width - 1) / width * width;
  /* opc_declared_copy leaves space for one element. */
  ((opc_parameter *)plugin->parameters)[plugin->n_parameters++] =
      (opc_parameter){
          timeout_name,
          OPC_REAL,
          OPC_ABOVE | OPC_NO_EFFECT,
          "s",
          .summary = "Time limit; a step that exceeds the limit fails",
          .offset = offset,
          .width = width};
  plugin->instance_size = offset + width;
  return plugin;
}

int opc_timeout_find(const opc_plugin *plugin) {
  size_t last = plugin->n_parameters;
  return last && plugin->parameters[last - 1].name == timeout_name
             ? (int)last - 1
             : -1;
}

const opc_choices *opc_choices_of(const opc_plugin *plugin) {
  return plugin->extension ? plugin->extension(OPC_CHOICES) : NULL;
}

/* ---- copies ---- */

gconstpointer opc_declared_copy(gconstpointer from, size_t n, size_t theirs,
                                size_t oldest, size_t ours) {
  static GPtrArray *all; /* never freed, as plugins stay loaded */
  if (n > MOST || (n && (!from || theirs < oldest || theirs > MOST)))
    return NULL;
  char *copy = g_malloc0_n(n + 1, ours);
  for (size_t i = 0; i < n; i++)
    memcpy(copy + i * ours, (const char *)from + i * theirs, MIN(theirs, ours));
  if (!all) all = g_ptr_array_new();
  g_ptr_array_add(all, copy);
  return copy;
}

/* ---- validity ---- */

/* Return the first fault of a parameter that needs no values in the message, as
   text to append to the parameter's name; NULL without such a fault. */
static const char *parameter_flaw(const opc_plugin *plugin,
                                  const opc_parameter *p) {
  uint32_t low = p->flags & (OPC_AT_LEAST | OPC_ABOVE);
  uint32_t high = p->flags & (OPC_AT_MOST | OPC_BELOW);
  size_t size = plugin->instance_size;
  g_auto(GStrv) words = opc_choice_list(p->choices);
  if (!p->summary) return " has no summary";
  /* The field must be inside the instance, after `host`. */
  if (p->offset < sizeof(opc_host *) || p->offset > size ||
      size - p->offset < p->width)
    return ": the field is outside of the instance";
  if (p->given && (p->given > size || size - p->given < sizeof(int)))
    return ": 'given' is outside of the instance";
  if (p->flags & OPC_LISTED && (p->type != OPC_TEXT || !opc_choices_of(plugin)))
    return " is OPC_LISTED, but is no text or the plugin has no function that "
           "lists choices";
  if (!p->choices &&
      (p->type == OPC_CHOICE || p->type == OPC_SLOT || p->type == OPC_INPUT))
    return " has no choices";
  if (g_strv_contains((const char *const *)words, ""))
    return " has an empty choice";
  if (low == (OPC_AT_LEAST | OPC_ABOVE) || high == (OPC_AT_MOST | OPC_BELOW) ||
      (low && high && !(p->min <= p->max)))
    return " has bounds that no value meets";
  if (p->preset && p->flags & OPC_REQUIRED)
    return " is required and has a default";
  if (p->follows &&
      (p->preset || p->flags & OPC_REQUIRED || p->type != OPC_REAL))
    return " follows from other values, and must be a number, not required and "
           "without a default";
  return p->preset && p->type == OPC_INPUT ? ": an input has no default" : NULL;
}

static char *preset_fault(const opc_parameter *p) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node = p->preset ? opc_preset_parse(p, problems) : NULL;
  g_autoptr(GPtrArray) owned = g_ptr_array_new_with_free_func(g_free);
  opc_setting value = {0};
  if (node && p->type != OPC_SLOT)
    opc_setting_convert(p, node, FALSE, owned, problems, &value);
  if (!problems->list->len) return NULL;
  const opc_problem *first = problems->list->pdata[0];
  return g_strdup_printf("default of parameter '%s': %s", p->name,
                         first->message);
}

/* Return whether one name is a group that contains the other: "a" and "a.b". */
static gboolean are_nested(const char *a, const char *b) {
  return (g_str_has_prefix(a, b) && a[strlen(b)] == '.') ||
         (g_str_has_prefix(b, a) && b[strlen(a)] == '.');
}

static char *parameter_fault(const opc_plugin *plugin, size_t i) {
  const opc_parameter *p = &plugin->parameters[i];
  if (!p->name || !opc_is_id(p->name) || !strcmp(p->name, "use"))
    return g_strdup_printf("parameter %zu has no valid name", i + 1);
  for (size_t j = 0; j < i; j++) {
    const char *other = plugin->parameters[j].name;
    if (!strcmp(p->name, other))
      return g_strdup_printf("parameter '%s' is declared twice", p->name);
    if (are_nested(p->name, other))
      return g_strdup_printf(
          "parameter '%s' and parameter '%s' conflict: one is a group of the "
          "other",
          other, p->name);
  }
  if (!opc_type_name(p->type))
    return g_strdup_printf("parameter '%s' has the unknown type %u", p->name,
                           p->type);
  if (p->unit && !opc_unit_find(p->unit))
    return g_strdup_printf("parameter '%s' has the unknown unit '%s'", p->name,
                           p->unit);
  if (p->width != opc_setting_width(p->type))
    return g_strdup_printf(
        "parameter '%s': the field has %zu bytes, expected for the type '%s' "
        "%zu",
        p->name, p->width, opc_type_name(p->type), opc_setting_width(p->type));
  const char *flaw = parameter_flaw(plugin, p);
  if (flaw) return g_strdup_printf("parameter '%s'%s", p->name, flaw);
  if (p->type == OPC_SLOT && !opc_is_id(p->choices))
    return g_strdup_printf("parameter '%s': '%s' is not a kind of plugin",
                           p->name, p->choices);
  return preset_fault(p);
}

static char *metric_fault(const opc_plugin *plugin, size_t i) {
  const opc_metric *m = &plugin->metrics[i];
  if (!m->name || !*m->name)
    return g_strdup_printf("metric %zu has no name", i + 1);
  for (size_t j = 0; j < i; j++)
    if (!strcmp(m->name, plugin->metrics[j].name))
      return g_strdup_printf("metric '%s' is declared twice", m->name);
  if (m->better > OPC_HIGHER || !m->summary)
    return g_strdup_printf("metric '%s' has no valid direction or no summary",
                           m->name);
  return NULL;
}

static char *arrays_fault(const opc_plugin *plugin) {
  char *fault = NULL;
  for (size_t i = 0; !fault && i < plugin->n_parameters; i++)
    fault = parameter_fault(plugin, i);
  for (size_t i = 0; !fault && i < plugin->n_metrics; i++)
    fault = metric_fault(plugin, i);
  return fault;
}

static char *version_fault(const opc_plugin *plugin) {
  if (plugin->abi_major == OPC_ABI_MAJOR && plugin->abi_minor >= OPC_ABI_OLDEST)
    return NULL;
  return g_strdup_printf(
      "built for plugin interface %u.%u, this is %u.%u (oldest: %u.%u)",
      plugin->abi_major, plugin->abi_minor, OPC_ABI_MAJOR, OPC_ABI_MINOR,
      OPC_ABI_MAJOR, OPC_ABI_OLDEST);
}

opc_plugin *opc_plugin_copy(const opc_plugin *theirs, char **fault) {
  *fault = theirs ? version_fault(theirs)
                  : g_strdup(OPC_ENTRY_NAME "() returned nothing");
  if (*fault) return NULL;
  opc_plugin *own = (opc_plugin *)OPC_DECLARED_COPY(opc_plugin, extension,
                                                    theirs, 1, theirs->size);
  if (!own) {
    *fault = g_strdup_printf(
        "the size of the descriptor, %u bytes, is not valid", theirs->size);
    return NULL;
  }
  own->parameters = OPC_DECLARED_COPY(opc_parameter, follows, own->parameters,
                                      own->n_parameters, own->parameter_size);
  own->metrics = OPC_DECLARED_COPY(opc_metric, summary, own->metrics,
                                   own->n_metrics, own->metric_size);
  if (!own->parameters)
    *fault = g_strdup("the parameters are not an array of opc_parameter");
  else if (!own->metrics)
    *fault = g_strdup("the metrics are not an array of opc_metric");
  return *fault ? NULL : own;
}

char *opc_plugin_fault(const opc_plugin *plugin, const char *id) {
  if (!plugin->id || !opc_is_id(plugin->id))
    return g_strdup("the id does not consist of lower-case words and dots");
  if (strcmp(plugin->id, id) != 0)
    return g_strdup_printf("the id is '%s', but the file name is '%s'",
                           plugin->id, id);
  const struct {
    const char *name, *text;
  } texts[] = {{"kind", plugin->kind},
               {"version", plugin->version},
               {"licence", plugin->licence},
               {"summary", plugin->summary}};
  for (size_t i = 0; i < G_N_ELEMENTS(texts); i++)
    if (!texts[i].text || !*texts[i].text)
      return g_strdup_printf("the descriptor has no %s", texts[i].name);
  if (plugin->instance_size < sizeof(opc_host *))
    return g_strdup("the instance is too small for the pointer to the host");
  if (!plugin->functions) return g_strdup("the plugin has no functions");
  return arrays_fault(plugin);
}
