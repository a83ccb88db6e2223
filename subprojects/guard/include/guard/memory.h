/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory available to this process. */
#pragma once

/* Return the available memory in bytes: the least of three limits, and the
   freed memory that malloc keeps. The limits are memory and swap of the
   machine, control groups (version 2), and address space; INFINITY if all are
   unknown. *source receives the name of the least limit (static text). */
double memory_free(const char **source);
