/* SPDX-License-Identifier: BSD-3-Clause */
/* EDA_WIDE before a function compiles further versions of the function for
   x86-64-v3 (AVX2 and FMA) and x86-64-v4 (AVX-512). The program selects the
   best version at start. EDA_WIDE is empty under sanitizers, which are not
   initialised when the selection runs.

   Both versions, and no other code, contract multiplications and additions to
   FMA wherever possible, so that they return the same bits. Processors without
   FMA return other bits. */
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EDA_WIDE                                                               \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), \
                 optimize("fp-contract=fast")))
#else
#define EDA_WIDE
#endif
