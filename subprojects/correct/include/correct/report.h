/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics, tables and metrics of a correction. */
#pragma once

#include <eda/print.h>
#include <eda/regulator.h>
#include <opcflow/plugin.h>

#include <correct/edges.h>
#include <correct/sites.h>

/* Deviations of a simulated mask from the design. */
typedef struct summary {
  double ion_mean, ion_max, ion_stdv; /* mean and maximum of |Ion deviation|,
                                         and standard deviation, %; thesis eq.
                                         3.3 to 3.5 */
  double ion_rms, ioff_rms; /* root mean squares, %; thesis eq. 2.5 is q1
                               ion_rms^2 + q2 ioff_rms^2 */
  double area_mean, area_max, ioff_mean, ioff_max; /* of |deviation|, % */
  double ioff_total[3]; /* deviation of the sum of Ioff from the drawn sum, %,
                           of n-, p- and all transistors; NAN if there are
                           none */
  size_t gates, failed, outside; /* numbers of transistors: all, not printed,
                                    with extrapolated figures; statistics
                                    exclude `failed` */
  double epe_mean, epe_max;      /* |edge placement error|, nm */
  size_t sites, lost; /* measured sites; sites without an edge within reach */
} summary;

/* Declared metrics with the values of a summary. clang-format off */
#define REPORT_METRICS                                                      \
  {"ion_mean", "%", OPC_LOWER, 0.01, "mean of |Ion deviation|"},            \
      {"ion_max", "%", OPC_LOWER, 0.01, "largest |Ion deviation|"},         \
      {"ion_stdv", "%", OPC_LOWER, 0.01,                                    \
       "standard deviation of the Ion deviation, thesis eq. 3.5"},          \
      {"ion_rms", "%", OPC_LOWER, 0.01,                                     \
       "root of the mean square of the Ion deviation, thesis eq. 2.5"},     \
      {"ioff_rms", "%", OPC_LOWER, 0.1,                                     \
       "root of the mean square of the Ioff deviation, thesis eq. 2.5"},    \
      {"area_mean", "%", OPC_LOWER, 0.01, "mean of |gate area deviation|"}, \
      {"area_max", "%", OPC_LOWER, 0.01, "largest |gate area deviation|"},  \
      {"ioff_mean", "%", OPC_LOWER, 0.1, "mean of |Ioff deviation|"},       \
      {"ioff_max", "%", OPC_LOWER, 0.1, "largest |Ioff deviation|"},        \
      {"ioff_total", "%", OPC_NEUTRAL, 0.1,                                 \
       "deviation of total Ioff from the drawn total"},                     \
      {"ioff_total_n", "%", OPC_NEUTRAL, 0.1,                               \
       "deviation of total Ioff of the n-transistors"},                     \
  {                                                                         \
    "ioff_total_p", "%", OPC_NEUTRAL, 0.1,                                  \
        "deviation of total Ioff of the p-transistors"                      \
  }
#define REPORT_PRINT_METRICS                                             \
  {"failed", NULL, OPC_LOWER, 0,                                         \
   "transistors that do not print as one separate transistor"},          \
      {"outside", NULL, OPC_LOWER, 0,                                    \
       "transistors with figures extrapolated beyond the device table"}, \
  {                                                                      \
    "short_slices", NULL, OPC_LOWER, 0,                                  \
        "slices shorter than the device model covers"                    \
  }
#define REPORT_DRAWN_METRICS                           \
  {"ion_mean_drawn", "%", OPC_NEUTRAL, 0,              \
   "mean of |Ion deviation| of the mask as drawn"},    \
  {                                                    \
    "ion_max_drawn", "%", OPC_NEUTRAL, 0,              \
        "largest |Ion deviation| of the mask as drawn" \
  }
/* Metrics that compare the mask with the drawn mask and with the regulator's
   rules. */
#define REPORT_JUDGED_METRICS                                                 \
  {"worse", NULL, OPC_LOWER, 0,                                               \
   "transistors whose |Ion deviation| exceeds both the value with the drawn " \
   "mask and the limit"},                                                     \
      {"lost", NULL, OPC_LOWER, 0,                                            \
       "transistors that print with the drawn mask but not with the "         \
       "corrected mask"},                                                     \
      {"violations", NULL, OPC_LOWER, 0,                                      \
       "violations of the regulator's rules by the printed contours"},        \
  {                                                                           \
    "violations_unexplained", NULL, OPC_LOWER, 0,                             \
        "violations caused neither by the drawn layout nor by a parameter"    \
  }
/* clang-format on */

/* Return the statistics of a simulated mask. `sites`, [gates->layers], may be
   NULL. */
OPC_EXPORT summary correct_summarize(const eda_gates *gates,
                                     const eda_performance *design,
                                     const eda_performance *printed,
                                     const uint32_t *flags, const sites *sites);

/* Return the name of a gate, "XU1:3" or at the top level "NAND2:3"; the caller
   frees the name with g_free(). */
OPC_EXPORT char *correct_report_gate_name(const eda_gates *gates, size_t gate);
/* Return the most severe fault in EDA_PRINT_* as a static text; "": none. */
OPC_EXPORT const char *correct_report_trouble(uint32_t flags);

/* A simulated mask of the loop. The line of an accurate simulation replaces the
   line of a fast simulation of the same mask. */
typedef struct history_line {
  summary print;
  int64_t iteration, simulations, fine_simulations;
  const char *model; /* "fine": accurate model; "cheap": fast model */
} history_line;

/* All simulated masks of the loop. */
typedef struct history {
  history_line *line;
  size_t count, capacity;
} history;

/* Add a simulated mask (`fine`: 1: by the accurate model). Free the history.
   Publish the history as a table. */
OPC_EXPORT void correct_history_add(history *history, const summary *print,
                                    uint32_t iteration,
                                    const eda_printer *printer, int fine);
OPC_EXPORT void correct_history_clear(history *history);
OPC_EXPORT int correct_history_report(const history *history,
                                      const opc_host *host, opc_error *error);

/* Input of correct_report_mask. Unknown members are NULL. */
typedef struct report {
  const eda_mask *mask;
  const double *extension; /* [2 * gates], printed line-end extensions, nm */
  const sites *sites;      /* [gates->layers] */
  const biases *biases;
  const opc_module *synthesizer;
  char *const *held;            /* [gates], verdict of the guard; NULL: none */
  const uint32_t *flags_before; /* [gates], EDA_PRINT_* of the mask as drawn */
  const eda_mask *corrected;    /* mask with the figures of the correction loop,
                                   with which the table compares */
} report;

/* Publish the tables and metrics of a mask. */
OPC_EXPORT int correct_report_mask(const opc_host *host, const report *report,
                                   opc_error *error);

/* Write the file `name` of the run folder with one row for each transistor, in
   the order of a flat mask; figures are those of the class. Strips of the mask
   are flattened one by one; only the names of all cell instances stay in
   memory. NULL: do nothing. */
OPC_EXPORT int correct_report_transistors(const opc_host *host,
                                          const eda_mask *mask,
                                          const char *name, opc_error *error);
#define REPORT_TRANSISTORS(state)                                          \
  OPC_PARAMETER(state, transistors, .type = OPC_OUTPUT,                    \
                .summary =                                                 \
                    "File with a row for each transistor, all.csv; the "   \
                    "table of a mask by classes has a row for each class " \
                    "(default: none)")

/* Publish a table of n violations of design rules. */
OPC_EXPORT int correct_report_violations(const opc_host *host,
                                         const eda_gates *gates,
                                         const eda_violation *violations,
                                         size_t n, opc_error *error);

/* Report the violations of a regulator's rules and store them in the mask.
   `regulator` may be NULL. Call on the main thread. */
OPC_EXPORT int correct_report_rules(const opc_host *host,
                                    const opc_module *regulator,
                                    const eda_printed *printed, eda_mask *mask,
                                    opc_error *error);
