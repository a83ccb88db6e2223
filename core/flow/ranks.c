/* SPDX-License-Identifier: BSD-3-Clause */
/* Meeting the other processes of a run; what carries it is loaded only where
   there are others. */
#include "core/flow/ranks.h"

#include <dlfcn.h>
#include <string.h>

#include "core/flow/mpi.h"
#include "core/plugin/registry.h"

struct opc_ranks {
  const opc_mpi *mpi;
  gboolean stopped; /* no more meeting */
};

/* ---- start and end ---- */

static gboolean read_number(const char *name, int *value) {
  guint64 number;
  const char *text = g_getenv(name);
  if (!text ||
      !g_ascii_string_to_unsigned(text, 10, 0, G_MAXINT, &number, NULL))
    return FALSE;
  *value = (int)number;
  return TRUE;
}

/* By mpirun of Open MPI, and by Slurm's srun with PMIx or PMI. */
gboolean opc_ranks_told(int *rank, int *size) {
  static const char *const names[][2] = {
      {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
      {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"},
      {"PMI_RANK", "PMI_SIZE"}};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    if (read_number(names[i][0], rank) && read_number(names[i][1], size))
      return *size > 1;
  return FALSE;
}

opc_ranks *opc_ranks_start(int (*stopped)(void), opc_error *error) {
  g_autofree char *path = opc_find_installed(OPC_LIBDIR, OPC_MPI_OBJECT);
  void *object = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
  opc_mpi_entry entry =
      object ? (opc_mpi_entry)dlsym(object, OPC_MPI_ENTRY) : NULL;
  const opc_mpi *mpi = entry ? entry(stopped) : NULL;
  if (!mpi) {
    opc_fail(error, OPC_NO_PLUGIN, NULL,
             "started as one of several processes, but %s",
             !path     ? "this build is without MPI"
             : !object ? dlerror()
                       : "MPI does not start with two threads");
    return NULL;
  }
  opc_ranks *ranks = g_new0(opc_ranks, 1);
  ranks->mpi = mpi;
  return ranks;
}

void opc_ranks_end(opc_ranks *ranks) {
  if (ranks && !ranks->stopped) ranks->mpi->end();
  g_free(ranks);
}

int opc_ranks_own(const opc_ranks *ranks) {
  return ranks ? ranks->mpi->rank : 0;
}

/* ---- all together ---- */

static int stop(opc_ranks *ranks, opc_error *error) {
  ranks->stopped = TRUE;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}

int opc_ranks_least(opc_ranks *ranks, gint64 *values, gsize n,
                    opc_error *error) {
  if (ranks->stopped || ranks->mpi->least(values, n)) return stop(ranks, error);
  return OPC_OK;
}

int opc_ranks_spread(opc_ranks *ranks, void *bytes, gsize n, int from,
                     opc_error *error) {
  if (ranks->stopped || ranks->mpi->spread(bytes, n, from))
    return stop(ranks, error);
  return OPC_OK;
}

gint64 opc_ranks_turn(opc_ranks *ranks, gint64 by) {
  return ranks->stopped ? -1 : ranks->mpi->turn(by);
}

void opc_ranks_restart(opc_ranks *ranks) { ranks->mpi->restart(); }

/* ---- agreeing ---- */

/* Whether this rank is where the first one is: else *error. */
static int compare(opc_ranks *ranks, const char *what, opc_error *error) {
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, what, -1);
  g_autofree char *first = g_strdup(sum);
  opc_error stopped;
  if (opc_ranks_spread(ranks, first, strlen(first), 0, &stopped))
    return OPC_CANCELLED;
  return strcmp(first, sum)
             ? opc_fail(error, OPC_FAILED, NULL,
                        "does not do the same as rank 0: its flow, files, "
                        "builds or processor are others")
             : OPC_OK;
}

/* Who has it, before it is spread. */
static void sign(const opc_ranks *ranks, opc_error *error) {
  const opc_error own = *error;
  if (ranks->mpi->rank)
    opc_fail(error, own.code, own.parameter, "rank %d on %s: %s",
             ranks->mpi->rank, g_get_host_name(), own.message);
}

int opc_ranks_meet(opc_ranks *ranks, const char *what, int code,
                   opc_error *error) {
  if (!ranks) return code;
  opc_error own = {0};
  int differs = compare(ranks, what, &own);
  if (code) own = *error;
  own.code = code ? code : differs;
  gint64 lowest = own.code ? ranks->mpi->rank : G_MAXINT64;
  int stopped = opc_ranks_least(ranks, &lowest, 1, error);
  if (stopped || lowest == G_MAXINT64) return stopped;
  if (lowest == ranks->mpi->rank) sign(ranks, &own);
  if (opc_ranks_spread(ranks, &own, sizeof own, (int)lowest, error))
    return OPC_CANCELLED;
  *error = own;
  return own.code;
}

gboolean opc_ranks_agree(opc_ranks *ranks, const char *what,
                         opc_problems *problems) {
  if (!ranks) return !problems->list->len;
  opc_error error = {0};
  int code =
      problems->list->len ? opc_problems_error(problems, &error) : OPC_OK;
  if (code == OPC_CANCELLED) ranks->stopped = TRUE;
  code = opc_ranks_meet(ranks, what, code, &error);
  if (code && !problems->list->len)
    opc_problem_add(problems, code, NULL, "%s", error.message);
  return !problems->list->len;
}
