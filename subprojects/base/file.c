/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of files, folders and names. Most checks do not open the file. */
#include <base/file.h>
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

const char *opc_file_fault(const char *path, size_t *size) {
  struct stat about;
  if (stat(path, &about))
    return errno == ENOENT ? "no such file" : g_strerror(errno);
  if (size) *size = (size_t)about.st_size;
  switch (about.st_mode & S_IFMT) {
    case S_IFREG:
      return NULL;
    case S_IFDIR:
      return "is a folder, not a regular file";
    case S_IFIFO:
      return "is a pipe, not a regular file";
    case S_IFSOCK:
      return "is a socket, not a regular file";
    default:
      return "is a device, not a regular file";
  }
}

gboolean opc_name_is_inside(const char *name) {
  if (!*name || *name == '/') return FALSE;
  g_auto(GStrv) parts = g_strsplit(name, "/", -1);
  for (guint i = 0; parts[i]; i++)
    if (!*parts[i] || !strcmp(parts[i], ".") || !strcmp(parts[i], ".."))
      return FALSE;
  return TRUE;
}

static gint compare_names(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

GPtrArray *opc_folder_names(const char *folder) {
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  if (!dir) return NULL;
  GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
  for (const char *name; (name = g_dir_read_name(dir));)
    g_ptr_array_add(names, g_strdup(name));
  g_ptr_array_sort(names, compare_names);
  return names;
}

/* ---- names ---- */

static const char name_letters[] =
    G_CSET_a_2_z G_CSET_A_2_Z G_CSET_DIGITS "_-.";

gboolean opc_is_name(const char *text, gboolean dots) {
  return *text && !strchr("-.", *text) && !text[strspn(text, name_letters)] &&
         (dots || !strchr(text, '.'));
}

gboolean opc_is_id(const char *name) {
  gboolean start = TRUE; /* TRUE at the start of a word */
  for (const char *c = name; *c; c++) {
    if (*c == '.' ? start
                  : !(g_ascii_islower(*c) ||
                      (!start && (g_ascii_isdigit(*c) || *c == '_'))))
      return FALSE;
    start = *c == '.';
  }
  return !start;
}

/* ---- folders of the executable ---- */

char *opc_executable_folder(void) {
  g_autofree char *executable = g_file_read_link("/proc/self/exe", NULL);
  return executable ? g_path_get_dirname(executable) : NULL;
}

char *opc_installed(const char *const *places, const char *in,
                    const char *name) {
  g_autofree char *folder = opc_executable_folder();
  if (folder && g_path_is_absolute(in))
    return g_build_filename(in, "opcflow", name, NULL);
  for (; folder && *places; places++) {
    if (!g_str_has_suffix(folder, *places)) continue;
    folder[strlen(folder) - strlen(*places)] = 0;
    return g_build_filename(*folder ? folder : "/", in, "opcflow", name, NULL);
  }
  return NULL;
}
