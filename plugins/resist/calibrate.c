/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the calibration of a resist threshold: the threshold at which one
   anchor line prints to size, or the least-squares fit to a table of lines. */
#include "calibrate.h"

#include <eda/csv.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drawn.h"

/* ---- values of the flow ---- */

enum { MAX_LINES = 1000 };

static const char *const set_name[RESIST_SETS] = {"poly", "active"};
static const char *const sources[RESIST_SETS][3] = {
    {"anchor", "table", "table_file"},
    {"active_anchor", "active_table", "active_table_file"}};

/* Upper limit of line widths and pitches, nm: a hundred times the range of
   optical interaction. Larger values make the calibration slow, and at 2 mm the
   coordinates of lines overflow. */
static const double most = 1e5;

static const char too_far[] = "lines and pitches must be at most 100 um";

static int is_far(const resist_line *l) {
  return fmax(l->pitch, fmax(l->line, l->cd)) > most;
}

/* Return the fault of a line as a text, or NULL if the line is valid. */
static const char *line_fault(const resist_line *l) {
  if (is_far(l)) return too_far;
  if (!(l->line > 0 && l->cd > 0)) return "widths must be above 0";
  if (!(l->pitch >= 0)) return "a pitch must be 0 (isolated) or above";
  if (l->pitch > 0 && fmax(l->line, l->cd) >= l->pitch)
    return "no space remains between the lines";
  return NULL;
}

/* Return 1 if the line or the pitch of the anchor is not given. */
static int anchor_is_open(const resist_layer *r) {
  return isnan(r->anchor.line) || isnan(r->anchor.pitch);
}

static int take_table(resist_layer *r, opc_error *error) {
  const opc_reals *table = &r->table;
  if (table->count < 2 || table->count % 2 || table->count > 2 * MAX_LINES)
    return opc_fail(
        error, OPC_INVALID, r->source,
        "'%s' has %zu numbers, expected pairs of a pitch and a width",
        r->source, table->count);
  r->count = table->count / 2;
  r->lines = eda_alloc(r->count, sizeof *r->lines);
  for (size_t i = 0; i < r->count; i++) {
    const double *pair = table->values + 2 * i;
    double line = isnan(r->anchor.line) ? pair[1] : r->anchor.line;
    r->lines[i] = (resist_line){line, pair[0], pair[1]};
    const char *why = line_fault(&r->lines[i]);
    if (why)
      return opc_fail(error, OPC_INVALID, r->source,
                      "pair %zu of '%s', (%g nm, %g nm): %s", i + 1, r->source,
                      pair[0], pair[1], why);
    r->lines[i].line = r->anchor.line; /* may be NAN: the width of the anchor
                                          line, not yet known */
  }
  return OPC_OK;
}

int resist_layer_check(resist_layer *r, int set, opc_error *error) {
  const char *const *names = sources[set];
  resist_line *a = &r->anchor;
  r->set = set;
  r->source = names[r->file ? 2 : r->table_given];
  if (isnan(a->cd) && !anchor_is_open(r)) a->cd = a->line;
  if (r->table_given && r->file)
    return opc_fail(error, OPC_INVALID, names[2],
                    "'%s' and '%s' exclude each other", names[1], names[2]);
  if (r->file) return OPC_OK;
  if (r->table_given) return take_table(r, error);
  r->lines = eda_alloc(1, sizeof *r->lines);
  r->count = 1;
  *r->lines = *a;
  if (anchor_is_open(r)) return OPC_OK;
  if (is_far(a))
    return opc_fail(error, OPC_INVALID, r->source, "'%s': %s", r->source,
                    too_far);
  if (a->pitch > 0 && fmax(a->line, a->cd) >= a->pitch)
    return opc_fail(error, OPC_INVALID, r->source,
                    "'%s' has no space between the lines: %g nm every %g nm",
                    r->source, fmax(a->line, a->cd), a->pitch);
  return OPC_OK;
}

static void layer_clear(resist_layer *layer) {
  free(layer->lines);
  layer->lines = NULL;
  layer->count = 0;
}

void resist_clear(void *self) {
  resist_base *r = self;
  for (int set = 0; set < RESIST_SETS; set++) layer_clear(&r->layer[set]);
}

int resist_layer_has_table(const resist_layer *layer) {
  return layer->source != sources[layer->set][0];
}

/* ---- default anchor, from the layout or the optics ---- */

void resist_take_gates(void *self, const eda_gates *gates) {
  resist_base *r = self;
  r->layer[0].drawn = gates;
}

/* Default anchor without a layout: 65 nm at a pitch of 250 nm for 193 nm, NA
   0.75 (thesis 3.3). */
static const char least_line[] = "0.2526 lambda/NA",
                  least_pitch[] = "0.9715 lambda/NA";

/* Default anchor of active: a line so wide that its edges do not interact, 1 um
   at 193 nm, NA 0.75. */
static const char wide_line[] = "3.886 lambda/NA";

/* Smallest k1 (half-pitch or line over wavelength / NA) of printable dense
   lines (B. J. Lin; source in eda/natural.h). */
static const double least_k1 = 0.25;

/* Limits of the ratio of the shortest gate length to the anchor line. Beyond
   the limits, a warning states that the anchor probably belongs to another
   process. Thick-oxide gates are up to 2.2 times as long as the anchor of their
   process (GF180MCU: 600 and 280 nm). The limits have no published source. */
static const double longer = 2.25, shorter = 0.8;

static void drawn_log(const resist_base *r, const char *id, resist_line a,
                      const resist_drawn *d, int guessed) {
  r->host->log(r->host, OPC_LOG_INFO,
               "%s: anchor: %g nm lines at %g nm, from the layout's gates (%zu "
               "of the shortest; %zu of %zu pitches between them)",
               id, a.line, a.pitch, d->gates, d->equal, d->pitches);
  if (guessed)
    r->host->log(r->host, OPC_LOG_WARNING,
                 "%s: no gate of %g nm has a neighbour: the anchor's pitch is "
                 "assumed to be three lines",
                 id, d->line);
}

/* Return the default anchor of poly for a layout that is unknown or has no
   transistors. This anchor depends on the optics only. */
static resist_drawn drawn_default(const resist_base *r, const char *id,
                                  eda_scanner scanner) {
  resist_drawn d = {.line = eda_natural(&scanner, least_line),
                    .pitch = eda_natural(&scanner, least_pitch)};
  char whence[128];
  if (r->layer[0].logged) return d;
  eda_natural_text(scanner, whence, sizeof whence);
  r->host->log(r->host, OPC_LOG_WARNING,
               "%s: 'anchor' is not set and no whole layout defines one: %g nm "
               "lines at %g nm, %s; set 'anchor' in numbers",
               id, d.line, d.pitch, whence);
  return d;
}

/* Set the drawn width of all lines of a layer, and check the lines. */
static int set_line(resist_layer *r, double line, opc_error *error) {
  for (size_t i = 0; i < r->count && !r->file; i++) {
    r->lines[i].line = line;
    const char *why = line_fault(&r->lines[i]);
    if (why)
      return opc_fail(error, OPC_INVALID, r->source,
                      "'%s', lines of %g nm at %g nm: %s", r->source, line,
                      r->lines[i].pitch, why);
  }
  return OPC_OK;
}

/* Set the values of poly's anchor that are not given to those of the gates of
   the layout. */
static int anchor_take_drawn(const resist_base *resist, resist_layer *r,
                             const char *id, eda_scanner scanner,
                             opc_error *error) {
  resist_drawn d;
  resist_line a = r->anchor;
  int anchor = !resist_layer_has_table(r);
  const eda_gates *gates = r->gates ? r->gates : r->drawn;
  if (!anchor && !isnan(a.line)) return OPC_OK;
  int found = gates && resist_drawn_of(gates, &d);
  if (!found && r->gates)
    return opc_fail(
        error, OPC_INVALID, "anchor.gates",
        "no transistor defines the anchor; set 'anchor' in numbers");
  if (!found) d = drawn_default(resist, id, scanner);
  int guessed = found && anchor && isnan(a.pitch) && !d.pitches;
  if (isnan(a.line)) r->anchor.line = a.line = d.line;
  if (isnan(a.pitch)) a.pitch = d.pitch;
  if (isnan(a.cd)) a.cd = a.line;
  if (anchor) *r->lines = a;
  int code = set_line(r, a.line, error);
  if (found && !code) drawn_log(resist, id, a, &d, guessed);
  return code;
}

/* Set the default anchor of active: an isolated wide line. */
static int anchor_take_wide(resist_layer *r, eda_scanner scanner,
                            opc_error *error) {
  resist_line *a = &r->anchor;
  a->line = eda_natural(&scanner, wide_line);
  if (isnan(a->cd)) a->cd = a->line;
  if (!resist_layer_has_table(r)) *r->lines = *a;
  return set_line(r, a->line, error);
}

/* Log a warning if the anchor does not suit the optics or the layout. */
static void anchor_warn(const resist_base *resist, const resist_layer *r,
                        const char *id, eda_scanner scanner) {
  const opc_host *host = resist->host;
  double line = r->lines->line, k1 = line / eda_natural_unit(scanner);
  resist_drawn d;
  if (resist_layer_has_table(r)) return;
  if (scanner.na > 0 && k1 < least_k1)
    host->log(
        host, OPC_LOG_WARNING,
        "%s: 'anchor': %g nm are %.2f of wavelength / NA; dense lines do not "
        "print below %g: check that the anchor belongs to these optics",
        id, line, k1, least_k1);
  if (!r->drawn || !resist_drawn_of(r->drawn, &d)) return;
  if (d.line > longer * line || d.line < shorter * line)
    host->log(host, OPC_LOG_WARNING,
              "%s: 'anchor' is a line of %g nm, but the shortest gate of the "
              "layout has %g nm: check that the anchor belongs to this process",
              id, line, d.line);
}

static int anchor_publish(const resist_base *resist, const resist_layer *r,
                          opc_error *error) {
  const opc_metric_value values[] = {{"anchor_line", r->lines->line},
                                     {"anchor_pitch", r->lines->pitch}};
  if (resist_layer_has_table(r)) return OPC_OK;
  return opc_put_metrics(resist->host, OPC_ARRAY(values), error);
}

/* ---- tables in files ---- */

enum { LINE, PITCH, CD, COLUMNS };
static const eda_csv_column columns[COLUMNS] = {
    [LINE] = {.name = "line", .unit = "nm", .optional = 1},
    [PITCH] = {.name = "pitch", .unit = "nm"},
    [CD] = {.name = "cd", .unit = "nm"}};

static int read_row(const eda_csv *table, size_t row, resist_line *l,
                    opc_error *error) {
  int code = eda_csv_number(table, row, PITCH, -INFINITY, &l->pitch, error);
  if (!code) code = eda_csv_number(table, row, CD, -INFINITY, &l->cd, error);
  if (!code && eda_csv_has(table, LINE))
    code = eda_csv_number(table, row, LINE, -INFINITY, &l->line, error);
  const char *why = code ? NULL : line_fault(l);
  return why ? eda_csv_fail(table, row, PITCH, why, error) : code;
}

static int read_table(resist_layer *l, opc_error *error) {
  eda_csv *table = eda_csv_read(l->file, l->source, columns, COLUMNS, 0, error);
  if (!table) return error->code;
  size_t rows = eda_csv_rows(table);
  int code = OPC_OK;
  if (rows > MAX_LINES)
    code = eda_csv_fail(table, MAX_LINES, PITCH, "too many rows, here:", error);
  l->lines = eda_alloc(rows, sizeof *l->lines);
  for (; l->count < rows && !code; l->count++) {
    l->lines[l->count].line = l->anchor.line;
    code = read_row(table, l->count, &l->lines[l->count], error);
  }
  eda_csv_free(table);
  return code;
}

/* ---- images of lines ---- */

/* A line that is simulated: its image, and the terms 1, 2, ... computed from
   the image. */
typedef struct specimen {
  const resist_line *want;
  eda_field image, term[RESIST_TERMS - 1];
  double edge; /* half the printed width, nm */
} specimen;

typedef struct fitting {
  const resist_base *resist;
  const resist_layer *layer;
  const opc_module *litho;
  const char *id; /* id of the plugin, for messages */
  resist_terms *terms;
  specimen *specimens;
  size_t n; /* number of terms */
  const int *fit;
  double sign; /* -1: bright features print */
} fitting;

/* Unit of a line's coordinates, nm. */
static const double unit = 1e-3;

/* Space between copies of an isolated line, nm. */
static const double isolation = 4000;

/* Error of the images of lines, relative to the clear field; one of the errors
   of accurate simulations (correct/fine.c), so that kernels are reused. If the
   error is halved, thresholds change by 4e-6 of the clear field, and the width
   of a line by 0.05 pm. */
static const double image_error = 1e-4;

/* Compute the image of a vertical line. The line has the height of the frame,
   and its centre is at x = 0, the centre of the frame. */
static int image_line(const fitting *f, const resist_line *l, eda_field *field,
                      opc_error *error) {
  const opc_module *litho = f->litho;
  const eda_litho *model = litho->functions;
  const opc_context *context = f->resist->host->context;
  double period = l->pitch > 0 ? l->pitch : l->line + isolation;
  eda_frame frame = {-period / 2, 0, period, period};
  int32_t x = (int32_t)lround(l->line / 2 / unit);
  int32_t top = (int32_t)lround(period / unit);
  eda_point points[4] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[2] = {0, 4};
  eda_shapes line = {.count = 1, .start = start, .points = points};
  eda_spectrum mask;
  int code =
      eda_litho_spectrum(context, litho, &line, unit, frame, &mask, error);
  if (code) return code;
  /* image_fine is optional and more accurate. */
  code = model->image_fine
             ? model->image_fine(litho->self, f->layer->set, &mask, 0,
                                 image_error, field, error)
             : model->image(litho->self, f->layer->set, &mask, field, error);
  eda_spectrum_clear(&mask);
  if (code) return code;
  return eda_field_diffuse(context, field, f->resist->diffusion, error);
}

/* Return the level set of the resist at x, its slope, and the terms at x. */
static double specimen_level(const fitting *f, const specimen *s,
                             const double *a, double x, double *slope,
                             double term[RESIST_TERMS]) {
  double y = 0, image, dx, sum = a[0], d = 0;
  eda_field_gradient(&s->image, &x, &y, 1, &image, &dx, NULL);
  term[0] = 1;
  for (size_t k = 1; k < f->n; k++) {
    double by_x;
    eda_field_gradient(&s->term[k - 1], &x, &y, 1, &term[k], &by_x, NULL);
    sum += a[k] * term[k];
    d += a[k] * by_x;
  }
  *slope = f->sign * (d - dx);
  return f->sign * (sum - image);
}

/* Find the printed edge of the line, outwards from its centre. Return 0 if the
   line does not print or merges with its neighbours. */
static int find_edge(const fitting *f, specimen *s, const double *a) {
  double term[RESIST_TERMS], slope, step = 2, low = 0;
  double limit = s->image.frame.width / 2;
  if (!(specimen_level(f, s, a, 0, &slope, term) > 0)) return 0;
  for (;;) {
    if (low >= limit) return 0;
    double next = fmin(low + step, limit);
    if (!(specimen_level(f, s, a, next, &slope, term) > 0)) break;
    low = next;
  }
  double high = fmin(low + step, limit);
  for (int i = 0; i < 60 && high - low > 1e-12; i++) {
    double middle = (low + high) / 2;
    if (specimen_level(f, s, a, middle, &slope, term) > 0)
      low = middle;
    else
      high = middle;
  }
  s->edge = (low + high) / 2;
  return 1;
}

static int find_edges(const fitting *f, const double *a) {
  for (size_t i = 0; i < f->layer->count; i++)
    if (!find_edge(f, &f->specimens[i], a)) return 0;
  return 1;
}

static int specimen_init(const fitting *f, specimen *s, opc_error *error) {
  const resist_layer *r = f->layer;
  int code = image_line(f, s->want, &s->image, error);
  if (!code && f->n > 1)
    code = f->terms(f->resist, &s->image, f->n, s->term, error);
  if (code) return code;
  double x[3] = {s->want->cd / 2, 0, s->image.frame.width / 2}, y[3] = {0};
  double v[3];
  eda_field_sample(&s->image, x, y, 3, v);
  if (f->sign * (v[0] - v[1]) > 0 && f->sign * (v[2] - v[0]) > 0) return OPC_OK;
  char line[96] = "", blur[64] = "";
  if (resist_layer_has_table(r))
    (void)snprintf(line, sizeof line, ", line %g nm, pitch %g nm",
                   s->want->line, s->want->pitch);
  if (f->resist->diffusion > 0)
    (void)snprintf(blur, sizeof blur, ", after 'diffusion' of %g nm",
                   f->resist->diffusion);
  return opc_fail(error, OPC_INVALID, r->source,
                  "'%s'%s cannot be printed: intensity %.3f at the centre of "
                  "the line, %.3f at the edge, %.3f between lines%s",
                  r->source, line, v[1], v[0], v[2], blur);
}

/* ---- least squares ---- */

/* Compute the x with the smallest |J x - r| by modified Gram-Schmidt. J has
   `rows` rows and m columns. Return 0 if the columns are linearly dependent. J
   and r are overwritten. */
static int least_squares(double *j, double *r, size_t rows, size_t m,
                         double x[RESIST_TERMS]) {
  double upper[RESIST_TERMS][RESIST_TERMS] = {{0}};
  for (size_t k = 0; k < m; k++) {
    double before = 0, after = 0;
    for (size_t i = 0; i < rows; i++) before += j[i * m + k] * j[i * m + k];
    for (size_t q = 0; q < k; q++) {
      double dot = 0;
      for (size_t i = 0; i < rows; i++) dot += j[i * m + q] * j[i * m + k];
      for (size_t i = 0; i < rows; i++) j[i * m + k] -= dot * j[i * m + q];
      upper[q][k] = dot;
    }
    for (size_t i = 0; i < rows; i++) after += j[i * m + k] * j[i * m + k];
    if (!(after > 1e-12 * before)) return 0;
    upper[k][k] = sqrt(after);
    for (size_t i = 0; i < rows; i++) j[i * m + k] /= upper[k][k];
  }
  for (size_t k = 0; k < m; k++) {
    x[k] = 0;
    for (size_t i = 0; i < rows; i++) x[k] += j[i * m + k] * r[i];
    for (size_t i = 0; i < rows; i++) r[i] -= x[k] * j[i * m + k];
  }
  for (size_t k = m; k-- > 0;) {
    for (size_t q = k + 1; q < m; q++) x[k] -= upper[k][q] * x[q];
    x[k] /= upper[k][k];
  }
  return 1;
}

/* Compute one Gauss-Newton step: the change of the fitted coefficients that
   corrects the printed widths to first order. `wanted`: 1: evaluate errors at
   the wanted edges; 0: at the printed edges. Return 0 on failure. */
static int fit_step(const fitting *f, const double *a, int wanted, double *j,
                    double *r, double change[RESIST_TERMS]) {
  size_t m = 0, rows = f->layer->count;
  for (size_t k = 0; k < f->n; k++) m += f->fit[k] != 0;
  for (size_t i = 0; i < rows; i++) {
    const specimen *s = &f->specimens[i];
    double term[RESIST_TERMS] = {0}, slope, half = s->want->cd / 2;
    double x = wanted ? half : s->edge;
    double value = specimen_level(f, s, a, x, &slope, term);
    size_t column = 0;
    if (wanted && !(slope < 0)) return 0;
    for (size_t k = 0; k < f->n; k++)
      if (f->fit[k]) j[i * m + column++] = -2 * f->sign * term[k] / slope;
    r[i] = wanted ? 2 * value / slope : 2 * (half - s->edge);
  }
  double x[RESIST_TERMS];
  if (!least_squares(j, r, rows, m, x)) return 0;
  for (size_t k = 0, column = 0; k < f->n; k++)
    change[k] = f->fit[k] ? x[column++] : 0;
  return 1;
}

static double sum_of_squares(const fitting *f) {
  double sum = 0;
  for (size_t i = 0; i < f->layer->count; i++) {
    double d = 2 * f->specimens[i].edge - f->specimens[i].want->cd;
    sum += d * d;
  }
  return sum;
}

/* Iterate Gauss-Newton steps. Halve a step if a line does not print or the
   error increases. Return 0 if no tried coefficients print all lines, or if the
   columns are linearly dependent. */
static int fit_iterate(const fitting *f, double *a) {
  size_t rows = f->layer->count;
  double *j = eda_alloc(rows * (RESIST_TERMS + 1), sizeof *j);
  double *r = j + rows * RESIST_TERMS;
  double change[RESIST_TERMS] = {0}, best = INFINITY;
  int ok = fit_step(f, a, 1, j, r, change);
  for (int step = 0; ok && step < 50; step++) {
    double tried[RESIST_TERMS] = {0}, by = 1, now = INFINITY;
    for (int halving = 0; halving < 20; halving++, by /= 2) {
      for (size_t k = 0; k < f->n; k++) tried[k] = a[k] + by * change[k];
      if (find_edges(f, tried)) {
        now = sum_of_squares(f);
        if (now <= best) break;
      }
      now = INFINITY;
    }
    if (now == INFINITY) break;
    double gain = best - now;
    memcpy(a, tried, sizeof *a * f->n);
    best = now;
    if (gain < 1e-14) break;
    ok = fit_step(f, a, 0, j, r, change);
  }
  free(j);
  /* Rejected steps have changed the edges, so compute the edges again. */
  return ok && isfinite(best) && find_edges(f, a);
}

static void fit_log(const fitting *f) {
  const resist_layer *l = f->layer;
  const opc_host *host = f->resist->host;
  if (!resist_layer_has_table(l)) return;
  for (size_t i = 0; i < l->count; i++) {
    const specimen *s = &f->specimens[i];
    host->log(host, OPC_LOG_INFO,
              "%s: %s, line %g nm, pitch %g nm: prints %.2f nm, expected %.2f "
              "nm (%+.2f nm)",
              f->id, set_name[l->set], s->want->line, s->want->pitch,
              2 * s->edge, s->want->cd, 2 * s->edge - s->want->cd);
  }
  host->log(host, OPC_LOG_INFO,
            "%s: %s, %zu lines: root mean square error %.3f nm", f->id,
            set_name[l->set], l->count,
            sqrt(sum_of_squares(f) / (double)l->count));
}

static void specimens_clear(const fitting *f) {
  for (size_t i = 0; i < f->layer->count; i++) {
    specimen *s = &f->specimens[i];
    eda_field_clear(&s->image);
    for (size_t k = 0; k < RESIST_TERMS - 1; k++) eda_field_clear(&s->term[k]);
  }
  free(f->specimens);
}

int resist_fit(resist_base *resist, int set, const opc_module *litho,
               const char *id, resist_terms *terms, size_t n, const int *fit,
               double *coefficient, opc_error *error) {
  resist_layer *layer = &resist->layer[set];
  int code = OPC_OK;
  size_t wanted = 0;
  eda_scanner scanner = eda_scanner_of(litho);
  if (set && anchor_is_open(layer))
    code = anchor_take_wide(layer, scanner, error);
  else if (anchor_is_open(layer))
    code = anchor_take_drawn(resist, layer, id, scanner, error);
  if (!code && layer->file && !layer->lines) code = read_table(layer, error);
  if (code) {
    layer_clear(layer);
    return code;
  }
  if (!set && !layer->logged) {
    anchor_warn(resist, layer, id, scanner);
    code = anchor_publish(resist, layer, error);
    if (code) return code;
  }
  layer->logged = 1;
  for (size_t k = 0; k < n; k++) wanted += fit[k] != 0;
  if (wanted > layer->count)
    return opc_fail(error, OPC_INVALID, layer->source,
                    "'%s' has %zu lines, too few for %zu coefficients",
                    layer->source, layer->count, wanted);
  fitting f = {.resist = resist,
               .layer = layer,
               .litho = litho,
               .id = id,
               .terms = terms,
               .n = n,
               .fit = fit,
               .sign = layer->bright ? -1 : 1,
               .specimens = eda_alloc(layer->count, sizeof *f.specimens)};
  for (size_t i = 0; i < layer->count && !code; i++) {
    f.specimens[i].want = &layer->lines[i];
    code = specimen_init(&f, &f.specimens[i], error);
  }
  if (!code && !fit_iterate(&f, coefficient))
    code = opc_fail(error, OPC_INVALID, layer->source,
                    "'%s' cannot be fitted: no coefficients print all lines, "
                    "or the lines do not determine the coefficients",
                    layer->source);
  if (!code) fit_log(&f);
  specimens_clear(&f);
  return code;
}

void resist_print(const resist_base *resist, int layer, double constant,
                  const eda_field *variable, eda_field *field) {
  float sign = resist->layer[resist_set(layer)].bright ? -1 : 1;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  for (size_t i = 0; i < n; i++) {
    float threshold = (float)constant;
    if (variable) threshold += variable->coefficients[i];
    field->coefficients[i] = sign * (threshold - field->coefficients[i]);
  }
}
