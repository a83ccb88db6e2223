/* SPDX-License-Identifier: BSD-3-Clause */
/* How much memory is left for this process. */
#ifndef OPCFLOW_CORE_MEMORY_H
#define OPCFLOW_CORE_MEMORY_H

/* Bytes, and in *source (static) who grants no more: the machine (its swap
   counts), a control group, a limit on the address space. INFINITY where
   nothing can be found out. */
double opc_memory_free(const char **source);

#endif
