/* SPDX-License-Identifier: BSD-3-Clause */
#include "annotate_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* DLC is written in steps of 0.01 nm, so that transistors share their cards:
   0.02 % of the gate capacitance at 65 nm. */
#define DLC_STEP 0.01
#define LONGEST_DLC 1e4 /* nm */

/* ---- text ---- */

typedef struct writer {
  const opc_host *host;
  const netlist_annotation *a;
  netlist_counts *counts;
  opc_error *error;
  char *text;
  size_t used, room;
  int failed;
} writer;

static void put(writer *w, const char *format, ...) OPC_PRINTF(2, 3);
static void put(writer *w, const char *format, ...) {
  for (int again = 0; again < 2 && !w->failed; again++) {
    va_list args;
    va_start(args, format);
    int n = vsnprintf(w->text + w->used, w->room - w->used, format, args);
    va_end(args);
    if (n < 0) break;
    if ((size_t)n < w->room - w->used) {
      w->used += (size_t)n;
      return;
    }
    size_t room = 2 * w->room + (size_t)n + 1;
    char *more = w->host->alloc(w->host, room, 1);
    if (!more) break;
    memcpy(more, w->text, w->used);
    w->host->free(w->host, w->text);
    w->text = more;
    w->room = room;
  }
  if (!w->failed)
    w->host->fail(w->host, w->error, OPC_FAILED, NULL, "out of memory");
  w->failed = 1;
}

/* A path with dots, as the simulator's own paths have. */
static void put_name(writer *w, const char *name) {
  put(w, "%s", name);
  if (w->failed) return;
  for (char *s = w->text + w->used - strlen(name); *s; s++)
    if (*s == '/') *s = '.';
}

static void put_net(writer *w, uint32_t net) {
  put(w, " ");
  put_name(w, w->a->circuit->net[net]);
}

/* ---- sizes ---- */

typedef struct sizes {
  double length, width; /* nm */
  long dlc;             /* difference to the card's, in steps */
} sizes;

static int refuse(writer *w, const opc_device *d, uint32_t gate,
                  const char *what) {
  const opc_gates *g = w->a->circuit->gates;
  w->failed = 1;
  return w->host->fail(
      w->host, w->error, OPC_FAILED, NULL,
      "netlist device '%.100s' has no size: its gate '%.200s:%u' %s", d->name,
      *g->instance[gate] ? g->instance[gate] : g->cell[gate], g->number[gate],
      what);
}

/* As drawn: the netlist's, with the width shared out as the layout does. */
static sizes drawn(const opc_gates *g, const opc_device *d, uint32_t gate) {
  double sum = 0;
  for (uint32_t i = 0; i < d->fingers; i++) sum += g->width[d->finger[i]];
  return (sizes){d->length, d->width * (g->width[gate] / sum), 0};
}

/* Equation 3.12: the length that the capacitance sees; then 3.11, of which
   LINT stands in the card. */
static int printed(writer *w, const opc_device *d, uint32_t gate, sizes *s) {
  const opc_mask *m = w->a->mask;
  const opc_performance *p =
      w->a->state == NETLIST_BEFORE ? &m->before : &m->after;
  if (w->a->state == NETLIST_AFTER &&
      m->flags[gate] & ~(uint32_t)OPC_PRINT_NOTES)
    return refuse(w, d, gate, "does not print well");
  s->length = p->leq_ion[gate];
  s->width = p->weq[gate];
  double mean = p->area[gate] / s->width;
  if (!(s->length > 0 && s->width > 0 && mean > 0) || isinf(s->length) ||
      isinf(s->width) || isinf(mean))
    return refuse(w, d, gate, "does not print");
  double dlc = (s->length - mean) / 2;
  if (fabs(dlc) > LONGEST_DLC) return refuse(w, d, gate, "does not print well");
  s->dlc = w->a->card[d->type] ? lround(dlc / DLC_STEP) : 0;
  return OPC_OK;
}

/* ---- models ---- */

/* "nmos", "nmos_dlc12", "nmos_dlcm7": the card with that much more DLC. */
static void put_model_name(writer *w, int type, long dlc) {
  put(w, "%s", w->a->model[type]);
  if (dlc) put(w, "_dlc%s%ld", dlc < 0 ? "m" : "", labs(dlc));
}

static int is_plain(const char *value) {
  return !strpbrk(value, "+*/() ") ||
         strspn(value, "+-.0123456789eE") == strlen(value);
}

static void put_model(writer *w, int type, long dlc) {
  const netlist_model *m = w->a->card[type];
  put(w, ".model ");
  put_model_name(w, type, dlc);
  put(w, " %s dlc=%.9ge-9", m->kind, m->dlc + (double)dlc * DLC_STEP);
  for (size_t i = 0; i < m->count; i++) {
    const char *quote = is_plain(m->value[i]) ? "" : "'";
    put(w, "%s%s=%s%s%s", i % 6 ? " " : "\n+ ", m->key[i], quote, m->value[i],
        quote);
  }
  put(w, "\n");
  w->counts->models++;
}

static int by_number(const void *a, const void *b) {
  long p = *(const long *)a, q = *(const long *)b;
  return (p > q) - (p < q);
}

/* A card for each DLC that occurs. */
static void put_models(writer *w, int type, const sizes *all) {
  const opc_circuit *c = w->a->circuit;
  size_t n = 0, at = 0;
  long *list = w->host->alloc(w->host, c->gates->count, sizeof *list);
  if (!list) {
    w->failed = 1;
    w->host->fail(w->host, w->error, OPC_FAILED, NULL, "out of memory");
    return;
  }
  for (size_t i = 0; i < c->count; i++)
    for (uint32_t k = 0; k < c->device[i].fingers; k++, at++)
      if (c->device[i].type == type && all[at].dlc) list[n++] = all[at].dlc;
  qsort(list, n, sizeof *list, by_number);
  for (size_t i = 0; i < n; i++)
    if (!i || list[i] != list[i - 1]) put_model(w, type, list[i]);
  w->host->free(w->host, list);
}

/* ---- the netlist ---- */

static void put_device(writer *w, const opc_device *d, const sizes *all) {
  for (uint32_t k = 0; k < d->fingers; k++) {
    int path = d->name[0] != 'M' && d->name[0] != 'm';
    put(w, "%s", path ? "M." : "");
    put_name(w, d->name);
    if (k) put(w, "_f%u", k + 1);
    put_net(w, d->drain);
    put_net(w, d->gate);
    put_net(w, d->source);
    put_net(w, d->bulk);
    put(w, " ");
    put_model_name(w, d->type, all[k].dlc);
    put(w, " w=%.9ge-9 l=%.9ge-9\n", all[k].width, all[k].length);
    w->counts->transistors++;
  }
}

static void put_all(writer *w, const sizes *all) {
  static const char *const states[] = {"drawn", "printed before correction",
                                       "printed after correction"};
  const opc_circuit *c = w->a->circuit;
  put(w, "* %s: sizes as %s\n", c->name, states[w->a->state]);
  for (int type = 0; type < 2; type++)
    if (w->a->card[type]) put_models(w, type, all);
  put(w, ".subckt ");
  put_name(w, c->name);
  for (size_t i = 0; i < c->ports; i++) {
    if (i % 12 == 11) put(w, "\n+");
    put_net(w, c->port[i]);
  }
  put(w, "\n");
  for (size_t i = 0; i < c->count; i++) {
    put_device(w, &c->device[i], all);
    all += c->device[i].fingers;
  }
  put(w, ".ends\n");
}

char *netlist_annotate(const opc_host *host, const netlist_annotation *a,
                       netlist_counts *counts, opc_error *error) {
  const opc_circuit *c = a->circuit;
  writer w = {.host = host, .a = a, .counts = counts, .error = error};
  *counts = (netlist_counts){0};
  size_t n = 0, at = 0;
  for (size_t i = 0; i < c->count; i++) n += c->device[i].fingers;
  sizes *all = host->alloc(host, n + 1, sizeof *all);
  w.room = 1 << 16;
  w.text = host->alloc(host, w.room, 1);
  if (!all || !w.text) {
    w.failed = 1;
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  }
  for (size_t i = 0; i < c->count && !w.failed; i++)
    for (uint32_t k = 0; k < c->device[i].fingers && !w.failed; k++, at++) {
      const opc_device *d = &c->device[i];
      if (a->state == NETLIST_DRAWN)
        all[at] = drawn(c->gates, d, d->finger[k]);
      else
        printed(&w, d, d->finger[k], &all[at]);
    }
  if (!w.failed) put_all(&w, all);
  host->free(host, all);
  if (!w.failed) return w.text;
  host->free(host, w.text);
  return NULL;
}
