/* SPDX-License-Identifier: BSD-3-Clause */
/* "Did you mean": the known word that is nearest to a mistyped one. */
#ifndef EDA_WORDS_H
#define EDA_WORDS_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The nearest of `known`, which ends with NULL; NULL if none is near: at most a
   third of the word's letters may be added, dropped or changed, and one where
   it is that short. The first of equals. Known words are cut at 64 bytes. [any]
 */
OPC_EXPORT const char *eda_nearest(const char *word, const char *const *known);

#ifdef __cplusplus
}
#endif
#endif
