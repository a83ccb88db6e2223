/* SPDX-License-Identifier: BSD-3-Clause */
/* How much memory is left for this process. */
#pragma once

/* Return the number of bytes, and in *source (static) the one that grants no
   more: the machine (its swap counts), a control group, or a limit on the
   address space. INFINITY where none of them is known. */
double memory_free(const char **source);
