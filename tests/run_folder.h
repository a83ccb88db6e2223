/* SPDX-License-Identifier: BSD-3-Clause */
/* Synthetic run folders with known content, and access to the data of report
   pages. */
#pragma once

#include <glib.h>
#include <json-glib/json-glib.h>
#include <string.h>

/* Content of a run folder; members that are NULL have a default. */
typedef struct made_run {
  const char *folder;
  const char *metrics; /* { "step": { ... } } */
  const char *gates;   /* CSV; NULL for no file */
  const char *view;    /* view.json; NULL for no file */
  const char *layout;  /* SHA-256 of the layout */
  const char *na, *target, *variant, *started;
  const char *more;  /* further entries of the manifest, with a trailing
                        comma */
  const char *files; /* entries of the list of files */
} made_run;

/* A metric in the form of metrics.json; all arguments are JSON texts. */
#define RUN_METRIC(name, value, better, tolerance) \
  "\"" name "\" : { \"value\" : " value            \
  ", \"unit\" : \"%\", \"better\" : \"" better     \
  "\", \"tolerance\" : " tolerance " }"

#define RUN_ION(value) \
  "{ \"mask\" : { " RUN_METRIC("ion", value, "lower", "0.1") " } }"

/* The first line of gates.csv. */
static const char gates_head[] =
    "transistor,type,l (nm),w (nm),ion_after (%),ioff_after (%)\r\n";

static inline void put_file(const char *run, const char *file,
                            const char *text) {
  g_autofree char *path = g_build_filename(run, file, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

static inline const char *or_else(const char *text, const char *preset) {
  return text ? text : preset;
}

/* Write the run folder. */
static inline void make_run(const made_run *m) {
  g_assert_false(g_mkdir_with_parents(m->folder, 0777));
  g_autofree char *manifest = g_strdup_printf(
      "{ %s \"opcflow\" : \"0.2.0\", %s%s%s \"result\" : \"complete\", "
      "\"started\" : \"%s\", \"seconds\" : 1.0, \"threads\" : 2, "
      "\"inputs\" : [ { \"path\" : \"/in/cell.gds\", \"sha256\" : \"%s\" } ], "
      "\"plugins\" : [], \"files\" : [ %s ] }",
      or_else(m->more, ""), m->variant ? "\"variant\" : \"" : "",
      or_else(m->variant, ""), m->variant ? "\"," : "",
      or_else(m->started, "2026-01-01T00:00:00Z"), or_else(m->layout, "aa"),
      or_else(m->files, ""));
  g_autofree char *flow = g_strdup_printf(
      "opcflow: 1\nname: demo\nsteps:\n"
      "  layout:\n    use: read.gds\n    file: /in/cell.gds\n"
      "  mask:\n    use: correct\n"
      "    litho:\n      use: litho.hopkins\n      na: %s\n"
      "    synthesizer:\n      use: synthesizer.newton\n      target: %s\n",
      or_else(m->na, "0.75"), or_else(m->target, "plain"));
  put_file(m->folder, "manifest.json", manifest);
  put_file(m->folder, "flow.yaml", flow);
  put_file(m->folder, "metrics.json", or_else(m->metrics, RUN_ION("1.0")));
  if (m->gates) put_file(m->folder, "gates.csv", m->gates);
  if (m->view) put_file(m->folder, "view.json", m->view);
}

/* Return the page (g_free). *root receives the content of the element `data`,
   parsed by json-glib (json_node_unref). */
static inline char *read_page(const char *path, JsonNode **root) {
  static const char start[] = "id=\"data\">";
  char *page = NULL;
  g_autoptr(GError) error = NULL;
  if (!g_file_get_contents(path, &page, NULL, &error))
    g_error("%s", error->message);
  const char *data = strstr(page, start);
  g_assert_nonnull(data);
  data += strlen(start);
  const char *end = strstr(data, "</script>");
  g_assert_nonnull(end);
  g_autofree char *text = g_strndup(data, (gsize)(end - data));
  *root = json_from_string(text, &error);
  if (!*root) g_error("%s", error->message);
  g_assert_null(strchr(text, '<')); /* no text can end the element */
  return page;
}
