/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the available memory of machine, control groups and address space.
   Sources: proc(5), getrlimit(2), and cgroup-v2 in the documentation of
   Linux. */
#include <glib.h>
#include <guard/memory.h>
#include <malloc.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>

/* Return the number after `name` in a file with lines "NAME: 12 kB" or "NAME
   12"; for "", the first number of the file. NAN if missing or "max". */
static double number_in(const char *path, const char *name) {
  g_autofree char *text = NULL;
  if (!g_file_get_contents(path, &text, NULL, NULL)) return NAN;
  size_t length = strlen(name);
  for (const char *line = text; line; line = strchr(line, '\n')) {
    line += *line == '\n';
    if (strncmp(line, name, length)) continue;
    char *end;
    double value = g_ascii_strtod(line + length, &end);
    if (end == line + length) return NAN;
    return g_str_has_prefix(end, " kB") ? value * 1024 : value;
  }
  return NAN;
}

static double machine_free(void) {
  double swap = number_in("/proc/meminfo", "SwapFree:");
  return number_in("/proc/meminfo", "MemAvailable:") + fmax(swap, 0);
}

/* Return the limit of the control group in `folder` minus its used memory,
   bytes; inactive cached files do not count as used. */
static double group_free(const char *folder) {
  g_autofree char *most = g_build_filename(folder, "memory.max", NULL);
  g_autofree char *now = g_build_filename(folder, "memory.current", NULL);
  g_autofree char *kinds = g_build_filename(folder, "memory.stat", NULL);
  return number_in(most, "") - number_in(now, "") +
         fmax(number_in(kinds, "inactive_file "), 0);
}

/* Return the least value of this process's group and its parent groups. */
static double groups_free(void) {
  g_autofree char *text = NULL;
  double least = NAN;
  if (!g_file_get_contents("/proc/self/cgroup", &text, NULL, NULL)) return NAN;
  char *path = strstr(text, "0::/");
  if (!path) return NAN;
  path += strlen("0::");
  path[strcspn(path, "\n")] = 0;
  for (;;) {
    g_autofree char *folder = g_strconcat("/sys/fs/cgroup", path, NULL);
    least = fmin(least, group_free(folder));
    char *slash = strrchr(path, '/');
    if (!slash || !path[1]) return least;
    slash[slash == path] = 0;
  }
}

static double address_space_free(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_AS, &limit) || limit.rlim_cur == RLIM_INFINITY)
    return NAN;
  return (double)limit.rlim_cur - number_in("/proc/self/status", "VmSize:");
}

double memory_free(const char **source) {
  const struct {
    double bytes;
    const char *source;
  } all[] = {{machine_free(), "the machine"},
             {groups_free(), "the control group (cgroup)"},
             {address_space_free(), "the limit on address space (ulimit -v)"}};
  double least = INFINITY;
  *source = all[0].source;
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    if (!(all[i].bytes < least)) continue;
    least = all[i].bytes;
    *source = all[i].source;
  }
  /* Add freed memory that malloc keeps: the kernel counts this memory as
     used. */
  return fmax(least, 0) + (double)mallinfo2().fordblks;
}
