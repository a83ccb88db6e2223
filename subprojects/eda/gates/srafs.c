/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows of sub-resolution assist features (scatter bars) parallel to edges. Each
   edge and row has a proposed bar; regions near drawn shapes and near placed
   scatter bars are subtracted from the bar. */
#include <eda/index.h>
#include <eda/memory.h>
#include <eda/srafs.h>
#include <math.h>
#include <stdlib.h>

/* ---- boxes ---- */

static int32_t length_of(eda_box b) {
  int32_t w = b.x1 - b.x0, h = b.y1 - b.y0;
  return w > h ? w : h;
}

/* ---- placement ---- */

/* A scatter bar before subtraction. */
typedef struct proposal {
  eda_box box;
  uint32_t number; /* position in the list of all proposals */
  uint8_t upright;
  size_t first,
      end; /* placed parts: indices first .. end - 1 of planner.srafs */
} proposal;

typedef struct planner {
  const eda_sraf_edge *edges;
  size_t edge_count;
  const eda_sraf_rule *rule;
  proposal *proposals;
  size_t count;
  eda_index *of_drawn, *of_proposals;
  eda_box *drawn; /* rectangles of the drawn shapes */
  size_t drawn_count;
  eda_box_list parts, next; /* parts of the current proposal; `next` receives
                               the parts after a subtraction */
  eda_box_list srafs;
} planner;

/* Return the proposed bar beside edge `e` in row `row`; row 0 is nearest to the
   edge. */
static proposal proposal_of(const planner *p, const eda_sraf_edge *e, int row) {
  const eda_sraf_rule *r = p->rule;
  int32_t near = r->distance + row * (r->width + r->space);
  int32_t low = e->low - r->overhang, high = e->high + r->overhang;
  int32_t from = e->sign > 0 ? e->at + near : e->at - near - r->width;
  proposal w = {.upright = e->upright};
  w.box = w.upright ? (eda_box){from, low, from + r->width, high}
                    : (eda_box){low, from, high, from + r->width};
  return w;
}

/* Subtract `keep_out` from all parts, over the full width of the bar. */
static void cut_parts(planner *p, eda_box keep_out, int upright) {
  p->next.count = 0;
  for (size_t i = 0; i < p->parts.count; i++) {
    eda_box b = p->parts.box[i], low = b, high = b;
    if (!eda_boxes_overlap(b, keep_out)) {
      eda_box_list_add(&p->next, b);
      continue;
    }
    if (upright)
      low.y1 = keep_out.y0, high.y0 = keep_out.y1;
    else
      low.x1 = keep_out.x0, high.x0 = keep_out.x1;
    if (low.y1 > low.y0 && low.x1 > low.x0) eda_box_list_add(&p->next, low);
    if (high.y1 > high.y0 && high.x1 > high.x0)
      eda_box_list_add(&p->next, high);
  }
  eda_box_list t = p->parts;
  p->parts = p->next;
  p->next = t;
}

/* Subtract the drawn shapes near a proposal, enlarged by the allowed distance,
   from the parts. */
static void cut_by_drawn(planner *p, const proposal *w) {
  int32_t off = p->rule->distance;
  eda_finder f = eda_index_find(p->of_drawn, eda_box_grown(w->box, off));
  for (uint32_t i; eda_index_next(&f, &i);)
    cut_parts(p, eda_box_grown(p->drawn[i], off), w->upright);
}

/* Subtract the placed scatter bars near a proposal, enlarged by the allowed
   space, from the parts. */
static void cut_by_srafs(planner *p, const proposal *w) {
  int32_t off = p->rule->space;
  eda_finder f = eda_index_find(p->of_proposals, eda_box_grown(w->box, off));
  for (uint32_t i; eda_index_next(&f, &i);)
    for (size_t n = p->proposals[i].first; n < p->proposals[i].end; n++)
      cut_parts(p, eda_box_grown(p->srafs.box[n], off), w->upright);
}

/* Place the parts of a proposal that have the minimum length after
   subtraction. */
static void planner_place(planner *p, proposal *w) {
  p->parts.count = 0;
  w->first = w->end = p->srafs.count;
  eda_box_list_add(&p->parts, w->box);
  cut_by_drawn(p, w);
  cut_by_srafs(p, w);
  for (size_t i = 0; i < p->parts.count; i++)
    if (length_of(p->parts.box[i]) >= p->rule->min_length)
      eda_box_list_add(&p->srafs, p->parts.box[i]);
  w->end = p->srafs.count;
}

/* Order proposals by row (held in `first` until placement), then by decreasing
   length. */
static int by_rank(const void *a, const void *b) {
  const proposal *p = *(const proposal *const *)a,
                 *q = *(const proposal *const *)b;
  if (p->first != q->first) return p->first < q->first ? -1 : 1;
  int32_t m = length_of(p->box), n = length_of(q->box);
  if (m != n) return m > n ? -1 : 1;
  return (p->number > q->number) - (p->number < q->number);
}

static void place_all(planner *p) {
  proposal **order = eda_alloc(p->count, sizeof(proposal *));
  for (size_t i = 0; i < p->count; i++) order[i] = &p->proposals[i];
  qsort(order, p->count, sizeof(proposal *), by_rank);
  for (size_t i = 0; i < p->count; i++)
    p->proposals[i].first = p->proposals[i].end = 0;
  for (size_t i = 0; i < p->count; i++) planner_place(p, order[i]);
  free(order);
}

static void make_proposals(planner *p) {
  size_t capacity = p->edge_count * (size_t)p->rule->rows;
  p->proposals = eda_alloc(capacity, sizeof *p->proposals);
  eda_box *all = eda_alloc(capacity, sizeof *all);
  for (int row = 0; row < p->rule->rows; row++)
    for (size_t e = 0; e < p->edge_count; e++) {
      proposal w = proposal_of(p, &p->edges[e], row);
      w.number = (uint32_t)p->count;
      w.first = (size_t)row; /* row number, for by_rank */
      all[p->count] = w.box;
      p->proposals[p->count++] = w;
    }
  p->of_proposals = eda_index_new(all, p->count, p->rule->distance);
  free(all);
}

int eda_srafs_place(const eda_sraf_edge *edges, size_t n,
                    const eda_sraf_rule *rule, const eda_shapes *drawn,
                    eda_box_list *out, opc_error *error) {
  planner p = {.edges = edges, .edge_count = n, .rule = rule};
  if (!rule->rows) return OPC_OK;
  int code = eda_fracture(drawn, &p.drawn, &p.drawn_count, error);
  if (code) return code;
  p.of_drawn = eda_index_new(p.drawn, p.drawn_count, rule->distance);
  make_proposals(&p);
  place_all(&p);
  free(p.drawn);
  free(p.proposals);
  free(p.parts.box);
  free(p.next.box);
  eda_index_free(p.of_drawn);
  eda_index_free(p.of_proposals);
  *out = p.srafs;
  return OPC_OK;
}

/* ---- scatter bars that print ---- */

/* Spacing of the points at which a bar is tested, nm. The optics do not resolve
   structures below 100 nm. Half and twice the value reject the same scatter
   bars. */
static const double sraf_step = 10;

/* Return the maximum of the level set on a bar, from points spaced at most
   sraf_step. */
static double bar_maximum(const eda_field *print, eda_box b, double grid) {
  double x0 = b.x0 * grid, y0 = b.y0 * grid, w = b.x1 * grid - x0,
         h = b.y1 * grid - y0, most = -INFINITY;
  int nx = (int)ceil(w / sraf_step), ny = (int)ceil(h / sraf_step);
  for (int j = 0; j <= ny; j++)
    for (int i = 0; i <= nx; i++) {
      double x = x0 + w * i / nx, y = y0 + h * j / ny, value;
      eda_field_sample(print, &x, &y, 1, &value);
      most = fmax(most, value);
    }
  return most;
}

typedef struct bars_task {
  const eda_box_list *srafs;
  const eda_field *print;
  double grid, margin;
  uint8_t *bad;
} bars_task;

static void look_at_bar(void *data, size_t i) {
  const bars_task *j = data;
  j->bad[i] = bar_maximum(j->print, j->srafs->box[i], j->grid) > -j->margin;
}

/* Return an array (free()): 1 for each bar whose level set exceeds -margin,
   otherwise 0. */
static uint8_t *find_bright(const opc_context *context,
                            const eda_box_list *srafs, const eda_field *print,
                            double grid, double margin) {
  bars_task j = {srafs, print, grid, margin, eda_alloc(srafs->count, 1)};
  opc_parallel(context, srafs->count, look_at_bar, &j);
  return j.bad;
}

size_t eda_srafs_drop(const opc_context *context, eda_box_list *srafs,
                      const eda_field *print, double grid, double margin) {
  size_t all = srafs->count, kept = 0;
  if (!all) return 0;
  uint8_t *bad = find_bright(context, srafs, print, grid, margin);
  for (size_t i = 0; i < all; i++)
    if (!bad[i]) srafs->box[kept++] = srafs->box[i];
  srafs->count = kept;
  free(bad);
  return all - kept;
}

size_t eda_srafs_narrow(const opc_context *context, eda_box_list *srafs,
                        const eda_field *print, double grid, double margin,
                        int32_t by, int32_t least, size_t *dropped) {
  size_t all = srafs->count, kept = 0, changed = 0;
  if (!all) return 0;
  uint8_t *bad = find_bright(context, srafs, print, grid, margin);
  for (size_t i = 0; i < all; i++) {
    eda_box b = srafs->box[i];
    if (bad[i]) {
      int upright = b.x1 - b.x0 < b.y1 - b.y0;
      changed++;
      *(upright ? &b.x0 : &b.y0) += by;
      *(upright ? &b.x1 : &b.y1) -= by;
      if ((upright ? b.x1 - b.x0 : b.y1 - b.y0) < least) continue;
    }
    srafs->box[kept++] = b;
  }
  srafs->count = kept;
  *dropped += all - kept;
  free(bad);
  return changed;
}
