/* SPDX-License-Identifier: BSD-3-Clause */
/* Statements of a model library as texts. Only the models and subcircuits that
   a device needs are kept: its model or subcircuit, and recursively all models
   and subcircuits named in kept statements. */
#include <eda/memory.h>
#include <eda/models.h>
#include <errno.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/lines.h"
#include "simulator/deck.h"

/* A top-level statement, or a subcircuit from .subckt to .ends. */
typedef struct piece {
  char *name;    /* subcircuit, or model without bin number; NULL: another
                    statement */
  int kind;      /* EDA_MODEL_CARD, EDA_MODEL_SUBCIRCUIT, 0 */
  GPtrArray *of; /* statements, char * */
} piece;

struct eda_models {
  GArray *piece;
  double unit;
  char *osdi;    /* NULL: none */
  GRegex *bound; /* matches bounds such as "lmin = 1e-7" */
};

/* ---- words of a statement ---- */

static const char blanks[] = " \t\n+=(){}',\"";

/* Return the first or second word in lower case (g_free). */
static char *word_of(const char *statement, int second) {
  const char *s = statement;
  for (int i = 0; i < second; i++) {
    s += strcspn(s, " \t\n");
    s += strspn(s, " \t\n+");
  }
  return g_ascii_strdown(s, (gssize)strcspn(s, " \t\n="));
}

/* Return a model name without bin number (g_free): "nshort_model" for
   "nshort_model.8". */
static char *without_bin(const char *name) {
  const char *dot = strrchr(name, '.');
  int is_bin =
      dot && dot[1] && strspn(dot + 1, "0123456789") == strlen(dot + 1);
  return is_bin ? g_strndup(name, (gsize)(dot - name)) : g_strdup(name);
}

/* ---- removal of statistical variation ---- */

/* Find the commas after the first two arguments of a function; `s` begins after
   the bracket. For a missing comma, write the end of the arguments. Return 0 if
   the bracket is not closed. */
static int find_arguments(const char *s, const char *comma[2]) {
  int depth = 0, n = 0;
  for (; *s; s++) {
    if (*s == ',' && !depth && n < 2) comma[n++] = s;
    if (*s == ')' && !depth--) break;
    if (*s == '(') depth++;
  }
  while (n < 2) comma[n++] = s;
  return *s == ')';
}

/* Return a statement (g_free) with agauss(nominal, deviation, sigma) replaced
   by agauss(nominal,0, sigma); likewise for gauss, aunif and unif. The function
   name stays, because the simulator accepts some expressions only with the
   function. */
static char *statement_settle(const char *statement) {
  static const char *const lots[] = {"agauss", "gauss", "aunif", "unif"};
  GString *out = g_string_new(NULL);
  const char *s = statement, *comma[2];
  while (*s) {
    size_t n = strspn(s,
                      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                      "0123456789_");
    int lot = 0;
    for (size_t i = 0; i < G_N_ELEMENTS(lots) && n; i++)
      lot |= n == strlen(lots[i]) && !g_ascii_strncasecmp(s, lots[i], n);
    const char *open = s + n + (lot ? strspn(s + n, " \t") : 0);
    if (!n) n = 1;
    if (lot && *open == '(' && find_arguments(open + 1, comma) &&
        *comma[0] == ',') {
      g_autofree char *nominal =
          g_strndup(open + 1, (gsize)(comma[0] - open - 1));
      g_autofree char *settled = statement_settle(nominal);
      g_string_append_len(out, s, (gssize)n);
      g_string_append_printf(out, "(%s,0", settled);
      s = comma[1];
      continue;
    }
    g_string_append_len(out, s, (gssize)n);
    s += n;
  }
  return g_string_free(out, FALSE);
}

/* ---- reading ---- */

static void clear_piece(void *data) {
  piece *p = data;
  g_free(p->name);
  g_ptr_array_unref(p->of);
}

static int begins_with(const char *statement, const char *want) {
  g_autofree char *first = word_of(statement, 0);
  return !strcmp(first, want);
}

static void take_scale(eda_models *l, const char *statement) {
  g_autoptr(GMatchInfo) match = NULL;
  g_autoptr(GRegex) scale =
      g_regex_new("\\bscale\\s*=\\s*([^\\s]+)", G_REGEX_CASELESS, 0, NULL);
  double value;
  if (!g_regex_match(scale, statement, 0, &match)) return;
  g_autofree char *number = g_match_info_fetch(match, 1);
  if (netlist_number(number, &value) && value > 0) l->unit = value * 1e9;
}

/* Store a statement; *depth is the number of open subcircuits. */
static void models_take_statement(eda_models *l, const char *statement,
                                  int *depth) {
  int opens = begins_with(statement, ".subckt"),
      closes = begins_with(statement, ".ends"),
      model = begins_with(statement, ".model");
  if (begins_with(statement, ".end")) return;
  if (begins_with(statement, ".option") || begins_with(statement, ".options") ||
      begins_with(statement, ".opt"))
    take_scale(l, statement);
  if (!*depth) {
    piece p = {.kind = opens   ? EDA_MODEL_SUBCIRCUIT
                       : model ? EDA_MODEL_CARD
                               : 0,
               .of = g_ptr_array_new_with_free_func(g_free)};
    g_autofree char *name = word_of(statement, 1);
    if (p.kind) p.name = without_bin(name);
    g_array_append_val(l->piece, p);
  }
  piece *last = &g_array_index(l->piece, piece, l->piece->len - 1);
  g_ptr_array_add(last->of, statement_settle(statement));
  *depth += opens - (closes && *depth > 0);
}

/* Store the statements of `text`. The first line is a title. Each further line
   is a statement, continued by lines that begin with '+'. */
static void take_all(eda_models *l, char *text) {
  int depth = 0;
  char *s = strchr(text, '\n');
  while (s && *++s) {
    char *end = strchr(s, '\n');
    while (end && end[1] == '+') end = strchr(end + 1, '\n');
    if (end) *end = 0;
    models_take_statement(l, s, &depth);
    s = end;
  }
}

/* Return the absolute path (free()), because the simulator runs in another
   folder. */
static char *whole_path(const char *file, const char *parameter,
                        opc_error *error) {
  char *path = realpath(file, NULL);
  if (!path)
    opc_fail(error, OPC_IO, parameter, "cannot read '%s': %s", file,
             g_strerror(errno));
  if (!path || !strpbrk(path, "\"\n")) return path;
  opc_fail(
      error, OPC_INVALID, parameter,
      "'%s': the simulator cannot open a file name with a quote or line break",
      file);
  free(path);
  return NULL;
}

static char *library_deck(const char *file, const char *section,
                          const char *osdi, opc_error *error) {
  char *path = whole_path(file, "library", error);
  char *object = path && osdi ? whole_path(osdi, "osdi", error) : NULL;
  GString *deck = g_string_new("t\n");
  if (object) g_string_append_printf(deck, ".osdi \"%s\"\n", object);
  g_string_append_printf(deck, "%s \"%s\" %s\n.end\n",
                         section ? ".lib" : ".include", path,
                         section ? section : "");
  int good = path && (object || !osdi);
  free(path);
  free(object);
  return g_string_free(deck, !good);
}

eda_models *eda_models_read(const char *path, const char *section,
                            const char *osdi, opc_error *error) {
  g_autofree char *deck = library_deck(path, section, osdi, error);
  char *object = NULL, *text = deck ? deck_write(deck, &object, error) : NULL;
  if (!text) return NULL;
  eda_models *l = eda_alloc(1, sizeof *l);
  l->osdi = object;
  l->unit = 1e9;
  l->piece = g_array_new(FALSE, FALSE, sizeof(piece));
  g_array_set_clear_func(l->piece, clear_piece);
  l->bound = g_regex_new("\\b([lw])(min|max)\\s*=\\s*([^\\s]+)",
                         G_REGEX_CASELESS, 0, NULL);
  take_all(l, text);
  free(text);
  return l;
}

void eda_models_free(eda_models *l) {
  if (!l) return;
  g_array_unref(l->piece);
  g_regex_unref(l->bound);
  g_free(l->osdi);
  free(l);
}

double eda_models_unit(const eda_models *l) { return l->unit; }

static const piece *piece_at(const eda_models *l, guint i) {
  return &g_array_index(l->piece, piece, i);
}

int eda_models_kind(const eda_models *l, const char *name) {
  int kind = 0;
  for (guint i = 0; i < l->piece->len && !kind; i++)
    if (piece_at(l, i)->name && !g_ascii_strcasecmp(piece_at(l, i)->name, name))
      kind = piece_at(l, i)->kind;
  return kind;
}

/* ---- needed statements ---- */

/* Add all words of a piece to `words`. */
static void add_words(GHashTable *words, const piece *p) {
  for (guint i = 0; i < p->of->len; i++) {
    const char *s = p->of->pdata[i];
    while (*s) {
      s += strspn(s, blanks);
      size_t n = strcspn(s, blanks);
      if (n) g_hash_table_add(words, g_ascii_strdown(s, (gssize)n));
      s += n;
    }
  }
}

/* Return an array (free()) with 1 for each piece that the models `name` need:
   these models, recursively all models and subcircuits named in these pieces,
   and all other statements that begin with '.'. */
static char *find_needed(const eda_models *l, const char *name) {
  g_autoptr(GHashTable) words =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  char *keep = eda_alloc(l->piece->len + 1, 1);
  int more = 1;
  g_auto(GStrv) names = g_strsplit(name, " ", -1);
  for (char **n = names; *n; n++)
    if (**n) g_hash_table_add(words, g_ascii_strdown(*n, -1));
  for (guint i = 0; i < l->piece->len; i++) {
    const char *first = piece_at(l, i)->of->pdata[0];
    keep[i] = !piece_at(l, i)->kind && *first == '.';
    if (keep[i]) add_words(words, piece_at(l, i));
  }
  while (more) {
    more = 0;
    for (guint i = 0; i < l->piece->len; i++) {
      const piece *p = piece_at(l, i);
      if (keep[i] || !p->kind || !g_hash_table_contains(words, p->name))
        continue;
      keep[i] = 1;
      more = 1;
      add_words(words, p);
    }
  }
  return keep;
}

/* ---- bins ---- */

/* Read the bounds of a bin (.model statement), nm. Return 1 if all four bounds
   are numbers. */
static int read_bin(const eda_models *l, const char *statement,
                    eda_sizes *out) {
  g_autoptr(GMatchInfo) match = NULL;
  int found = 0;
  if (!begins_with(statement, ".model")) return 0;
  g_regex_match(l->bound, statement, 0, &match);
  for (; g_match_info_matches(match); g_match_info_next(match, NULL)) {
    g_autofree char *axis = g_match_info_fetch(match, 1);
    g_autofree char *side = g_match_info_fetch(match, 2);
    g_autofree char *number = g_match_info_fetch(match, 3);
    double value;
    const char *end = netlist_number(number, &value);
    if (!end || *end) return 0;
    int width = g_ascii_tolower(*axis) == 'w',
        high = !g_ascii_strcasecmp(side, "max");
    (width ? out->width : out->length)[high] = value * 1e9;
    found |= 1 << (2 * width + high);
  }
  return found == 15;
}

static void bin_join(double into[2], const double more[2]) {
  into[0] = fmin(into[0], more[0]);
  into[1] = fmax(into[1], more[1]);
}

/* Return whether two pieces belong to the same model. */
static int are_one(const piece *a, const piece *b) {
  return a == b || (a->kind == EDA_MODEL_CARD && b->kind == a->kind &&
                    !strcmp(a->name, b->name));
}

/* Compute the smallest lower and largest upper bounds of all bins in kept
   pieces. If `of` is not NULL, only bins of the model of this piece count.
   Return whether there are any bins. */
static int bins_outermost(const eda_models *l, const char *keep,
                          const piece *of, eda_sizes *out) {
  int found = 0;
  *out = (eda_sizes){{INFINITY, 0}, {INFINITY, 0}};
  for (guint i = 0; i < l->piece->len; i++)
    for (guint k = 0; keep[i] && k < piece_at(l, i)->of->len; k++) {
      eda_sizes bin;
      if (of && !are_one(of, piece_at(l, i))) break;
      if (!read_bin(l, piece_at(l, i)->of->pdata[k], &bin)) continue;
      found = 1;
      bin_join(out->length, bin.length);
      bin_join(out->width, bin.width);
    }
  return found;
}

int eda_models_bins(const eda_models *l, const char *name, eda_sizes *out) {
  char *keep = find_needed(l, name);
  int found = bins_outermost(l, keep, NULL, out);
  free(keep);
  return found;
}

/* Tolerance for equal bounds, nm. */
static const double same = 1e-3;

/* If a bound of a bin is outermost (equal to the bound in `all`), move the
   bound to 1 nm beyond the sizes `to`, unless it is already farther outside.
   Return whether the bin changed. */
static int bin_stretch(double bin[2], const double all[2], const double to[2]) {
  const double was[2] = {bin[0], bin[1]};
  if (fabs(bin[0] - all[0]) < same) bin[0] = fmin(bin[0], to[0] - 1);
  if (fabs(bin[1] - all[1]) < same) bin[1] = fmax(bin[1], to[1] + 1);
  return bin[0] != was[0] || bin[1] != was[1];
}

static int bin_touches(const double bin[2], const double want[2]) {
  return bin[0] - same <= want[1] && bin[1] + same >= want[0];
}

static gboolean write_bound(const GMatchInfo *match, GString *out, void *data) {
  const eda_sizes *bin = data;
  g_autofree char *axis = g_match_info_fetch(match, 1);
  g_autofree char *side = g_match_info_fetch(match, 2);
  int width = g_ascii_tolower(*axis) == 'w',
      high = !g_ascii_strcasecmp(side, "max");
  g_string_append_printf(out, "%s%s=%.12g", axis, side,
                         (width ? bin->width : bin->length)[high] * 1e-9);
  return FALSE;
}

/* Write a statement, unless the statement is a bin that does not overlap
   `sizes`. If `extend` is set, extend outermost bins to `sizes`. */
static void models_put_statement(const eda_models *l, GString *out,
                                 const char *statement, const eda_sizes *all,
                                 const eda_sizes *sizes, int extend) {
  eda_sizes bin;
  if (!read_bin(l, statement, &bin)) {
    g_string_append_printf(out, "%s\n", statement);
    return;
  }
  int changed = 0;
  if (extend) {
    changed |= bin_stretch(bin.length, all->length, sizes->length);
    changed |= bin_stretch(bin.width, all->width, sizes->width);
  }
  if (!bin_touches(bin.length, sizes->length) ||
      !bin_touches(bin.width, sizes->width))
    return;
  if (!changed) {
    g_string_append_printf(out, "%s\n", statement);
    return;
  }
  g_autofree char *text = g_regex_replace_eval(l->bound, statement, -1, 0, 0,
                                               write_bound, &bin, NULL);
  g_string_append_printf(out, "%s\n", text);
}

char *eda_models_cut(const eda_models *l, const char *name,
                     const eda_sizes *sizes, int extend) {
  GString *out = g_string_new(NULL);
  if (l->osdi) g_string_append_printf(out, ".osdi \"%s\"\n", l->osdi);
  eda_sizes all = {{0}, {0}};
  char *keep = find_needed(l, name);
  for (guint i = 0; i < l->piece->len; i++)
    for (guint k = 0; keep[i] && k < piece_at(l, i)->of->len; k++) {
      if (!k && piece_at(l, i)->kind)
        (void)bins_outermost(l, keep, piece_at(l, i), &all);
      models_put_statement(l, out, piece_at(l, i)->of->pdata[k], &all, sizes,
                           extend);
    }
  free(keep);
  return g_string_free(out, FALSE);
}
