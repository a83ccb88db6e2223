/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of netlist files as lines of words: comments, continuation lines,
   quotes. */
#include "netlist/lines.h"

#include <errno.h>
#include <glib.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* Largest nesting depth and number of included files. Process libraries include
   tens of files. */
enum { MAX_INCLUDES = 16, MAX_FILES = 10000 };
/* Largest total size of all files, bytes. */
#define MAX_BYTES ((size_t)1 << 28)

int lines_refuse(const lines *s, eda_place at, const char *format, ...) {
  char what[700];
  va_list args;
  va_start(args, format);
  vsnprintf(what, sizeof what, format, args);
  va_end(args);
  return opc_fail(s->error, OPC_INVALID, NULL, "%.200s:%u:%u: %s",
                  s->file[at.file], at.line, at.column, what);
}

/* ---- words ---- */

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

int is_equals(const word *w) {
  return !w->quoted && w->text[0] == '=' && w->text[1] == '\0';
}

/* Return whether a character only separates words. */
static int is_gap(char c) {
  return is_blank(c) || c == ',' || c == '(' || c == ')';
}

/* Parse a position such as "x=250.5 y=400 nm" in a comment. Ignore other
   comments. */
static void read_position(const char *s, const char *end, line *l) {
  double at[2] = {NAN, NAN};
  for (; s + 2 < end; s++) {
    int d = *s == 'y' || *s == 'Y';
    if ((!d && *s != 'x' && *s != 'X') || s[1] != '=') continue;
    char *after;
    at[d] = strtod(s + 2, &after);
    if (after == s + 2 || after > end) return;
    while (*after == ' ') after++;
    double unit = !strncasecmp(after, "nm", 2)   ? 1
                  : !strncasecmp(after, "um", 2) ? 1e3
                                                 : 0;
    if (d && unit > 0 && isfinite(at[0] * unit) && isfinite(at[1] * unit)) {
      l->x = at[0] * unit;
      l->y = at[1] * unit;
      return;
    }
    s = after - 1;
  }
}

static int add_word(lines *r, line *l, const char *text, size_t length,
                    eda_place at, int quoted) {
  eda_pool_grow(r->pool, &l->word, &l->capacity, l->words + 1, sizeof *l->word);
  for (size_t i = 0; i < length; i++) {
    unsigned char c = (unsigned char)text[i];
    /* Quoted file names may contain any letters. */
    if (quoted && (c == '\t' || c > 127)) continue;
    if (c < 32 || c > 126)
      return lines_refuse(r, at, "byte 0x%02x in a word", c);
  }
  l->word[l->words++] =
      (word){eda_pool_text(r->pool, text, length), at, quoted};
  return OPC_OK;
}

/* Append a line of the file to l->text, without trailing blanks; write tabs and
   carriage returns as blanks. */
static void keep_text(lines *r, line *l, const char *from, const char *end) {
  while (end > from && is_blank(end[-1])) end--;
  const char *joint = l->length ? "\n+ " : "";
  size_t n = (size_t)(end - from), joined = strlen(joint);
  eda_pool_grow(r->pool, &l->text, &l->text_capacity,
                l->length + joined + n + 1, 1);
  char *at = l->text + l->length;
  memcpy(at, joint, joined);
  for (size_t i = 0; i < n; i++)
    at[joined + i] = is_blank(from[i]) ? ' ' : from[i];
  at[joined + n] = '\0';
  l->length += joined + n;
}

/* Split a line of the file (`from` to `end`) into words. `begin` is the first
   byte of the line, for columns in messages. */
static int line_split(lines *r, line *l, const char *from, const char *end,
                      uint32_t file, uint32_t number, const char *begin) {
  const char *s = from;
  while (s < end) {
    if (is_gap(*s)) {
      s++;
      continue;
    }
    if (*s == ';' || *s == '$') {
      read_position(s, end, l);
      break;
    }
    eda_place at = {file, number, (uint32_t)(s - begin) + 1};
    if (*s == '=') {
      if (add_word(r, l, s++, 1, at, 0)) return r->error->code;
      continue;
    }
    if (*s == '\'' || *s == '"' || *s == '{') {
      char close = *s == '{' ? '}' : *s;
      const char *to = memchr(s + 1, close, (size_t)(end - s - 1));
      if (!to && *s == '{' && r->wraps) to = end;
      if (!to) return lines_refuse(r, at, "'%c' is not closed", *s);
      if (add_word(r, l, s + 1, (size_t)(to - s - 1), at, 1))
        return r->error->code;
      s = to + (to < end);
      continue;
    }
    const char *to = s;
    while (to < end && !is_gap(*to) && *to != '=' && *to != ';') to++;
    if (add_word(r, l, s, (size_t)(to - s), at, 0)) return r->error->code;
    s = to;
  }
  keep_text(r, l, from, s);
  return OPC_OK;
}

/* ---- files ---- */

static char *read_whole(lines *r, const char *path, size_t *length) {
  g_autoptr(GError) why = NULL;
  struct stat about;
  char *text = NULL;
  if (stat(path, &about))
    opc_fail(r->error, OPC_IO, NULL, "'%.300s': %s", path, strerror(errno));
  else if (!S_ISREG(about.st_mode))
    opc_fail(r->error, OPC_IO, NULL, "'%.300s': is not a regular file", path);
  else if (r->bytes + (size_t)about.st_size > MAX_BYTES)
    opc_fail(r->error, OPC_IO, NULL,
             "'%.300s': this file and the files before it exceed %zu MB", path,
             MAX_BYTES >> 20);
  else if (r->files == MAX_FILES)
    opc_fail(r->error, OPC_IO, NULL, "'%.300s': more than %d files", path,
             MAX_FILES);
  else if (!g_file_get_contents(path, &text, length, &why))
    opc_fail(r->error, OPC_IO, NULL, "'%.300s': %s", path, why->message);
  return text;
}

static int line_flush(lines *r, line *l) {
  int code = l->words ? r->take(r->data, l) : OPC_OK;
  l->words = l->length = 0;
  l->x = l->y = NAN;
  return code;
}

static int read_lines(lines *r, const char *text, size_t length,
                      uint32_t file) {
  line l = {.x = NAN, .y = NAN};
  const char *end = text + length, *s = text;
  int code = OPC_OK;
  /* Skip a byte order mark. */
  if (length >= 3 && !memcmp(s, "\xEF\xBB\xBF", 3)) s += 3;
  for (uint32_t number = 1; !code && s < end && !r->ended; number++) {
    const char *begin = s, *stop = memchr(s, '\n', (size_t)(end - s));
    if (!stop) stop = end;
    while (s < stop && is_blank(*s)) s++;
    /* Comments may precede a continuation line. The first line of the first
       file is a title, unless a '.' begins the line. */
    int title = number == 1 && file == 0 && s < stop && *s != '.';
    if (s < stop && *s != '*' && !title) {
      if (*s == '+') {
        eda_place at = {file, number, (uint32_t)(s - begin) + 1};
        if (!l.words)
          code = lines_refuse(r, at, "'+' has no statement to continue");
        else
          code = line_split(r, &l, s + 1, stop, file, number, begin);
      } else {
        code = line_flush(r, &l);
        if (!code && !r->ended)
          code = line_split(r, &l, s, stop, file, number, begin);
      }
    }
    s = stop + (stop < end);
  }
  return code ? code : line_flush(r, &l);
}

int lines_read_text(lines *r, const char *name, const char *text,
                    size_t length) {
  eda_pool_grow(r->pool, &r->file, &r->capacity, r->files + 1, sizeof *r->file);
  r->file[r->files++] = eda_pool_text(r->pool, name, strlen(name));
  r->bytes += length;
  return read_lines(r, text, length, (uint32_t)r->files - 1);
}

int lines_read(lines *r, const char *path) {
  size_t length = 0;
  g_autofree char *text = read_whole(r, path, &length);
  return text ? lines_read_text(r, path, text, length) : r->error->code;
}

const char *lines_folder(eda_pool *pool, const char *path) {
  g_autofree char *real = realpath(path, NULL);
  char *slash = real ? strrchr(real, '/') : NULL;
  return slash ? eda_pool_text(pool, real, (size_t)(slash + 1 - real)) : NULL;
}

int lines_is_include(const line *l) {
  return !strcasecmp(l->word[0].text, ".include") ||
         !strcasecmp(l->word[0].text, ".inc");
}

int lines_include(lines *r, const line *l) {
  if (l->words != 2)
    return lines_refuse(r, l->word[0].at, "%.20s requires one file name",
                        l->word[0].text);
  const char *name = l->word[1].text, *from = r->file[l->word[0].at.file];
  const char *slash = strrchr(from, '/');
  char path[4096];
  int used =
      snprintf(path, sizeof path, "%.*s%s",
               slash && *name != '/' ? (int)(slash + 1 - from) : 0, from, name);
  if (used < 0 || (size_t)used >= sizeof path)
    return lines_refuse(r, l->word[1].at, "the path is too long");
  g_autofree char *real = r->root ? realpath(path, NULL) : NULL;
  if (real && strncmp(real, r->root, strlen(r->root)) != 0)
    return lines_refuse(
        r, l->word[1].at,
        "'%.200s' is outside of '%.300s', the folder of the netlist", name,
        r->root);
  if (r->depth == MAX_INCLUDES)
    return lines_refuse(r, l->word[0].at, "included files are nested too deep");
  r->depth++;
  int code = lines_read(r, real ? real : path);
  r->depth--;
  r->ended = 0;
  if (code == OPC_IO) {
    opc_error why = *r->error;
    return lines_refuse(r, l->word[1].at, "%.500s", why.message);
  }
  return code;
}
