/* SPDX-License-Identifier: BSD-3-Clause */
/* Sandbox of the helper program, entered before it reads a deck. */
#pragma once

/* The address sanitizer maps terabytes, so memory is not limited with it. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1 /* macro of gcc */
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
enum { SANDBOX_ANY_MEMORY = 1 };
#else
enum { SANDBOX_ANY_MEMORY = 0 };
#endif

/* Enter the sandbox: from here on the process cannot open, start, send or
   signal anything. It may use its memory, and read and write open files. Other
   attempts fail, or end the process with SIGSYS. Return NULL, or the name of
   the restriction that failed.

   `file` is an open file, or -1. The process may open this file again for
   reading, by any of its names, map it as code, and query the existence of
   other files, but not their contents. This requires Landlock. */
const char *sandbox_enter(int file);

/* Enter the Landlock part of the sandbox; without Landlock nothing happens,
   unless there is a file. Requires that privileges were dropped. */
const char *landlock_enter(int file);
