/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory for the values of fields. */
#pragma once

#include <stddef.h>

/* Spare bytes behind the values of fields allocated by the library. Guard words
   (gates/fence.h) use this memory, so that the field need not be copied. */
enum { EDA_VALUES_SPARE = 512 };

/* Return n uninitialised values, freed by eda_field_clear. Ends the program if
   memory is exhausted. [any] */
float *eda_values_new(size_t n);
