/* SPDX-License-Identifier: BSD-3-Clause */
/* Facts that a result depends on: the key made of them, and the difference
   between two lists. All functions are [main]. */
#pragma once

#include <store/store.h>

/* A list, a(ysss): subject of the fact; its path; its text for people; and a
   sum where the text is incomplete. */
#define OPC_FACTS_TYPE G_VARIANT_TYPE("a(ysss)")

/* Add a fact to a list under construction. */
void opc_facts_add(GVariantBuilder *facts, char about, const char *path,
                   const char *shown, const char *sum);

/* Return the SHA-256 of a list (g_free). */
char *opc_facts_sum(GVariant *facts);

/* Return the processor's kind, within which results have equal bits. */
const char *opc_facts_machine(void);

/* Describe the change of one fact (g_free); `before` or `now` is NULL if the
   other list has no such fact. `data` is the caller's. */
typedef char *opc_fact_text(const void *data, char about, const char *path,
                            const char *before, const char *now);

/* Describe the differences between two lists (g_free): three of them, and the
   number of others. Return the text and write the total number to *count. */
char *opc_facts_difference(GVariant *before, GVariant *now, opc_fact_text *text,
                           const void *data, guint *count);

/* Return why there is no result for `now` (g_free): the difference from the
   most similar list kept under `name`. */
char *opc_facts_reason(opc_store *store, const char *name, GVariant *now,
                       opc_fact_text *text, const void *data);

/* Keep a list under `name`, with the 31 latest others. */
void opc_facts_keep(opc_store *store, const char *name, GVariant *facts);
