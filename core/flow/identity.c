/* SPDX-License-Identifier: BSD-3-Clause */
/* One sum of a plugin, its shared object, the values of its parameters, the
   contents of files that they name, and the same of what stands in its slots.
   Neither places nor names of files are in it. */
#include "core/flow/identity.h"

#include <dlfcn.h>
#include <string.h>

#include "core/flow/files.h"
#include "core/plugin/declaration.h"

typedef struct summer {
  GChecksum *sum;
  const opc_context *context;
  opc_error *error;
} summer;

/* A text with its length, so that no two can be taken for others. */
static void add(const summer *s, const char *text) {
  g_autofree char *item = g_strdup_printf("%zu:%s", strlen(text), text);
  g_checksum_update(s->sum, (const guchar *)item, (gssize)strlen(item));
}

static void add_number(const summer *s, double number) {
  g_autofree char *text = opc_number_text(number);
  add(s, text);
}

static int add_file(const summer *s, const char *path) {
  g_autofree char *sum = opc_file_sha256(path, s->context, s->error);
  if (!sum) return s->error->code;
  add(s, sum);
  return OPC_OK;
}

static int add_value(const summer *s, const opc_parameter *p,
                     const opc_setting *v) {
  const opc_field *f = &v->field;
  add(s, p->name);
  add(s, p->given && v->given ? "given" : "");
  switch (p->type) {
    case OPC_BOOL:
    case OPC_CHOICE:
      add_number(s, f->flag);
      break;
    case OPC_INT:
      add_number(s, (double)f->integer);
      break;
    case OPC_REAL:
      add_number(s, f->real);
      break;
    case OPC_FILE:
      return add_file(s, f->text);
    case OPC_REALS:
      add_number(s, (double)f->reals.count);
      for (size_t i = 0; i < f->reals.count; i++)
        add_number(s, f->reals.values[i]);
      break;
    case OPC_MAP:
      add_number(s, (double)f->map.count);
      for (size_t i = 0; i < f->map.count; i++) {
        add(s, f->map.pairs[i].key);
        add(s, f->map.pairs[i].value);
      }
      break;
    default:
      add(s, f->text ? f->text : "");
  }
  return OPC_OK;
}

/* The shared object that a plugin came from. */
static int add_build(const summer *s, const opc_plugin *plugin) {
  Dl_info about;
  add(s, plugin->id);
  add(s, plugin->version);
  if (!dladdr(plugin, &about) || !about.dli_fname)
    return opc_fail(s->error, OPC_FAILED, NULL, "where %s is from is not known",
                    plugin->id);
  return add_file(s, about.dli_fname);
}

static int add_binding(const summer *s, const opc_binding *b) {
  const opc_plugin *plugin = b->plugin;
  int code = add_build(s, plugin);
  for (size_t i = 0; i < plugin->n_parameters && !code; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    if (b->slots[i]) {
      add(s, p->name);
      code = add_binding(s, b->slots[i]);
    } else if (b->values[i].present && p->type != OPC_INPUT &&
               !(p->flags & OPC_NO_EFFECT)) {
      code = add_value(s, p, &b->values[i]);
    }
  }
  return code;
}

const char *opc_identity(const opc_host *host, const char *slot,
                         opc_error *error) {
  const opc_binding *b = host->data;
  int i = slot ? opc_parameter_find(b->plugin, slot) : 0;
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  const summer s = {sum, host->context, error};
  if (i < 0 || (slot && b->plugin->parameters[i].type != OPC_SLOT)) {
    opc_fail(error, OPC_INVALID, NULL, "%s has no slot '%s'", b->plugin->id,
             slot);
    return NULL;
  }
  const opc_binding *of = slot ? b->slots[i] : b;
  if (of && add_binding(&s, of)) return NULL;
  char *text = g_strdup(g_checksum_get_string(sum));
  g_ptr_array_add(b->owned, text);
  return text;
}
