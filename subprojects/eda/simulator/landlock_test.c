/* SPDX-License-Identifier: BSD-3-Clause */
/* Landlock without the other restrictions: only the permitted file can be read,
   and no file can be changed or created. */
#include "simulator/landlock.c"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>

static long kernel_version(void) {
  return syscall(SYS_landlock_create_ruleset, NULL, 0, 1);
}

static int is_denied(int got) { return got < 0 && errno == EACCES; }

/* Return the number of the failed restriction as an exit code. */
static int try_all(const char *old, const char *new, int named) {
  const struct sockaddr_in to = {.sin_family = AF_INET,
                                 .sin_port = htons(9),
                                 .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || landlock_enter(named)) return 1;
  if (!is_denied(open(old, O_RDONLY)) != (named >= 0)) return 2;
  if (named >= 0 && !is_denied(open("/etc/passwd", O_RDONLY))) return 12;
  if (!is_denied(open(old, O_WRONLY | O_APPEND))) return 3;
  if (!is_denied(open(new, O_WRONLY | O_CREAT, 0600))) return 4;
  if (!is_denied(mkdir(new, 0700))) return 5;
  if (!is_denied(unlink(old))) return 6;
  if (!is_denied(symlink("/", new))) return 7;
  if (kernel_version() >= 3 && !is_denied(truncate(old, 0))) return 8;
  int s = socket(AF_INET, SOCK_STREAM, 0);
  if (kernel_version() >= 4 && s >= 0 &&
      !is_denied(connect(s, (const struct sockaddr *)&to, sizeof to)))
    return 9;
  if (kernel_version() >= 6 && !(kill(getppid(), 0) < 0 && errno == EPERM))
    return 10;
  if (!is_denied(execl("/bin/true", "true", (char *)NULL))) return 11;
  return 0;
}

static void test_alone(void) {
  if (kernel_version() < 1) {
    g_test_skip("this kernel has no Landlock");
    return;
  }
  g_autofree char *folder = g_dir_make_tmp("landlock-XXXXXX", NULL);
  g_autofree char *old = g_build_filename(folder, "old", NULL);
  g_autofree char *new = g_build_filename(folder, "new", NULL);
  g_assert_true(g_file_set_contents(old, "unchanged", -1, NULL));
  for (int with = 0; with < 2; with++) {
    int file = with ? open(old, O_RDONLY) : -1;
    pid_t child = fork();
    if (!child) _exit(try_all(old, new, file));
    int status;
    g_assert_cmpint(waitpid(child, &status, 0), ==, child);
    g_assert_true(WIFEXITED(status));
    g_assert_cmpint(WEXITSTATUS(status), ==, 0);
    if (with) close(file);
  }
  g_assert_cmpint(g_remove(old), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/landlock/alone", test_alone);
  return g_test_run();
}
