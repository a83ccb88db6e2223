/* SPDX-License-Identifier: BSD-3-Clause */
/* Delays in SDF (IEEE 1497, version 3.0). */
#include <eda/sdf.h>

#include <ctype.h>
#include <eda/file.h>
#include <math.h>
#include <string.h>

void eda_verilog_name(FILE *out, const char *name) {
  const char *at = name;
  int good = isalpha((unsigned char)*at) || *at == '_';
  while (good && *++at) good = isalnum((unsigned char)*at) || *at == '_';
  fprintf(out, good ? "%s" : "\\%s ", name);
}

/* Write an identifier of SDF: a backslash precedes each special character. A
   first digit is escaped, too, for programs that take it for a number. */
static void put_name(FILE *out, const char *name) {
  for (const char *c = name; *c; c++) {
    int plain = isalpha((unsigned char)*c) || *c == '_' ||
                (c > name && isdigit((unsigned char)*c));
    if (!plain) fputc('\\', out);
    fputc(*c, out);
  }
}

/* Write a string of SDF. */
static void put_string(FILE *out, const char *text) {
  fputc('"', out);
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', out);
    fputc(*text, out);
  }
  fputc('"', out);
}

static void put_delay(FILE *out, const double delay[3]) {
  if (isnan(delay[1]))
    fputs(" ()", out);
  else
    fprintf(out, " (%.3f:%.3f:%.3f)", delay[0], delay[1], delay[2]);
}

static int same_entry(const eda_sdf_arc *a, const eda_sdf_arc *b) {
  return !strcmp(a->instance, b->instance) && !strcmp(a->output, b->output);
}

static void put_arcs(FILE *out, size_t arcs, const eda_sdf_arc *arc) {
  for (size_t i = 0; i < arcs; i++) {
    const eda_sdf_arc *a = &arc[i];
    if (!i || !same_entry(a, a - 1)) {
      fputs("  (CELL (CELLTYPE ", out);
      put_string(out, a->cell);
      fputs(") (INSTANCE ", out);
      put_name(out, a->instance);
      fputs(")\n    (DELAY (ABSOLUTE\n", out);
    }
    fputs("      (IOPATH ", out);
    put_name(out, a->input);
    fputc(' ', out);
    put_name(out, a->output);
    put_delay(out, a->delay[1]);
    put_delay(out, a->delay[0]);
    fputs(")\n", out);
    if (i + 1 == arcs || !same_entry(a, a + 1)) fputs("    ))\n  )\n", out);
  }
}

/* Return an arc with a delay that is not finite, or NULL. */
static const eda_sdf_arc *find_infinite(size_t arcs, const eda_sdf_arc *arc) {
  for (size_t i = 0; i < arcs; i++)
    for (int rises = 0; rises < 2; rises++)
      for (int k = 0; k < 3; k++) {
        double x = arc[i].delay[rises][k];
        if (!isnan(arc[i].delay[rises][1]) && !isfinite(x)) return &arc[i];
      }
  return NULL;
}

int eda_sdf_write(const char *path, const char *design, const char *program,
                  double supply, double temperature, size_t arcs,
                  const eda_sdf_arc *arc, opc_error *error) {
  const eda_sdf_arc *wrong = find_infinite(arcs, arc);
  if (wrong)
    return opc_fail(error, OPC_FAILED, NULL,
                    "the delay of '%.100s' from '%.100s' to '%.100s' is not "
                    "finite",
                    wrong->instance, wrong->input, wrong->output);
  FILE *out = fopen(path, "wb");
  if (out) {
    fputs("(DELAYFILE\n  (SDFVERSION \"3.0\")\n  (DESIGN ", out);
    put_string(out, design);
    fputs(")\n  (PROGRAM ", out);
    put_string(out, program);
    fprintf(out,
            ")\n  (VOLTAGE %g)\n  (TEMPERATURE %g)\n  (DIVIDER /)\n"
            "  (TIMESCALE 1 ps)\n",
            supply, temperature);
    put_arcs(out, arcs, arc);
    fputs(")\n", out);
  }
  return eda_file_close(out, path, NULL, error);
}
