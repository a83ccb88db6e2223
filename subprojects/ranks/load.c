/* SPDX-License-Identifier: BSD-3-Clause */
/* Detects runs of several processes; loads the shared object linked to MPI. */
#include <dlfcn.h>
#include <ranks/ranks.h>
#include <string.h>

static gboolean read_number(const char *name, int *value) {
  guint64 number;
  const char *text = g_getenv(name);
  if (!text ||
      !g_ascii_string_to_unsigned(text, 10, 0, G_MAXINT, &number, NULL))
    return FALSE;
  *value = (int)number;
  return TRUE;
}

/* Read the variables of Open MPI, and of Slurm's srun with PMIx or PMI. */
gboolean ranks_launched(int *rank, int *size) {
  static const char *const names[][2] = {
      {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
      {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"},
      {"PMI_RANK", "PMI_SIZE"}};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    if (read_number(names[i][0], rank) && read_number(names[i][1], size))
      return *size > 1;
  return FALSE;
}

const ranks_group *ranks_load(const char *path, int (*stopped)(void),
                              opc_error *error) {
  void *object = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
  void *symbol = object ? dlsym(object, RANKS_ENTRY) : NULL;
  ranks_entry join;
  memcpy(&join, &symbol, sizeof join);
  const ranks_group *group = symbol ? join(stopped) : NULL;
  if (!group)
    opc_fail(error, OPC_NO_PLUGIN, NULL,
             "started as one of several processes, but %s",
             !path     ? "this build is without MPI"
             : !symbol ? dlerror()
                       : "MPI does not start with two threads");
  return group;
}
