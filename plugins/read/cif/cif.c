/* SPDX-License-Identifier: BSD-3-Clause */
/* read.cif: a CIF 2.0 file as a layout. */
#include "cif.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* ---- work ---- */

int cif_refuse(cif *c, size_t at, opc_error *error, const char *what) {
  size_t line = 1, start = 0;
  for (size_t i = 0; i < at; i++)
    if (c->text[i] == '\n') {
      line++;
      start = i + 1;
    }
  return opc_fail(error, OPC_IO, NULL, "%s:%zu:%zu: %s (byte %zu)", c->r->file,
                  line, at - start + 1, what, at);
}

static int read_file(cif *c, opc_error *error) {
  if (reader_load(c->r, &c->text, &c->n, error) || cif_parse(c, error) ||
      cif_make_cells(c, error))
    return error->code;
  c->building = 1;
  if (cif_parse(c, error) || cif_check_layers(c, error)) return error->code;
  int32_t top = c->symbols[0].cell; /* or what the file calls */
  if (top < 0 && c->calls) top = c->symbols[c->called].cell;
  return reader_keep(c->r, c->layout, NULL, top, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const reader *r = self;
  cif c = {
      .r = r,
      .seen = eda_alloc(r->layers.count, 1),
      .numbers = g_hash_table_new_full(g_int64_hash, g_int64_equal, free, NULL),
      .layer_number = -1};
  int code = read_file(&c, error);
  outputs[0] = c.layout;
  g_hash_table_unref(c.numbers);
  for (size_t i = 0; i < c.n_symbols; i++) free(c.symbols[i].name);
  free(c.symbols);
  free(c.forgotten);
  free(c.text);
  free(c.layer);
  free(c.outer);
  free(c.points);
  free(c.word);
  free(c.seen);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {READ_PARAMETERS(
    "The CIF file", "Names for layers: { poly: CP }; the others keep theirs")};

static int check(void *self, opc_error *error) {
  const opc_map *map = &((reader *)self)->layers;
  for (size_t i = 0; i < map->count; i++)
    for (size_t j = 0; j < i; j++)
      if (!strcmp(map->pairs[i].value, map->pairs[j].value))
        return opc_fail(error, OPC_INVALID, "layers",
                        "'%s': layer %s is '%s' already", map->pairs[i].key,
                        map->pairs[i].value, map->pairs[j].key);
  return OPC_OK;
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run};

OPC_PLUGIN(reader, .id = "read.cif", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause", .summary = "Read a CIF file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check,
           OPC_FUNCTIONS(functions));
