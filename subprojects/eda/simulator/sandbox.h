/* SPDX-License-Identifier: BSD-3-Clause */
/* Sandbox of the helper program, entered before the simulator parses a deck. */
#pragma once

/* The address sanitizer maps terabytes of address space, so memory is not
   limited in builds with the sanitizer. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1 /* macro that gcc defines */
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
enum { SANDBOX_ANY_MEMORY = 1 };
#else
enum { SANDBOX_ANY_MEMORY = 0 };
#endif

/* Enter the sandbox. Afterwards the process cannot open files, start programs,
   use the network or signal other processes. Memory and open files remain
   usable. Forbidden calls fail or end the process with SIGSYS. Return NULL, or
   the name of the restriction that could not be set.

   `file` is the descriptor of an OSDI file, or -1. The process may open this
   file again for reading by any of its names, and map the file as code. The
   process may test whether other files exist, but cannot read them. A file
   requires Landlock. */
const char *sandbox_enter(int file);

/* Set the Landlock restriction. If the kernel has no Landlock, return NULL
   without effect for file -1, otherwise an error. Requires
   PR_SET_NO_NEW_PRIVS. */
const char *landlock_enter(int file);
