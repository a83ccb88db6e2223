/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a libFuzzer dictionary for flow files from the declarations of
   plugins. */
#include <base/unit.h>
#include <stdio.h>

#include "core/plugin/registry.h"
#include "core/plugin/value.h"

static void word_put(const char *word) {
  putchar('"');
  for (; *word; word++)
    if (*word == '"' || *word == '\\' || *word < ' ')
      printf("\\x%02x", (unsigned char)*word);
    else
      putchar(*word);
  puts("\"");
}

static void put_all(const char *choices) {
  g_auto(GStrv) words = opc_choice_list(choices);
  for (guint i = 0; words[i]; i++) word_put(words[i]);
}

static void put_plugin(const opc_plugin *plugin) {
  word_put(plugin->id);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    word_put(p->name);
    if (p->preset && *p->preset) word_put(p->preset);
    if (p->choices) put_all(p->choices);
  }
}

int main(void) {
  static const char *const syntax[] = {
      "opcflow: 1", "steps:", "use:", "{ use: ", "${", "}",  ": ",    "- ",
      "[",          "]",      "|",    ">",       "&a", "*a", "!!str", "---",
      "extends:",   "name:",  "#",    "\\x09",   "'",  "? ", "<<:",   "%"};
  for (size_t i = 0; i < G_N_ELEMENTS(syntax); i++) word_put(syntax[i]);
  g_autoptr(GPtrArray) units = opc_unit_names();
  for (guint i = 0; i < units->len; i++) word_put(units->pdata[i]);
  g_autoptr(opc_registry) registry = opc_registry_new(NULL);
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, "", 10);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    opc_error error;
    const opc_plugin *plugin = c->reason || c->hidden_by
                                   ? NULL
                                   : opc_registry_find(registry, c->id, &error);
    if (plugin) put_plugin(plugin);
  }
  return 0;
}
