/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the data kind "settings": a figure of merit for each combination
   of parameter values. */
#include <eda/settings.h>
#include <glib.h>

eda_settings *eda_settings_new(size_t n_parameters) {
  eda_settings *s = g_new0(eda_settings, 1);
  s->n_parameters = n_parameters;
  s->parameters = g_new0(eda_setting, n_parameters);
  return s;
}

void eda_settings_parameter(eda_settings *s, size_t i, const char *name,
                            const char *unit, size_t count,
                            const double *values, const char *const *texts) {
  char **copies = g_new0(char *, count + 1);
  for (size_t k = 0; k < count; k++) copies[k] = g_strdup(texts[k]);
  ((eda_setting *)s->parameters)[i] = (eda_setting){
      .name = g_strdup(name),
      .unit = g_strdup(unit),
      .count = count,
      .values = values ? g_memdup2(values, count * sizeof *values) : NULL,
      .texts = (const char *const *)copies};
}

void eda_settings_figure(eda_settings *s, const char *name, const char *unit,
                         const double *figure, size_t best) {
  s->count = 1;
  for (size_t i = 0; i < s->n_parameters; i++)
    s->count *= s->parameters[i].count;
  s->figure = g_memdup2(figure, s->count * sizeof *figure);
  s->name = g_strdup(name);
  s->unit = g_strdup(unit);
  s->best = best;
}

void eda_settings_free(void *object) {
  eda_settings *s = object;
  if (!s) return;
  for (size_t i = 0; i < s->n_parameters; i++) {
    g_free((char *)s->parameters[i].name);
    g_free((char *)s->parameters[i].unit);
    g_free((double *)s->parameters[i].values);
    g_strfreev((char **)s->parameters[i].texts);
  }
  g_free((eda_setting *)s->parameters);
  g_free((double *)s->figure);
  g_free((char *)s->name);
  g_free((char *)s->unit);
  g_free(s);
}

int eda_settings_check(const void *object, opc_error *error) {
  const eda_settings *s = object;
  size_t count = 1;
  for (size_t i = 0; i < s->n_parameters; i++) {
    const eda_setting *p = &s->parameters[i];
    if (!p->name || !p->texts || !p->count)
      return opc_fail(error, OPC_FAILED, NULL,
                      "parameter %zu of the settings has no name or no values",
                      i + 1);
    count *= p->count;
  }
  if (s->figure && s->name && s->count == count && s->best < count)
    return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL,
                  "figure or its name missing, or %zu values for %zu "
                  "combinations, best: number %zu",
                  s->count, count, s->best + 1);
}
