/* SPDX-License-Identifier: BSD-3-Clause */
/* The dynamic symbols of a shared object, read from its file: looking at it
   must not run it. */
#include <elf.h>
#include <link.h>
#include <string.h>

#include "core/plugin/lint.h"

typedef struct image {
  const char *bytes;
  size_t size;
} image;

/* `n` objects of `size` bytes at `offset`, NULL if they are not all there. */
static const void *at(const image *file, size_t offset, size_t n, size_t size) {
  if (offset > file->size || (n && (file->size - offset) / n < size) ||
      offset % sizeof(uint32_t))
    return NULL;
  return file->bytes + offset;
}

static gint compare(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The names of the defined, visible symbols of a table. */
static void add_names(const image *file, const ElfW(Shdr) * table,
                      const ElfW(Shdr) * strings, GPtrArray *names) {
  size_t n = table->sh_size / sizeof(ElfW(Sym));
  const char *symbols = at(file, table->sh_offset, n, sizeof(ElfW(Sym)));
  if (!symbols || strings->sh_offset > file->size ||
      strings->sh_size > file->size - strings->sh_offset)
    return;
  for (size_t i = 0; i < n; i++) {
    ElfW(Sym) s;
    memcpy(&s, symbols + i * sizeof s, sizeof s);
    int binding = ELF64_ST_BIND(s.st_info);
    if (s.st_shndx == SHN_UNDEF || s.st_name >= strings->sh_size ||
        (binding != STB_GLOBAL && binding != STB_WEAK) ||
        ELF64_ST_VISIBILITY(s.st_other) != STV_DEFAULT)
      continue;
    const char *name = file->bytes + strings->sh_offset + s.st_name;
    size_t length = strnlen(name, strings->sh_size - s.st_name);
    g_ptr_array_add(names, g_strndup(name, length));
  }
}

static GPtrArray *read_names(const image *file) {
  const ElfW(Ehdr) *head = at(file, 0, 1, sizeof *head);
  if (!head || memcmp(head->e_ident, ELFMAG, SELFMAG) ||
      head->e_ident[EI_CLASS] !=
          (sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32))
    return NULL;
  const ElfW(Shdr) *sections =
      at(file, head->e_shoff, head->e_shnum, sizeof *sections);
  if (!sections || head->e_shentsize != sizeof *sections) return NULL;
  GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < head->e_shnum; i++)
    if (sections[i].sh_type == SHT_DYNSYM &&
        sections[i].sh_link < head->e_shnum)
      add_names(file, &sections[i], &sections[sections[i].sh_link], names);
  g_ptr_array_sort(names, compare);
  return names;
}

GPtrArray *opc_exports(const char *path, char **reason) {
  g_autoptr(GError) error = NULL;
  g_autoptr(GMappedFile) map = g_mapped_file_new(path, FALSE, &error);
  *reason = NULL;
  if (!map) {
    *reason = g_strdup(error->message);
    return NULL;
  }
  const image file = {g_mapped_file_get_contents(map),
                      g_mapped_file_get_length(map)};
  GPtrArray *names = read_names(&file);
  if (!names) *reason = g_strdup("it is no shared object of this machine");
  return names;
}
