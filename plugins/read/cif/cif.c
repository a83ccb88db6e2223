/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements read.cif: a CIF 2.0 file as a layout. */
#include "cif.h"

/* ---- work ---- */

void cif_refuse_at(cif *c, size_t at, const char *what) {
  size_t line = 1, start = 0;
  if (c->b.failed) return;
  for (size_t i = 0; i < at; i++)
    if (c->b.text[i] == '\n') {
      line++;
      start = i + 1;
    }
  c->b.failed = opc_fail(c->b.error, OPC_IO, NULL, "%s:%zu:%zu: %s (byte %zu)",
                         c->b.r->file, line, at - start + 1, what, at);
  c->at = c->b.n;
}

void cif_refuse(void *self, const char *what) {
  cif_refuse_at(self, ((cif *)self)->command, what);
}

static void read_file(void *self) {
  cif *c = self;
  cif_parse(c);
  if (c->b.failed) return;
  cif_make_cells(c);
  c->building = 1;
  if (!c->b.failed) cif_parse(c);
  c->b.top = cif_symbol_at(c, 0)->cell; /* or the called symbol */
  if (c->b.top < 0 && c->calls) c->b.top = c->called->cell;
}

static int cif_run(void *self, void **outputs, opc_error *error) {
  cif c = {.b.format = "CIF", .b.refuse = cif_refuse, .layer_number = -1};
  cif_open(&c);
  int code = reading_run(&c, self, outputs, error, read_file);
  cif_clear(&c);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {READ_PARAMETERS(
    "The CIF file", "Names for layers: { poly: CP }; the others keep theirs")};

static int cif_check(void *self, opc_error *error) {
  return reader_check(self, 0, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = cif_run,
                                   .flags = OPC_STEP_LIGHT};

static int cif_choices(void *self, const char *parameter,
                       void (*take)(void *data, const char *value), void *data,
                       opc_error *error) {
  (void)parameter;
  return reader_choices(self, &functions, take, data, error);
}

static const void *extension(const char *name) {
  static const opc_choices listed = {cif_choices};
  return strcmp(name, OPC_CHOICES) ? NULL : &listed;
}

OPC_PLUGIN(reader, .id = "read.cif", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause", .summary = "Read a CIF file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = cif_check,
           OPC_FUNCTIONS(functions), .extension = extension);
