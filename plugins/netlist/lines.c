/* SPDX-License-Identifier: BSD-3-Clause */
/* A netlist's file as lines of words: comments, continuation, quotes. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist.h"

enum { MAX_INCLUDES = 16 };
#define MAX_BYTES ((long)1 << 28)

int netlist_no_memory(netlist *n) {
  return n->host->fail(n->host, n->error, OPC_FAILED, NULL, "out of memory");
}

int netlist_refuse(netlist *n, place at, const char *format, ...) {
  char what[700];
  va_list args;
  va_start(args, format);
  vsnprintf(what, sizeof what, format, args);
  va_end(args);
  return n->host->fail(n->host, n->error, OPC_INVALID, NULL, "%.200s:%u:%u: %s",
                       n->file[at.file], at.line, at.column, what);
}

/* ---- words ---- */

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* What ends a word and means nothing itself. */
static int is_gap(char c) {
  return is_blank(c) || c == ',' || c == '(' || c == ')';
}

/* "x=250.5 y=400 nm" of a comment. Other comments are left alone. */
static void read_position(const char *s, const char *end, line *l) {
  double at[2] = {NAN, NAN};
  for (; s < end; s++) {
    if ((s[0] != 'x' && s[0] != 'X' && s[0] != 'y' && s[0] != 'Y') ||
        s + 1 >= end || s[1] != '=')
      continue;
    int d = s[0] == 'y' || s[0] == 'Y';
    char number[40];
    size_t n = 0;
    for (s += 2;
         s < end && n + 1 < sizeof number && strchr("+-.0123456789eE", *s);)
      number[n++] = *s++;
    number[n] = '\0';
    if (!n) return;
    at[d] = strtod(number, NULL);
    while (s < end && *s == ' ') s++;
    double unit = end - s >= 2 && !strncasecmp(s, "nm", 2)   ? 1
                  : end - s >= 2 && !strncasecmp(s, "um", 2) ? 1e3
                                                             : 0;
    if (d && unit > 0 && isfinite(at[0] * unit) && isfinite(at[1] * unit)) {
      l->x = at[0] * unit;
      l->y = at[1] * unit;
      return;
    }
    s--;
  }
}

static int add_word(netlist *n, line *l, const char *text, size_t length,
                    place at, int quoted) {
  if (!pool_grow(&n->pool, &l->word, &l->room, l->words + 1, sizeof *l->word))
    return netlist_no_memory(n);
  for (size_t i = 0; i < length; i++)
    if ((text[i] < 32 && !(quoted && text[i] == '\t')) || text[i] > 126)
      return netlist_refuse(n, at, "byte 0x%02x in a word",
                            (unsigned char)text[i]);
  char *copy = pool_text(&n->pool, text, length);
  if (!copy) return netlist_no_memory(n);
  l->word[l->words++] = (word){copy, at, quoted};
  return OPC_OK;
}

/* One line of the file, from `from` up to `end`, into words. */
static int split(netlist *n, line *l, const char *from, const char *end,
                 uint32_t file, uint32_t number, const char *begin) {
  const char *s = from;
  while (s < end) {
    if (is_gap(*s)) {
      s++;
      continue;
    }
    if (*s == ';' || *s == '$') {
      read_position(s, end, l);
      return OPC_OK;
    }
    place at = {file, number, (uint32_t)(s - begin) + 1};
    if (*s == '=') {
      if (add_word(n, l, s++, 1, at, 0)) return n->error->code;
      continue;
    }
    if (*s == '\'' || *s == '"' || *s == '{') {
      char close = *s == '{' ? '}' : *s;
      const char *to = memchr(s + 1, close, (size_t)(end - s - 1));
      if (!to) return netlist_refuse(n, at, "'%c' is not closed", *s);
      if (add_word(n, l, s + 1, (size_t)(to - s - 1), at, 1))
        return n->error->code;
      s = to + 1;
      continue;
    }
    const char *to = s;
    while (to < end && !is_gap(*to) && *to != '=' && *to != ';') to++;
    if (add_word(n, l, s, (size_t)(to - s), at, 0)) return n->error->code;
    s = to;
  }
  return OPC_OK;
}

/* ---- files ---- */

static char *read_whole(netlist *n, const char *path, size_t *length) {
  FILE *f = fopen(path, "rb");
  char *text = NULL;
  int code = OPC_OK;
  if (!f || fseek(f, 0, SEEK_END)) {
    code = n->host->fail(n->host, n->error, OPC_IO, NULL, "'%.300s': %s", path,
                         strerror(errno));
  } else {
    long bytes = ftell(f);
    rewind(f);
    if (bytes < 0 || bytes > MAX_BYTES)
      code = n->host->fail(n->host, n->error, OPC_IO, NULL,
                           "'%.300s': no file, or larger than 256 MB", path);
    else if (!(text = malloc((size_t)bytes + 1)))
      code = netlist_no_memory(n);
    else if ((*length = fread(text, 1, (size_t)bytes, f)) != (size_t)bytes)
      code = n->host->fail(n->host, n->error, OPC_IO, NULL,
                           "'%.300s': cannot be read", path);
  }
  if (f) fclose(f);
  if (!code) return text;
  free(text);
  return NULL;
}

static int flush(netlist *n, parser *p, line *l) {
  int code = l->words ? netlist_line(n, p, l) : OPC_OK;
  l->words = 0;
  l->x = l->y = NAN;
  return code;
}

static int read_lines(netlist *n, parser *p, const char *text, size_t length,
                      uint32_t file) {
  line l = {.x = NAN, .y = NAN};
  const char *end = text + length, *s = text;
  int code = OPC_OK;
  for (uint32_t number = 1; !code && s < end && !p->ended; number++) {
    const char *begin = s, *stop = memchr(s, '\n', (size_t)(end - s));
    if (!stop) stop = end;
    while (s < stop && is_blank(*s)) s++;
    /* Comments may stand between a line and its continuation. */
    int title = number == 1 && file == 0 && s < stop && *s != '.';
    if (s < stop && *s != '*' && !title) {
      if (*s == '+') {
        place at = {file, number, (uint32_t)(s - begin) + 1};
        if (!l.words)
          code = netlist_refuse(n, at, "'+' continues nothing");
        else
          code = split(n, &l, s + 1, stop, file, number, begin);
      } else {
        code = flush(n, p, &l);
        if (!code && !p->ended)
          code = split(n, &l, s, stop, file, number, begin);
      }
    }
    s = stop + (stop < end);
  }
  return code ? code : flush(n, p, &l);
}

static int read_into(netlist *n, parser *p, const char *path) {
  size_t length = 0;
  char *text = read_whole(n, path, &length);
  if (!text) return n->error->code;
  char *name = pool_text(&n->pool, path, strlen(path));
  int code = OPC_OK;
  if (!name || !pool_grow(&n->pool, &n->file, &n->room_files, n->files + 1,
                          sizeof *n->file))
    code = netlist_no_memory(n);
  if (!code) {
    n->file[n->files++] = name;
    code = read_lines(n, p, text, length, (uint32_t)n->files - 1);
  }
  free(text);
  return code;
}

/* A file beside the one that asks for it. */
int netlist_include(netlist *n, parser *p, const line *l) {
  if (l->words != 2)
    return netlist_refuse(n, l->word[0].at, "%.20s takes one file",
                          l->word[0].text);
  const char *name = l->word[1].text, *from = n->file[l->word[0].at.file];
  const char *slash = strrchr(from, '/');
  char path[4096];
  int used =
      snprintf(path, sizeof path, "%.*s%s",
               slash && *name != '/' ? (int)(slash + 1 - from) : 0, from, name);
  if (used < 0 || (size_t)used >= sizeof path)
    return netlist_refuse(n, l->word[1].at, "the path is too long");
  if (p->depth == MAX_INCLUDES)
    return netlist_refuse(n, l->word[0].at,
                          "files that include each other go too deep");
  p->depth++;
  int code = read_into(n, p, path);
  p->depth--;
  p->ended = 0;
  if (code == OPC_IO) {
    opc_error why = *n->error;
    return netlist_refuse(n, l->word[1].at, "%.500s", why.message);
  }
  return code;
}

int netlist_read(netlist *n, const char *path) {
  parser p = {.current = UINT32_MAX};
  n->unit = 1;
  n->subcircuit_of.pool = n->type_of.pool = n->global_of.pool =
      n->setting_of.pool = &n->pool;
  int code = read_into(n, &p, path);
  if (!code && p.current != UINT32_MAX) {
    const subcircuit *s = &n->subcircuit[p.current];
    code = netlist_refuse(n, s->at, "'%.100s' has no .ends", s->name);
  }
  return code;
}
