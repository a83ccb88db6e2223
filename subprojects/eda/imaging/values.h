/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory for the values of fields. */
#pragma once

#include <stddef.h>

/* Spare bytes behind the values of fields made by the library: guard words
   (gates/fence.h) are written there without copying the field. */
enum { EDA_VALUES_SPARE = 512 };

/* Return n values, not initialised, freed by eda_field_clear. Ends the program
   without memory. [any] */
float *eda_values_new(size_t n);
