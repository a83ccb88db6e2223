/* SPDX-License-Identifier: BSD-3-Clause */
/* No place in the file system and no network, by the kernel's Landlock, of
   which the C library has no functions. */
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "simulator/sandbox.h"

/* As in linux/landlock.h, which may be older than the kernel. */
struct ruleset {
  uint64_t files, network, scoped;
};

enum { ALL_NETWORK = 3, ALL_SCOPED = 3 };

/* How much of that each version of the interface has, from 1 on. */
static const struct {
  unsigned bits; /* of rights on files */
  size_t size;
} versions[] = {{13, 8}, {14, 8}, {15, 8}, {15, 16}, {16, 16}, {16, 24}};

#ifdef SYS_landlock_create_ruleset
const char *landlock_enter(void) {
  enum { ASK_VERSION = 1, COUNT = sizeof versions / sizeof *versions };
  long version = syscall(SYS_landlock_create_ruleset, NULL, 0, ASK_VERSION);
  if (version < 1) return NULL; /* this kernel has none */
  if (version > COUNT) version = COUNT;
  struct ruleset all = {(UINT64_C(1) << versions[version - 1].bits) - 1,
                        ALL_NETWORK, ALL_SCOPED};
  long set =
      syscall(SYS_landlock_create_ruleset, &all, versions[version - 1].size, 0);
  if (set < 0) return "Landlock's rules";
  long bad = syscall(SYS_landlock_restrict_self, set, 0);
  close((int)set);
  return bad ? "Landlock" : NULL;
}
#else
const char *landlock_enter(void) { return NULL; }
#endif
