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
  if (!reading_text(&c->b)) return;
  cif_parse(c);
  if (c->b.failed) return;
  cif_make_cells(c);
  c->building = 1;
  if (!c->b.failed) cif_parse(c);
  c->b.top =
      cif_symbol_at(c, 0)->cell; /* a called symbol may replace this cell */
  if (c->b.top < 0 && c->calls) c->b.top = c->called->cell;
}

static int cif_run(void *self, void **outputs, opc_error *error) {
  cif c = {.b.format = "CIF", .b.refuse = cif_refuse, .layer_number = -1};
  cif_open(&c);
  int code = reading_run(&c, self, outputs, error, read_file);
  cif_clear(&c);
  return code;
}

/* ---- entry ---- */

READER_FUNCTIONS(
    cif_run, 0, "The CIF file",
    "Layer names, as in { poly: CP }; other layers keep the names of the file")

OPC_PLUGIN(reader, .id = "read.cif", .summary = "Read a CIF file",
           READER_ENTRY);
