/* SPDX-License-Identifier: BSD-3-Clause */
/* read.cif: a CIF 2.0 file as a layout. */
#include "cif.h"
#include "../parameters.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

typedef struct reader {
  const opc_host *host;
  const opc_value *values;
} reader;

/* A port is released without its instance: the table that every host has. */
static const opc_layout_service *layouts;

/* ---- work ---- */

int cif_refuse(cif *c, size_t at, opc_error *error, const char *what) {
  size_t line = 1, start = 0;
  for (size_t i = 0; i < at; i++)
    if (c->text[i] == '\n') {
      line++;
      start = i + 1;
    }
  return c->host->fail(c->host, error, OPC_IO, NULL,
                       "%s:%zu:%zu: %s (byte %zu)", c->path, line,
                       at - start + 1, what, at);
}

int cif_no_memory(cif *c, opc_error *error) {
  return c->host->fail(c->host, error, OPC_FAILED, NULL, "'%s': out of memory",
                       c->path);
}

int cif_grow(void *array, size_t *room, size_t need, size_t size) {
  if (need <= *room) return 1;
  size_t wanted = need + need / 2 + 16;
  void *memory = realloc(*(void **)array, wanted * size);
  if (!memory) return 0;
  *(void **)array = memory;
  *room = wanted;
  return 1;
}

static int load(cif *c, opc_error *error) {
  FILE *file = fopen(c->path, "rb");
  if (!file)
    return c->host->fail(c->host, error, OPC_IO, NULL, "'%s': %s", c->path,
                         strerror(errno));
  size_t room = 0, got;
  int good;
  do {
    good = cif_grow(&c->text, &room, c->n + 65536, 1);
    got = good ? fread(c->text + c->n, 1, room - c->n, file) : 0;
    c->n += got;
  } while (got);
  int code = OPC_OK;
  if (!good)
    code = cif_no_memory(c, error);
  else if (ferror(file))
    code = c->host->fail(c->host, error, OPC_IO, NULL, "'%s': %s", c->path,
                         strerror(errno));
  fclose(file);
  return code;
}

/* The cell to keep: the one asked for, or what the file calls. */
static int keep_top(cif *c, const opc_value *asked, opc_error *error) {
  int32_t top = c->symbols[0].cell;
  if (top < 0 && c->calls) top = c->symbols[c->called].cell;
  if (asked->type != OPC_ABSENT) {
    top = layouts->find_cell(c->layout, asked->text);
    if (top < 0)
      return c->host->fail(c->host, error, OPC_INVALID, "top",
                           "'%s': there is no cell '%s'", c->path, asked->text);
  }
  return top < 0 ? OPC_OK : layouts->keep(c->layout, top, error);
}

static int read_file(cif *c, const opc_value *top, opc_error *error) {
  if (load(c, error) || cif_parse(c, error) || cif_make_cells(c, error))
    return error->code;
  c->building = 1;
  if (cif_parse(c, error) || cif_check_layers(c, error)) return error->code;
  return keep_top(c, top, error);
}

static void clear(cif *c) {
  cif_clear_numbers(c);
  for (size_t i = 0; i < c->n_symbols; i++) free(c->symbols[i].name);
  free(c->symbols);
  free(c->forgotten);
  free(c->text);
  free(c->layer);
  free(c->outer);
  free(c->points);
  free(c->word);
  free(c->seen);
  if (c->layout) layouts->destroy(c->layout);
}

static int run(void *self, void **outputs, opc_error *error) {
  const reader *r = self;
  cif c = {.host = r->host,
           .path = r->values[FILE_NAME].text,
           .layers = &r->values[LAYERS],
           .scale = r->values[SCALE].real,
           .layer_number = -1};
  c.seen = calloc(c.layers->count + 1, 1);
  int code =
      c.seen ? read_file(&c, &r->values[TOP], error) : cif_no_memory(&c, error);
  if (!code) {
    outputs[0] = c.layout;
    c.layout = NULL;
  }
  clear(&c);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {READ_PARAMETERS(
    "The CIF file", "Names for layers: { poly: CP }; the others keep theirs")};

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
  const opc_value *map = &values[LAYERS];
  for (size_t i = 0; i < map->count; i++)
    for (size_t j = 0; j < i; j++)
      if (!strcmp(map->pairs[i].value, map->pairs[j].value)) {
        host->fail(host, error, OPC_INVALID, "layers",
                   "'%s': layer %s is '%s' already", map->pairs[i].key,
                   map->pairs[i].value, map->pairs[j].key);
        return NULL;
      }
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
    .id = "read.cif",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Read a CIF file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
