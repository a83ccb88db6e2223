/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the output waveforms with the largest delay deviations, and the
   butterfly curves of the memory cell with the largest deviation. */
#include <eda/drawing.h>
#include <math.h>
#include <stdio.h>

#include "bench.h"

static const double paper_width = 1200, paper_height = 600, font = 15;

static const char *const state_names[EDA_STATES] = {
    [EDA_DRAWN] = "drawn",
    [EDA_BEFORE] = "printed before correction",
    [EDA_AFTER] = "printed after correction"};
static const double dashes[EDA_STATES] = {[EDA_AFTER] = 6};

static eda_colour colour_of(int state) {
  return state == EDA_DRAWN    ? eda_ink
         : state == EDA_BEFORE ? eda_layer_outline(EDA_POLY)
                               : eda_layer_outline(EDA_ACTIVE);
}

/* Open the paper with title and legend. Initialise a chart, except its
   horizontal position. */
static eda_paper *open_paper(const bench *b, const char *path, eda_chart *c,
                             const char *title, const char *also,
                             opc_error *error) {
  eda_paper *paper =
      eda_paper_open(path, paper_width, paper_height, font, error);
  eda_legend l;
  if (!paper) return NULL;
  *c = (eda_chart){.paper = paper, .top = 110, .height = 410};
  paper->margin = 80;
  eda_legend_init(&l, paper, font + eda_heading(paper, font / 2, title));
  eda_sign sign = {.kind = EDA_SIGN_LINE, .line = 2.5};
  for (int s = 0; s < EDA_STATES; s++) {
    sign.colour = colour_of(s);
    sign.dash = dashes[s];
    if (b->has[s]) eda_legend_add(&l, &sign, "%s", state_names[s]);
  }
  sign.colour = eda_faint;
  sign.dash = 0;
  if (also) eda_legend_add(&l, &sign, "%s", also);
  return paper;
}

/* ---- waveforms ---- */

/* Set the time range from shortly before the inputs change to shortly after the
   last output has settled. */
static void set_range(const bench *b, const arrival *a, double window,
                      eda_chart *c) {
  double start = 1e12 * bench_start(b), slew = 1e12 * b->slew;
  double end = start + slew;
  for (int s = 0; s < EDA_STATES; s++) {
    double last = start + slew / 2 + 1e12 * (a->delay[s] + a->slope[s]);
    if (b->has[s] && last > end) end = last;
  }
  c->x = (eda_axis){.low = 0,
                    .high = fmin(end + 0.15 * (end - start), 1e12 * window),
                    .title = "time, ps"};
  c->y = (eda_axis){
      .low = -0.1 * b->supply, .high = 1.1 * b->supply, .title = "V"};
}

static void draw_inputs(const bench *b, const patterns *p, transition t,
                        const eda_chart *c) {
  double start = 1e12 * bench_start(b);
  double x[] = {0, start, start + 1e12 * b->slew, c->x.high};
  for (size_t i = 0; i < b->inputs; i++) {
    int from = p->bit[t.from * b->inputs + i],
        to = p->bit[t.to * b->inputs + i];
    double y[] = {from * b->supply, from * b->supply, to * b->supply,
                  to * b->supply};
    if (from != to) eda_chart_line(c, eda_faint, 2, 0, x, y, 4);
  }
}

static int draw_arrival(bench *b, const patterns *p, const delays *d,
                        size_t index, eda_chart *c, opc_error *error) {
  const arrival *a = &d->arrival[index];
  transition t = p->transition[d->flip[a->flip]];
  char title[256];
  set_range(b, a, d->window[a->flip], c);
  snprintf(title, sizeof title, "%.60s %s, %.150s",
           b->circuit->net[b->output[a->output]], a->rises ? "rises" : "falls",
           patterns_say(b, p, t));
  c->title = title;
  eda_chart_axes(c);
  c->title = NULL;
  draw_inputs(b, p, t, c);
  for (int s = 0; s < EDA_STATES; s++) {
    wave w;
    if (!b->has[s]) continue;
    if (delays_wave(b, p, d, index, s, &w, error)) return error->code;
    for (size_t i = 0; i < w.count; i++) w.time[i] *= 1e12;
    eda_chart_line(c, colour_of(s), 2.5, dashes[s], w.time, w.value, w.count);
  }
  return OPC_OK;
}

int draw_delays(bench *b, const patterns *p, const delays *d, const char *path,
                opc_error *error) {
  eda_chart c;
  char title[256];
  snprintf(title, sizeof title, "%.120s: %s", b->circuit->name,
           b->has[EDA_AFTER] ? "delays with the largest deviations"
                             : "the longest delays");
  eda_paper *paper = open_paper(b, path, &c, title, "input", error);
  if (!paper) return error->code;
  c.width = 460;
  int code = OPC_OK;
  for (int rises = 1; rises >= 0 && !code; rises--) {
    int64_t index = worst_arrival(d, b, rises);
    c.left = rises ? 90 : 690;
    if (index >= 0) code = draw_arrival(b, p, d, (size_t)index, &c, error);
  }
  return eda_paper_close(paper, code, error);
}

/* ---- butterflies ---- */

static void draw_butterfly(const eda_chart *c, const butterfly *f,
                           double supply, int state) {
  double at[SWEEP];
  eda_colour colour = colour_of(state);
  for (int i = 0; i < SWEEP; i++) at[i] = supply * i / (SWEEP - 1);
  eda_chart_line(c, colour, 2, dashes[state], at, f->right, SWEEP);
  eda_chart_line(c, colour, 2, dashes[state], f->up, at, SWEEP);
  for (int side = 0; side < 2; side++) {
    const double *k = f->corner[side];
    double x[] = {k[0], k[2], k[2], k[0], k[0]};
    double y[] = {k[1], k[1], k[3], k[3], k[1]};
    if (f->margin[side] > 0)
      eda_chart_line(c, colour, 1.5, dashes[state], x, y, 5);
  }
}

static void put_margins(const eda_paper *paper, const bench *b,
                        const margins *m, size_t k) {
  double y = 1.8 * font;
  for (int s = 0; s < EDA_STATES; s++) {
    char text[96];
    if (!b->has[s]) continue;
    const double *margin = m->of[s][k].margin;
    snprintf(text, sizeof text, "%s: left %.1f mV, right %.1f mV",
             state_names[s], 1e3 * margin[0], 1e3 * margin[1]);
    eda_text(paper, 720, y, EDA_LEFT, INFINITY, text);
    y += 1.5 * font;
  }
}

int draw_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 const char *path, opc_error *error) {
  size_t k = worst_cell(b, count, m);
  const eda_circuit *circuit = b->circuit;
  eda_chart c;
  char title[256], of_x[96], of_y[96];
  snprintf(title, sizeof title, "%.60s, cell %.90s", circuit->name,
           circuit->net[cells[k].q]);
  snprintf(of_x, sizeof of_x, "%.80s, V", circuit->net[cells[k].q]);
  snprintf(of_y, sizeof of_y, "%.80s, V", circuit->net[cells[k].qb]);
  eda_paper *paper = open_paper(b, path, &c, title, NULL, error);
  if (!paper) return error->code;
  c.left = 90;
  c.width = c.height;
  c.x = (eda_axis){.high = b->supply, .title = of_x};
  c.y = (eda_axis){.high = b->supply, .title = of_y};
  /* Draw one chart for each set of printed sizes, with the drawn curve behind
     the printed curve. If there is no printed curve, draw only the drawn
     curve. */
  int printed = b->has[EDA_BEFORE] || b->has[EDA_AFTER];
  for (int s = printed; s < (printed ? EDA_STATES : 1); s++) {
    if (!b->has[s]) continue;
    c.title = state_names[s];
    eda_chart_axes(&c);
    draw_butterfly(&c, &m->of[0][k], b->supply, EDA_DRAWN);
    if (s) draw_butterfly(&c, &m->of[s][k], b->supply, s);
    c.left += 560;
  }
  put_margins(paper, b, m, k);
  return eda_paper_close(paper, OPC_OK, error);
}
