/* SPDX-License-Identifier: BSD-3-Clause */
/* Three restrictions: allowed system calls (seccomp, required), no file access
   (Landlock, if the kernel supports Landlock), and resource limits. Each
   restriction alone prevents file access. */
#include "simulator/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <seccomp.h>
#include <stddef.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- limits ---- */

/* Largest memory of the process, bytes: twice the largest accepted size of the
   results (2 GB). The netlist and the matrix of a circuit need far less. */
static const rlim_t most_memory = (rlim_t)4 << 30;

static const char *set_limits(int file) {
  const struct rlimit none = {0, 0}, memory = {most_memory, most_memory};
  /* Descriptors up to file + 1, so that the file can be opened again. */
  const rlim_t most_files = file < 0 ? 0 : (rlim_t)file + 2;
  const struct rlimit files = {most_files, most_files};
  int bad = setrlimit(RLIMIT_FSIZE, &none) | setrlimit(RLIMIT_NPROC, &none) |
            setrlimit(RLIMIT_NOFILE, &files);
  if (!SANDBOX_ANY_MEMORY) bad |= setrlimit(RLIMIT_AS, &memory);
  return bad ? "setrlimit" : NULL;
}

/* ---- system calls ---- */

/* Calls for memory, time, open files, and signals of the process itself. */
static const int allowed[] = {
    SCMP_SYS(read),
    SCMP_SYS(write),
    SCMP_SYS(writev),
    SCMP_SYS(close),
    SCMP_SYS(lseek),
    SCMP_SYS(_llseek),
    SCMP_SYS(fstat),
    SCMP_SYS(fstat64),
    SCMP_SYS(brk),
    SCMP_SYS(munmap),
    SCMP_SYS(mremap),
    SCMP_SYS(madvise),
    SCMP_SYS(futex),
    SCMP_SYS(futex_time64),
    SCMP_SYS(clock_gettime),
    SCMP_SYS(clock_gettime64),
    SCMP_SYS(gettimeofday),
    SCMP_SYS(time),
    SCMP_SYS(times),
    SCMP_SYS(getrusage),
    SCMP_SYS(getpid),
    SCMP_SYS(gettid),
    SCMP_SYS(getuid),
    SCMP_SYS(geteuid),
    SCMP_SYS(getrandom),
    SCMP_SYS(sysinfo),
    SCMP_SYS(uname),
    SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),
    SCMP_SYS(sigreturn),
    SCMP_SYS(sigaltstack),
    SCMP_SYS(restart_syscall),
    SCMP_SYS(exit),
    SCMP_SYS(exit_group),
};

/* Calls that no simulation needs: such a call ends the process with SIGSYS, so
   that no values of the simulation are used. Other calls fail with EACCES. */
static const int deadly[] = {
    SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fork),
    SCMP_SYS(vfork),  SCMP_SYS(clone),    SCMP_SYS(ptrace),
    SCMP_SYS(kill),   SCMP_SYS(unlink),   SCMP_SYS(unlinkat),
    SCMP_SYS(rename), SCMP_SYS(renameat), SCMP_SYS(renameat2),
    SCMP_SYS(mkdir),  SCMP_SYS(mkdirat),  SCMP_SYS(creat),
};

/* End the process at an attempt to open a file for writing. Opening for reading
   fails with EACCES, which the simulator reports. */
static int refuse_writing(scmp_filter_ctx f) {
  int bad = 0;
  for (int at = 0; at < 2; at++) {
    int call = at ? SCMP_SYS(openat) : SCMP_SYS(open);
    unsigned flags = at ? 2 : 1;
    for (scmp_datum_t mode = O_WRONLY; mode <= O_RDWR; mode++)
      bad |= seccomp_rule_add(
          f, SCMP_ACT_KILL_PROCESS, call, 1,
          SCMP_CMP(flags, SCMP_CMP_MASKED_EQ, O_ACCMODE, mode));
  }
  return bad;
}

/* Allow the calls of dlopen. Landlock restricts dlopen to one file. Mapped
   pages are executable or writable, never both. */
static int allow_mapping(scmp_filter_ctx f) {
  int bad = 0;
  const int asks[] = {SCMP_SYS(stat), SCMP_SYS(stat64), SCMP_SYS(newfstatat),
                      SCMP_SYS(statx), SCMP_SYS(pread64)};
  for (size_t i = 0; i < sizeof asks / sizeof *asks; i++)
    bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, asks[i], 0);
  const int maps[] = {SCMP_SYS(mmap), SCMP_SYS(mmap2)};
  for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
    bad |= seccomp_rule_add(
        f, SCMP_ACT_ALLOW, maps[i], 2,
        SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC | PROT_WRITE, PROT_EXEC),
        SCMP_A3(SCMP_CMP_MASKED_EQ, MAP_ANONYMOUS, 0));
  const scmp_datum_t reading = O_ACCMODE | O_CREAT | O_TRUNC;
  bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(open), 1,
                          SCMP_A1(SCMP_CMP_MASKED_EQ, reading, O_RDONLY));
  bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(openat), 1,
                          SCMP_A2(SCMP_CMP_MASKED_EQ, reading, O_RDONLY));
  return bad;
}

static int add_rules(scmp_filter_ctx f, int file) {
  int bad = refuse_writing(f);
  if (file >= 0) bad |= allow_mapping(f);
  for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
    bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, allowed[i], 0);
  for (size_t i = 0; i < sizeof deadly / sizeof *deadly; i++)
    bad |= seccomp_rule_add(f, SCMP_ACT_KILL_PROCESS, deadly[i], 0);
  /* With ENOSYS, the C library uses clone, whose arguments seccomp can
     check. */
  bad |= seccomp_rule_add(f, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  /* Memory must not be executable. */
  const int maps[] = {SCMP_SYS(mmap), SCMP_SYS(mmap2), SCMP_SYS(mprotect)};
  for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
    bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, maps[i], 1,
                            SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
  /* fstat as called by the C library (AT_EMPTY_PATH); stat of paths is not
     allowed. */
  bad |= seccomp_rule_add(
      f, SCMP_ACT_ALLOW, SCMP_SYS(newfstatat), 1,
      SCMP_A3(SCMP_CMP_MASKED_EQ, AT_EMPTY_PATH, AT_EMPTY_PATH));
  /* for abort() */
  bad |= seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
                          SCMP_A0(SCMP_CMP_EQ, (scmp_datum_t)getpid(), 0));
  return bad;
}

static const char *shut_calls(int file) {
  scmp_filter_ctx f = seccomp_init(SCMP_ACT_ERRNO(EACCES));
  int bad = !f || add_rules(f, file) || seccomp_load(f);
  seccomp_release(f);
  return bad ? "seccomp" : NULL;
}

const char *sandbox_enter(int file) {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) return "new privileges";
  const char *open = landlock_enter(file);
  if (!open) open = set_limits(file);
  return open ? open : shut_calls(file);
}
