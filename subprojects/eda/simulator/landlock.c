/* SPDX-License-Identifier: BSD-3-Clause */
/* Restriction of the process to one readable file and no network by Landlock, a
   feature of the Linux kernel. The C library has no functions for Landlock. */
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "simulator/sandbox.h"

/* As landlock_ruleset_attr in linux/landlock.h, which may be older than the
   kernel. */
struct ruleset {
  uint64_t files, network, scoped;
};

/* As landlock_path_beneath_attr in linux/landlock.h. */
struct beneath {
  uint64_t allowed;
  int32_t file;
} __attribute__((packed));

enum { ALL_NETWORK = 3, ALL_SCOPED = 3, BENEATH = 1, READ_FILE = 1 << 2 };

/* Known file rights and size of `ruleset` in each version of Landlock, from
   1. */
static const struct {
  unsigned bits; /* number of file rights */
  size_t size;
} versions[] = {{13, 8}, {14, 8}, {15, 8}, {15, 16}, {16, 16}, {16, 24}};

#ifdef SYS_landlock_create_ruleset
const char *landlock_enter(int file) {
  enum { ASK_VERSION = 1, COUNT = sizeof versions / sizeof *versions };
  long version = syscall(SYS_landlock_create_ruleset, NULL, 0, ASK_VERSION);
  if (version < 1) /* the kernel has no Landlock */
    return file < 0 ? NULL : "Landlock, without which no OSDI file is loaded";
  if (version > COUNT) version = COUNT;
  struct ruleset all = {(UINT64_C(1) << versions[version - 1].bits) - 1,
                        ALL_NETWORK, ALL_SCOPED};
  long set =
      syscall(SYS_landlock_create_ruleset, &all, versions[version - 1].size, 0);
  if (set < 0) return "Landlock's rules";
  const struct beneath one = {READ_FILE, file};
  if (file >= 0 && syscall(SYS_landlock_add_rule, set, BENEATH, &one, 0))
    return "Landlock's rule of a file";
  long bad = syscall(SYS_landlock_restrict_self, set, 0);
  close((int)set);
  return bad ? "Landlock" : NULL;
}
#else
const char *landlock_enter(int file) {
  return file < 0 ? NULL : "Landlock, without which no OSDI file is loaded";
}
#endif
