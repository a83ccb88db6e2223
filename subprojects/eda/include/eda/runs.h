/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of run folders written by `opcflow run`: parameters, metrics and
   tables. Files are not trusted: their size is limited, and errors name the
   position of damaged data. [any], [main]: see opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* ---- tables ----------------------------------------------------------- */

/* A table of a run (CSV of RFC 4180; first line: "name (unit)" of each column).
   All functions are [main] for one table, because numbers are converted on
   first request. */
typedef struct eda_table eda_table;

/* Read a table from a file of up to 1 GB. Each row must have as many fields as
   the first line. Return NULL and *error on failure: OPC_IO if the file cannot
   be read; OPC_INVALID if the file is larger than 1 GB or not UTF-8;
   OPC_INVALID with file:line:column if a line is malformed. */
OPC_EXPORT eda_table *eda_table_read(const char *path, opc_error *error);
/* Free a table (NULL: do nothing). */
OPC_EXPORT void eda_table_free(eda_table *table);

/* Return the number of rows, without the first line; return the number of
   columns. */
OPC_EXPORT size_t eda_table_rows(const eda_table *table);
OPC_EXPORT size_t eda_table_columns(const eda_table *table);

/* Return the name, or the unit ("": no unit), of a column. */
OPC_EXPORT const char *eda_table_name(const eda_table *table, size_t column);
OPC_EXPORT const char *eda_table_unit(const eda_table *table, size_t column);

/* Return the index of the first column with a name, -1 if none exists. */
OPC_EXPORT int eda_table_find(const eda_table *table, const char *name);

/* Return the text of a field of any column. */
OPC_EXPORT const char *eda_table_text(const eda_table *table, size_t row,
                                      size_t column);

/* Return the numbers of a column, one for each row, owned by the table; NAN for
   an empty field, infinity for "inf" or "-inf". Return NULL if a field is not a
   number, if all fields are empty, or if there are no rows. */
OPC_EXPORT const double *eda_table_numbers(eda_table *table, size_t column);

/* Fill *error with "path:line: column 'name': what 'field'" and return
   OPC_INVALID. */
OPC_EXPORT int eda_table_fail(const eda_table *table, size_t row, size_t column,
                              const char *what, opc_error *error);

/* ---- runs ------------------------------------------------------------- */

/* Directions in which a metric improves. */
enum { EDA_RUN_NEUTRAL = 0, EDA_RUN_LOWER = 1, EDA_RUN_HIGHER = 2 };

/* A metric with its value. */
typedef struct eda_run_metric {
  const char *name; /* "mask.ion_max" */
  const char *unit; /* NULL: dimensionless */
  double value;     /* NAN: no value */
  int better;       /* direction of improvement: EDA_RUN_LOWER ... */
  double tolerance; /* largest insignificant difference, in `unit` */
} eda_run_metric;

/* A parameter of a step, or of the plugin in a slot of the step. The value of
   "mask.litho.use" is the name of the plugin in slot "litho" of step "mask". */
typedef struct eda_run_parameter {
  const char *name;  /* "mask.litho.na" */
  const char *value; /* text as in a flow file: "193 nm", "[1, 2]" */
  int given;         /* 0: the default value */
} eda_run_parameter;

/* A file that a run read (input) or wrote (output). */
typedef struct eda_run_file {
  const char *path; /* input: path as recorded by the run; output: path inside
                       the run folder */
  const char *sha256;
  int64_t bytes; /* size in bytes; -1: not recorded (inputs) */
} eda_run_file;

/* A plugin that a run used. */
typedef struct eda_run_plugin {
  const char *id, *version, *sha256; /* plugin, its version, checksum of the
                                        shared object */
} eda_run_plugin;

/* A step with its run time, s; for a reused result, the time of its
   computation. */
typedef struct eda_run_step {
  const char *name;
  double seconds;
} eda_run_step;

/* A finding reported by a step. */
typedef struct eda_run_finding {
  const char *step, *text;
} eda_run_finding;

/* A requirement of the flow for a metric. `kept`: 1 if `value` meets it. */
typedef struct eda_run_requirement {
  const char *metric, *required, *unit; /* unit may be NULL */
  double value;                         /* NAN: no value */
  int kept;
} eda_run_requirement;

/* Contents of a run folder without tables. Arrays are in file order. */
typedef struct eda_run_facts {
  const char *folder;  /* path as passed to eda_run_open */
  const char *name;    /* name of the flow */
  const char *variant; /* NULL: none */
  const char *version; /* version of opcflow, "0.2.0" */
  const char *started; /* ISO 8601, UTC */
  const char *failure; /* NULL: the run is complete */
  double seconds;
  int64_t threads;
  int64_t points; /* points (parameter combinations) of a sweep; 0: no sweep */
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

/* A run folder in memory. */
typedef struct eda_run eda_run;

/* Read manifest.json, metrics.json and flow.yaml (up to 16 MB each) of a run
   folder, also of a failed run. Return NULL and *error on failure: OPC_IO if
   the folder is not a run folder or a file cannot be read; OPC_INVALID with
   file:line:column if a file is damaged or of an unknown format. [any] */
OPC_EXPORT eda_run *eda_run_open(const char *folder, opc_error *error);
/* Free a run with its tables (NULL: do nothing). */
OPC_EXPORT void eda_run_free(eda_run *run);

/* Return the contents of a run, owned by the run. [any] */
OPC_EXPORT const eda_run_facts *eda_run_info(const eda_run *run);

/* Return the time of the steps of a run, s; the time of the run if the run has
   no steps. A step whose result was reused counts with the time of its
   computation, which the manifest keeps; the time of the run itself depends on
   the store. [any] */
OPC_EXPORT double eda_run_time(const eda_run *run);

/* Return a metric, or a parameter, by name; NULL if none exists. [any] */
OPC_EXPORT const eda_run_metric *eda_run_metric_of(const eda_run *run,
                                                   const char *name);
OPC_EXPORT const eda_run_parameter *eda_run_parameter_of(const eda_run *run,
                                                         const char *name);

/* eda_run_has_table: return 1 if the folder has the table `name` ("gates"),
   otherwise 0. eda_run_table: return the table, which the run owns and reads on
   first request; NULL and *error as in eda_table_read. [main] */
OPC_EXPORT int eda_run_has_table(const eda_run *run, const char *name);
OPC_EXPORT eda_table *eda_run_table(eda_run *run, const char *name,
                                    opc_error *error);

/* ---- experiments ------------------------------------------------------ */

/* Result of one method on one case. */
typedef struct eda_run_case {
  const char *name, *method;
  const char *folder; /* run folder, inside the folder of the experiment; NULL:
                         none */
  const char *result; /* "good", or the failure */
  double seconds;
} eda_run_case;

/* An experiment: a folder with a table experiment.csv (columns case, method,
   folder, result, seconds, and one for each metric). */
typedef struct eda_run_cases eda_run_cases;

/* Return 1 if a folder contains an experiment, otherwise 0. [any] */
OPC_EXPORT int eda_run_is_experiment(const char *folder);

/* Read the table of an experiment. Return NULL and *error as in eda_table_read.
   Further errors with OPC_INVALID: a case or method has no name, a run folder
   is outside the experiment, or a case has a method twice. [any] */
OPC_EXPORT eda_run_cases *eda_run_cases_open(const char *folder,
                                             opc_error *error);
/* Free an experiment (NULL: do nothing). */
OPC_EXPORT void eda_run_cases_free(eda_run_cases *cases);

/* Return all *n results in the order of the table. [any] */
OPC_EXPORT const eda_run_case *eda_run_cases_all(const eda_run_cases *cases,
                                                 size_t *n);

OPC_C_END
