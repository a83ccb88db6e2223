/* SPDX-License-Identifier: BSD-3-Clause */
/* Delays in SDF (IEEE 1497, version 3.0). */
#include <eda/sdf.h>

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <string.h>

void eda_verilog_name(FILE *out, const char *name) {
  const char *at = name;
  int good = isalpha((unsigned char)*at) || *at == '_';
  while (good && *++at) good = isalnum((unsigned char)*at) || *at == '_';
  fprintf(out, good ? "%s" : "\\%s ", name);
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
      fprintf(out, "  (CELL (CELLTYPE \"%s\") (INSTANCE ", a->cell);
      eda_verilog_name(out, a->instance);
      fputs(")\n    (DELAY (ABSOLUTE\n", out);
    }
    fputs("      (IOPATH ", out);
    eda_verilog_name(out, a->input);
    fputc(' ', out);
    eda_verilog_name(out, a->output);
    put_delay(out, a->delay[1]);
    put_delay(out, a->delay[0]);
    fputs(")\n", out);
    if (i + 1 == arcs || !same_entry(a, a + 1)) fputs("    ))\n  )\n", out);
  }
}

int eda_sdf_write(const char *path, const char *design, const char *program,
                  double supply, double temperature, size_t arcs,
                  const eda_sdf_arc *arc, opc_error *error) {
  FILE *out = fopen(path, "wb");
  if (out) {
    fprintf(out,
            "(DELAYFILE\n  (SDFVERSION \"3.0\")\n  (DESIGN \"%s\")\n"
            "  (PROGRAM \"%s\")\n  (VOLTAGE %g)\n  (TEMPERATURE %g)\n"
            "  (DIVIDER /)\n  (TIMESCALE 1 ps)\n",
            design, program, supply, temperature);
    put_arcs(out, arcs, arc);
    fputs(")\n", out);
  }
  int bad = !out || ferror(out), why = errno;
  if (out && fclose(out)) {
    bad = 1;
    why = errno;
  }
  if (!bad) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%.300s': %s", path, strerror(why));
}
