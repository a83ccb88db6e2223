/* SPDX-License-Identifier: BSD-3-Clause */
/* What the helper program gives up before it looks at a deck. */
#pragma once

/* The address sanitizer maps terabytes, so that memory has no limit with it. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1 /* as gcc has it */
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
enum { SANDBOX_ANY_MEMORY = 1 };
#else
enum { SANDBOX_ANY_MEMORY = 0 };
#endif

/* From here on this process opens, starts, sends and signals nothing; it works
   in its memory, and reads and writes what is open. What it tries of that
   fails, or ends it with SIGSYS. NULL, or what could not be shut.

   `file`, an open file, or -1: it may be opened again to be read, by any of its
   names, and mapped as code; and what is there of other files may be asked,
   not what is in them. This takes Landlock. */
const char *sandbox_enter(int file);

/* The part of that which Landlock does; nothing where the kernel has none,
   unless there is a file. It takes that privileges have been given up. */
const char *landlock_enter(int file);
