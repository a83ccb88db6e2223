/* SPDX-License-Identifier: BSD-3-Clause */
/* read.oasis: an OASIS file as a layout. */
#include "oasis.h"
#include "../parameters.h"

#include <stdlib.h>

/* ---- state ---- */

typedef struct reader {
  const opc_host *host;
  const opc_value *values;
} reader;

/* A port is released without its instance: the table that every host has. */
static const opc_layout_service *layouts;

/* ---- work ---- */

static void clear(oasis *o) {
  oasis_close(&o->s);
  for (int i = 0; i < OASIS_NAMES; i++) oasis_names_clear(&o->names[i]);
  layer_map_clear(&o->layers);
  cell_list_clear(&o->cells);
  oasis_modal_clear(&o->m);
  free(o->points);
  free(o->instance.s);
  if (o->layout) layouts->destroy(o->layout);
}

static int finish(oasis *o) {
  const char *path = o->s.path;
  if (o->s.failed) return o->error->code;
  if (layer_map_check(&o->layers, path, o->error)) return o->error->code;
  cell_list_warn(&o->cells, o->host, o->layout, path);
  return cell_list_keep(&o->cells, o->host, o->layout, o->top, path, o->error);
}

static int run(void *self, void **outputs, opc_error *error) {
  const reader *r = self;
  oasis o = {.host = r->host,
             .top = &r->values[TOP],
             .scale = r->values[SCALE].real,
             .error = error};
  int code =
      layer_map_init(&o.layers, r->host, &r->values[LAYERS], UINT32_MAX, error);
  if (!code) {
    oasis_open(&o.s, r->host, r->values[FILE_NAME].text, error);
    o.s.told = 1;
    if (!o.s.failed) oasis_read(&o);
    code = finish(&o);
  }
  if (!code) {
    outputs[0] = o.layout;
    o.layout = NULL;
  }
  clear(&o);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    READ_PARAMETERS("The OASIS file",
                    "Names for layers: { poly: 9/0 }, or 9 for every datatype; "
                    "the others are called 9/0")};

static void release_layout(void *layout) { layouts->destroy(layout); }

static const opc_port outputs[] = {{"layout", "layout", release_layout}};

/* ---- entry ---- */

static void destroy(void *self) {
  reader *r = self;
  r->host->free(r->host, r);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  layouts = host->layout;
  layer_map layers;
  int code = layer_map_init(&layers, host, &values[LAYERS], UINT32_MAX, error);
  layer_map_clear(&layers);
  if (code) return NULL;
  reader *r = host->alloc(host, 1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  r->values = values;
  return r;
}

static const opc_step step = {.size = sizeof step,
                              .n_outputs = 1,
                              .port_size = sizeof(opc_port),
                              .outputs = outputs,
                              .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "read.oasis",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Read an OASIS file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
