/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory available to this process. */
#pragma once

/* Return the available memory in bytes: the least of three limits, plus the
   freed memory that malloc keeps. The limits are the free memory and swap space
   of the machine, the control groups (version 2), and the address space;
   INFINITY if all three are unknown. *source receives the name of the least
   limit (static text). */
double memory_free(const char **source);
