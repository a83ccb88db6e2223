/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the CSV file of all transistors of a mask. The file is written
   strip by strip, so that memory does not grow with the number of
   transistors. */
#include <correct/report.h>

#include <eda/file.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct listing {
  const eda_mask *mask; /* the whole mask */
  FILE *file;
} listing;

static const char head[] =
    "transistor,cell,class,type,l (nm),w (nm),x (nm),y (nm),ion_after (%),"
    "ioff_after (%),area_after (%),leq_ion (nm),weq (nm),print\r\n";

/* Write a text, in quotes if necessary (RFC 4180). */
static void put_text(FILE *f, const char *text) {
  int quoted = strpbrk(text, ",\"\r\n") != NULL;
  if (quoted) (void)fputc('"', f);
  for (; *text; text++) {
    if (*text == '"') (void)fputc('"', f);
    (void)fputc(*text, f);
  }
  if (quoted) (void)fputc('"', f);
}

/* Write a comma and a number; only the comma for NAN. */
static void put_number(FILE *f, double number, int decimals) {
  if (isnan(number))
    (void)fputc(',', f);
  else
    (void)fprintf(f, ",%.*f", decimals, number);
}

static void put_row(const listing *t, const eda_gates *g, size_t i, size_t k) {
  const eda_mask *m = t->mask;
  const eda_performance *now = &m->after, *drawn = &m->design;
  double none = eda_print_failed(m->flags[k]) ? NAN : 0;
  char name[32];
  (void)snprintf(name, sizeof name, ":%u", g->number[i]);
  g_autofree char *full = g_strconcat(eda_gates_owner(g, i), name, NULL);
  put_text(t->file, full);
  (void)fputc(',', t->file);
  put_text(t->file, g->cell[i]);
  (void)fprintf(t->file, ",%zu,%s", k + 1, g->type[i] == EDA_PMOS ? "p" : "n");
  put_number(t->file, g->length[i], 1);
  put_number(t->file, g->width[i], 1);
  put_number(t->file, ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid, 1);
  put_number(t->file, ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid, 1);
  put_number(t->file, none + eda_deviation(now->ion[k], drawn->ion[k]), 3);
  put_number(t->file, none + eda_deviation(now->ioff[k], drawn->ioff[k]), 2);
  put_number(t->file, none + eda_deviation(now->area[k], drawn->area[k]), 2);
  put_number(t->file, none + now->leq_ion[k], 3);
  put_number(t->file, none + now->weq[k], 2);
  (void)fprintf(t->file, ",%s\r\n", correct_report_trouble(m->flags[k]));
}

static int put_part(void *data, const eda_mask_part *part, opc_error *error) {
  const listing *t = data;
  (void)error;
  for (size_t i = 0; i < part->mask->gates->count; i++) {
    size_t k = eda_mask_part_gate(part, i);
    if (k != UINT32_MAX) put_row(t, part->mask->gates, i, k);
  }
  return OPC_OK;
}

int correct_report_transistors(const opc_host *host, const eda_mask *mask,
                               const char *name, opc_error *error) {
  if (!name) return OPC_OK;
  const char *path = host->output_path(host, name, error);
  if (!path) return error->code;
  listing t = {mask, fopen(path, "wbe")};
  int code = OPC_OK;
  if (t.file) {
    (void)fputs(head, t.file);
    code = eda_mask_each_strip(mask, put_part, &t, error);
  }
  opc_error why;
  int closed = eda_file_close(t.file, path, NULL, code ? &why : error);
  return code ? code : closed;
}
