/* SPDX-License-Identifier: BSD-3-Clause */
/* Names and the numbers that stand for them. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

static void free_name(void *data) {
  oasis_name *name = data;
  free(name->text);
  free(name);
}

GHashTable *oasis_names_new(void) {
  return g_hash_table_new_full(g_int64_hash, g_int64_equal, free_name, NULL);
}

/* ---- records ---- */

/* Takes `text`. */
static void define(oasis *o, int table, uint64_t number, char *text) {
  oasis_name *name = g_hash_table_lookup(o->names[table], &number);
  if (name && (name->defined || strcmp(name->text, text) != 0))
    oasis_refuse(&o->s, "a second name for the same number");
  if (name) {
    free(text);
  } else {
    name = eda_alloc(1, sizeof *name);
    *name = (oasis_name){.number = number, .text = text};
    g_hash_table_add(o->names[table], name);
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
  if (record == EDA_OASIS_XNAME || record == EDA_OASIS_XNAME_NUMBER) {
    oasis_uint(s);
    oasis_skip_string(s);
    if (record == EDA_OASIS_XNAME_NUMBER) oasis_uint(s);
    return;
  }
  if (record == EDA_OASIS_LAYERNAME || record == EDA_OASIS_LAYERNAME_TEXT) {
    oasis_skip_string(s);
    skip_interval(s);
    skip_interval(s);
    return;
  }
  int table = (int)(record - EDA_OASIS_CELLNAME) / 2;
  int explicit = (record - EDA_OASIS_CELLNAME) % 2;
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
    if (record == EDA_OASIS_CBLOCK)
      oasis_enter_block(&o->s);
    else if (record == EDA_OASIS_PROPERTY)
      oasis_read_property(o, record);
    else if (record >= EDA_OASIS_CELLNAME &&
             record <= EDA_OASIS_PROPSTRING_NUMBER &&
             (int)(record - EDA_OASIS_CELLNAME) / 2 == table)
      oasis_read_name(o, record);
    else if (record != EDA_OASIS_PAD && record != EDA_OASIS_PROPERTY_AGAIN)
      break;
  }
}

/* Another reading, for names: of a table, or of the whole file if its place
   `at` is 0. */
static void look_for_names(oasis *o, int table, uint64_t at) {
  oasis other = {.r = o->r, .error = o->error, .naming = 1};
  memcpy(other.names, o->names, sizeof o->names); /* the tables are shared */
  oasis_open(&other.s, o->r->host, o->s.path, o->error);
  if (at)
    read_table(&other, table, at);
  else
    oasis_read(&other);
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
  const oasis_name *name = g_hash_table_lookup(o->names[table], &number);
  if (!name && o->tables[table] && !o->s.failed) {
    look_for_names(o, table, o->tables[table]);
    o->tables[table] = 0;
    name = g_hash_table_lookup(o->names[table], &number);
  }
  if (!name && !o->named && !o->s.failed) {
    look_for_names(o, table, 0);
    o->named = 1;
    name = g_hash_table_lookup(o->names[table], &number);
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
