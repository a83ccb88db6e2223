/* SPDX-License-Identifier: BSD-3-Clause */
/* The performance of all gates of a print, and the arrays that hold it. */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <string.h>

enum { BLOCK = 64, FIGURES = 6 };

int opc_performance_make(const opc_host *host, size_t n, opc_performance *p) {
  p->count = n;
  int ok = 1;
  for (int k = 0; k < FIGURES; k++)
    ok &= ((&p->ion)[k] = host->alloc(host, n, sizeof(double))) != NULL;
  return ok;
}

void opc_performance_copy(opc_performance *to, const opc_performance *from) {
  if (!from->count) return;
  for (int k = 0; k < FIGURES; k++)
    memcpy((&to->ion)[k], (&from->ion)[k], from->count * sizeof(double));
}

void opc_performance_clear(const opc_host *host, opc_performance *p) {
  for (int k = 0; k < FIGURES; k++) host->free(host, (&p->ion)[k]);
}

int opc_measurement_make(const opc_host *host, size_t n, opc_measurement *m) {
  m->flags = host->alloc(host, n, sizeof *m->flags);
  m->extension = host->alloc(host, 2 * n, sizeof *m->extension);
  return opc_performance_make(host, n, &m->performance) && m->flags &&
         m->extension;
}

void opc_measurement_clear(const opc_host *host, opc_measurement *m) {
  opc_performance_clear(host, &m->performance);
  host->free(host, m->flags);
  host->free(host, m->extension);
}

int opc_extract_prepare(const opc_module *extract, opc_error *error) {
  const opc_extract *model = extract->plugin->operations;
  const char *before = opc_call(extract, error);
  int code = model->prepare(extract->self, error);
  opc_leave(before);
  return opc_blame(error, code, "extract");
}

/* ---- all gates ---- */

typedef struct job {
  const opc_host *host;
  const opc_gates *gates;
  const opc_field *print;
  const opc_module *extract;
  opc_measurement *out;
  opc_error *failures;   /* of each block */
} job;

static void measure_block(void *data, size_t block) {
  job *j = data;
  size_t first = block * BLOCK, last = first + BLOCK;
  if (last > j->gates->count) last = j->gates->count;
  opc_measure(j->host, j->gates, j->print, j->extract, first, last, j->out,
              &j->failures[block]);
}

int opc_measure_all(const opc_host *host, const opc_gates *gates,
                    const opc_field print[OPC_MASKS],
                    const opc_module *extract, opc_measurement *out,
                    opc_error *error) {
  size_t blocks = (gates->count + BLOCK - 1) / BLOCK;
  job j = {host, gates, print, extract, out,
           host->alloc(host, blocks, sizeof *j.failures)};
  if (!j.failures)
    return opc_fail(error, OPC_FAILED, NULL, "out of memory");
  host->parallel(host, blocks, measure_block, &j);
  int code = OPC_OK;
  for (size_t b = 0; b < blocks && !code; b++)
    if ((code = j.failures[b].code)) *error = j.failures[b];
  host->free(host, j.failures);
  return code;
}

/* ---- masks ---- */

void opc_mask_release(void *object) {
  opc_mask *m = object;
  opc_host *host = opc_host_new(NULL);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    host->geometry->release(&m->shapes[layer]);
    host->imaging->release_field(host, &m->print[layer]);
  }
  opc_performance_clear(host, &m->design);
  opc_performance_clear(host, &m->before);
  opc_performance_clear(host, &m->after);
  host->free(host, m->flags);
  host->free(host, m);
  opc_host_free(host);
}
