/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory for the values of fields. */
#ifndef EDA_VALUES_H
#define EDA_VALUES_H

#include <stddef.h>

/* Bytes behind the values of a field that the library makes: guard words
   (gates/fence.h) go there, and the field is not copied for them. */
enum { EDA_VALUES_SPARE = 512 };

/* n values, not zeroed, for eda_field_clear. Running out of memory ends the
   program. [any] */
float *eda_values_new(size_t n);

#endif
