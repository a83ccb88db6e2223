/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects problems, merges lists without duplicates, and sorts and formats
   problems. */
#include <base/problem.h>
#include <base/shown.h>
#include <string.h>

enum {
  MOST_PROBLEMS = 1000,
  LONGEST_MESSAGE = 1000 /* bytes */
};

static void problem_free(gpointer item) {
  opc_problem *problem = item;
  g_free((char *)problem->at.file);
  g_free(problem->message);
  g_free(problem);
}

opc_problems *opc_problems_new(void) {
  opc_problems *problems = g_new0(opc_problems, 1);
  problems->list = g_ptr_array_new_with_free_func(problem_free);
  return problems;
}

void opc_problems_free(opc_problems *problems) {
  if (!problems) return;
  g_ptr_array_free(problems->list, TRUE);
  g_free(problems);
}

gboolean opc_problems_full(const opc_problems *problems) {
  return problems->list->len >= MOST_PROBLEMS;
}

/* Truncate a message before the limit, at the end of a character. */
static void message_truncate(char *message) {
  if (strlen(message) <= LONGEST_MESSAGE) return;
  char *end = g_utf8_find_prev_char(message, message + LONGEST_MESSAGE - 3);
  strcpy(end ? end : message, "...");
}

gboolean opc_problem_add(opc_problems *problems, int code,
                         const opc_place *place, const char *format, ...) {
  if (opc_problems_full(problems)) return FALSE;
  gboolean last = problems->list->len + 1 == MOST_PROBLEMS;
  opc_problem *problem = g_new0(opc_problem, 1);
  va_list args;
  va_start(args, format);
  if (place && !last) problem->at = *place;
  problem->at.file = g_strdup(problem->at.file);
  problem->code = code;
  g_autofree char *message =
      g_strdup_vprintf(last ? "further problems are not listed" : format, args);
  va_end(args);
  problem->message = opc_shown(message, "");
  message_truncate(problem->message);
  g_ptr_array_add(problems->list, problem);
  return FALSE;
}

/* Return whether one of the first `n` problems equals `p`, or `p` with note. */
static gboolean is_known(const opc_problems *problems, guint n,
                         const opc_problem *p, const char *noted) {
  for (guint i = 0; i < n; i++) {
    const opc_problem *q = problems->list->pdata[i];
    if (p->at.line == q->at.line && p->at.column == q->at.column &&
        !g_strcmp0(p->at.file, q->at.file) &&
        (!strcmp(p->message, q->message) || !strcmp(noted, q->message)))
      return TRUE;
  }
  return FALSE;
}

void opc_problems_merge(opc_problems *problems, const opc_problems *from,
                        const char *note) {
  guint before = problems->list->len;
  for (guint i = 0; i < from->list->len; i++) {
    const opc_problem *p = from->list->pdata[i];
    g_autofree char *noted = g_strconcat(p->message, note, NULL);
    if (!is_known(problems, before, p, noted))
      opc_problem_add(problems, p->code, &p->at, "%s", noted);
  }
}

char *opc_place_text(const opc_place *place) {
  if (!place->file) return g_strdup("");
  char *file = opc_shown(place->file, "");
  if (!place->line) return file;
  char *text = g_strdup_printf("%s:%u:%u", file, place->line, place->column);
  g_free(file);
  return text;
}

static gboolean same_file(gconstpointer a, gconstpointer b) {
  return !g_strcmp0(a, b); /* either may be NULL */
}

/* Return the index of the file of a problem in a list of files; the length of
   the list if the file is not in the list. */
static guint file_rank(const GPtrArray *files, const opc_problem *problem) {
  guint rank = files->len;
  g_ptr_array_find_with_equal_func((GPtrArray *)files, problem->at.file,
                                   same_file, &rank);
  return MIN(rank, files->len);
}

static gint problem_compare(gconstpointer a, gconstpointer b, gpointer files) {
  const opc_problem *p = *(opc_problem *const *)a,
                    *q = *(opc_problem *const *)b;
  guint i = file_rank(files, p), j = file_rank(files, q);
  if (i != j) return i < j ? -1 : 1;
  if (p->at.line != q->at.line) return p->at.line < q->at.line ? -1 : 1;
  if (p->at.column != q->at.column) return p->at.column < q->at.column ? -1 : 1;
  return 0;
}

void opc_problems_sort(opc_problems *problems) {
  g_autoptr(GPtrArray) files = g_ptr_array_new();
  for (guint i = 0; i < problems->list->len; i++) {
    const opc_problem *problem = problems->list->pdata[i];
    if (file_rank(files, problem) == files->len)
      g_ptr_array_add(files, (char *)problem->at.file);
  }
  /* g_ptr_array_sort_with_data is stable. */
  g_ptr_array_sort_with_data(problems->list, problem_compare, files);
}

char *opc_problem_text(const opc_problem *problem) {
  g_autofree char *where = opc_place_text(&problem->at);
  return g_strdup_printf("%s%s%s", where, *where ? ": " : "", problem->message);
}

char *opc_problems_text(opc_problems *problems) {
  opc_problems_sort(problems);
  GString *text = g_string_new(NULL);
  for (guint i = 0; i < problems->list->len; i++) {
    g_autofree char *line = opc_problem_text(problems->list->pdata[i]);
    if (i) g_string_append_c(text, '\n');
    g_string_append(text, line);
  }
  return g_string_free(text, FALSE);
}

int opc_problems_code(const opc_problems *problems) {
  int code = OPC_OK;
  for (guint i = 0; i < problems->list->len; i++) {
    int other = ((const opc_problem *)problems->list->pdata[i])->code;
    if (code != OPC_OK && code != other) return OPC_INVALID;
    code = other;
  }
  return code;
}

int opc_problems_error(opc_problems *problems, opc_error *error) {
  guint n = problems->list->len;
  if (!n) return OPC_OK;
  opc_problems_sort(problems);
  g_autofree char *first = opc_problem_text(problems->list->pdata[0]);
  int code = opc_problems_code(problems);
  if (n == 1) return opc_fail(error, code, NULL, "%s", first);
  return opc_fail(error, code, NULL, "%s (and %u more)", first, n - 1);
}
