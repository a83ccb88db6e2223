/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzers: one program per parser. Each program defines LLVMFuzzerTestOneInput,
   and is linked with libFuzzer (meson -Dfuzz=true, clang) or with replay.c. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Pass the bytes to the parser; return 0. The parser must report any text that
   is not valid as an error. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Return the path of a file in memory with this content. Each of the two
   functions has one file, whose path is the same in each call. */
const char *fuzz_file(const uint8_t *data, size_t size);
const char *fuzz_second_file(const uint8_t *data, size_t size);
