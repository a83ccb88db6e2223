/* SPDX-License-Identifier: BSD-3-Clause */
/* Experiments (data kind): cases, methods, and the folder of each run. */
#include <eda/experiment.h>
#include <glib.h>

static const char *const *texts_copy(const char *const *texts, size_t n) {
  char **copies = g_new0(char *, n + 1);
  for (size_t i = 0; i < n; i++) copies[i] = g_strdup(texts[i]);
  return (const char *const *)copies;
}

static void texts_free(const char *const *texts, size_t n) {
  for (size_t i = 0; i < n; i++) g_free((char *)texts[i]);
  g_free((char **)texts);
}

eda_experiment *eda_experiment_new(size_t n_cases, const char *const *cases,
                                   size_t n_methods, const char *const *methods,
                                   const char *const *folders) {
  eda_experiment *e = g_new0(eda_experiment, 1);
  e->n_cases = n_cases;
  e->n_methods = n_methods;
  e->cases = texts_copy(cases, n_cases);
  e->methods = texts_copy(methods, n_methods);
  e->folders = texts_copy(folders, n_cases * n_methods);
  return e;
}

void eda_experiment_free(void *object) {
  eda_experiment *e = object;
  if (!e) return;
  texts_free(e->cases, e->n_cases);
  texts_free(e->methods, e->n_methods);
  texts_free(e->folders, e->n_cases * e->n_methods);
  g_free(e);
}

int eda_experiment_check(const void *object, opc_error *error) {
  const eda_experiment *e = object;
  size_t named = 0;
  if (!e->n_cases || !e->n_methods || !e->cases || !e->methods || !e->folders)
    return opc_fail(error, OPC_FAILED, NULL,
                    "an experiment has %zu cases and %zu methods, expected at "
                    "least one of each",
                    e->n_cases, e->n_methods);
  for (size_t i = 0; i < e->n_cases; i++) named += e->cases[i] && *e->cases[i];
  for (size_t i = 0; i < e->n_methods; i++)
    named += e->methods[i] && *e->methods[i];
  if (named == e->n_cases + e->n_methods) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL,
                  "a case or a method of the experiment has no name");
}
