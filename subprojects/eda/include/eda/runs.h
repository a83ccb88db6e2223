/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders, as `opcflow run` leaves them, read again: what a run was made
   of, what it measured, its tables. What stands in a folder is taken for
   anybody's: it is bounded, and what is damaged is refused with its place. */
#ifndef EDA_RUNS_H
#define EDA_RUNS_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables ----------------------------------------------------------- */

/* A table of a run (RFC 4180, the first line with "name (unit)"), by columns.
   All [main] for one table: numbers are made when they are first asked for. */
typedef struct eda_table eda_table;

/* Read a file of up to 1 GB; NULL and *error: OPC_IO if it cannot be read,
   OPC_INVALID with file:line:column if it is no such table. A row must have as
   many fields as the first line. */
OPC_EXPORT eda_table *eda_table_read(const char *path, opc_error *error);
OPC_EXPORT void eda_table_free(eda_table *table);

OPC_EXPORT size_t eda_table_rows(const eda_table *table);
OPC_EXPORT size_t eda_table_columns(const eda_table *table);

/* A column's name, and its unit, "" if it has none. */
OPC_EXPORT const char *eda_table_name(const eda_table *table, size_t column);
OPC_EXPORT const char *eda_table_unit(const eda_table *table, size_t column);

/* The first column of that name, -1 if there is none. */
OPC_EXPORT int eda_table_find(const eda_table *table, const char *name);

/* The text of a field, whatever the column holds. */
OPC_EXPORT const char *eda_table_text(const eda_table *table, size_t row,
                                      size_t column);

/* A column as numbers, of each row, the table's own; NAN where a field is
   empty, and infinity where it says "inf" or "-inf". NULL if a field is no
   number, or all are empty. */
OPC_EXPORT const double *eda_table_numbers(eda_table *table, size_t column);

/* An error about a field: "path:line: column 'name': what 'field'". The code:
   OPC_INVALID. */
OPC_EXPORT int eda_table_fail(const eda_table *table, size_t row, size_t column,
                              const char *what, opc_error *error);

/* ---- runs ------------------------------------------------------------- */

enum { EDA_RUN_NEUTRAL = 0, EDA_RUN_LOWER = 1, EDA_RUN_HIGHER = 2 };

typedef struct eda_run_metric {
  const char *name; /* "mask.ion_max" */
  const char *unit; /* NULL: a plain number */
  double value;     /* NAN: none */
  int better;       /* EDA_RUN_LOWER ... */
  double tolerance; /* a difference up to it means nothing; same unit */
} eda_run_metric;

/* A parameter of a step or of a plugin in its slot; "mask.litho.use" is the
   plugin. */
typedef struct eda_run_parameter {
  const char *name;  /* "mask.litho.na" */
  const char *value; /* as a flow writes it: "193 nm", "[1, 2]" */
  int given;         /* 0: it is the default */
} eda_run_parameter;

typedef struct eda_run_file {
  const char *path; /* of an input: as the run knew it; of what the run wrote:
                       inside its folder */
  const char *sha256;
  int64_t bytes; /* -1: not told, as of inputs */
} eda_run_file;

typedef struct eda_run_plugin {
  const char *id, *version, *sha256; /* of the shared object */
} eda_run_plugin;

typedef struct eda_run_step {
  const char *name;
  double seconds;
} eda_run_step;

/* What a step found that must not be missed. */
typedef struct eda_run_finding {
  const char *step, *text;
} eda_run_finding;

/* What the flow requires of a metric, and whether it was kept. */
typedef struct eda_run_requirement {
  const char *metric, *required, *unit; /* unit may be NULL */
  double value;                         /* NAN: none */
  int kept;
} eda_run_requirement;

/* All but the tables. Arrays are in the order of the files. */
typedef struct eda_run_facts {
  const char *folder;  /* as it was opened */
  const char *name;    /* of the flow */
  const char *variant; /* NULL: none */
  const char *version; /* of opcflow, "0.2.0" */
  const char *started; /* ISO 8601, UTC */
  const char *failure; /* NULL: the run is complete */
  double seconds;
  int64_t threads;
  int64_t points; /* of a sweep; 0: it is none */
  size_t n_metrics;
  const eda_run_metric *metrics;
  size_t n_parameters;
  const eda_run_parameter *parameters;
  size_t n_inputs;
  const eda_run_file *inputs;
  size_t n_files;
  const eda_run_file *files;
  size_t n_plugins;
  const eda_run_plugin *plugins;
  size_t n_steps;
  const eda_run_step *steps;
  size_t n_findings;
  const eda_run_finding *findings;
  size_t n_requirements;
  const eda_run_requirement *requirements;
} eda_run_facts;

typedef struct eda_run eda_run;

/* Open a run folder: its manifest.json, metrics.json and flow.yaml, of up to
   16 MB each. NULL and *error: OPC_IO if it is no run folder or a file of it
   cannot be read, OPC_INVALID with file:line:column if one is damaged or of a
   format that this does not know. A run that failed is opened, too. [any] */
OPC_EXPORT eda_run *eda_run_open(const char *folder, opc_error *error);
OPC_EXPORT void eda_run_free(eda_run *run);

/* What it says; the run's own. [any] */
OPC_EXPORT const eda_run_facts *eda_run_told(const eda_run *run);

/* One by its name, NULL if there is none. [any] */
OPC_EXPORT const eda_run_metric *eda_run_metric_of(const eda_run *run,
                                                   const char *name);
OPC_EXPORT const eda_run_parameter *eda_run_parameter_of(const eda_run *run,
                                                         const char *name);

/* Whether the folder has a table of that name ("gates"), and the table: the
   run's own, read when it is first asked for. NULL and *error as of
   eda_table_read. [main] */
OPC_EXPORT int eda_run_has_table(const eda_run *run, const char *name);
OPC_EXPORT eda_table *eda_run_table(eda_run *run, const char *name,
                                    opc_error *error);

/* ---- experiments ------------------------------------------------------ */

/* One method on one case. */
typedef struct eda_run_case {
  const char *name, *method;
  const char *folder; /* of its run: the experiment's folder and below; NULL
                         where there is none */
  const char *result; /* "good", or what is not */
  double seconds;
} eda_run_case;

/* A folder with a table experiment.csv: columns case, method, folder, result,
   seconds, and then metrics. */
typedef struct eda_run_cases eda_run_cases;

/* Whether a folder has that table. [any] */
OPC_EXPORT int eda_run_is_experiment(const char *folder);

/* NULL and *error as of eda_table_read; also where a folder in it leaves that
   of the experiment, or a case has a method twice. [any] */
OPC_EXPORT eda_run_cases *eda_run_cases_open(const char *folder,
                                             opc_error *error);
OPC_EXPORT void eda_run_cases_free(eda_run_cases *cases);

/* All, in the order of the table; *n: how many. [any] */
OPC_EXPORT const eda_run_case *eda_run_cases_all(const eda_run_cases *cases,
                                                 size_t *n);

/* The table itself, with the metrics; the cases' own. */
OPC_EXPORT eda_table *eda_run_cases_table(eda_run_cases *cases);

#ifdef __cplusplus
}
#endif
#endif
