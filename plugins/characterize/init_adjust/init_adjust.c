/* SPDX-License-Identifier: BSD-3-Clause */
/* characterize.init_adjust: the table of mask.dpb's first corrections (thesis
   3.2.2 (2), figure 3.5). An evaluation transistor of each length and width is
   corrected by DPB from each of a range of first corrections; the one that ends
   nearest to the drawn current is chosen. */
#include <math.h>
#include <stdlib.h>

#include <opcflow/step.h>

#include "../../mask/dpb/control.h"
#include "row.h"

/* ---- state ---- */

enum {
  LITHO, RESIST, EXTRACT, LENGTHS, WIDTHS, TYPE, FROM, TO, TIE, MAX_PDE,
  MAX_BIAS, W_STEP, MAX_ITERATIONS, GRID, EXTENSION, ENCLOSURE, MARGIN,
  PARAMETERS
};

typedef struct characterize {
  const opc_host *host;
  const opc_value *values;
} characterize;

/* What became of one transistor. */
typedef struct trial {
  double pde;             /* %, at the end */
  int64_t iterations;     /* moves of its mask */
} trial;

/* One run. Sizes are by length, then width. Of each there are `starts` trials,
   first corrections of first, first + 1 ... grid steps, and one more that
   begins with a step towards the smaller error. */
typedef struct work {
  const opc_value *values;
  row_rules row;
  control_rules rules;
  int32_t first;
  size_t sizes, starts;
  trial *trials;          /* [size * (starts + 1) + start] */
  opc_error *failures;    /* of each size */
} work;

/* ---- work: one size ---- */

static double length_of(const work *k, size_t size) {
  return k->values[LENGTHS].reals[size / k->values[WIDTHS].count];
}

static double width_of(const work *k, size_t size) {
  return k->values[WIDTHS].reals[size % k->values[WIDTHS].count];
}

/* The next step of each transistor of a row. Sets the flags of layers that
   have changed. */
static void step_all(const work *k, row *r, control *state, trial *trials,
                     int64_t iteration, int changed[OPC_MASKS]) {
  changed[OPC_POLY] = changed[OPC_ACTIVE] = 0;
  for (size_t i = 0; i < r->count; i++) {
    control_input in = {.error = 100 * (r->ion[i] - r->design) / r->design,
                        .width = r->width / k->row.grid};
    int32_t start = i < k->starts ? k->first + (int32_t)i : 0;
    int by_l = iteration == 0
                   ? control_first(&k->rules, &state[i], &in, start, &r->l[i])
                   : control_length(&k->rules, &state[i], &in, &r->l[i],
                                    r->w[i]);
    int by_w = iteration > 0 && !by_l &&
               control_width(&k->rules, &state[i], &in, &r->w[i]);
    state[i].error = in.error;
    trials[i].pde = in.error;
    if (by_l || by_w) trials[i].iterations = iteration + 1;
    changed[OPC_POLY] |= by_l;
    changed[OPC_ACTIVE] |= by_w;
  }
}

static int correct_row(const work *k, row *r, control *state, trial *trials,
                       opc_error *error) {
  int64_t most = k->values[MAX_ITERATIONS].integer;
  int changed[OPC_MASKS] = {1, 1};
  for (int64_t iteration = 0;; iteration++) {
    int code = row_print(r, changed, error);
    if (code) return code;
    if (k->row.host->cancelled(k->row.host))
      return k->row.host->fail(k->row.host, error, OPC_CANCELLED, NULL, "stopped");
    step_all(k, r, state, trials, iteration, changed);
    if (iteration >= most || (!changed[OPC_POLY] && !changed[OPC_ACTIVE]))
      return OPC_OK;
  }
}

static void try_size(void *data, size_t size) {
  work *k = data;
  opc_error *error = &k->failures[size];
  size_t n = k->starts + 1;
  row r;
  control *state = calloc(n, sizeof *state);
  int code = row_make(&r, &k->row, length_of(k, size), width_of(k, size), n, error);
  if (!code && !state)
    code = k->row.host->fail(k->row.host, error, OPC_FAILED, NULL, "out of memory");
  if (!code) code = correct_row(k, &r, state, k->trials + size * n, error);
  error->code = code;
  row_clear(&r);
  free(state);
}

/* ---- work: the choice ---- */

/* Nearer to the design, then sooner, then by a smaller correction. */
static int is_better(const work *k, size_t size, size_t a, size_t b) {
  const trial *t = k->trials + size * (k->starts + 1);
  double tie = k->values[TIE].real;
  double pde_a = fmax(fabs(t[a].pde), tie), pde_b = fmax(fabs(t[b].pde), tie);
  if (pde_a != pde_b) return pde_a < pde_b;
  if (t[a].iterations != t[b].iterations) return t[a].iterations < t[b].iterations;
  return abs(k->first + (int32_t)a) < abs(k->first + (int32_t)b);
}

static size_t choose(const work *k, size_t size) {
  size_t best = 0;
  for (size_t s = 1; s < k->starts; s++)
    if (is_better(k, size, s, best)) best = s;
  return best;
}

/* Room for `columns` columns of `rows` numbers. */
static double *make_columns(const work *k, size_t columns, size_t rows,
                            opc_error *error) {
  double *room = k->row.host->alloc(k->row.host, columns * rows, sizeof *room);
  if (!room)
    k->row.host->fail(k->row.host, error, OPC_FAILED, NULL, "out of memory");
  return room;
}

static int publish_trials(const work *k, opc_error *error) {
  size_t rows = k->sizes * k->starts;
  double *c = make_columns(k, 5, rows, error);
  if (!c) return error->code;
  for (size_t i = 0; i < rows; i++) {
    size_t size = i / k->starts, s = i % k->starts;
    const trial *t = &k->trials[size * (k->starts + 1) + s];
    const double all[] = {length_of(k, size), width_of(k, size),
                          (k->first + (double)s) * k->row.grid, t->pde,
                          (double)t->iterations};
    for (size_t q = 0; q < 5; q++) c[q * rows + i] = all[q];
  }
  const opc_column columns[] = {{"l", "nm", OPC_REAL, -1, c},
                                {"w", "nm", OPC_REAL, -1, c + rows},
                                {"init_adjust", "nm", OPC_REAL, -1, c + 2 * rows},
                                {"pde", "%", OPC_REAL, 4, c + 3 * rows},
                                {"iterations", NULL, OPC_REAL, 0, c + 4 * rows}};
  int code = k->row.host->table(k->row.host, "init_adjust_trials", 0, rows,
                                columns, 5, error);
  k->row.host->free(k->row.host, c);
  return code;
}

static int publish_choice(const work *k, opc_error *error) {
  const opc_host *host = k->row.host;
  size_t n = k->sizes, border = 0;
  double *c = make_columns(k, 6, n, error), sooner = 0, plain = 0;
  if (!c) return error->code;
  for (size_t i = 0; i < n; i++) {
    size_t s = choose(k, i);
    const trial *t = k->trials + i * (k->starts + 1);
    const double all[] = {length_of(k, i), width_of(k, i),
                          (k->first + (double)s) * k->row.grid, t[s].pde,
                          (double)t[s].iterations,
                          (double)t[k->starts].iterations};
    for (size_t q = 0; q < 6; q++) c[q * n + i] = all[q];
    border += s == 0 || s + 1 == k->starts;
    sooner += (double)t[s].iterations / (double)n;
    plain += (double)t[k->starts].iterations / (double)n;
  }
  if (border)
    host->log(host, OPC_LOG_WARNING,
              "%zu of %zu sizes take the first or last correction that was "
              "tried: a wider range may have a better one", border, n);
  const opc_column columns[] = {
      {"l", "nm", OPC_REAL, -1, c},
      {"w", "nm", OPC_REAL, -1, c + n},
      {"init_adjust", "nm", OPC_REAL, -1, c + 2 * n},
      {"pde", "%", OPC_REAL, 4, c + 3 * n},
      {"iterations", NULL, OPC_REAL, 0, c + 4 * n},
      {"iterations_by_one", NULL, OPC_REAL, 0, c + 5 * n}};
  int code =
      host->table(host, "init_adjust", OPC_TABLE_PRINT, n, columns, 6, error);
  host->free(host, c);
  if (!code) code = host->metric(host, "iterations_mean", sooner, error);
  if (!code) code = host->metric(host, "iterations_mean_by_one", plain, error);
  return code;
}

/* ---- work: a run ---- */

static int prepare(const work *k, opc_error *error) {
  const opc_litho *litho = k->row.litho->plugin->operations;
  const opc_resist *resist = k->row.resist->plugin->operations;
  const opc_extract *extract = k->row.extract->plugin->operations;
  int code = litho->prepare(k->row.litho->self, error);
  if (!code) code = resist->prepare(k->row.resist->self, k->row.litho, error);
  return code ? code : extract->prepare(k->row.extract->self, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const characterize *c = self;
  const opc_host *host = c->host;
  const opc_value *v = c->values;
  double grid = v[GRID].real;
  (void)outputs;
  work k = {.values = v,
            .row = {.host = host,
                    .litho = v[LITHO].object,
                    .resist = v[RESIST].object,
                    .extract = v[EXTRACT].object,
                    .grid = grid,
                    .extension = v[EXTENSION].real,
                    .enclosure = v[ENCLOSURE].real,
                    .margin = v[MARGIN].real,
                    .type = (uint8_t)v[TYPE].integer},
            .rules = control_rules_make(v[MAX_PDE].real, v[MAX_BIAS].real, grid,
                                        (int)v[W_STEP].integer),
            .first = (int32_t)lround(v[FROM].real / grid),
            .sizes = v[LENGTHS].count * v[WIDTHS].count};
  k.starts = (size_t)(lround(v[TO].real / grid) - k.first + 1);
  k.trials = host->alloc(host, k.sizes * (k.starts + 1), sizeof *k.trials);
  k.failures = host->alloc(host, k.sizes, sizeof *k.failures);
  int code = OPC_OK;
  if (!k.trials || !k.failures)
    code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  if (!code) code = prepare(&k, error);
  if (!code) host->parallel(host, k.sizes, try_size, &k);
  for (size_t i = 0; i < k.sizes && !code; i++)
    if ((code = k.failures[i].code)) *error = k.failures[i];
  if (!code) code = publish_choice(&k, error);
  if (!code) code = publish_trials(&k, error);
  host->free(host, k.trials);
  host->free(host, k.failures);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [LITHO] = {.name = "litho", .type = OPC_SLOT, .flags = OPC_REQUIRED,
               .choices = "litho", .summary = "model of the optics"},
    [RESIST] = {.name = "resist", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                .choices = "resist", .summary = "model of the resist"},
    [EXTRACT] = {.name = "extract", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                 .choices = "extract",
                 .summary = "performance of a printed transistor"},
    [LENGTHS] = {.name = "lengths", .type = OPC_REALS, .unit = "nm",
                 .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 10, .max = 10000,
                 .preset = "[60 nm, 65 nm, 70 nm, 80 nm, 100 nm]",
                 .summary = "drawn lengths, multiples of the grid"},
    [WIDTHS] = {.name = "widths", .type = OPC_REALS, .unit = "nm",
                .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 10, .max = 10000,
                .preset = "[100 nm, 150 nm, 200 nm, 300 nm, 500 nm, 1000 nm]",
                .summary = "drawn widths, multiples of the grid"},
    [TYPE] = {.name = "type", .type = OPC_CHOICE, .preset = "nmos",
              .choices = "nmos|pmos", .summary = "of the transistors"},
    [FROM] = {.name = "from", .type = OPC_REAL, .unit = "nm", .preset = "-4 nm",
              .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = -100, .max = 100,
              .summary = "first correction of L to begin with"},
    [TO] = {.name = "to", .type = OPC_REAL, .unit = "nm", .preset = "15 nm",
            .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = -100, .max = 100,
            .summary = "last one; all between are tried, by grid steps"},
    [TIE] = {.name = "tie", .type = OPC_REAL, .unit = "%", .preset = "0 %",
             .flags = OPC_AT_LEAST, .min = 0,
             .summary = "|PDE| of at most this are as good as each other, and "
                        "fewer iterations win; the thesis has 0 %"},
    [MAX_PDE] = {.name = "max_pde", .type = OPC_REAL, .unit = "%",
                 .flags = OPC_ABOVE, .preset = "0.5 %",
                 .summary = "as of mask.dpb"},
    [MAX_BIAS] = {.name = "max_bias", .type = OPC_REAL, .unit = "nm",
                  .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "80 nm",
                  .max = 1000, .summary = "as of mask.dpb"},
    [W_STEP] = {.name = "w_step", .type = OPC_CHOICE, .preset = "unit",
                .choices = "unit|proportional", .summary = "as of mask.dpb"},
    [MAX_ITERATIONS] = {.name = "max_iterations", .type = OPC_INT,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "100",
                        .min = 0, .max = 100000,
                        .summary = "stop each correction after so many moves"},
    [GRID] = {.name = "grid", .type = OPC_REAL, .unit = "nm", .preset = "1 nm",
              .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 0.1, .max = 10,
              .summary = "of the mask; the step of all corrections"},
    [EXTENSION] = {.name = "extension", .type = OPC_REAL, .unit = "nm",
                   .preset = "84 nm", .flags = OPC_AT_LEAST | OPC_AT_MOST,
                   .min = 0, .max = 1000,
                   .summary = "poly line end past the active"},
    [ENCLOSURE] = {.name = "enclosure", .type = OPC_REAL, .unit = "nm",
                   .preset = "98 nm", .flags = OPC_AT_LEAST | OPC_AT_MOST,
                   .min = 0, .max = 1000,
                   .summary = "active past the gate, along L"},
    [MARGIN] = {.name = "margin", .type = OPC_REAL, .unit = "nm",
                .preset = "1000 nm", .flags = OPC_AT_LEAST | OPC_AT_MOST,
                .min = 0, .max = 10000,
                .summary = "clear field around each transistor"},
};

static const opc_metric metrics[] = {
    {.name = "iterations_mean", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "moves from the chosen first corrections, mean of all sizes"},
    {.name = "iterations_mean_by_one",
     .summary = "moves if the first correction is one grid step, mean"},
};

/* Every size must lie on the grid. */
static int check_sizes(const opc_host *host, const opc_value *v,
                       const char *name, double grid, opc_error *error) {
  if (!v->count)
    return host->fail(host, error, OPC_INVALID, name, "'%s' is empty", name);
  for (size_t i = 0; i < v->count; i++) {
    double steps = v->reals[i] / grid;
    if (fabs(steps - nearbyint(steps)) > 1e-6)
      return host->fail(host, error, OPC_INVALID, name,
                        "'%g nm' is no multiple of the grid of %g nm",
                        v->reals[i], grid);
    for (size_t j = 0; j < i; j++)
      if (v->reals[j] == v->reals[i])
        return host->fail(host, error, OPC_INVALID, name, "'%g nm' twice",
                          v->reals[i]);
  }
  return OPC_OK;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  double grid = values[GRID].real;
  if (check_sizes(host, &values[LENGTHS], "lengths", grid, error) ||
      check_sizes(host, &values[WIDTHS], "widths", grid, error))
    return NULL;
  if (values[LENGTHS].count * values[WIDTHS].count > 10000) {
    host->fail(host, error, OPC_INVALID, "lengths",
               "%zu lengths and %zu widths are more than 10000 sizes",
               values[LENGTHS].count, values[WIDTHS].count);
    return NULL;
  }
  if (values[FROM].real > values[TO].real) {
    host->fail(host, error, OPC_INVALID, "from", "'%g nm' is above 'to', %g nm",
               values[FROM].real, values[TO].real);
    return NULL;
  }
  characterize *c = calloc(1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static void destroy(void *self) { free(self); }

/* ---- entry ---- */

static const opc_step operations = {.size = sizeof operations, .run = run};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "characterize.init_adjust",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "table of the first corrections of mask.dpb over L and W",
      .kind = OPC_KIND_STEP,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
