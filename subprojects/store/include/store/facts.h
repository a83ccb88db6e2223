/* SPDX-License-Identifier: BSD-3-Clause */
/* Facts that a result depends on, such as parameters and files: their checksum,
   and differences between two lists of facts. All functions are [main]. */
#pragma once

#include <store/store.h>

/* A list of facts. Each fact has a subject (a letter that the caller defines),
   a path, a value for the user, and a checksum if the value does not identify
   the fact. */
#define OPC_FACTS_TYPE G_VARIANT_TYPE("a(ysss)")

/* Add a fact to a list under construction. */
void opc_facts_add(GVariantBuilder *facts, char about, const char *path,
                   const char *shown, const char *sum);

/* Return the SHA-256 of a list (g_free). */
char *opc_facts_sum(GVariant *facts);

/* Return the class of the processor; results of one class are bit-identical. */
const char *opc_facts_machine(void);

/* Return a description of the change of one fact (g_free). `before` or `now` is
   NULL if that list has no such fact. */
typedef char *opc_fact_text(const void *data, char about, const char *path,
                            const char *before, const char *now);

/* Return the reason why no result exists for `now` (g_free): the differences
   from the most similar list kept under `name`. At most three changed or new
   facts and three missing facts are described; the others are counted. The
   reason is "not seen before" if no list is kept, and "the stored result was
   removed" if an equal list is kept. */
char *opc_facts_reason(opc_store *store, const char *name, GVariant *now,
                       opc_fact_text *text, const void *data);

/* Keep a list under `name`, together with at most 31 earlier lists. */
void opc_facts_keep(opc_store *store, const char *name, GVariant *facts);
