/* SPDX-License-Identifier: BSD-3-Clause */
/* read.oasis: an OASIS file as a layout. */
#include "oasis.h"

#include <stdlib.h>

/* ---- work ---- */

static int read_file(oasis *o) {
  const reader *r = o->r;
  if (layer_map_init(&o->layers, r, UINT32_MAX, o->error))
    return o->error->code;
  oasis_open(&o->s, r->host, r->file, o->error);
  o->s.told = 1;
  if (!o->s.failed) oasis_read(o);
  if (o->s.failed || layer_map_check(&o->layers, o->error))
    return o->error->code;
  cell_list_warn(&o->cells, r, o->layout);
  return reader_keep(r, o->layout, &o->cells, -1, o->error);
}

static int run(void *self, void **outputs, opc_error *error) {
  oasis o = {.r = self, .error = error};
  for (int i = 0; i < OASIS_NAMES; i++) o.names[i] = oasis_names_new();
  int code = read_file(&o);
  outputs[0] = o.layout;
  oasis_close(&o.s);
  for (int i = 0; i < OASIS_NAMES; i++) g_hash_table_unref(o.names[i]);
  layer_map_clear(&o.layers);
  free(o.cells.defined);
  oasis_modal_clear(&o.m);
  free(o.points);
  free(o.instance.s);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    READ_PARAMETERS("The OASIS file",
                    "Names for layers: { poly: 9/0 }, or 9 for every datatype; "
                    "the others are called 9/0")};

static int check(void *self, opc_error *error) {
  return layer_map_try(self, UINT32_MAX, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run};

OPC_PLUGIN(reader, .id = "read.oasis", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause", .summary = "Read an OASIS file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check,
           OPC_FUNCTIONS(functions));
