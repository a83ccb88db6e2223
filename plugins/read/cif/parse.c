/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the parser of CIF commands, for both passes. */
#include <math.h>
#include <string.h>

#include "cif.h"

/* ---- characters ---- */

static int is_digit(int ch) { return ch >= '0' && ch <= '9'; }

static int is_space(int ch) { return ch == ' ' || (ch >= '\t' && ch <= '\r'); }

/* In CIF, all characters are blanks except digits, capitals and - ( ) ; */
static int is_blank(int ch) {
  return !(is_digit(ch) || (ch >= 'A' && ch <= 'Z') || ch == '-' || ch == '(' ||
           ch == ')' || ch == ';');
}

static int cif_peek(const cif *c) {
  return c->at < c->b.n ? (unsigned char)c->b.text[c->at] : -1;
}

/* Skip a comment; comments nest. */
static void skip_comment(cif *c) {
  size_t depth = 0, open = c->at;
  for (; c->at < c->b.n; c->at++) {
    if (cif_peek(c) == '(') depth++;
    if (cif_peek(c) != ')' || --depth) continue;
    c->at++;
    return;
  }
  cif_refuse_at(c, open, "unterminated comment");
}

/* Skip blanks and comments; return the place. */
static size_t cif_skip(cif *c) {
  for (int ch; (ch = cif_peek(c)) >= 0 && (ch == '(' || is_blank(ch));) {
    if (ch == '(')
      skip_comment(c);
    else
      c->at++;
  }
  return c->at;
}

static void skip_to_end(cif *c) {
  const char *end = memchr(c->b.text + c->at, ';', c->b.n - c->at);
  if (end)
    c->at = (size_t)(end - c->b.text);
  else
    cif_refuse(c, "';' is missing");
}

static int number_follows(cif *c) {
  cif_skip(c);
  return cif_peek(c) == '-' || is_digit(cif_peek(c));
}

/* Read an integer of 32 bits. */
static int64_t take_number(cif *c) {
  size_t start = cif_skip(c);
  int negative = cif_peek(c) == '-';
  if (negative) c->at++;
  size_t digits = c->at;
  int64_t v = 0;
  for (; is_digit(cif_peek(c)) && v <= INT32_MAX; c->at++)
    v = 10 * v + (cif_peek(c) - '0');
  if (c->at == digits) cif_refuse_at(c, start, "a number is missing");
  if (v > INT32_MAX) cif_refuse_at(c, start, "a number beyond 32 bits");
  return negative ? -v : v;
}

/* Read a nonnegative integer. */
static int64_t take_size(cif *c) {
  size_t start = cif_skip(c);
  int64_t v = take_number(c);
  if (v < 0) cif_refuse_at(c, start, "a negative size");
  return v;
}

/* Read a positive integer. */
static int64_t take_count(cif *c) {
  size_t start = cif_skip(c);
  int64_t v = take_number(c);
  if (v <= 0) cif_refuse_at(c, start, "not a positive number");
  return v;
}

static void take_direction(cif *c, int64_t *dx, int64_t *dy) {
  size_t start = cif_skip(c);
  *dx = take_number(c);
  *dy = take_number(c);
  if (!*dx && !*dy) cif_refuse_at(c, start, "no direction");
}

/* ---- words ---- */

/* Return the next word before the ';', delimited by spaces; *n is 0 for
   none. */
static const char *next_word(cif *c, size_t *n) {
  while (is_space(cif_peek(c))) c->at++;
  const char *start = c->b.text + c->at;
  while (c->at < c->b.n && !is_space(cif_peek(c)) && cif_peek(c) != ';')
    c->at++;
  *n = (size_t)(c->b.text + c->at - start);
  return start;
}

static void set_layer(cif *c, const char *name, size_t n) {
  c->layer_number = -1;
  g_free(c->layer);
  c->layer = reader_string(name, n);
}

/* Read the layer after L. The layer is the last word, so that "Layer CP
   (poly);" is accepted. */
static void take_layer(cif *c) {
  size_t start = 0, end = 0;
  for (int ch; (ch = cif_peek(c)) >= 0 && ch != ';';) {
    if (ch == '(') {
      skip_comment(c);
    } else if (is_space(ch)) {
      c->at++;
    } else {
      start = c->at;
      while (cif_peek(c) >= 0 && cif_peek(c) != '(' && cif_peek(c) != ';' &&
             !is_space(cif_peek(c)))
        c->at++;
      end = c->at;
    }
  }
  if (start == end) cif_refuse(c, "a layer without a name");
  set_layer(c, c->b.text + start, end - start);
}

/* ---- commands ---- */

/* Read the points, in units, up to the end of the command. */
static void take_points(cif *c) {
  g_array_set_size(c->points, 0);
  while (number_follows(c)) {
    int64_t x = take_number(c), y = take_number(c);
    eda_point p = {cif_units(c, x), cif_units(c, y)};
    g_array_append_val(c->points, p);
  }
}

static void take_box(cif *c) {
  int64_t length = take_size(c), width = take_size(c);
  int64_t x = take_number(c), y = take_number(c), dx = 1, dy = 0;
  if (number_follows(c)) take_direction(c, &dx, &dy);
  cif_box(c, length, width, x, y, dx, dy);
}

static void take_wire(cif *c) {
  int64_t width = take_size(c);
  take_points(c);
  cif_wire(c, width);
}

static void take_flash(cif *c) {
  int64_t diameter = take_size(c), x = take_number(c), y = take_number(c);
  cif_flash(c, diameter, x, y);
}

static double placement_turned(double angle) {
  angle = fmod(angle, 360);
  return angle < 0 ? angle + 360 : angle;
}

/* Append one step to a call's transformation. M mirrors y -> -y and R(a)
   rotates by a. Then x -> -x is R(180) M, and M R(a) = R(-a) M. */
static void take_step(cif *c, cif_transform *t) {
  int kind = (unsigned char)c->b.text[c->at++];
  int64_t x, y;
  if (kind == 'T') {
    t->x += (double)take_number(c);
    t->y += (double)take_number(c);
    return;
  }
  if (kind == 'R') {
    take_direction(c, &x, &y);
    double size = hypot((double)x, (double)y);
    double cosine = (double)x / size, sine = (double)y / size;
    double tx = t->x;
    t->angle = placement_turned(t->angle + cif_angle(x, y));
    t->x = cosine * tx - sine * t->y;
    t->y = sine * tx + cosine * t->y;
    return;
  }
  cif_skip(c);
  int axis = cif_peek(c);
  if (kind != 'M' || (axis != 'X' && axis != 'Y')) {
    cif_refuse_at(c, c->at, "not a transformation");
    return;
  }
  c->at++;
  t->mirror = !t->mirror;
  t->angle = placement_turned(axis == 'X' ? 180 - t->angle : -t->angle);
  if (axis == 'X')
    t->x = -t->x;
  else
    t->y = -t->y;
}

static void take_call(cif *c) {
  int64_t number = take_size(c);
  cif_transform t = {0, 0, 0, 0};
  if (c->b.failed) return;
  cif_symbol *called = cif_symbol_of(c, number);
  for (cif_skip(c); cif_peek(c) >= 0 && cif_peek(c) != ';'; cif_skip(c))
    take_step(c, &t);
  cif_call(c, called, &t);
}

static void begin_symbol(cif *c) {
  int64_t a = 1, b = 1;
  if (c->current != cif_symbol_at(c, 0))
    cif_refuse(c, "symbol definition inside of another");
  int64_t number = take_size(c);
  if (number_follows(c)) {
    a = take_count(c);
    b = take_count(c);
  }
  if (c->b.failed) return;
  cif_symbol *s = c->current = cif_symbol_of(c, number);
  if (!c->building) {
    if (s->defined) cif_refuse(c, "a symbol defined twice");
    s->defined = 1;
    s->a = a;
    s->b = b;
  }
  g_free(c->outer);
  c->outer = g_steal_pointer(&c->layer);
  set_layer(c, "", 0);
}

static void end_symbol(cif *c) {
  cif_symbol *outside = cif_symbol_at(c, 0);
  if (c->current == outside) {
    cif_refuse(c, "DF without DS");
    return;
  }
  c->current = outside;
  c->layer_number = -1;
  g_free(c->layer);
  c->layer = g_steal_pointer(&c->outer);
}

static void take_definition(cif *c) {
  cif_skip(c);
  int kind = cif_peek(c);
  c->at++;
  if (kind == 'S')
    begin_symbol(c);
  else if (kind == 'F')
    end_symbol(c);
  else if (kind == 'D')
    cif_forget(c, take_size(c));
  else
    cif_refuse(c, "an unknown command");
}

/* Read "9 name". */
static void take_name(cif *c) {
  while (is_space(cif_peek(c))) c->at++;
  size_t start = c->at;
  skip_to_end(c);
  size_t end = c->at;
  while (end > start && is_space((unsigned char)c->b.text[end - 1])) end--;
  cif_symbol *s = c->current;
  if (end > start && s != cif_symbol_at(c, 0) && !s->name)
    s->name = reader_string(c->b.text + start, end - start);
}

/* Read "94 label x y [layer]". */
static void take_label(cif *c) {
  size_t n;
  const char *word = next_word(c, &n);
  if (!n) cif_refuse(c, "a label without a name");
  g_autofree char *label = reader_string(word, n);
  int64_t x = take_number(c), y = take_number(c);
  word = next_word(c, &n);
  if (!n) {
    cif_label(c, label, x, y);
    return;
  }
  /* The layer of a label applies only to this label. */
  char *layer = g_steal_pointer(&c->layer);
  set_layer(c, word, n);
  cif_label(c, label, x, y);
  g_free(c->layer);
  c->layer = layer;
  c->layer_number = -1;
}

/* Skip user extensions except names and labels. */
static void take_extension(cif *c, int digit) {
  if (digit == '9' && is_space(cif_peek(c))) {
    take_name(c);
  } else if (digit == '9' && cif_peek(c) == '4' && c->at + 1 < c->b.n &&
             is_space((unsigned char)c->b.text[c->at + 1])) {
    c->at++;
    take_label(c);
  } else {
    skip_to_end(c);
  }
}

static void take_command(cif *c, int kind) {
  switch (kind) {
    case 'P':
      take_points(c);
      cif_polygon(c);
      break;
    case 'B':
      take_box(c);
      break;
    case 'W':
      take_wire(c);
      break;
    case 'R':
      take_flash(c);
      break;
    case 'L':
      take_layer(c);
      break;
    case 'D':
      take_definition(c);
      break;
    case 'C':
      take_call(c);
      break;
    default:
      if (is_digit(kind))
        take_extension(c, kind);
      else
        cif_refuse(c, "an unknown command");
  }
}

void cif_parse(cif *c) {
  cif_begin(c);
  set_layer(c, "", 0);
  c->b.next_progress = 0;
  for (;;) {
    c->command = cif_skip(c);
    int kind = cif_peek(c);
    if (kind < 0)
      cif_refuse_at(c, c->b.n, "the file ends before its E command");
    c->at++;
    if (kind == ';') continue;
    if (kind == 'E' || !reading_goes_on(&c->b, c->at, c->building)) break;
    take_command(c, kind);
    cif_skip(c);
    if (cif_peek(c) != ';') cif_refuse_at(c, c->at, "';' is missing");
    c->at++;
  }
  if (c->current != cif_symbol_at(c, 0)) cif_refuse(c, "E inside of a symbol");
}
