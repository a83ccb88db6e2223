/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects the facts that a step's result depends on: builds of plugins and of
   all linked objects, values, contents of files, and the keys of the inputs. A
   key does not depend on the number of threads or on places in flow files. */
#include "core/run/key.h"

#include <base/file.h>
#include <string.h>

#include "core/binding/inner.h"
#include "core/plugin/value.h"

typedef struct keyer {
  opc_store *store;
  opc_key *keys, *key;       /* keys of all steps; key of this step */
  const opc_flow_step *step; /* NULL for the key of an instance */
  const char *root;          /* path of the step or instance */
  GVariantBuilder facts;
} keyer;

/* ---- facts ---- */

/* Return a parameter's path below the root, such as "slot.name" (g_free). */
static char *place_of(const keyer *k, const opc_binding *b, const char *name) {
  const char *rest = b->path + strlen(k->root);
  rest += *rest == '.';
  return g_strdup_printf("%s%s%s", rest, *rest && *name ? "." : "", name);
}

static void keyer_add(keyer *k, char about, const char *path, const char *shown,
                      const char *sum) {
  opc_facts_add(&k->facts, about, path, shown, sum);
}

/* Record why the result cannot be stored; takes ownership of the reason. The
   first reason is kept. */
static void keyer_exclude(keyer *k, char *why) {
  if (k->key->why)
    g_free(why);
  else
    k->key->why = why;
}

static void add_build(keyer *k, char about, const char *path, const char *shown,
                      const opc_plugin *plugin) {
  const char *sum = opc_store_build(k->store, plugin ? plugin->id : NULL);
  if (sum)
    keyer_add(k, about, path, shown, sum);
  else
    keyer_exclude(k, g_strdup_printf("the shared objects of %s cannot be read",
                                     plugin ? plugin->id : "opcflow"));
}

/* ---- values ---- */

static void add_file(keyer *k, const char *path, const char *file) {
  opc_error error;
  g_autofree char *whole = g_canonicalize_filename(file, NULL);
  g_autofree char *name = g_path_get_basename(file);
  char *sum = opc_store_sum(k->store, whole, NULL, &error);
  if (!sum) {
    keyer_exclude(k, g_strdup(error.message));
    return;
  }
  keyer_add(k, OPC_FACT_FILE, path, name, sum);
  g_ptr_array_add(k->key->files, g_steal_pointer(&whole));
  g_ptr_array_add(k->key->files, sum);
}

/* Add all files in the folder of `file`. */
static void add_beside(keyer *k, const char *path, const char *file) {
  enum { MOST = 1000 }; /* largest number of files; kernel sets have tens */
  g_autofree char *folder = g_path_get_dirname(file);
  g_autoptr(GPtrArray) names = opc_folder_names(folder);
  for (guint i = names ? names->len : 0; i-- > 0;) {
    g_autofree char *one = g_build_filename(folder, names->pdata[i], NULL);
    if (!g_file_test(one, G_FILE_TEST_IS_REGULAR))
      g_ptr_array_remove_index(names, i);
  }
  if (!names || names->len > MOST) {
    keyer_exclude(
        k, g_strdup_printf("'%s' is unreadable or has too many files", folder));
    return;
  }
  for (guint i = 0; i < names->len; i++) {
    const char *name = names->pdata[i];
    g_autofree char *one = g_build_filename(folder, name, NULL);
    g_autofree char *its = g_strdup_printf("%s beside %s", name, path);
    add_file(k, its, one);
  }
}

/* Append a text of a list or map in quotes, so that its end is unambiguous. */
static void text_append_quoted(GString *out, const char *text) {
  g_autofree char *quoted = g_strescape(text, NULL);
  g_string_append_printf(out, "%s\"%s\"", out->len ? " " : "", quoted);
}

static char *value_text(const opc_parameter *p, const opc_field *f) {
  g_autoptr(GString) out = g_string_new("");
  switch (p->type) {
    case OPC_BOOL:
      return g_strdup(f->flag > 0 ? "true" : "false");
    case OPC_INT:
      return g_strdup_printf("%" G_GINT64_FORMAT, (gint64)f->integer);
    case OPC_REAL:
      return opc_quantity_text(p, f->real);
    case OPC_CHOICE: {
      g_auto(GStrv) words = g_strsplit(p->choices, "|", -1);
      return g_strdup(words[f->flag]);
    }
    case OPC_REALS:
      for (size_t i = 0; i < f->reals.count; i++) {
        g_autofree char *one = opc_quantity_text(p, f->reals.values[i]);
        g_string_append_printf(out, "%s%s", i ? ", " : "", one);
      }
      return g_strdup_printf("[%s]", out->str);
    case OPC_MAP:
      for (size_t i = 0; i < f->map.count; i++) {
        text_append_quoted(out, f->map.pairs[i].key);
        text_append_quoted(out, f->map.pairs[i].value);
      }
      return g_strdup_printf("{%s}", out->str);
    default:
      return g_strdup(f->text ? f->text : "");
  }
}

/* Add the value of a parameter, and, if the plugin has a `given` field, whether
   the value was given. */
static void add_value(keyer *k, const opc_binding *b, size_t i) {
  const opc_parameter *p = &b->plugin->parameters[i];
  const opc_setting *v = &b->values[i];
  g_autofree char *path = place_of(k, b, p->name);
  if (!v->present || p->type == OPC_INPUT || p->type == OPC_SLOT ||
      p->flags & (OPC_NO_EFFECT | OPC_INNER_FLOW))
    return;
  if (p->type == OPC_FILE) {
    add_file(k, path, v->field.text);
    if (p->flags & OPC_BESIDE) add_beside(k, path, v->field.text);
    return;
  }
  g_autofree char *text = value_text(p, &v->field);
  keyer_add(k, OPC_FACT_PARAMETER, path, text,
            p->given && v->given ? "given" : "");
}

/* ---- the flow that a step runs ---- */

typedef struct inner_sum {
  keyer *keyer;
  GChecksum *sum;
} inner_sum;

static void take_flow(void *data, const opc_flow *flow) {
  const inner_sum *in = data;
  g_autofree opc_key *keys = g_new0(opc_key, flow->steps->len);
  opc_flow_keys(flow, in->keyer->store, keys);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    if (!keys[i].sum)
      keyer_exclude(in->keyer, g_strdup_printf("in its flow, %s: %s",
                                               step->name, keys[i].why));
    g_autofree char *line =
        g_strdup_printf("%s %s\n", step->name, keys[i].sum ? keys[i].sum : "");
    g_checksum_update(in->sum, (const guchar *)line, -1);
    opc_key_clear(&keys[i]);
  }
}

static void add_inner(keyer *k, const opc_binding *b) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  inner_sum in = {k, sum};
  opc_inner_visit(b->inner, take_flow, &in);
  keyer_add(k, OPC_FACT_INNER, "", "", g_checksum_get_string(sum));
}

/* ---- a step ---- */

static void add_instance(keyer *k, const opc_binding *b) {
  g_autofree char *path = place_of(k, b, "");
  const opc_plugin *loader = opc_plugin_loader(b->plugin);
  add_build(k, OPC_FACT_PLUGIN, path, b->plugin->id,
            loader ? loader : b->plugin);
  const opc_loader *functions = loader ? loader->functions : NULL;
  const char *const *files = loader ? functions->files(b->plugin->id) : NULL;
  for (; files && *files; files++) {
    g_autofree char *name = g_path_get_basename(*files);
    g_autofree char *its = g_strdup_printf("%s of %s", name, path);
    add_file(k, its, *files);
  }
  if (!(b->plugin->flags & OPC_DETERMINISTIC))
    keyer_exclude(
        k, g_strdup_printf("%s does not promise equal results for equal inputs",
                           b->plugin->id));
  for (size_t i = 0; i < b->plugin->n_parameters; i++) add_value(k, b, i);
  if (b->inner) add_inner(k, b);
}

static void add_inputs(keyer *k) {
  for (guint i = 0; i < k->step->inputs->len; i++) {
    const opc_flow_input *in =
        &g_array_index(k->step->inputs, opc_flow_input, i);
    const opc_plugin *from = in->from->binding->plugin;
    const char *sum = k->keys[in->from->number].sum;
    g_autofree char *path = place_of(
        k, in->binding, in->binding->plugin->parameters[in->parameter].name);
    if (!sum)
      keyer_exclude(
          k, g_strdup_printf(
                 "the step uses the output of step '%s', which is not stored",
                 in->from->name));
    else
      keyer_add(k, OPC_FACT_INPUT, path,
                ((const opc_step *)from->functions)->outputs[in->port].name,
                sum);
  }
}

static void make_key(keyer *k) {
  const opc_binding *b = k->step->binding;
  const opc_step *functions = b->plugin->functions;
  g_autoptr(GPtrArray) instances = g_ptr_array_new();
  k->key->files = g_ptr_array_new_with_free_func(g_free);
  g_variant_builder_init(&k->facts, OPC_FACTS_TYPE);
  if (functions->flags & OPC_STEP_OUTSIDE)
    keyer_exclude(k, g_strdup_printf("%s reads files that no parameter names",
                                     b->plugin->id));
  add_build(k, OPC_FACT_COMMAND, "", opc_facts_machine(), NULL);
  opc_binding_list(b, instances);
  for (guint i = 0; i < instances->len; i++)
    add_instance(k, instances->pdata[i]);
  add_inputs(k);
  k->key->facts = g_variant_ref_sink(g_variant_builder_end(&k->facts));
  if (k->key->why)
    g_clear_pointer(&k->key->facts, g_variant_unref);
  else
    k->key->sum = opc_facts_sum(k->key->facts);
}

void opc_flow_keys(const opc_flow *flow, opc_store *store, opc_key *keys) {
  for (guint i = 0; i < flow->order->len; i++) {
    const opc_flow_step *step = flow->order->pdata[i];
    keyer k = {.store = store,
               .keys = keys,
               .key = &keys[step->number],
               .step = step,
               .root = step->name};
    if (!k.key->sum && !k.key->why) make_key(&k);
  }
}

char *opc_binding_key(const opc_binding *binding, opc_store *store,
                      opc_error *error) {
  opc_key key = {.files = g_ptr_array_new_with_free_func(g_free)};
  keyer k = {.store = store, .key = &key, .root = binding->path};
  g_autoptr(GPtrArray) instances = g_ptr_array_new();
  g_variant_builder_init(&k.facts, OPC_FACTS_TYPE);
  opc_binding_list(binding, instances);
  for (guint i = 0; i < instances->len; i++)
    add_instance(&k, instances->pdata[i]);
  key.facts = g_variant_ref_sink(g_variant_builder_end(&k.facts));
  char *sum = key.why ? NULL : opc_facts_sum(key.facts);
  if (!sum) opc_fail(error, OPC_FAILED, NULL, "%s", key.why);
  opc_key_clear(&key);
  return sum;
}

gboolean opc_key_is_unchanged(const opc_key *key, opc_store *store) {
  for (guint i = 0; i + 1 < key->files->len; i += 2)
    if (!opc_store_same(store, key->files->pdata[i], key->files->pdata[i + 1]))
      return FALSE;
  return TRUE;
}

void opc_key_clear(opc_key *key) {
  g_free(key->sum);
  g_free(key->why);
  if (key->facts) g_variant_unref(key->facts);
  if (key->files) g_ptr_array_free(key->files, TRUE);
  *key = (opc_key){0};
}

/* ---- differences ---- */

char *opc_key_difference(const void *step, char about, const char *path,
                         const char *before, const char *now) {
  g_autofree char *whole =
      g_strdup_printf("%s%s%s", (const char *)step, *path ? "." : "", path);
  switch (about) {
    case OPC_FACT_COMMAND:
      return g_strcmp0(before, now)
                 ? g_strdup_printf("the processor is different: %s", now)
                 : g_strdup("opcflow was rebuilt");
    case OPC_FACT_PLUGIN:
      if (!before) return g_strdup_printf("%s is new: %s", whole, now);
      if (!now) return g_strdup_printf("%s was removed", whole);
      return strcmp(before, now)
                 ? g_strdup_printf("%s changed from %s to %s", whole, before,
                                   now)
                 : g_strdup_printf("plugin %s was rebuilt", now);
    case OPC_FACT_FILE:
      if (before && now && !strcmp(before, now))
        return g_strdup_printf("file %s (%s) changed", now, whole);
      break;
    case OPC_FACT_PARAMETER:
      if (before && now && !strcmp(before, now))
        return g_strdup_printf("%s was set or unset, with the same value %s",
                               whole, now);
      break;
    case OPC_FACT_INPUT:
      return g_strdup_printf("input %s changed", whole);
    case OPC_FACT_INNER:
      return g_strdup("the inner flow changed");
  }
  return g_strdup_printf("%s changed from %s to %s", whole,
                         before ? before : "nothing", now ? now : "nothing");
}
