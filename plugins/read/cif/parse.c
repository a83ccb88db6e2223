/* SPDX-License-Identifier: BSD-3-Clause */
/* The commands of a CIF file, for both readings. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cif.h"

/* ---- characters ---- */

static int is_digit(int ch) { return ch >= '0' && ch <= '9'; }

static int is_space(int ch) { return ch == ' ' || (ch >= '\t' && ch <= '\r'); }

/* CIF takes everything for a blank but digits, capitals and - ( ) ; */
static int is_blank(int ch) {
  return !(is_digit(ch) || (ch >= 'A' && ch <= 'Z') || ch == '-' || ch == '(' ||
           ch == ')' || ch == ';');
}

static int peek(const cif *c) {
  return c->at < c->n ? (unsigned char)c->text[c->at] : -1;
}

/* Past a comment; they nest. */
static int skip_comment(cif *c, opc_error *error) {
  size_t depth = 0, open = c->at;
  for (; c->at < c->n; c->at++) {
    if (peek(c) == '(') depth++;
    if (peek(c) != ')' || --depth) continue;
    c->at++;
    return OPC_OK;
  }
  return cif_refuse(c, open, error, "a comment that does not end");
}

/* Past blanks and comments. */
static int skip(cif *c, opc_error *error) {
  for (;;) {
    int ch = peek(c);
    if (ch == '(') {
      if (skip_comment(c, error)) return error->code;
    } else if (ch < 0 || !is_blank(ch)) {
      return OPC_OK;
    } else {
      c->at++;
    }
  }
}

static int skip_to_end(cif *c, opc_error *error) {
  const char *end = memchr(c->text + c->at, ';', c->n - c->at);
  if (!end) return cif_refuse(c, c->command, error, "';' is missing");
  c->at = (size_t)(end - c->text);
  return OPC_OK;
}

static int number_follows(cif *c, int *yes, opc_error *error) {
  if (skip(c, error)) return error->code;
  *yes = peek(c) == '-' || is_digit(peek(c));
  return OPC_OK;
}

/* An integer of 32 bits. */
static int take_number(cif *c, int64_t *out, opc_error *error) {
  *out = 0;
  if (skip(c, error)) return error->code;
  size_t start = c->at;
  int negative = peek(c) == '-';
  if (negative) c->at++;
  size_t digits = c->at;
  int64_t v = 0;
  for (; is_digit(peek(c)) && v <= INT32_MAX; c->at++)
    v = 10 * v + (peek(c) - '0');
  if (c->at == digits)
    return cif_refuse(c, start, error, "a number is missing");
  if (v > INT32_MAX)
    return cif_refuse(c, start, error, "a number beyond 32 bits");
  *out = negative ? -v : v;
  return OPC_OK;
}

/* One that is not negative. */
static int take_size(cif *c, int64_t *out, opc_error *error) {
  if (skip(c, error)) return error->code;
  size_t start = c->at;
  if (take_number(c, out, error)) return error->code;
  if (*out < 0) return cif_refuse(c, start, error, "a negative size");
  return OPC_OK;
}

/* One that is positive. */
static int take_count(cif *c, int64_t *out, opc_error *error) {
  if (skip(c, error)) return error->code;
  size_t start = c->at;
  if (take_number(c, out, error)) return error->code;
  if (*out <= 0) return cif_refuse(c, start, error, "not a positive number");
  return OPC_OK;
}

static int take_direction(cif *c, int64_t *dx, int64_t *dy, opc_error *error) {
  if (skip(c, error)) return error->code;
  size_t start = c->at;
  if (take_number(c, dx, error) || take_number(c, dy, error))
    return error->code;
  if (!*dx && !*dy) return cif_refuse(c, start, error, "no direction");
  return OPC_OK;
}

/* ---- words ---- */

/* n bytes of the file as a string. */
static void copy_word(const char *from, size_t n, char **to, size_t *room) {
  eda_grow(to, room, 4 * n + 1, 1);
  reader_string(from, n, *to);
}

/* The next word before the ';', of any characters but spaces; *n = 0 if there
   is none. */
static const char *next_word(cif *c, size_t *n) {
  while (is_space(peek(c))) c->at++;
  const char *start = c->text + c->at;
  while (c->at < c->n && !is_space(peek(c)) && peek(c) != ';') c->at++;
  *n = (size_t)(c->text + c->at - start);
  return start;
}

static void set_layer(cif *c, const char *name, size_t n) {
  c->layer_number = -1;
  copy_word(name, n, &c->layer, &c->room_layer);
}

/* L: the last word, for one may write "Layer CP (poly);". */
static int take_layer(cif *c, opc_error *error) {
  size_t start = 0, end = 0;
  for (int ch; (ch = peek(c)) >= 0 && ch != ';';) {
    if (ch == '(') {
      if (skip_comment(c, error)) return error->code;
    } else if (is_space(ch)) {
      c->at++;
    } else {
      start = c->at;
      while (peek(c) >= 0 && peek(c) != '(' && peek(c) != ';' &&
             !is_space(peek(c)))
        c->at++;
      end = c->at;
    }
  }
  if (start == end)
    return cif_refuse(c, c->command, error, "a layer without a name");
  set_layer(c, c->text + start, end - start);
  return OPC_OK;
}

/* ---- commands ---- */

/* The rest of the command: points, in units. */
static int take_points(cif *c, opc_error *error) {
  int more = 0;
  c->n_points = 0;
  for (;;) {
    if (number_follows(c, &more, error)) return error->code;
    if (!more) return OPC_OK;
    int64_t x = 0, y = 0;
    eda_point p = {0, 0};
    if (take_number(c, &x, error) || take_number(c, &y, error) ||
        cif_units(c, x, &p.x, error) || cif_units(c, y, &p.y, error))
      return error->code;
    eda_grow(&c->points, &c->room_points, c->n_points + 1, sizeof p);
    c->points[c->n_points++] = p;
  }
}

static int take_box(cif *c, opc_error *error) {
  int64_t length = 0, width = 0, x = 0, y = 0, dx = 1, dy = 0;
  int turned = 0;
  if (take_size(c, &length, error) || take_size(c, &width, error) ||
      take_number(c, &x, error) || take_number(c, &y, error) ||
      number_follows(c, &turned, error))
    return error->code;
  if (turned && take_direction(c, &dx, &dy, error)) return error->code;
  return cif_box(c, length, width, x, y, dx, dy, error);
}

static int take_wire(cif *c, opc_error *error) {
  int64_t width = 0;
  if (take_size(c, &width, error) || take_points(c, error)) return error->code;
  return cif_wire(c, width, error);
}

static int take_flash(cif *c, opc_error *error) {
  int64_t diameter = 0, x = 0, y = 0;
  if (take_size(c, &diameter, error) || take_number(c, &x, error) ||
      take_number(c, &y, error))
    return error->code;
  return cif_flash(c, diameter, x, y, error);
}

static double turned(double angle) {
  angle = fmod(angle, 360);
  return angle < 0 ? angle + 360 : angle;
}

/* One step of a call's transformation, done after those before it. With M for
   y -> -y and R(a) for a turn, x -> -x is R(180) M, and M R(a) = R(-a) M. */
static int take_step(cif *c, int kind, cif_transform *t, opc_error *error) {
  int64_t x = 0, y = 0;
  if (kind == 'T') {
    if (take_number(c, &x, error) || take_number(c, &y, error))
      return error->code;
    t->x += (double)x;
    t->y += (double)y;
    return OPC_OK;
  }
  if (kind == 'R') {
    if (take_direction(c, &x, &y, error)) return error->code;
    double size = hypot((double)x, (double)y);
    double cosine = (double)x / size, sine = (double)y / size;
    double tx = t->x;
    t->angle = turned(t->angle + cif_angle(x, y));
    t->x = cosine * tx - sine * t->y;
    t->y = sine * tx + cosine * t->y;
    return OPC_OK;
  }
  if (skip(c, error)) return error->code;
  int axis = peek(c);
  if (kind != 'M' || (axis != 'X' && axis != 'Y'))
    return cif_refuse(c, c->at, error, "not a transformation");
  c->at++;
  t->mirror = !t->mirror;
  t->angle = turned(axis == 'X' ? 180 - t->angle : -t->angle);
  if (axis == 'X')
    t->x = -t->x;
  else
    t->y = -t->y;
  return OPC_OK;
}

static int take_call(cif *c, opc_error *error) {
  int64_t number = 0;
  cif_transform t = {0, 0, 0, 0};
  if (take_size(c, &number, error)) return error->code;
  size_t called = cif_symbol_of(c, number);
  for (;;) {
    if (skip(c, error)) return error->code;
    int kind = peek(c);
    if (kind == ';' || kind < 0) break;
    c->at++;
    if (take_step(c, kind, &t, error)) return error->code;
  }
  return cif_call(c, called, &t, error);
}

static int begin_symbol(cif *c, opc_error *error) {
  int64_t number = 0, a = 1, b = 1;
  int scaled = 0;
  if (c->current)
    return cif_refuse(c, c->command, error, "a symbol inside of another");
  if (take_size(c, &number, error) || number_follows(c, &scaled, error))
    return error->code;
  if (scaled && (take_count(c, &a, error) || take_count(c, &b, error)))
    return error->code;
  size_t i = cif_symbol_of(c, number);
  cif_symbol *s = &c->symbols[i];
  if (!c->building) {
    if (s->defined)
      return cif_refuse(c, c->command, error, "a symbol defined twice");
    s->defined = 1;
    s->a = a;
    s->b = b;
  }
  c->current = i;
  const char *layer = c->layer ? c->layer : "";
  copy_word(layer, strlen(layer), &c->outer, &c->room_outer);
  set_layer(c, "", 0);
  return OPC_OK;
}

static int end_symbol(cif *c, opc_error *error) {
  if (!c->current) return cif_refuse(c, c->command, error, "DF without DS");
  c->current = 0;
  set_layer(c, c->outer, strlen(c->outer));
  return OPC_OK;
}

static int take_definition(cif *c, opc_error *error) {
  int64_t from = 0;
  if (skip(c, error)) return error->code;
  int kind = peek(c);
  c->at++;
  if (kind == 'S') return begin_symbol(c, error);
  if (kind == 'F') return end_symbol(c, error);
  if (kind != 'D')
    return cif_refuse(c, c->command, error, "an unknown command");
  if (take_size(c, &from, error)) return error->code;
  cif_forget(c, from);
  return OPC_OK;
}

/* 9 name */
static int take_name(cif *c, opc_error *error) {
  while (is_space(peek(c))) c->at++;
  size_t start = c->at;
  if (skip_to_end(c, error)) return error->code;
  size_t end = c->at;
  while (end > start && is_space((unsigned char)c->text[end - 1])) end--;
  cif_symbol *s = &c->symbols[c->current];
  if (c->building || end == start || !c->current || s->name) return OPC_OK;
  size_t room = 0;
  copy_word(c->text + start, end - start, &s->name, &room);
  return OPC_OK;
}

/* 94 label x y [layer] */
static int take_label(cif *c, opc_error *error) {
  size_t n;
  int64_t x = 0, y = 0;
  const char *word = next_word(c, &n);
  if (!n) return cif_refuse(c, c->command, error, "a label without a name");
  copy_word(word, n, &c->word, &c->room_word);
  if (take_number(c, &x, error) || take_number(c, &y, error))
    return error->code;
  word = next_word(c, &n);
  if (!n) return cif_label(c, c->word, x, y, error);
  /* Only this label's layer: the current one comes back. */
  char *layer = c->layer;
  size_t room = c->room_layer;
  c->layer = NULL;
  c->room_layer = 0;
  set_layer(c, word, n);
  int code = cif_label(c, c->word, x, y, error);
  free(c->layer);
  c->layer = layer;
  c->room_layer = room;
  c->layer_number = -1;
  return code;
}

/* User extensions are skipped but for names and labels. */
static int take_extension(cif *c, int digit, opc_error *error) {
  if (digit == '9' && is_space(peek(c))) return take_name(c, error);
  if (digit == '9' && peek(c) == '4' && c->at + 1 < c->n &&
      is_space((unsigned char)c->text[c->at + 1])) {
    c->at++;
    return take_label(c, error);
  }
  return skip_to_end(c, error);
}

static int take_command(cif *c, int kind, opc_error *error) {
  switch (kind) {
    case 'P':
      if (take_points(c, error)) return error->code;
      return cif_polygon(c, error);
    case 'B':
      return take_box(c, error);
    case 'W':
      return take_wire(c, error);
    case 'R':
      return take_flash(c, error);
    case 'L':
      return take_layer(c, error);
    case 'D':
      return take_definition(c, error);
    case 'C':
      return take_call(c, error);
    default:
      if (is_digit(kind)) return take_extension(c, kind, error);
      return cif_refuse(c, c->command, error, "an unknown command");
  }
}

int cif_parse(cif *c, opc_error *error) {
  cif_begin(c);
  c->current = 0;
  set_layer(c, "", 0);
  for (size_t commands = 0;; commands++) {
    if (skip(c, error)) return error->code;
    c->command = c->at;
    int kind = peek(c);
    if (kind < 0)
      return cif_refuse(c, c->n, error, "the file ends before its E command");
    c->at++;
    if (kind == ';') continue;
    if (kind == 'E') break;
    if (commands % 65536 == 0 && opc_cancelled(c->r->host->context))
      return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
    if (take_command(c, kind, error) || skip(c, error)) return error->code;
    if (peek(c) != ';') return cif_refuse(c, c->at, error, "';' is missing");
    c->at++;
  }
  if (c->current)
    return cif_refuse(c, c->command, error, "E inside of a symbol");
  return OPC_OK;
}
