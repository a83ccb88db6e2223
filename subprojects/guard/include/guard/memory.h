/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory available to this process. */
#pragma once

/* Return the available memory in bytes: the least of memory and swap of the
   machine, control groups, and address space; INFINITY if all are unknown.
   *source receives the name of the least one (static text). */
double memory_free(const char **source);
