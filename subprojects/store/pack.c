/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs files into values, and writes packed files. */
#include <errno.h>
#include <glib/gstdio.h>
#include <store/files.h>
#include <store/pack.h>

gboolean opc_files_add(GVariantBuilder *all, const char *path,
                       const char *name) {
  struct stat about;
  char *text;
  gsize n;
  if (lstat(path, &about)) return errno == ENOENT;
  if (!S_ISREG(about.st_mode) || !g_file_get_contents(path, &text, &n, NULL))
    return FALSE;
  g_variant_builder_add(all, "(^ay@ay)", name,
                        g_variant_new_from_data(G_VARIANT_TYPE_BYTESTRING, text,
                                                n, TRUE, g_free, text));
  return TRUE;
}

typedef struct packer {
  GVariantBuilder files;
  guint64 bytes;
} packer;

static int pack_size(void *data, const char *path, const char *name,
                     const struct stat *about, opc_error *error) {
  (void)path, (void)name, (void)error;
  ((packer *)data)->bytes += (guint64)about->st_size;
  return OPC_OK;
}

static int pack_entry(void *data, const char *path, const char *name,
                      const struct stat *about, opc_error *error) {
  if (S_ISDIR(about->st_mode)) return OPC_OK;
  return opc_files_add(&((packer *)data)->files, path, name)
             ? OPC_OK
             : opc_fail(error, OPC_IO, NULL, "'%s'", path);
}

GVariant *opc_files_pack(const char *folder, guint64 most) {
  packer p = {.bytes = 0};
  opc_error none;
  if (opc_traverse(folder, pack_size, &p, &none) || p.bytes > most) return NULL;
  g_variant_builder_init(&p.files, OPC_FILES_TYPE);
  int code = opc_traverse(folder, pack_entry, &p, &none);
  GVariant *all = g_variant_builder_end(&p.files);
  if (!code) return all;
  g_variant_unref(g_variant_ref_sink(all));
  return NULL;
}

/* The file is a copy: later changes of the file do not affect the store. */
int opc_file_unpack(const char *path, GVariant *bytes, opc_error *error) {
  gsize n;
  const char *text = g_variant_get_fixed_array(bytes, &n, 1);
  g_autoptr(GError) fault = NULL;
  if (g_file_set_contents(path, n ? text : "", (gssize)n, &fault))
    return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "%s", fault->message);
}

int opc_files_unpack(GVariant *files, const char *folder, opc_error *error) {
  GVariantIter all;
  const char *name;
  GVariant *bytes;
  int code = OPC_OK;
  g_variant_iter_init(&all, files);
  while (!code && g_variant_iter_next(&all, "(^&ay@ay)", &name, &bytes)) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    g_autofree char *parent = g_path_get_dirname(path);
    (void)g_mkdir_with_parents(parent, 0777);
    code = opc_file_unpack(path, bytes, error);
    g_variant_unref(bytes);
  }
  return code;
}
