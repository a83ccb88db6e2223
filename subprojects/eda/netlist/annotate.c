/* SPDX-License-Identifier: BSD-3-Clause */
/* SPICE netlists with the printed sizes of transistors (thesis, section 3.3.3).
   A transistor line has the effective length for the current. The DLC of the
   model card corrects the length for the gate capacitance. */
#include <eda/netlist.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Step to which DLC is rounded, nm, so that transistors share model cards. The
   step changes the gate capacitance by 0.02 % at a length of 65 nm. */
#define DLC_STEP 0.01
#define LONGEST_DLC 1e4 /* nm; larger values are rejected */

/* ---- text ---- */

typedef struct writer {
  const eda_annotation *a;
  eda_annotated counts;
  FILE *out;
} writer;

/* Write a path with '.' instead of '/', as in simulators. */
static void put_name(writer *w, const char *name) {
  for (; *name; name++) fputc(*name == '/' ? '.' : *name, w->out);
}

static void put_net(writer *w, uint32_t net) {
  fputc(' ', w->out);
  put_name(w, w->a->circuit->net[net]);
}

/* ---- sizes ---- */

typedef struct sizes {
  double length, width; /* nm */
  long dlc;             /* DLC minus the DLC of the model card, in DLC_STEP */
} sizes;

static int device_refuse(const eda_annotation *a, const eda_device *d,
                         uint32_t gate, const char *what, opc_error *error) {
  const eda_gates *g = a->circuit->gates;
  return opc_fail(
      error, OPC_FAILED, NULL,
      "netlist device '%.100s' has no size: the gate '%.200s:%u' %s", d->name,
      *g->instance[gate] ? g->instance[gate] : g->cell[gate], g->number[gate],
      what);
}

/* Return the drawn size of a finger: the length in the netlist, and the share
   of the netlist's width in proportion to the finger's width in the layout. */
static sizes drawn_size(const eda_gates *g, const eda_device *d,
                        uint32_t gate) {
  double sum = 0;
  for (uint32_t i = 0; i < d->fingers; i++) sum += g->width[d->finger[i]];
  return (sizes){d->length, d->width * (g->width[gate] / sum), 0};
}

/* Set the printed size of a gate. The average length is gate area / width
   (thesis, equation 3.12). DLC increases by (leq_ion - average length) / 2
   (equation 3.11; LINT is part of the card's DLC). */
static int printed_size(const eda_annotation *a, const eda_device *d,
                        uint32_t gate, sizes *s, opc_error *error) {
  const eda_mask *m = a->mask;
  const eda_performance *p = a->state == EDA_BEFORE ? &m->before : &m->after;
  if (a->state == EDA_AFTER && m->flags[gate] & ~(uint32_t)EDA_PRINT_NOTES)
    return device_refuse(a, d, gate, "does not print well", error);
  s->length = p->leq_ion[gate];
  s->width = p->weq[gate];
  double mean = p->area[gate] / s->width;
  if (!(s->length > 0 && s->width > 0 && mean > 0) || isinf(s->length) ||
      isinf(s->width) || isinf(mean))
    return device_refuse(a, d, gate, "does not print", error);
  double dlc = (s->length - mean) / 2;
  if (fabs(dlc) > LONGEST_DLC)
    return device_refuse(a, d, gate, "does not print well", error);
  s->dlc = a->card[d->type] ? lround(dlc / DLC_STEP) : 0;
  return OPC_OK;
}

/* Return the sizes of all fingers of all devices in order (free()). If a size
   is unknown, set *error and return NULL. */
static sizes *all_sizes(const eda_annotation *a, opc_error *error) {
  const eda_circuit *c = a->circuit;
  size_t n = 0, at = 0;
  for (size_t i = 0; i < c->count; i++) n += c->device[i].fingers;
  sizes *all = eda_alloc(n, sizeof *all);
  for (size_t i = 0; i < c->count; i++)
    for (uint32_t k = 0; k < c->device[i].fingers; k++, at++) {
      const eda_device *d = &c->device[i];
      if (a->state == EDA_DRAWN) {
        all[at] = drawn_size(c->gates, d, d->finger[k]);
      } else if (printed_size(a, d, d->finger[k], &all[at], error)) {
        free(all);
        return NULL;
      }
    }
  return all;
}

/* ---- models ---- */

/* Write a model name: "nmos", "nmos_dlc12" (DLC 12 steps larger) or
   "nmos_dlcm7" (7 steps smaller). */
static void put_model_name(writer *w, const eda_device *d, long dlc) {
  const char *name = w->a->model[d->type];
  if (!name) name = d->model ? d->model : d->type == EDA_PMOS ? "pmos" : "nmos";
  fputs(name, w->out);
  if (dlc) fprintf(w->out, "_dlc%s%ld", dlc < 0 ? "m" : "", labs(dlc));
}

static void put_model(writer *w, int type, long dlc) {
  const eda_card *m = w->a->card[type];
  char name[200];
  snprintf(name, sizeof name, "%.150s_dlc%s%ld", w->a->model[type],
           dlc < 0 ? "m" : "", labs(dlc));
  eda_card_write(w->out, m, name, m->dlc + (double)dlc * DLC_STEP);
  w->counts.models++;
}

static int by_number(const void *a, const void *b) {
  long p = *(const long *)a, q = *(const long *)b;
  return (p > q) - (p < q);
}

/* Write a model card for each DLC that occurs. */
static void put_models(writer *w, int type, const sizes *all) {
  const eda_circuit *c = w->a->circuit;
  size_t n = 0, at = 0;
  long *list = eda_alloc(c->gates->count, sizeof *list);
  for (size_t i = 0; i < c->count; i++)
    for (uint32_t k = 0; k < c->device[i].fingers; k++, at++)
      if (c->device[i].type == type && all[at].dlc) list[n++] = all[at].dlc;
  qsort(list, n, sizeof *list, by_number);
  for (size_t i = 0; i < n; i++)
    if (!i || list[i] != list[i - 1]) put_model(w, type, list[i]);
  free(list);
}

/* ---- the netlist ---- */

/* Write a device name that begins with M, or with X if the model is a
   subcircuit. */
static void put_device_name(writer *w, const char *name) {
  int letter = name[0] & ~32;
  if (w->a->subcircuits)
    fputs(letter == 'X' ? "" : "X", w->out);
  else
    fputs(letter == 'M' ? "" : "M.", w->out);
  put_name(w, name);
}

static void put_sizes(writer *w, const sizes *s) {
  double unit = w->a->unit;
  if (unit > 0)
    fprintf(w->out, " w=%.9g l=%.9g\n", s->width / unit, s->length / unit);
  else
    fprintf(w->out, " w=%.9ge-9 l=%.9ge-9\n", s->width, s->length);
}

static void put_device(writer *w, const eda_device *d, const sizes *all) {
  for (uint32_t k = 0; k < d->fingers; k++) {
    put_device_name(w, d->name);
    if (k) fprintf(w->out, "_f%u", k + 1);
    put_net(w, d->drain);
    put_net(w, d->gate);
    put_net(w, d->source);
    put_net(w, d->bulk);
    fprintf(w->out, " ");
    put_model_name(w, d, all[k].dlc);
    put_sizes(w, &all[k]);
    w->counts.transistors++;
  }
}

static void put_all(writer *w, const sizes *all) {
  static const char *const states[] = {"drawn", "printed before correction",
                                       "printed after correction"};
  const eda_circuit *c = w->a->circuit;
  fprintf(w->out, "* %s: sizes as %s\n", c->name, states[w->a->state]);
  for (int type = 0; type < 2; type++)
    if (w->a->card[type]) put_models(w, type, all);
  fprintf(w->out, ".subckt ");
  put_name(w, c->name);
  for (size_t i = 0; i < c->ports; i++) {
    if (i % 12 == 11) fprintf(w->out, "\n+");
    put_net(w, c->port[i]);
  }
  fprintf(w->out, "\n");
  for (size_t i = 0; i < c->count; i++) {
    put_device(w, &c->device[i], all);
    all += c->device[i].fingers;
  }
  fprintf(w->out, ".ends\n");
}

char *eda_annotate(const eda_annotation *a, eda_annotated *counts,
                   opc_error *error) {
  sizes *all = all_sizes(a, error);
  char *text = NULL;
  size_t size;
  writer w = {.a = a};
  if (!all) return NULL;
  w.out = open_memstream(&text, &size);
  put_all(&w, all);
  fclose(w.out);
  free(all);
  if (counts) *counts = w.counts;
  return text;
}
