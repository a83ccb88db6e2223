/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements names and their reference numbers. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

static void free_name(void *data) {
  oasis_name *name = data;
  g_free(name->text);
  free(name);
}

GHashTable *oasis_names_new(void) {
  return g_hash_table_new_full(g_int64_hash, g_int64_equal, free_name, NULL);
}

/* ---- records ---- */

/* Define a name; `text` is owned by the table. */
static void name_define(oasis *o, int table, uint64_t number, char *text) {
  oasis_name *name = g_hash_table_lookup(o->names[table], &number);
  if (name && (name->defined || strcmp(name->text, text) != 0))
    oasis_refuse(o, "a second name for the same number");
  if (name) {
    g_free(text);
  } else {
    name = eda_alloc(1, sizeof *name);
    *name = (oasis_name){.number = number, .text = text};
    g_hash_table_add(o->names[table], name);
  }
  if (!o->naming) name->defined = 1;
}

static void skip_interval(oasis *o) {
  uint64_t type = oasis_uint(o);
  if (type > 4) {
    oasis_refuse(o, "an unknown kind of interval");
    return;
  }
  if (type > 0) oasis_uint(o);
  if (type == 4) oasis_uint(o);
}

void oasis_read_name(oasis *o, uint64_t record) {
  if (record == EDA_OASIS_XNAME || record == EDA_OASIS_XNAME_NUMBER) {
    oasis_uint(o);
    oasis_skip_string(o);
    if (record == EDA_OASIS_XNAME_NUMBER) oasis_uint(o);
    return;
  }
  if (record == EDA_OASIS_LAYERNAME || record == EDA_OASIS_LAYERNAME_TEXT) {
    oasis_skip_string(o);
    skip_interval(o);
    skip_interval(o);
    return;
  }
  int table = (int)(record - EDA_OASIS_CELLNAME) / 2;
  int explicit = (record - EDA_OASIS_CELLNAME) % 2;
  if (o->numbered[table] && o->numbered[table] != 1 + explicit) {
    oasis_refuse(o, "names with numbers among names without,");
    return;
  }
  o->numbered[table] = 1 + explicit;
  char *text = oasis_string(o);
  uint64_t number = explicit ? oasis_uint(o) : o->next[table]++;
  if (o->b.failed)
    g_free(text);
  else
    name_define(o, table, number, text);
}

/* ---- looking up ---- */

/* Read all records of a table, which begins at `at`. */
static void read_table(oasis *o, int table, uint64_t at) {
  oasis_seek(o, at);
  while (oasis_begin_record(o)) {
    uint64_t record = oasis_uint(o);
    if (record == EDA_OASIS_CBLOCK)
      oasis_enter_block(o);
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

/* Read names by a second reader: a table at `at`, or all names if `at` is 0. */
static void look_for_names(oasis *o, int table, uint64_t at) {
  oasis other = oasis_again(o, o->b.error);
  if (at)
    read_table(&other, table, at);
  else
    oasis_read(&other);
  o->b.failed = other.b.failed;
  oasis_clear(&other);
}

void oasis_read_reference(oasis *o, int by_number, oasis_reference *to) {
  g_clear_pointer(&to->text, g_free);
  if (by_number)
    to->number = oasis_uint(o);
  else
    to->text = oasis_string(o);
}

const char *oasis_referred(oasis *o, int table, const oasis_reference *to) {
  static const char *const what[] = {"a cell whose number has no name",
                                     "a text whose number has no string",
                                     "a property whose number has no name",
                                     "a property whose number has no string"};
  if (o->b.failed || to->text) return o->b.failed ? NULL : to->text;
  const oasis_name *name = g_hash_table_lookup(o->names[table], &to->number);
  if (!name && o->tables[table]) {
    look_for_names(o, table, o->tables[table]);
    o->tables[table] = 0;
    name = g_hash_table_lookup(o->names[table], &to->number);
  }
  if (!name && !o->named && !o->b.failed) {
    look_for_names(o, table, 0);
    o->named = 1;
    name = g_hash_table_lookup(o->names[table], &to->number);
  }
  if (!name) oasis_refuse(o, what[table]);
  return o->b.failed ? NULL : name->text;
}
