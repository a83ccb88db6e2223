/* SPDX-License-Identifier: BSD-3-Clause */
/* The waveforms of the outputs that deviate most, and the butterfly of the cell
   that does. */
#include <math.h>
#include <stdio.h>

#include "../../draw/chart.h"
#include "bench.h"

static const double paper_width = 1200, paper_height = 600;

static const char *const state_names[STATES] = {
    [NETLIST_DRAWN] = "drawn",
    [NETLIST_BEFORE] = "printed before correction",
    [NETLIST_AFTER] = "printed after correction"};
static const double dashes[STATES] = {[NETLIST_AFTER] = 6};

static rgb colour_of(int state) {
  return state == NETLIST_DRAWN    ? picture_ink
         : state == NETLIST_BEFORE ? picture_mask[OPC_POLY]
                                   : picture_mask[OPC_ACTIVE];
}

/* The paper, its title and the key. */
static int open_paper(paper *file, const bench *b, int format, const char *path,
                      chart *c, const char *title, const char *also,
                      opc_error *error) {
  int code = chart_open(file, b->host, format, path, paper_width, paper_height,
                        c, error);
  if (code) return code;
  double x = 80, y = 3.8 * c->font;
  c->top = 110;
  c->height = 410;
  chart_title(c, x, 1.8 * c->font, title);
  for (int s = 0; s < STATES; s++)
    if (b->has[s])
      x = chart_key(c, x, y, colour_of(s), dashes[s], state_names[s]);
  if (also) chart_key(c, x, y, picture_faint, 0, also);
  return OPC_OK;
}

/* ---- waveforms ---- */

/* From shortly before the inputs change to shortly after the last output is
   there. */
static void set_range(const bench *b, const arrival *a, double window,
                      chart *c) {
  double start = 1e12 * bench_start(b), slew = 1e12 * b->slew;
  double end = start + slew;
  for (int s = 0; s < STATES; s++) {
    double last = start + slew / 2 + 1e12 * (a->delay[s] + a->slope[s]);
    if (b->has[s] && last > end) end = last;
  }
  c->x0 = 0;
  c->x1 = fmin(end + 0.15 * (end - start), 1e12 * window);
  c->y0 = -0.1 * b->supply;
  c->y1 = 1.1 * b->supply;
}

static void draw_inputs(const bench *b, const patterns *p, transition t,
                        const chart *c) {
  double start = 1e12 * bench_start(b);
  double x[] = {0, start, start + 1e12 * b->slew, c->x1};
  for (size_t i = 0; i < b->inputs; i++) {
    int from = p->bit[t.from * b->inputs + i],
        to = p->bit[t.to * b->inputs + i];
    double y[] = {from * b->supply, from * b->supply, to * b->supply,
                  to * b->supply};
    if (from != to) chart_line(c, picture_faint, 2, 0, x, y, 4);
  }
}

static int draw_arrival(bench *b, const patterns *p, const delays *d,
                        size_t index, chart *c, opc_error *error) {
  const arrival *a = &d->arrival[index];
  transition t = p->transition[d->flip[a->flip]];
  char title[256];
  set_range(b, a, d->window[a->flip], c);
  snprintf(title, sizeof title, "%.60s %s, %.150s",
           b->circuit->net[b->output[a->output]], a->rises ? "rises" : "falls",
           patterns_say(b, p, t));
  chart_axes(c, title, "time, ps", "V");
  draw_inputs(b, p, t, c);
  for (int s = 0; s < STATES; s++) {
    wave w;
    if (!b->has[s]) continue;
    if (delays_wave(b, p, d, index, s, &w, error)) return error->code;
    for (size_t i = 0; i < w.count; i++) w.time[i] *= 1e12;
    chart_line(c, colour_of(s), 2.5, dashes[s], w.time, w.value, w.count);
  }
  picture_use(c->cairo, picture_ink);
  return OPC_OK;
}

int draw_delays(bench *b, const patterns *p, const delays *d, int format,
                const char *path, opc_error *error) {
  paper file;
  chart c;
  char title[256];
  snprintf(title, sizeof title, "%.120s: %s", b->circuit->name,
           b->has[NETLIST_AFTER] ? "the delays that deviate most"
                                 : "the longest delays");
  int code = open_paper(&file, b, format, path, &c, title, "input", error);
  if (code) return code;
  c.width = 460;
  for (int rises = 1; rises >= 0 && !code; rises--) {
    int64_t index = worst_arrival(d, b, rises);
    c.left = rises ? 90 : 690;
    if (index >= 0) code = draw_arrival(b, p, d, (size_t)index, &c, error);
  }
  return paper_close(&file, code, error);
}

/* ---- butterflies ---- */

static void draw_butterfly(const chart *c, const butterfly *f, double supply,
                           int state) {
  double at[SWEEP];
  rgb colour = colour_of(state);
  for (int i = 0; i < SWEEP; i++) at[i] = supply * i / (SWEEP - 1);
  chart_line(c, colour, 2, dashes[state], at, f->right, SWEEP);
  chart_line(c, colour, 2, dashes[state], f->up, at, SWEEP);
  for (int side = 0; side < 2; side++) {
    const double *k = f->corner[side];
    double x[] = {k[0], k[2], k[2], k[0], k[0]};
    double y[] = {k[1], k[1], k[3], k[3], k[1]};
    if (f->margin[side] > 0) chart_line(c, colour, 1.5, dashes[state], x, y, 5);
  }
}

static void put_margins(const chart *c, const bench *b, const margins *m,
                        size_t k, double x, double y) {
  char text[96];
  picture_use(c->cairo, picture_ink);
  for (int s = 0; s < STATES; s++) {
    if (!b->has[s]) continue;
    const double *margin = m->of[s][k].margin;
    snprintf(text, sizeof text, "%s: left %.1f mV, right %.1f mV",
             state_names[s], 1e3 * margin[0], 1e3 * margin[1]);
    chart_text(c, x, y, CHART_BEGIN, text);
    y += 1.5 * c->font;
  }
}

int draw_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 int format, const char *path, opc_error *error) {
  size_t k = worst_cell(b, count, m);
  const opc_circuit *circuit = b->circuit;
  paper file;
  chart c;
  char title[256], of_x[96], of_y[96];
  snprintf(title, sizeof title, "%.60s, cell %.90s", circuit->name,
           circuit->net[cells[k].q]);
  snprintf(of_x, sizeof of_x, "%.80s, V", circuit->net[cells[k].q]);
  snprintf(of_y, sizeof of_y, "%.80s, V", circuit->net[cells[k].qb]);
  int code = open_paper(&file, b, format, path, &c, title, NULL, error);
  if (code) return code;
  c.left = 90;
  c.width = c.height;
  c.x0 = c.y0 = 0;
  c.x1 = c.y1 = b->supply;
  /* Each printed one over the drawn one; or that alone. */
  int printed = b->has[NETLIST_BEFORE] || b->has[NETLIST_AFTER];
  for (int s = printed; s < (printed ? STATES : 1); s++) {
    if (!b->has[s]) continue;
    chart_axes(&c, state_names[s], of_x, of_y);
    draw_butterfly(&c, &m->of[0][k], b->supply, NETLIST_DRAWN);
    if (s) draw_butterfly(&c, &m->of[s][k], b->supply, s);
    picture_use(c.cairo, picture_ink);
    c.left += 560;
  }
  put_margins(&c, b, m, k, 720, 1.8 * c.font);
  return paper_close(&file, code, error);
}
