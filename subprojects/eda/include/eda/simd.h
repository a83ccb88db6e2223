/* SPDX-License-Identifier: BSD-3-Clause */
/* EDA_WIDE before a function compiles further versions of the function for
   x86-64-v3 (AVX2 and FMA) and x86-64-v4 (AVX-512). The program selects the
   best version at start. EDA_WIDE is empty for compilers other than GCC and for
   other processors. It is also empty with a sanitizer, because the selection
   runs before the sanitizer is initialised.

   Both versions, and no other code, contract multiplications and additions to
   FMA wherever possible, so that both versions return the same bits. The
   default version, for processors without FMA, returns other bits. */
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EDA_WIDE                                                               \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), \
                 optimize("fp-contract=fast")))
#else
#define EDA_WIDE
#endif
