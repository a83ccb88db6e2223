/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks whether two runs are comparable: the runs must have the same layout
   and the same models of optics, resist and transistors. Corrections and their
   parameters may differ. */
#include "same.h"

#include <eda/verdicts.h>
#include <stdlib.h>
#include <string.h>

/* Slots of the models that determine the printed image and the currents. */
static const char *const judges[] = {"litho", "resist", "extractor", NULL};

/* Prefixes of the steps that provide the design. */
static const char *const sources[] = {"read.", "segment.", NULL};

int same_is_shared(const eda_run *run, const char *name) {
  g_auto(GStrv) parts = g_strsplit(name, ".", -1);
  for (char **part = parts; *part; part++)
    if (part > parts && g_strv_contains(judges, *part)) return 1;
  g_autofree char *use = g_strconcat(parts[0], ".use", NULL);
  const eda_run_parameter *plugin = eda_run_parameter_of(run, use);
  for (int i = 0; plugin && sources[i]; i++)
    if (g_str_has_prefix(plugin->value, sources[i])) return 1;
  return 0;
}

const char *same_content(const eda_run *run, const eda_run_parameter *p) {
  const eda_run_facts *f = eda_run_info(run);
  if (!g_path_is_absolute(p->value)) return NULL;
  for (size_t i = 0; i < f->n_inputs; i++) {
    g_autofree char *path = g_canonicalize_filename(f->inputs[i].path, NULL);
    if (!strcmp(path, p->value)) return f->inputs[i].sha256;
  }
  return NULL;
}

static char *step_use(const char *name) {
  return g_strdup_printf("%.*s.use", (int)strcspn(name, "."), name);
}

/* Add a reason if a shared parameter differs. */
static void check_parameter(const pair *p, const eda_run_parameter *a,
                            GPtrArray *why) {
  const eda_run_parameter *b = eda_run_parameter_of(p->other, a->name);
  if (!b) {
    g_ptr_array_add(
        why, g_strdup_printf("only the base has %s: %s", a->name, a->value));
    return;
  }
  const char *x = same_content(p->base, a), *y = same_content(p->other, b);
  if (x && y && strcmp(x, y) != 0)
    g_ptr_array_add(why, g_strdup_printf("%s differs in content (%.8s, %.8s)",
                                         a->name, x, y));
  else if (!(x && y) && strcmp(a->value, b->value) != 0)
    g_ptr_array_add(
        why, g_strdup_printf("%s is %s and %s", a->name, a->value, b->value));
}

/* Check the parameters of the steps that both runs have. */
static void check_parameters(const pair *p, GPtrArray *why) {
  const eda_run_facts *a = eda_run_info(p->base), *b = eda_run_info(p->other);
  for (size_t i = 0; i < a->n_parameters; i++) {
    const eda_run_parameter *one = &a->parameters[i];
    g_autofree char *step = step_use(one->name);
    if (same_is_shared(p->base, one->name) &&
        eda_run_parameter_of(p->other, step))
      check_parameter(p, one, why);
  }
  for (size_t i = 0; i < b->n_parameters; i++) {
    const eda_run_parameter *one = &b->parameters[i];
    g_autofree char *step = step_use(one->name);
    if (same_is_shared(p->other, one->name) &&
        eda_run_parameter_of(p->base, step) &&
        !eda_run_parameter_of(p->base, one->name))
      g_ptr_array_add(why, g_strdup_printf("only the other has %s: %s",
                                           one->name, one->value));
  }
}

int same_check(const pair *p, GPtrArray *why, opc_error *error) {
  const eda_run *const runs[] = {p->base, p->other};
  for (int i = 0; i < 2; i++) {
    const eda_run_facts *f = eda_run_info(runs[i]);
    if (f->failure)
      g_ptr_array_add(
          why, g_strdup_printf("'%s' failed: %s", f->folder, f->failure));
  }
  check_parameters(p, why);
  char *unlike;
  int code = eda_run_unlike(p->base, p->other, &unlike, error);
  if (unlike) g_ptr_array_add(why, g_strdup(unlike));
  free(unlike);
  return code;
}
