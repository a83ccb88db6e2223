/* SPDX-License-Identifier: BSD-3-Clause */
/* Divides simulations into jobs, one process each. */
#include <stdlib.h>
#include <string.h>

#include "bench.h"

/* ---- decks ---- */

/* Charges are of the order of fF times mV. The default charge tolerance of the
   simulator, 1e-14 C, would ignore them. */
void job_begin(const bench_task *j, FILE *out, double reltol, double abstol) {
  const bench *b = j->b;
  fputs("circuit.ngspice\n", out);
  for (int i = 0; i < 2; i++)
    if (b->cards[i]) fprintf(out, ".include \"%s\"\n", b->cards[i]);
  if (b->statements) fputs(b->statements, out);
  fprintf(out,
          ".options temp=%.17g gmin=1e-15 reltol=%g abstol=%g "
          "chgtol=1e-19\n",
          b->temperature, reltol, abstol);
}

void job_circuit(bench_task *j, FILE *out, int sizes) {
  const bench *b = j->b;
  const eda_circuit *c = b->circuit;
  node_name node;
  char *netlist = bench_netlist(b, &b->plain, j->state, sizes, &j->error);
  if (!netlist) {
    j->code = j->error.code;
    return;
  }
  fprintf(out, "%sx1", netlist);
  free(netlist);
  for (size_t i = 0; i < c->ports; i++)
    fprintf(out, "\n+ %s", bench_node(b, c->port[i], node));
  fprintf(out, "\n+ %s\n", c->name);
  for (size_t i = 0; i < b->outputs; i++)
    if (b->load > 0)
      fprintf(out, "cl%zu n%u 0 %.17g\n", i, b->output[i], b->load);
}

void job_sources(const bench_task *j, FILE *out) {
  const bench *b = j->b;
  const eda_circuit *c = b->circuit;
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_SUPPLY)
      fprintf(out, "vs%zu n%u 0 dc %.17g\n", i, c->port[i], b->supply);
  for (size_t i = 0; i < b->inputs; i++)
    fprintf(out, "vi%zu n%u 0 dc 0\n", i, b->input[i]);
}

/* ---- one job ---- */

char *job_text(bench_task *j,
               void (*write)(bench_task *j, FILE *out, const void *how),
               const void *how) {
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  write(j, out, how);
  fclose(out);
  if (!j->code) return text;
  free(text);
  return NULL;
}

void job_simulate(bench_task *j, const char *deck, const char *commands,
                  eda_spice_result *out) {
  *out = (eda_spice_result){0};
  if (!j->code)
    j->code = eda_spice_run(j->b->host->context, deck, commands, j->b->limit,
                            out, &j->error);
  if (j->code && strstr(j->error.message, "' did not finish within ")) {
    g_autofree char *why = g_strdup(j->error.message);
    opc_fail(&j->error, j->code, "time_limit",
             "%.400s; tiny steps mean that the models do not converge there, "
             "otherwise raise 'time_limit'",
             why);
  }
}

/* ---- all jobs ---- */

typedef struct jobs {
  void (*work)(bench_task *j);
  bench_task *job;
} jobs;

static void work_on(void *data, size_t index) {
  const jobs *all = data;
  all->work(&all->job[index]);
}

int jobs_run_at(bench *b, int state, size_t count, size_t some,
                void (*work)(bench_task *j), const void *of, opc_error *error) {
  size_t n = (count + some - 1) / some;
  jobs all = {work, g_new0(bench_task, n)};
  int code = OPC_OK;
  for (size_t i = 0; i < n; i++)
    all.job[i] = (bench_task){.b = b,
                              .of = of,
                              .state = state,
                              .from = i * some,
                              .to = i + 1 < n ? (i + 1) * some : count};
  opc_parallel(b->host->context, n, work_on, &all);
  for (size_t i = 0; i < n && !code; i++) {
    code = all.job[i].code;
    if (code) *error = all.job[i].error;
  }
  g_free(all.job);
  return code;
}

int jobs_run(bench *b, size_t count, size_t some, void (*work)(bench_task *j),
             const void *of, opc_error *error) {
  for (int state = 0; state < EDA_STATES; state++) {
    if (!b->has[state]) continue;
    int code = jobs_run_at(b, state, count, some, work, of, error);
    if (code && bench_forgive(b, state, code, error)) return code;
  }
  return OPC_OK;
}
