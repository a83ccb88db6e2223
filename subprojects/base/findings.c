/* SPDX-License-Identifier: BSD-3-Clause */
/* List of findings. */
#include <base/findings.h>

#include <string.h>

enum { MOST_FINDINGS = 100 };

static void finding_free(gpointer item) {
  opc_finding *finding = item;
  g_free(finding->path);
  g_free(finding->text);
  g_free(finding);
}

void opc_findings_init(opc_findings *findings) {
  *findings = (opc_findings){g_ptr_array_new_with_free_func(finding_free), 0};
}

void opc_findings_clear(opc_findings *findings) {
  g_ptr_array_free(findings->list, TRUE);
}

static gboolean finding_is_known(const opc_findings *findings, size_t point,
                                 const char *path, const char *text) {
  for (guint i = 0; i < findings->list->len; i++) {
    const opc_finding *f = findings->list->pdata[i];
    if (f->point == point && !strcmp(f->path, path) && !strcmp(f->text, text))
      return TRUE;
  }
  return FALSE;
}

void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text) {
  if (finding_is_known(findings, point, path, text)) return;
  if (findings->list->len == MOST_FINDINGS) {
    findings->more++;
    return;
  }
  opc_finding *f = g_new(opc_finding, 1);
  *f = (opc_finding){point, g_strdup(path), g_strdup(text)};
  g_ptr_array_add(findings->list, f);
}

GPtrArray *opc_findings_lines(const opc_findings *findings) {
  GPtrArray *lines = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < findings->list->len; i++) {
    const opc_finding *f = findings->list->pdata[i];
    g_autofree char *point =
        f->point ? g_strdup_printf("point %zu: ", f->point) : g_strdup("");
    g_ptr_array_add(lines,
                    g_strdup_printf("%s%s: %s", point, f->path, f->text));
  }
  if (findings->more)
    g_ptr_array_add(lines,
                    g_strdup_printf("and %zu more findings", findings->more));
  return lines;
}
