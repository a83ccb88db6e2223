/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements characterize.init_adjust: writes the table of first corrections of
   synthesizer.dpb (thesis 3.2.2 (2), figure 3.5). For each length and width,
   DPB corrects an evaluation transistor from a range of first corrections. The
   table contains the first correction whose final current is nearest to the
   drawn current. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/control.h>
#include <correct/fine.h>
#include "row.h"

/* ---- state ---- */

/* Result of one transistor. */
typedef struct trial {
  double pde;         /* deviation of Ion after the last move, % */
  int64_t iterations; /* moves of the mask */
} trial;

typedef struct characterize {
  const opc_host *host;
  const opc_module *litho, *resist, *extractor;
  opc_reals lengths, widths;
  int type, proportional;
  double from, to, tie, ion_limit, max_bias;
  int64_t max_iterations;
  double grid, extension, enclosure, margin;
} characterize;

/* State of a run. Sizes are ordered by length, then width. Each size has
   `starts` trials, with first corrections of `first`, `first` + 1 and so on, in
   grid steps. One more trial begins with one grid step that reduces the
   error. */
typedef struct work {
  const characterize *by;
  row_rules row;
  control_rules rules;
  int32_t first;
  size_t sizes, starts;
  trial *trials;       /* [size * (starts + 1) + start] */
  opc_error *failures; /* of each size */
} work;

/* ---- work: one size ---- */

static double length_of(const work *k, size_t size) {
  return k->by->lengths.values[size / k->by->widths.count];
}

static double width_of(const work *k, size_t size) {
  return k->by->widths.values[size % k->by->widths.count];
}

/* Perform the next step of each transistor of a row. Set the flags of layers
   whose mask changes. */
static void row_step(const work *k, row *r, control *state, trial *trials,
                     int64_t iteration, int changed[ROW_LAYERS]) {
  changed[EDA_POLY] = changed[EDA_ACTIVE] = 0;
  for (size_t i = 0; i < r->count; i++) {
    control_input in = {.error = 100 * (r->ion[i] - r->design) / r->design,
                        .width = r->width / k->row.grid};
    int32_t start = i < k->starts ? k->first + (int32_t)i : 0;
    int by_l = iteration == 0 ? correct_control_first(&k->rules, &state[i], &in,
                                                      start, &r->l[i])
                              : correct_control_length(&k->rules, &state[i],
                                                       &in, &r->l[i], r->w[i]);
    int by_w = iteration > 0 && !by_l &&
               correct_control_width(&k->rules, &state[i], &in, &r->w[i]);
    state[i].error = in.error;
    trials[i].pde = in.error;
    if (by_l || by_w) trials[i].iterations = iteration + 1;
    changed[EDA_POLY] |= by_l;
    changed[EDA_ACTIVE] |= by_w;
  }
}

static int correct_row(const work *k, row *r, control *state, trial *trials,
                       opc_error *error) {
  int changed[ROW_LAYERS] = {1, 1};
  for (int64_t iteration = 0;; iteration++) {
    int code = row_print(r, changed, error);
    if (code) return code;
    if (opc_cancelled(k->row.context))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    row_step(k, r, state, trials, iteration, changed);
    if (iteration >= k->by->max_iterations ||
        (!changed[EDA_POLY] && !changed[EDA_ACTIVE]))
      return OPC_OK;
  }
}

static void try_size(void *data, size_t size) {
  work *k = data;
  opc_error *error = &k->failures[size];
  size_t n = k->starts + 1;
  row r;
  control *state = eda_alloc(n, sizeof *state);
  int code =
      row_init(&r, &k->row, length_of(k, size), width_of(k, size), n, error);
  if (!code) code = correct_row(k, &r, state, k->trials + size * n, error);
  error->code = code;
  row_clear(&r);
  free(state);
}

/* ---- work: the choice ---- */

/* Return whether trial a is better than b. Values of |PDE| up to `tie` count as
   equal. If they are equal, the smaller number of moves decides, then the
   smaller first correction. */
static int is_better(const work *k, size_t size, size_t a, size_t b) {
  const trial *t = k->trials + size * (k->starts + 1);
  double tie = k->by->tie;
  double pde_a = fmax(fabs(t[a].pde), tie), pde_b = fmax(fabs(t[b].pde), tie);
  if (pde_a != pde_b) return pde_a < pde_b;
  if (t[a].iterations != t[b].iterations)
    return t[a].iterations < t[b].iterations;
  return abs(k->first + (int32_t)a) < abs(k->first + (int32_t)b);
}

static size_t size_choose(const work *k, size_t size) {
  size_t best = 0;
  for (size_t s = 1; s < k->starts; s++)
    if (is_better(k, size, s, best)) best = s;
  return best;
}

/* Row of a table: the results of a first correction of a size. */
typedef struct trial_result {
  double l, w, init_adjust, pde, iterations;
  double by_one; /* iterations if the first correction is one grid step */
} trial_result;

static trial_result trial_row(const work *k, size_t size, size_t s) {
  const trial *t = k->trials + size * (k->starts + 1);
  return (trial_result){length_of(k, size),
                        width_of(k, size),
                        (k->first + (double)s) * k->row.grid,
                        t[s].pde,
                        (double)t[s].iterations,
                        (double)t[k->starts].iterations};
}

/* Write a table with the first `columns` of all columns. Return OPC_OK or an
   error. */
static int table_publish(const work *k, const char *name, uint32_t flags,
                         const trial_result *first, size_t rows, size_t columns,
                         opc_error *error) {
  const opc_column all[] = {
      {"l", "nm", OPC_REAL, -1, &first->l},
      {"w", "nm", OPC_REAL, -1, &first->w},
      {"init_adjust", "nm", OPC_REAL, -1, &first->init_adjust},
      {"pde", "%", OPC_REAL, 4, &first->pde},
      {"iterations", NULL, OPC_REAL, 0, &first->iterations},
      {"iterations_by_one", NULL, OPC_REAL, 0, &first->by_one}};
  return opc_put_rows(k->by->host, name, flags, rows, sizeof *first, all,
                      columns, error);
}

static int publish_trials(const work *k, opc_error *error) {
  size_t rows = k->sizes * k->starts;
  trial_result *all = eda_alloc(rows, sizeof *all);
  for (size_t i = 0; i < rows; i++)
    all[i] = trial_row(k, i / k->starts, i % k->starts);
  int code = table_publish(k, "init_adjust_trials", 0, all, rows, 5, error);
  free(all);
  return code;
}

static int publish_choice(const work *k, opc_error *error) {
  const opc_host *host = k->by->host;
  size_t n = k->sizes, border = 0, open = 0;
  trial_result *all = eda_alloc(n, sizeof *all);
  double sooner = 0, plain = 0;
  for (size_t i = 0; i < n; i++) {
    size_t s = size_choose(k, i);
    all[i] = trial_row(k, i, s);
    border += s == 0 || s + 1 == k->starts;
    open += !(all[i].pde > -100);
    sooner += all[i].iterations / (double)n;
    plain += all[i].by_one / (double)n;
  }
  if (open)
    host->log(host, OPC_LOG_FINDING,
              "%zu of %zu sizes do not print with any first correction; their "
              "rows have no meaning",
              open, n);
  if (border)
    host->log(host, OPC_LOG_WARNING,
              "%zu of %zu sizes have their best result at an end of the range "
              "of first corrections; widen 'from' to 'to'",
              border, n);
  const opc_metric_value values[] = {{"iterations_mean", sooner},
                                     {"iterations_mean_by_one", plain}};
  int code = table_publish(k, "init_adjust", OPC_TABLE_PRINT, all, n, 6, error);
  free(all);
  return code ? code : opc_put_metrics(host, OPC_ARRAY(values), error);
}

/* ---- work: a run ---- */

static int characterize_prepare(const characterize *c, opc_error *error) {
  const eda_litho *litho = c->litho->functions;
  const eda_resist *resist = c->resist->functions;
  const eda_extractor *extractor = c->extractor->functions;
  int code = litho->prepare(c->litho->self, error);
  if (!code) code = resist->prepare(c->resist->self, c->litho, error);
  return code ? code : extractor->prepare(c->extractor->self, error);
}

static int characterize_run(void *self, void **outputs, opc_error *error) {
  characterize *c = self;
  (void)outputs;
  if (correct_fine_margin(c->host, c->litho, 0, &c->margin, error))
    return error->code;
  work k = {.by = c,
            .row = {.context = c->host->context,
                    .litho = c->litho,
                    .resist = c->resist,
                    .extractor = c->extractor,
                    .grid = c->grid,
                    .extension = c->extension,
                    .enclosure = c->enclosure,
                    .margin = c->margin,
                    .type = (uint8_t)c->type},
            .rules = correct_control_rules_for(c->ion_limit, c->max_bias,
                                               c->grid, c->proportional),
            .first = (int32_t)lround(c->from / c->grid),
            .sizes = c->lengths.count * c->widths.count};
  k.starts = (size_t)(lround(c->to / c->grid) - k.first + 1);
  k.trials = eda_alloc(k.sizes * (k.starts + 1), sizeof *k.trials);
  k.failures = eda_alloc(k.sizes, sizeof *k.failures);
  int code = characterize_prepare(c, error);
  if (!code) opc_parallel(c->host->context, k.sizes, try_size, &k);
  for (size_t i = 0; i < k.sizes && !code; i++)
    if ((code = k.failures[i].code)) *error = k.failures[i];
  if (!code) code = publish_choice(&k, error);
  if (!code) code = publish_trials(&k, error);
  free(k.trials);
  free(k.failures);
  return code;
}

/* ---- parameters ---- */

#define SLOT(NAME, SUMMARY)                                                   \
  {                                                                           \
    .name = #NAME, .type = OPC_SLOT, .flags = OPC_REQUIRED, .choices = #NAME, \
    .summary = (SUMMARY), OPC_FIELD(characterize, NAME)                       \
  }
#define NUMBER(NAME, TYPE, UNIT, FLAGS, MIN, MAX, PRESET, SUMMARY)        \
  {                                                                       \
    .name = #NAME, .type = (TYPE), .flags = (FLAGS), .unit = (UNIT),      \
    .min = (MIN), .max = (MAX), .preset = (PRESET), .summary = (SUMMARY), \
    OPC_FIELD(characterize, NAME)                                         \
  }
enum { BETWEEN = OPC_AT_LEAST | OPC_AT_MOST };

static const opc_parameter parameters[] = {
    SLOT(litho, "model of the optics"),
    SLOT(resist, "model of the resist"),
    SLOT(extractor, "performance of a printed transistor"),
    NUMBER(lengths, OPC_REALS, "nm", BETWEEN, 10, 10000,
           "[60 nm, 65 nm, 70 nm, 80 nm, 100 nm]",
           "drawn lengths, multiples of the grid"),
    NUMBER(widths, OPC_REALS, "nm", BETWEEN, 10, 10000,
           "[100 nm, 150 nm, 200 nm, 300 nm, 500 nm, 1000 nm]",
           "drawn widths, multiples of the grid"),
    OPC_PARAMETER(characterize, type, .type = OPC_CHOICE, .preset = "nmos",
                  .choices = "nmos|pmos", .summary = "type of the transistors"),
    NUMBER(from, OPC_REAL, "nm", BETWEEN, -100, 100, "-4 nm",
           "smallest first correction of L to try"),
    NUMBER(to, OPC_REAL, "nm", BETWEEN, -100, 100, "15 nm",
           "largest first correction of L to try; all grid steps from `from` "
           "to this value are tried"),
    NUMBER(tie, OPC_REAL, "%", OPC_AT_LEAST, 0, 0, "0 %",
           "|Ion deviation| up to which results count as equal, so that the "
           "fewest iterations decide; the thesis uses 0 %"),
    OPC_PARAMETER(characterize, ion_limit, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "0.5 %", .former = "limit",
                  .summary = "largest allowed |Ion deviation|, as in "
                             "synthesizer.dpb"),
    NUMBER(max_bias, OPC_REAL, "nm", OPC_ABOVE | OPC_AT_MOST, 0, 1000, "80 nm",
           "largest correction of L or W, as in synthesizer.dpb"),
    OPC_PARAMETER_NAMED(
        "w_step", characterize, proportional, .type = OPC_CHOICE,
        .preset = "unit", .choices = "unit|proportional",
        .summary = "steps of W: one grid step, or proportional to the error"),
    NUMBER(max_iterations, OPC_INT, NULL, BETWEEN, 0, 100000, "100",
           "largest number of moves of a correction"),
    NUMBER(grid, OPC_REAL, "nm", BETWEEN, 0.1, 10, "1 nm",
           "mask grid, the step of all corrections"),
    NUMBER(extension, OPC_REAL, "nm", BETWEEN, 0, 1000, "84 nm",
           "extension of the poly line end past the active"),
    NUMBER(enclosure, OPC_REAL, "nm", BETWEEN, 0, 1000, "98 nm",
           "extension of the active past the gate, in the direction of L"),
    NUMBER(margin, OPC_REAL, "nm", BETWEEN, 0, 10000, "1000 nm",
           "width of the clear field around each transistor"),
};

static const opc_metric metrics[] = {
    {"iterations_mean", NULL, OPC_LOWER, 0.01,
     "mean number of moves with the chosen first corrections, over all sizes"},
    {"iterations_mean_by_one", NULL, OPC_NEUTRAL, 0,
     "mean number of moves with a first correction of one grid step"},
};

/* Check that every size is on the grid. Return OPC_OK or an error. */
static int check_sizes(const opc_reals *sizes, const char *name, double grid,
                       opc_error *error) {
  if (!sizes->count)
    return opc_fail(error, OPC_INVALID, name, "'%s' is empty", name);
  for (size_t i = 0; i < sizes->count; i++) {
    double nm = sizes->values[i], steps = nm / grid;
    if (fabs(steps - nearbyint(steps)) > 1e-6)
      return opc_fail(error, OPC_INVALID, name,
                      "'%g nm' is no multiple of the grid of %g nm", nm, grid);
    for (size_t j = 0; j < i; j++)
      if (sizes->values[j] == nm)
        return opc_fail(error, OPC_INVALID, name, "'%g nm' appears twice", nm);
  }
  return OPC_OK;
}

static int characterize_check(void *self, opc_error *error) {
  const characterize *c = self;
  if (check_sizes(&c->lengths, "lengths", c->grid, error) ||
      check_sizes(&c->widths, "widths", c->grid, error))
    return error->code;
  if (c->lengths.count * c->widths.count > 10000)
    return opc_fail(
        error, OPC_INVALID, "lengths",
        "%zu lengths and %zu widths exceed the limit of 10000 sizes",
        c->lengths.count, c->widths.count);
  if (c->from > c->to)
    return opc_fail(error, OPC_INVALID, "from", "'%g nm' is above 'to', %g nm",
                    c->from, c->to);
  return OPC_OK;
}

/* ---- entry ---- */

static const opc_step functions = {.run = characterize_run};

OPC_PLUGIN(
    characterize, .id = "characterize.init_adjust", .kind = "step",
    .version = "0.2.0", .licence = "BSD-3-Clause",
    .summary = "table of first corrections of synthesizer.dpb over L and W",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = characterize_check,
    OPC_FUNCTIONS(functions));
