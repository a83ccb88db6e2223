/* SPDX-License-Identifier: BSD-3-Clause */
/* EDA_WIDE before a function with a simple inner loop compiles it for the wide
   vectors of newer processors as well (x86-64-v4: AVX-512; x86-64-v3: AVX2 and
   FMA); the best version is selected at run time. Not used under sanitizers,
   which are not ready when the selection runs.

   Both versions fuse multiplication and addition wherever possible and nothing
   else does, so that they return the same bits. Older processors have no fused
   instruction and return other bits. */
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EDA_WIDE                                                               \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), \
                 optimize("fp-contract=fast")))
#else
#define EDA_WIDE
#endif
