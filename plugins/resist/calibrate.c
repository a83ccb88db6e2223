/* SPDX-License-Identifier: BSD-3-Clause */
#include "calibrate.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what the flow says ---- */

enum { MAX_LINES = 1000, MAX_TEXT = 1 << 20, COLUMNS = 3 };

static const char *const layer_name[OPC_MASKS] = {"poly", "active"};
static const char *const sources[OPC_MASKS][3] = {
    {"anchor", "table", "table_file"},
    {"active_anchor", "active_table", "active_table_file"}};

/* Why a line cannot be used, NULL if it can. */
static const char *fault(const resist_line *l) {
  if (!(l->line > 0 && l->cd > 0 && isfinite(l->line) && isfinite(l->cd)))
    return "widths must be above 0";
  if (!(l->pitch >= 0 && isfinite(l->pitch)))
    return "a pitch must be 0 (isolated) or above";
  if (l->pitch > 0 && fmax(l->line, l->cd) >= l->pitch)
    return "there is no space between its lines";
  return NULL;
}

static int take_table(resist_layer *r, const opc_value *table, double width,
                      opc_error *error) {
  if (table->count < 2 || table->count % 2 || table->count > 2 * MAX_LINES)
    return r->host->fail(r->host, error, OPC_INVALID, r->source,
                         "'%s' needs pairs of a pitch and a width, not %zu "
                         "numbers",
                         r->source, table->count);
  r->count = table->count / 2;
  r->lines = calloc(r->count, sizeof *r->lines);
  if (!r->lines)
    return r->host->fail(r->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < r->count; i++) {
    r->lines[i] =
        (resist_line){width, table->reals[2 * i], table->reals[2 * i + 1]};
    const char *why = fault(&r->lines[i]);
    if (why)
      return r->host->fail(r->host, error, OPC_INVALID, r->source,
                           "pair %zu of '%s', (%g nm, %g nm): %s", i + 1,
                           r->source, r->lines[i].pitch, r->lines[i].cd, why);
  }
  return OPC_OK;
}

int resist_layer_create(resist_layer *out, const opc_host *host,
                        const char *plugin, int layer, const opc_value *values,
                        opc_error *error) {
  int table = values[RESIST_TABLE].type != OPC_ABSENT;
  int file = values[RESIST_TABLE_FILE].type != OPC_ABSENT;
  const char *const *names = sources[layer];
  *out = (resist_layer){.host = host,
                        .plugin = plugin,
                        .layer = layer,
                        .bright = values[RESIST_TONE].integer == 1,
                        .source = names[file ? 2 : table],
                        .width = values[RESIST_LINE].real};
  if (table && file)
    return host->fail(host, error, OPC_INVALID, names[2],
                      "'%s' and '%s' exclude each other", names[1], names[2]);
  if (file) {
    out->file = values[RESIST_TABLE_FILE].text;
    return OPC_OK;
  }
  if (table) return take_table(out, &values[RESIST_TABLE], out->width, error);
  out->lines = calloc(1, sizeof *out->lines);
  if (!out->lines)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  out->count = 1;
  *out->lines =
      (resist_line){out->width, values[RESIST_PITCH].real, out->width};
  if (values[RESIST_CD].type != OPC_ABSENT)
    out->lines->cd = values[RESIST_CD].real;
  const resist_line *a = out->lines;
  if (a->pitch > 0 && fmax(a->line, a->cd) >= a->pitch)
    return host->fail(host, error, OPC_INVALID, out->source,
                      "'%s' has no space between its lines: %g nm every %g nm",
                      out->source, fmax(a->line, a->cd), a->pitch);
  return OPC_OK;
}

void resist_layer_clear(resist_layer *layer) {
  free(layer->lines);
  layer->lines = NULL;
  layer->count = 0;
}

int resist_layer_has_table(const resist_layer *layer) {
  return layer->source != sources[layer->layer][0];
}

/* ---- tables in files ---- */

typedef struct reader {
  resist_layer *layer;
  char *text, *at;
  size_t row;          /* of the file, from 1 */
  int column[COLUMNS]; /* where line, pitch and cd stand; -1: nowhere */
  opc_error *error;
} reader;

static int read_fault(const reader *r, const char *place, const char *line,
                      const char *why) {
  const resist_layer *l = r->layer;
  return l->host->fail(l->host, r->error, OPC_INVALID, l->source,
                       "'%s':%zu:%zu: %s", l->file, r->row ? r->row : 1,
                       (size_t)(place - line) + 1, why);
}

static char *trim(char *text) {
  while (*text == ' ' || *text == '\t') text++;
  size_t n = strlen(text);
  while (n && strchr(" \t\r", text[n - 1])) text[--n] = 0;
  return text;
}

/* The next line that is not empty and no comment; NULL at the end. */
static char *next_line(reader *r) {
  while (*r->at) {
    char *line = r->at, *end = strchr(line, '\n');
    r->at = end ? end + 1 : line + strlen(line);
    if (end) *end = 0;
    r->row++;
    char *content = line + strspn(line, " \t\r");
    if (*content && *content != '#') return line;
  }
  return NULL;
}

/* Cut the next cell off *line. */
static char *next_cell(char **line) {
  char *cell = *line, *comma = strchr(cell, ',');
  *line = comma ? comma + 1 : NULL;
  if (comma) *comma = 0;
  return trim(cell);
}

static int read_header(reader *r) {
  static const char *const names[COLUMNS] = {"line", "pitch", "cd"};
  char *line = next_line(r), *rest = line;
  if (!line) return read_fault(r, r->at, r->at, "the table is empty");
  for (int c = 0; c < COLUMNS; c++) r->column[c] = -1;
  for (int i = 0; rest; i++) {
    char *cell = next_cell(&rest), *unit = strstr(cell, "(nm)");
    if (unit && !unit[4]) *unit = 0;
    char *name = trim(cell);
    int c = 0;
    while (c < COLUMNS && strcmp(name, names[c]) != 0) c++;
    if (c == COLUMNS)
      return read_fault(r, cell, line,
                        "a column is none of 'line', 'pitch', 'cd'");
    if (r->column[c] >= 0)
      return read_fault(r, cell, line, "a column comes twice");
    r->column[c] = i;
  }
  if (r->column[1] < 0 || r->column[2] < 0)
    return read_fault(r, line, line, "the columns 'pitch' and 'cd' are needed");
  return OPC_OK;
}

static int read_row(reader *r, char *line) {
  resist_layer *l = r->layer;
  double value[COLUMNS] = {l->width, 0, 0};
  char *rest = line;
  int columns = 2 + (r->column[0] >= 0), i = 0;
  for (; rest; i++) {
    char *cell = next_cell(&rest), *end;
    double number = strtod(cell, &end);
    if (end == cell || *end) return read_fault(r, cell, line, "not a number");
    for (int c = 0; c < COLUMNS; c++)
      if (r->column[c] == i) value[c] = number;
  }
  if (i != columns)
    return read_fault(r, line, line,
                      "a row has not as many numbers as columns");
  resist_line *next = &l->lines[l->count++];
  *next = (resist_line){value[0], value[1], value[2]};
  const char *why = fault(next);
  return why ? read_fault(r, line, line, why) : OPC_OK;
}

static int read_text(const resist_layer *l, char *text, opc_error *error) {
  FILE *file = fopen(l->file, "rb");
  size_t n = file ? fread(text, 1, MAX_TEXT, file) : 0;
  int why = !file || ferror(file) ? errno : 0;
  if (file) (void)fclose(file);
  if (why)
    return l->host->fail(l->host, error, OPC_IO, l->source, "'%s': %s", l->file,
                         strerror(why));
  if (n == MAX_TEXT || memchr(text, 0, n))
    return l->host->fail(l->host, error, OPC_INVALID, l->source,
                         "'%s': not a table of text of less than %d bytes",
                         l->file, MAX_TEXT);
  return OPC_OK;
}

static int read_table(resist_layer *l, opc_error *error) {
  reader r = {.layer = l, .error = error, .text = calloc(1, MAX_TEXT + 1)};
  l->lines = calloc(MAX_LINES, sizeof *l->lines);
  int code = OPC_OK;
  if (!r.text || !l->lines) {
    code = OPC_FAILED;
    l->host->fail(l->host, error, code, NULL, "out of memory");
  }
  r.at = r.text;
  if (!code) code = read_text(l, r.text, error);
  if (!code) code = read_header(&r);
  while (!code) {
    char *line = next_line(&r);
    if (!line) break;
    code = l->count < MAX_LINES ? read_row(&r, line)
                                : read_fault(&r, line, line, "too many rows");
  }
  if (!code && !l->count)
    code = read_fault(&r, r.at, r.at, "the table has no rows");
  free(r.text);
  return code;
}

/* ---- images of lines ---- */

/* Units of a line's coordinates: fine enough for any. */
static const double unit = 1e-3;

/* An isolated line is one whose neighbours are this far away, nm. */
static const double isolation = 4000;

/* The image of a vertical line in the middle of the frame, whole height, x = 0
   its middle. */
static int image_line(const resist_layer *r, const resist_line *l,
                      const opc_module *litho, double diffusion,
                      opc_field *field, opc_error *error) {
  const opc_litho *model = litho->plugin->operations;
  const opc_imaging_service *imaging = r->host->imaging;
  double period = l->pitch > 0 ? l->pitch : l->line + isolation;
  opc_frame frame = {-period / 2, 0, period, period};
  int32_t x = (int32_t)lround(l->line / 2 / unit);
  int32_t top = (int32_t)lround(period / unit);
  opc_point points[4] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[2] = {0, 4};
  opc_shapes line = {.count = 1, .start = start, .points = points};
  opc_spectrum mask;
  int code = imaging->mask_spectrum(r->host, &line, unit, frame,
                                    model->band(litho->self), &mask, error);
  if (code) return code;
  code = model->image(litho->self, r->layer, &mask, field, error);
  imaging->release_spectrum(r->host, &mask);
  if (!code && diffusion > 0)
    code = imaging->diffuse(r->host, field, diffusion, error);
  return code;
}

/* A line's image and the terms 1 .. of it; where it is drawn and printed. */
typedef struct specimen {
  const resist_line *want;
  opc_field image, term[RESIST_TERMS - 1];
  double edge; /* half its printed width, nm */
} specimen;

typedef struct fitting {
  const resist_layer *layer;
  const opc_host *host;
  specimen *specimens;
  size_t n; /* terms */
  const int *fit;
  double sign; /* -1: bright features print */
} fitting;

/* The level set at x and its slope; term[k] and slopes of terms there. */
static double level(const fitting *f, const specimen *s, const double *a,
                    double x, double *slope, double term[RESIST_TERMS]) {
  double y = 0, image, dx, sum = a[0], d = 0;
  f->host->imaging->gradient(&s->image, &x, &y, 1, &image, &dx, NULL);
  term[0] = 1;
  for (size_t k = 1; k < f->n; k++) {
    double by_x;
    f->host->imaging->gradient(&s->term[k - 1], &x, &y, 1, &term[k], &by_x,
                               NULL);
    sum += a[k] * term[k];
    d += a[k] * by_x;
  }
  *slope = f->sign * (d - dx);
  return f->sign * (sum - image);
}

/* Where the line ends, going outwards from its middle; 0 if it does not print
   or has merged. */
static int find_edge(const fitting *f, specimen *s, const double *a) {
  double term[RESIST_TERMS], slope, step = 2, low = 0;
  double limit = s->image.frame.width / 2;
  if (!(level(f, s, a, 0, &slope, term) > 0)) return 0;
  for (;;) {
    if (low >= limit) return 0;
    double next = fmin(low + step, limit);
    if (!(level(f, s, a, next, &slope, term) > 0)) break;
    low = next;
  }
  double high = fmin(low + step, limit);
  for (int i = 0; i < 60 && high - low > 1e-12; i++) {
    double middle = (low + high) / 2;
    if (level(f, s, a, middle, &slope, term) > 0)
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

static int make_specimen(const fitting *f, specimen *s, const opc_module *litho,
                         const resist_model *model, opc_error *error) {
  const resist_layer *r = f->layer;
  int code = image_line(r, s->want, litho, model->diffusion, &s->image, error);
  if (!code && f->n > 1)
    code = model->terms(model->self, &s->image, f->n, s->term, error);
  if (code) return code;
  double x[3] = {s->want->cd / 2, 0, s->image.frame.width / 2}, y[3] = {0};
  double v[3];
  r->host->imaging->sample(&s->image, x, y, 3, v);
  if (f->sign * (v[0] - v[1]) > 0 && f->sign * (v[2] - v[0]) > 0) return OPC_OK;
  char line[96] = "";
  if (resist_layer_has_table(r))
    (void)snprintf(line, sizeof line, ", line %g nm, pitch %g nm",
                   s->want->line, s->want->pitch);
  return r->host->fail(
      r->host, error, OPC_INVALID, r->source,
      "'%s'%s cannot be printed: intensity %.3f in the middle of the line, "
      "%.3f at its edge, %.3f between lines",
      r->source, line, v[1], v[0], v[2]);
}

/* ---- least squares ---- */

/* The x with the least |J x - r|, J of rows x m, by the modified Gram-Schmidt
   process; 0 if the columns of J are not independent. J and r are lost. */
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

/* One step: the changes of the fitted coefficients that, to first order, take
   the printed widths to those wanted. `drawn` measures at the edges wanted and
   not at those printed. The changes are scattered to their coefficients. */
static int newton(const fitting *f, const double *a, int wanted, double *j,
                  double *r, double change[RESIST_TERMS]) {
  size_t m = 0, rows = f->layer->count;
  for (size_t k = 0; k < f->n; k++) m += f->fit[k] != 0;
  for (size_t i = 0; i < rows; i++) {
    const specimen *s = &f->specimens[i];
    double term[RESIST_TERMS] = {0}, slope, half = s->want->cd / 2;
    double x = wanted ? half : s->edge;
    double value = level(f, s, a, x, &slope, term);
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

/* Gauss-Newton steps, halved while they lose a line or make things worse. 0 if
   no coefficients print all lines or the columns depend on each other. */
static int iterate(const fitting *f, double *a) {
  size_t rows = f->layer->count;
  double *j = malloc(sizeof *j * rows * (RESIST_TERMS + 1)), *r = j;
  double change[RESIST_TERMS] = {0}, best = INFINITY;
  if (!j) return 0;
  r += rows * RESIST_TERMS;
  int ok = newton(f, a, 1, j, r, change);
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
    ok = newton(f, a, 0, j, r, change);
  }
  free(j);
  /* Steps that were tried and not taken have moved the edges. */
  return ok && isfinite(best) && find_edges(f, a);
}

static void tell(const fitting *f) {
  const resist_layer *l = f->layer;
  if (!resist_layer_has_table(l)) return;
  for (size_t i = 0; i < l->count; i++) {
    const specimen *s = &f->specimens[i];
    l->host->log(l->host, OPC_LOG_INFO,
                 "%s: %s, line %g nm, pitch %g nm: prints %.2f nm, wanted "
                 "%.2f nm (%+.2f nm)",
                 l->plugin, layer_name[l->layer], s->want->line, s->want->pitch,
                 2 * s->edge, s->want->cd, 2 * s->edge - s->want->cd);
  }
  l->host->log(l->host, OPC_LOG_INFO,
               "%s: %s, %zu lines: error %.3f nm (root of the mean square)",
               l->plugin, layer_name[l->layer], l->count,
               sqrt(sum_of_squares(f) / (double)l->count));
}

static void clear_specimens(const fitting *f) {
  for (size_t i = 0; f->specimens && i < f->layer->count; i++) {
    specimen *s = &f->specimens[i];
    f->host->imaging->release_field(f->host, &s->image);
    for (size_t k = 0; k < RESIST_TERMS - 1; k++)
      f->host->imaging->release_field(f->host, &s->term[k]);
  }
  free(f->specimens);
}

int resist_fit(resist_layer *layer, const opc_module *litho,
               const resist_model *model, size_t n, const int *fit,
               double *coefficient, opc_error *error) {
  const opc_host *host = layer->host;
  int code = OPC_OK;
  size_t wanted = 0;
  if (layer->file && !layer->lines) code = read_table(layer, error);
  if (code) {
    resist_layer_clear(layer);
    return code;
  }
  for (size_t k = 0; k < n; k++) wanted += fit[k] != 0;
  if (wanted > layer->count)
    return host->fail(host, error, OPC_INVALID, layer->source,
                      "'%s' has %zu lines, too few for %zu coefficients",
                      layer->source, layer->count, wanted);
  fitting f = {.layer = layer,
               .host = host,
               .n = n,
               .fit = fit,
               .sign = layer->bright ? -1 : 1,
               .specimens = calloc(layer->count, sizeof *f.specimens)};
  if (!f.specimens)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < layer->count && !code; i++) {
    f.specimens[i].want = &layer->lines[i];
    code = make_specimen(&f, &f.specimens[i], litho, model, error);
  }
  if (!code && !iterate(&f, coefficient))
    code = host->fail(host, error, OPC_INVALID, layer->source,
                      "'%s' cannot be fitted: no coefficients print all its "
                      "lines, or it does not tell them apart",
                      layer->source);
  if (!code) tell(&f);
  clear_specimens(&f);
  return code;
}
