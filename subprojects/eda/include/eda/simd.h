/* SPDX-License-Identifier: BSD-3-Clause */
/* EDA_WIDE before a function with a simple inner loop: it is compiled for the
   wide vectors of newer processors as well (x86-64-v4: AVX-512; x86-64-v3: AVX2
   and FMA), and the best one is taken at run time. Not under sanitizers, which
   are not ready when that choice is made.

   Both multiply and add at once wherever they can, everything else never does,
   so that they give the same bits; older processors have no such instruction
   and give others. */
#ifndef EDA_SIMD_H
#define EDA_SIMD_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EDA_WIDE                                                               \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), \
                 optimize("fp-contract=fast")))
#else
#define EDA_WIDE
#endif

#endif
