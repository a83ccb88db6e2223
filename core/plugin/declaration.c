/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/plugin/declaration.h"

#include <string.h>

#include "core/flow/unit.h"
#include "core/flow/value.h"
#include "core/plugin/guard.h"

/* More than any plugin will have; a wild number is caught before its array is
   read. */
enum { MOST = 4096 };

/* ---- arrays ---- */

const opc_parameter *opc_parameter_at(const opc_plugin *plugin, size_t i) {
  return (const opc_parameter *)((const char *)plugin->parameters +
                                 i * plugin->parameter_size);
}

const opc_metric *opc_metric_at(const opc_plugin *plugin, size_t i) {
  return (const opc_metric *)((const char *)plugin->metrics +
                              i * plugin->metric_size);
}

size_t opc_port_count(const opc_plugin *plugin) {
  if (plugin->kind != OPC_KIND_STEP) return 0;
  return ((const opc_step *)plugin->operations)->n_outputs;
}

const opc_port *opc_port_at(const opc_plugin *plugin, size_t i) {
  const opc_step *step = plugin->operations;
  return (const opc_port *)((const char *)step->outputs + i * step->port_size);
}

int opc_parameter_find(const opc_plugin *plugin, const char *name) {
  for (size_t i = 0; i < plugin->n_parameters; i++)
    if (!strcmp(opc_parameter_at(plugin, i)->name, name)) return (int)i;
  return -1;
}

const opc_metric *opc_metric_find(const opc_plugin *plugin, const char *name) {
  for (size_t i = 0; i < plugin->n_metrics; i++)
    if (!strcmp(opc_metric_at(plugin, i)->name, name))
      return opc_metric_at(plugin, i);
  return NULL;
}

static const opc_renames *renames_of(const opc_plugin *plugin) {
  if (!plugin->get_extension) return NULL;
  const char *before = opc_enter(plugin->id);
  const opc_renames *renames = plugin->get_extension(OPC_RENAMED_PARAMETERS);
  opc_leave(before);
  return renames;
}

size_t opc_rename_count(const opc_plugin *plugin) {
  const opc_renames *renames = renames_of(plugin);
  return renames ? renames->count : 0;
}

const opc_rename *opc_rename_at(const opc_plugin *plugin, size_t i) {
  const opc_renames *renames = renames_of(plugin);
  return (const opc_rename *)((const char *)renames->renames +
                              i * renames->rename_size);
}

const opc_rename *opc_rename_find(const opc_plugin *plugin, const char *from) {
  for (size_t i = 0; i < opc_rename_count(plugin); i++)
    if (!strcmp(opc_rename_at(plugin, i)->from, from))
      return opc_rename_at(plugin, i);
  return NULL;
}

/* ---- names ---- */

static const char *const kinds[] = {NULL,   "litho", "resist", "extract",
                                    "mask", "drc",   "step"};
static const char *const types[] = {NULL,    "bool",   "int",   "real",
                                    "text",  "choice", "file",  "output",
                                    "reals", "map",    "input", "slot"};

const char *opc_kind_name(uint32_t kind) {
  return kind < G_N_ELEMENTS(kinds) ? kinds[kind] : NULL;
}

uint32_t opc_kind_find(const char *name) {
  for (uint32_t i = 1; i < G_N_ELEMENTS(kinds); i++)
    if (!strcmp(kinds[i], name)) return i;
  return 0;
}

const char *opc_type_name(uint32_t type) {
  return type < G_N_ELEMENTS(types) ? types[type] : NULL;
}

char **opc_choice_list(const char *choices) {
  return g_strsplit(choices ? choices : "", "|", -1);
}

gboolean opc_is_id(const char *name) {
  gboolean start = TRUE; /* of a word */
  for (const char *c = name; *c; c++) {
    if (*c == '.' ? start
                  : !(g_ascii_islower(*c) ||
                      (!start && (g_ascii_isdigit(*c) || *c == '_'))))
      return FALSE;
    start = *c == '.';
  }
  return !start;
}

/* ---- soundness ---- */

static char *choices_fault(const opc_parameter *p) {
  if (!p->choices) {
    if (p->type == OPC_CHOICE || p->type == OPC_SLOT || p->type == OPC_INPUT)
      return g_strdup_printf("parameter '%s' has no choices", p->name);
    return NULL;
  }
  g_auto(GStrv) words = opc_choice_list(p->choices);
  for (guint i = 0; words[i]; i++)
    if (!*words[i])
      return g_strdup_printf("parameter '%s' has an empty choice", p->name);
  if (p->type == OPC_SLOT && !opc_kind_find(p->choices))
    return g_strdup_printf("parameter '%s': '%s' is no kind of plugin", p->name,
                           p->choices);
  return NULL;
}

static char *bounds_fault(const opc_parameter *p) {
  uint32_t low = p->flags & (OPC_AT_LEAST | OPC_ABOVE);
  uint32_t high = p->flags & (OPC_AT_MOST | OPC_BELOW);
  if (low == (OPC_AT_LEAST | OPC_ABOVE) || high == (OPC_AT_MOST | OPC_BELOW) ||
      (low && high && !(p->min <= p->max)))
    return g_strdup_printf("parameter '%s' has bounds that fit no value",
                           p->name);
  return NULL;
}

static char *preset_fault(const opc_parameter *p) {
  if (!p->preset) return NULL;
  if (p->flags & OPC_REQUIRED)
    return g_strdup_printf("parameter '%s' is required and has a default",
                           p->name);
  if (p->type == OPC_INPUT)
    return g_strdup_printf("parameter '%s': an input has no default", p->name);
  opc_source source = {.name = NULL};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node = opc_preset_parse(p, &source, problems);
  if (node && p->type != OPC_SLOT) {
    g_autoptr(GPtrArray) owned = g_ptr_array_new_with_free_func(g_free);
    opc_value value = {0};
    opc_value_convert(p, node, FALSE, owned, problems, &value);
  }
  if (!problems->list->len) return NULL;
  const opc_problem *first = problems->list->pdata[0];
  return g_strdup_printf("default of parameter '%s': %s", p->name,
                         first->message);
}

/* Whether one is the group that the other is in. */
static gboolean are_nested(const char *a, const char *b) {
  return (g_str_has_prefix(a, b) && a[strlen(b)] == '.') ||
         (g_str_has_prefix(b, a) && b[strlen(a)] == '.');
}

static char *parameter_fault(const opc_plugin *plugin, size_t i) {
  const opc_parameter *p = opc_parameter_at(plugin, i);
  if (!p->name || !opc_is_id(p->name) || !strcmp(p->name, "use"))
    return g_strdup_printf("parameter %zu has no proper name", i + 1);
  for (size_t j = 0; j < i; j++) {
    const char *other = opc_parameter_at(plugin, j)->name;
    if (!strcmp(p->name, other))
      return g_strdup_printf("parameter '%s' is there twice", p->name);
    if (are_nested(p->name, other))
      return g_strdup_printf("parameters '%s' and '%s' get in each other's way",
                             other, p->name);
  }
  if (!opc_type_name(p->type))
    return g_strdup_printf("parameter '%s' has the unknown type %u", p->name,
                           p->type);
  if (p->unit && !opc_unit_find(p->unit))
    return g_strdup_printf("parameter '%s' has the unknown unit '%s'", p->name,
                           p->unit);
  if (!p->summary)
    return g_strdup_printf("parameter '%s' has no summary", p->name);
  char *fault = choices_fault(p);
  if (!fault) fault = bounds_fault(p);
  if (!fault) fault = preset_fault(p);
  return fault;
}

static char *rename_fault(const opc_plugin *plugin, size_t i) {
  const opc_rename *r = opc_rename_at(plugin, i);
  if (!r->from || !r->to || !opc_is_id(r->from) || !r->since)
    return g_strdup_printf("renamed parameter %zu is not complete", i + 1);
  if (opc_parameter_find(plugin, r->to) < 0)
    return g_strdup_printf("'%s' was renamed to '%s', which is no parameter",
                           r->from, r->to);
  const char *other = NULL;
  for (size_t j = 0; j < plugin->n_parameters && !other; j++) {
    const char *name = opc_parameter_at(plugin, j)->name;
    if (!strcmp(name, r->from) || are_nested(name, r->from)) other = name;
  }
  for (size_t j = 0; j < i && !other; j++) {
    const char *name = opc_rename_at(plugin, j)->from;
    if (!strcmp(name, r->from) || are_nested(name, r->from)) other = name;
  }
  if (!other) return NULL;
  return g_strdup_printf("renamed parameter '%s' gets in the way of '%s'",
                         r->from, other);
}

static char *renames_fault(const opc_plugin *plugin) {
  const opc_renames *renames = renames_of(plugin);
  if (!renames) return NULL;
  if (renames->size < sizeof *renames || renames->count > MOST ||
      (renames->count &&
       (renames->rename_size < sizeof(opc_rename) || !renames->renames)))
    return g_strdup("its renamed parameters are not an array of opc_rename");
  char *fault = NULL;
  for (size_t i = 0; !fault && i < renames->count; i++)
    fault = rename_fault(plugin, i);
  return fault;
}

static char *metric_fault(const opc_plugin *plugin, size_t i) {
  const opc_metric *m = opc_metric_at(plugin, i);
  if (!m->name || !*m->name)
    return g_strdup_printf("metric %zu has no name", i + 1);
  for (size_t j = 0; j < i; j++)
    if (!strcmp(m->name, opc_metric_at(plugin, j)->name))
      return g_strdup_printf("metric '%s' is there twice", m->name);
  if (m->better > OPC_HIGHER || !m->summary)
    return g_strdup_printf("metric '%s' is not complete", m->name);
  return NULL;
}

static char *ports_fault(const opc_step *step) {
  if (!step->n_outputs) return NULL;
  if (step->n_outputs > MOST || step->port_size < sizeof(opc_port) ||
      !step->outputs)
    return g_strdup("the outputs are not an array of opc_port");
  for (size_t i = 0; i < step->n_outputs; i++) {
    const opc_port *port =
        (const opc_port *)((const char *)step->outputs + i * step->port_size);
    if (!port->name || !port->kind || !port->release || !opc_is_id(port->name))
      return g_strdup_printf("output %zu is not complete", i + 1);
  }
  return NULL;
}

/* The functions of a kind: where they begin in its struct and how many there
   are, in the first minor of this major. */
static char *operations_fault(const opc_plugin *plugin) {
  static const struct {
    size_t size, first, functions;
  } needs[] = {
      [OPC_KIND_LITHO] = {sizeof(opc_litho), offsetof(opc_litho, prepare), 3},
      [OPC_KIND_RESIST] = {sizeof(opc_resist), offsetof(opc_resist, prepare),
                           2},
      [OPC_KIND_EXTRACT] = {offsetof(opc_extract, slice), offsetof(opc_extract, prepare),
                            3},
      [OPC_KIND_MASK] = {offsetof(opc_synthesizer, cut),
                         offsetof(opc_synthesizer, begin), 3},
      [OPC_KIND_DRC] = {sizeof(opc_regulator), offsetof(opc_regulator, rule),
                        2},
      [OPC_KIND_STEP] = {sizeof(opc_step), offsetof(opc_step, run), 1},
  };
  const char *operations = plugin->operations;
  if (!operations) return g_strdup("it has no operations");
  size_t size = *(const size_t *)plugin->operations;
  if (size < needs[plugin->kind].size)
    return g_strdup_printf("its operations have %zu bytes, %zu are needed",
                           size, needs[plugin->kind].size);
  for (size_t i = 0; i < needs[plugin->kind].functions; i++) {
    void *function;
    memcpy(&function,
           operations + needs[plugin->kind].first + i * sizeof function,
           sizeof function);
    if (!function)
      return g_strdup_printf("function %zu of its operations is missing",
                             i + 1);
  }
  return plugin->kind == OPC_KIND_STEP ? ports_fault(plugin->operations) : NULL;
}

static char *arrays_fault(const opc_plugin *plugin) {
  if (plugin->n_parameters &&
      (plugin->n_parameters > MOST ||
       plugin->parameter_size < sizeof(opc_parameter) || !plugin->parameters))
    return g_strdup("its parameters are not an array of opc_parameter");
  if (plugin->n_metrics &&
      (plugin->n_metrics > MOST || plugin->metric_size < sizeof(opc_metric) ||
       !plugin->metrics))
    return g_strdup("its metrics are not an array of opc_metric");
  char *fault = NULL;
  for (size_t i = 0; !fault && i < plugin->n_parameters; i++)
    fault = parameter_fault(plugin, i);
  if (!fault) fault = renames_fault(plugin);
  for (size_t i = 0; !fault && i < plugin->n_metrics; i++)
    fault = metric_fault(plugin, i);
  return fault;
}

char *opc_plugin_fault(const opc_plugin *plugin, const char *id) {
  if (!plugin) return g_strdup(OPC_ENTRY_NAME "() returned nothing");
  /* The frozen prefix: no other field is looked at before it is good. */
  if (plugin->size < sizeof(uint32_t) + 2 * sizeof(uint16_t))
    return g_strdup_printf("its descriptor has %u bytes, %zu are needed",
                           plugin->size, sizeof(opc_plugin));
  if (plugin->abi_major != OPC_ABI_MAJOR)
    return g_strdup_printf("built for plugin interface %u, this is %u",
                           plugin->abi_major, OPC_ABI_MAJOR);
  if (plugin->size < sizeof(opc_plugin))
    return g_strdup_printf("its descriptor has %u bytes, %zu are needed",
                           plugin->size, sizeof(opc_plugin));
  if (!plugin->id || !opc_is_id(plugin->id))
    return g_strdup("its id is not made of lower-case words and dots");
  if (strcmp(plugin->id, id))
    return g_strdup_printf("its id is '%s', its file is called '%s'",
                           plugin->id, id);
  if (!plugin->version || !plugin->licence || !plugin->summary)
    return g_strdup("it has no version, licence or summary");
  if (!opc_kind_name(plugin->kind))
    return g_strdup_printf("its kind %u is unknown", plugin->kind);
  if (!plugin->create || !plugin->destroy)
    return g_strdup("it has no create or destroy");
  char *fault = operations_fault(plugin);
  return fault ? fault : arrays_fault(plugin);
}
