/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the required files that a flow leaves open, such as the layout of a
   process flow, and the variants that a command line chooses. */
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/declaration.h"

static void open_file_clear(void *data) {
  g_free(((cli_open_file *)data)->path);
}

/* Add the missing files of a plugin and of the plugins in its slots. */
static void open_files_add(GArray *open, const opc_binding *b) {
  for (size_t i = 0; b && i < b->plugin->n_parameters; i++) {
    const opc_parameter *p = &b->plugin->parameters[i];
    if (b->slots[i]) open_files_add(open, b->slots[i]);
    if (p->type != OPC_FILE || !(p->flags & OPC_REQUIRED) || b->origin[i])
      continue;
    const cli_open_file one = {g_strdup_printf("%s.%s", b->path, p->name),
                               p->summary};
    g_array_append_val(open, one);
  }
}

GArray *cli_open_files(const opc_flow *flow) {
  GArray *open = g_array_new(FALSE, FALSE, sizeof(cli_open_file));
  g_array_set_clear_func(open, open_file_clear);
  for (guint i = 0; i < flow->steps->len; i++)
    open_files_add(open, ((opc_flow_step *)flow->steps->pdata[i])->binding);
  return open;
}

static void add_all(GPtrArray *chosen, const opc_recipe *recipe) {
  for (guint k = 0; k < recipe->variants->keys->len; k++)
    g_ptr_array_add(chosen, (char *)opc_node_key(recipe->variants, k));
}

GPtrArray *cli_choose_variants(const opc_recipe *recipe, GPtrArray *given,
                               gboolean every, opc_problems *problems) {
  GPtrArray *chosen = g_ptr_array_new();
  const char *const *names = cli_list(given);
  if (!recipe) return chosen;
  if (!*names) g_ptr_array_add(chosen, NULL);
  if (!*names && every) add_all(chosen, recipe);
  for (; *names; names++) {
    const opc_place at = {recipe->path, 0, 0};
    if (!strcmp(*names, "all")) {
      add_all(chosen, recipe);
      if (!recipe->variants->keys->len)
        opc_problem_add(problems, OPC_INVALID, &at, "has no variants");
    } else if (!strcmp(*names, "base") ||
               !opc_recipe_has(recipe, *names, NULL, problems)) {
      g_ptr_array_add(chosen, NULL);
    } else {
      g_ptr_array_add(chosen, (char *)*names);
    }
  }
  return chosen;
}
