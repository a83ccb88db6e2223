/* SPDX-License-Identifier: BSD-3-Clause */
/* Filter of decks: the simulator receives only statements that describe a
   circuit. The language of ngspice has further statements that run commands,
   access files or load code (.control, "*ng_script", "*#", .csparam, code
   models, tables in files). New versions add more, so unknown statements are
   rejected. This filter reads all included files, which must be in the folder
   of the file that the deck names, or below. Compiled models (OSDI) are code:
   the deck itself may name an OSDI file, included files may not. */
#include "simulator/deck.h"

#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/lines.h"

typedef struct deck {
  lines lines;
  FILE *out;
  const char *osdi; /* path of the OSDI file with compiled models; NULL: none */
  GMappedFile *objects; /* content of the OSDI file */
  /* State of the current file. */
  const char
      *wanted; /* section to copy; NULL: copy statements outside of sections */
  int found;   /* 1: the file has the section `wanted` */
  const char *section;  /* current section; NULL: outside of sections */
  eda_place section_at; /* start of the section, for messages */
  /* State of the whole deck. `models`: key: model name with scope number;
     value: "FILE:LINE" of the statement. */
  GHashTable *models;
  unsigned scope;  /* number of the current scope; 0: outside of subcircuits */
  unsigned scopes; /* number of scopes so far */
  unsigned depth;  /* number of open .subckt */
  unsigned branches; /* number of open .if */
} deck;

/* ---- known statements ---- */

/* First letters of allowed devices. A and U (code models) are rejected. N is
   allowed if the deck has an OSDI file. */
static const char devices[] = "bcdefghijklmqrvx";

/* Allowed kinds of models. CIDER and code models are rejected, because they
   access files. */
static const char model_kinds[] =
    "nmos pmos npn pnp njf pjf nmf pmf d r res c l";

/* Allowed options. Other options set variables of the simulator, such as paths.
   "parser" is an option of another simulator and has no effect in ngspice. */
static const char options[] =
    "abstol chgtol defad defas defl defw gmin itl1 itl2 itl4 parser pivrel "
    "pivtol reltol scale tnom trtol vntol";

/* Keywords of sources and models that read a file; rejected in all statements,
   also within quotes. */
static const char *const file_words[] = {"file", "sound"};
static const char letters[] =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

/* Return whether a statement is in the deck itself, not in an included file. */
static int is_own(const line *l) { return l->word[0].at.file == 0; }

/* ---- statements ---- */

/* Return whether a text contains a keyword that opens a file. Search within
   quotes too, because the simulator may pair quotes differently. */
static int names_file(const char *text) {
  while (*text) {
    size_t n = strspn(text, letters);
    for (size_t i = 0; i < sizeof file_words / sizeof *file_words; i++)
      if (n == strlen(file_words[i]) && !strncasecmp(text, file_words[i], n))
        return 1;
    text += n ? n : 1;
  }
  return 0;
}

static int deck_copy_statement(deck *d, const line *l) {
  for (size_t i = 0; i < l->words; i++)
    if (names_file(l->word[i].text))
      return lines_refuse(&d->lines, l->word[i].at,
                          "'%.100s': a deck must not open a file",
                          l->word[i].text);
  for (const char *c = l->text; *c; c++) {
    /* A backslash at the end of a line joins the next statement to this
       statement. */
    if (*c == '\\' && (!c[1] || c[1] == '\n'))
      return lines_refuse(&d->lines, l->word[0].at,
                          "a line of this statement ends in '\\'");
    if (*c == '`')
      return lines_refuse(&d->lines, l->word[0].at, "a '`' in this statement");
    if ((unsigned char)*c > 126)
      return lines_refuse(&d->lines, l->word[0].at,
                          "byte 0x%02x in this statement", (unsigned char)*c);
  }
  fprintf(d->out, "%s\n", l->text);
  return OPC_OK;
}

/* Return whether the OSDI file contains the name `kind`, terminated by a zero
   byte. */
static int is_compiled(const deck *d, const char *kind) {
  size_t n = strlen(kind), size = g_mapped_file_get_length(d->objects);
  const char *s = g_mapped_file_get_contents(d->objects);
  for (size_t i = 0; i + n < size; i++)
    if (!s[i + n] && !g_ascii_strncasecmp(s + i, kind, n)) return 1;
  return 0;
}

/* Reject a second model of the same name in a scope: the simulator would use
   one of the two without a message. Accept a statement that is read twice (a
   file included twice) and models in branches of .if. */
static int check_unique(deck *d, const line *l) {
  const word *name = &l->word[1];
  if (d->branches) return OPC_OK;
  g_autofree char *lower = g_ascii_strdown(name->text, -1);
  char *key = g_strdup_printf("%u %s", d->scope, lower);
  char *place = g_strdup_printf("%s:%u", d->lines.file[name->at.file],
                                (unsigned)name->at.line);
  const char *first = g_hash_table_lookup(d->models, key);
  int code = OPC_OK;
  if (first && strcmp(first, place) != 0)
    code = lines_refuse(&d->lines, name->at,
                        "model '%.100s' is defined twice, first at %s",
                        name->text, first);
  if (!first) {
    g_hash_table_insert(d->models, key, place);
    return code;
  }
  g_free(key);
  g_free(place);
  return code;
}

static int take_model(deck *d, const line *l) {
  if (l->words < 3)
    return lines_refuse(&d->lines, l->word[0].at,
                        ".model without a name and a kind");
  int code = check_unique(d, l);
  if (code) return code;
  const word *kind = &l->word[2];
  if (!kind->quoted && eda_in_list(model_kinds, kind->text))
    return deck_copy_statement(d, l);
  if (kind->quoted || !d->osdi)
    return lines_refuse(&d->lines, kind->at,
                        "models of kind '%.100s' are not supported; supported: "
                        "%s, and the models of an OSDI file",
                        kind->text, model_kinds);
  /* Omit models that are not compiled: libraries contain more models than a
     circuit uses. The simulator rejects devices of omitted models. */
  return is_compiled(d, kind->text) ? deck_copy_statement(d, l) : OPC_OK;
}

static int take_subcircuit(deck *d, const line *l) {
  d->depth++;
  d->scope = ++d->scopes;
  return deck_copy_statement(d, l);
}

/* At the end of a nested subcircuit, begin a new scope for the remainder of the
   outer subcircuit. This may miss duplicate models, but rejects no valid
   model. */
static int take_ends(deck *d, const line *l) {
  if (d->depth) d->depth--;
  d->scope = d->depth ? ++d->scopes : 0;
  return deck_copy_statement(d, l);
}

static int take_branch(deck *d, const line *l) {
  if (eda_same_name(l->word[0].text, ".if"))
    d->branches++;
  else if (d->branches)
    d->branches--;
  return deck_copy_statement(d, l);
}

/* Check options of the form NAME or NAME=NUMBER. */
static int take_options(deck *d, const line *l) {
  double number;
  for (size_t i = 1; i < l->words; i++) {
    const word *w = &l->word[i];
    /* In included files, a temperature would override the temperature of the
       step. */
    int good = eda_in_list(options, w->text) ||
               (is_own(l) && eda_same_name(w->text, "temp"));
    if (w->quoted || !good)
      return lines_refuse(&d->lines, w->at,
                          "option '%.100s' is not supported; supported: %s",
                          w->text, options);
    if (i + 1 == l->words || !is_equals(&w[1])) continue;
    const char *end = i + 2 < l->words && !w[2].quoted
                          ? netlist_number(w[2].text, &number)
                          : NULL;
    if (!end || *end)
      return lines_refuse(&d->lines, w->at, "option '%s' requires a number",
                          w->text);
    i += 2;
  }
  return deck_copy_statement(d, l);
}

/* Read the statements of another file. If `section` is not NULL, read only
   statements of this section. */
static int read_file(deck *d, const line *l, const char *section) {
  const deck outer = *d;
  line file = *l;
  file.words = 2;
  d->wanted = section;
  d->section = NULL;
  d->found = 0;
  if (is_own(l)) d->lines.root = lines_folder(d->lines.pool, l->word[1].text);
  int code = lines_include(&d->lines, &file);
  if (!code && d->section)
    code = lines_refuse(&d->lines, d->section_at,
                        "section '%.100s' has no .endl", d->section);
  if (!code && section && !d->found)
    code = lines_refuse(&d->lines, l->word[2].at,
                        "'%.300s' has no section '%.100s'", l->word[1].text,
                        section);
  d->wanted = outer.wanted;
  d->section = outer.section;
  d->section_at = outer.section_at;
  d->found = outer.found;
  d->lines.root = outer.lines.root;
  return code;
}

static int take_include(deck *d, const line *l) {
  if (l->words != 2)
    return lines_refuse(&d->lines, l->word[0].at, "%s requires one file",
                        l->word[0].text);
  return read_file(d, l, NULL);
}

/* Process .lib FILE SECTION (read a section) or .lib SECTION (start of a
   section). */
static int take_library(deck *d, const line *l) {
  if (l->words == 3) return read_file(d, l, l->word[2].text);
  if (l->words != 2 || d->section || is_own(l))
    return lines_refuse(&d->lines, l->word[0].at,
                        ".lib requires a file and a section");
  d->section = l->word[1].text;
  d->section_at = l->word[0].at;
  if (d->wanted && eda_same_name(d->section, d->wanted)) d->found = 1;
  return OPC_OK;
}

static int take_osdi(deck *d, const line *l) {
  g_autoptr(GError) why = NULL;
  if (l->words != 2 || d->osdi)
    return lines_refuse(&d->lines, l->word[0].at, ".osdi requires one file");
  d->osdi = l->word[1].text;
  d->objects = g_mapped_file_new(d->osdi, FALSE, &why);
  return d->objects
             ? OPC_OK
             : lines_refuse(&d->lines, l->word[1].at, "%.500s", why->message);
}

static int take_end(deck *d, const line *l) {
  if (is_own(l)) fputs(".end\n", d->out);
  d->lines.ended = 1;
  return OPC_OK;
}

/* ---- all statements ---- */

static const struct {
  const char *name;
  int (*take)(deck *d, const line *l);
  int own; /* 1: allowed only in the deck itself, not in included files */
} statements[] = {
    {".model", take_model, 0},
    {".param", deck_copy_statement, 0},
    {".subckt", take_subcircuit, 0},
    {".ends", take_ends, 0},
    {".global", deck_copy_statement, 0},
    {".func", deck_copy_statement, 0},
    {".if", take_branch, 0},
    {".elseif", deck_copy_statement, 0},
    {".else", deck_copy_statement, 0},
    {".endif", take_branch, 0},
    {".option", take_options, 0},
    {".options", take_options, 0},
    {".opt", take_options, 0},
    {".include", take_include, 0},
    {".inc", take_include, 0},
    {".lib", take_library, 0},
    {".end", take_end, 0},
    {".save", deck_copy_statement, 1},
    {".nodeset", deck_copy_statement, 1},
    {".osdi", take_osdi, 1},
};

/* Return whether statements at the current place are to be copied. */
static int is_meant(const deck *d) {
  if (!d->wanted) return !d->section;
  return d->section && eda_same_name(d->section, d->wanted);
}

static int word_refuse(deck *d, const word *w) {
  return lines_refuse(
      &d->lines, w->at,
      "'%.100s' is refused: the simulator receives only models, parameters, "
      "subcircuits, devices (%s), options, includes and libraries",
      w->text, devices);
}

static int is_device(const deck *d, const char *name) {
  char letter = g_ascii_tolower(*name);
  return g_ascii_isalpha(letter) &&
         (strchr(devices, letter) || (letter == 'n' && d->osdi));
}

static int take_line(void *data, const line *l) {
  deck *d = data;
  const word *first = &l->word[0];
  if (eda_same_name(first->text, ".endl")) {
    d->section = NULL;
    return OPC_OK;
  }
  int is_section = l->words == 2 && eda_same_name(first->text, ".lib");
  if (!is_meant(d) && !is_section) return OPC_OK;
  /* A statement must begin with its first word; rejects "(.control". */
  if (strncmp(l->text, first->text, strlen(first->text)) != 0)
    return word_refuse(d, first);
  if (first->text[0] != '.')
    return is_device(d, first->text) ? deck_copy_statement(d, l)
                                     : word_refuse(d, first);
  for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
    if (eda_same_name(first->text, statements[i].name) &&
        (!statements[i].own || is_own(l)))
      return statements[i].take(d, l);
  return word_refuse(d, first);
}

char *deck_write(const char *text, char **osdi, opc_error *error) {
  eda_pool pool = {0};
  char *out = NULL;
  size_t size;
  deck d = {
      .lines = {.error = error, .pool = &pool, .take = take_line, .wraps = 1},
      .models = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free),
      .out = open_memstream(&out, &size)};
  d.lines.data = &d;
  /* The simulator interprets the first line as a title, even "*ng_script". */
  fputs("opcflow\n", d.out);
  int code = lines_read_text(&d.lines, "deck", text, strlen(text));
  fclose(d.out);
  if (osdi) *osdi = code ? NULL : g_strdup(d.osdi);
  g_hash_table_unref(d.models);
  g_clear_pointer(&d.objects, g_mapped_file_unref);
  eda_pool_clear(&pool);
  if (!code) return out;
  free(out);
  return NULL;
}
