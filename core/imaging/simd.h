/* SPDX-License-Identifier: BSD-3-Clause */
/* OPC_WIDE before a function with a simple inner loop: it is compiled for the
   wide vectors of newer processors as well, and the best one taken at run
   time. Not under sanitizers, which are not ready when that choice is made. */
#ifndef OPCFLOW_CORE_SIMD_H
#define OPCFLOW_CORE_SIMD_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OPC_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define OPC_WIDE
#endif

#endif
