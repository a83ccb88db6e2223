/* SPDX-License-Identifier: BSD-3-Clause */
/* Names and the numbers that stand for them. */
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

/* ---- the hash table ---- */

static size_t slot_of(const oasis_names *names, uint64_t number) {
  uint64_t h = number * 0x9e3779b97f4a7c15u;
  size_t i = (size_t)(h >> 20) & (names->room - 1);
  while (names->slots[i].text && names->slots[i].number != number)
    i = (i + 1) & (names->room - 1);
  return i;
}

oasis_name *oasis_names_find(const oasis_names *names, uint64_t number) {
  if (!names->room) return NULL;
  oasis_name *found = &names->slots[slot_of(names, number)];
  return found->text ? found : NULL;
}

static int enlarge(oasis_names *names) {
  oasis_names larger = {.n = names->n,
                        .room = names->room ? 2 * names->room : 64};
  larger.slots = calloc(larger.room, sizeof *larger.slots);
  if (!larger.slots) return 0;
  for (size_t i = 0; i < names->room; i++)
    if (names->slots[i].text)
      larger.slots[slot_of(&larger, names->slots[i].number)] = names->slots[i];
  free(names->slots);
  *names = larger;
  return 1;
}

oasis_name *oasis_names_add(oasis_names *names, uint64_t number, char *text) {
  if (2 * names->n >= names->room && !enlarge(names)) return NULL;
  oasis_name *slot = &names->slots[slot_of(names, number)];
  *slot = (oasis_name){.number = number, .text = text};
  names->n++;
  return slot;
}

void oasis_names_clear(oasis_names *names) {
  for (size_t i = 0; i < names->room; i++) free(names->slots[i].text);
  free(names->slots);
  *names = (oasis_names){0};
}

/* ---- records ---- */

static void define(oasis *o, int table, uint64_t number, char *text) {
  oasis_name *name = oasis_names_find(&o->names[table], number);
  if (name && (name->defined || strcmp(name->text, text) != 0)) {
    oasis_refuse(&o->s, "a second name for the same number");
    free(text);
    return;
  }
  if (name) {
    free(text);
  } else {
    name = oasis_names_add(&o->names[table], number, text);
    if (!name) {
      free(text);
      oasis_no_memory(&o->s);
      return;
    }
  }
  if (!o->naming) name->defined = 1;
}

static void skip_interval(oasis_stream *s) {
  uint64_t type = oasis_uint(s);
  if (type > 4) {
    oasis_refuse(s, "an unknown kind of interval");
    return;
  }
  if (type > 0) oasis_uint(s);
  if (type == 4) oasis_uint(s);
}

void oasis_read_name(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  if (record == OASIS_XNAME || record == OASIS_XNAME_NUMBER) {
    oasis_uint(s);
    oasis_skip_string(s);
    if (record == OASIS_XNAME_NUMBER) oasis_uint(s);
    return;
  }
  if (record == OASIS_LAYERNAME || record == OASIS_LAYERNAME_TEXT) {
    oasis_skip_string(s);
    skip_interval(s);
    skip_interval(s);
    return;
  }
  int table = (int)(record - OASIS_CELLNAME) / 2;
  int explicit = (record - OASIS_CELLNAME) % 2;
  if (o->numbered[table] && o->numbered[table] != 1 + explicit) {
    oasis_refuse(s, "names with numbers among names without,");
    return;
  }
  o->numbered[table] = 1 + explicit;
  oasis_text text = {NULL, 0};
  oasis_string(s, &text);
  uint64_t number = explicit ? oasis_uint(s) : o->next[table]++;
  if (s->failed)
    free(text.s);
  else
    define(o, table, number, text.s);
}

/* ---- looking up ---- */

/* The records of one table, all of them, from its place on. */
static void read_table(oasis *o, int table, uint64_t at) {
  oasis_seek(&o->s, at);
  while (oasis_begin_record(&o->s)) {
    uint64_t record = oasis_uint(&o->s);
    if (record == OASIS_CBLOCK)
      oasis_enter_block(&o->s);
    else if (record == OASIS_PROPERTY)
      oasis_read_property(o, record);
    else if (record >= OASIS_CELLNAME && record <= OASIS_PROPSTRING_NUMBER &&
             (int)(record - OASIS_CELLNAME) / 2 == table)
      oasis_read_name(o, record);
    else if (record != OASIS_PAD && record != OASIS_PROPERTY_AGAIN)
      break;
  }
}

/* Another reading, for names: of a table, or of the whole file if its place
   `at` is 0. */
static void look_for_names(oasis *o, int table, uint64_t at) {
  oasis other = {.host = o->host, .error = o->error, .naming = 1};
  memcpy(other.names, o->names, sizeof o->names);
  oasis_open(&other.s, o->host, o->s.path, o->error);
  if (at)
    read_table(&other, table, at);
  else
    oasis_read(&other);
  memcpy(o->names, other.names, sizeof o->names);
  if (other.s.failed) {
    o->s.failed = 1;
    o->s.p = o->s.end;
  }
  oasis_close(&other.s);
  oasis_modal_clear(&other.m);
}

const char *oasis_name_of(oasis *o, int table, uint64_t number) {
  static const char *const what[] = {"a cell whose number has no name",
                                     "a text whose number has no string",
                                     "a property whose number has no name",
                                     "a property whose number has no string"};
  const oasis_name *name = oasis_names_find(&o->names[table], number);
  if (!name && o->tables[table] && !o->s.failed) {
    look_for_names(o, table, o->tables[table]);
    o->tables[table] = 0;
    name = oasis_names_find(&o->names[table], number);
  }
  if (!name && !o->named && !o->s.failed) {
    look_for_names(o, table, 0);
    o->named = 1;
    name = oasis_names_find(&o->names[table], number);
  }
  if (o->s.failed) return NULL;
  if (name) return name->text;
  oasis_refuse(&o->s, what[table]);
  return NULL;
}

void oasis_read_reference(oasis *o, int by_number, oasis_reference *to) {
  to->by_number = by_number;
  if (by_number)
    to->number = oasis_uint(&o->s);
  else
    oasis_string(&o->s, &to->text);
}

const char *oasis_referred(oasis *o, int table, const oasis_reference *to) {
  if (o->s.failed) return NULL;
  return to->by_number ? oasis_name_of(o, table, to->number) : to->text.s;
}
