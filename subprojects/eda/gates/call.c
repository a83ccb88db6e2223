/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of extractors, resists, synthesizers and regulators. A plugin writes to
   copies between guard words. Data to which the plugin's pointers refer are
   read before opc_leave, so that a crash by an invalid pointer is attributed to
   the plugin. */
#include <eda/check.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "gates/fence.h"

enum {
  LONGEST_TEXT = 200
}; /* largest length of a verdict or rule name, bytes */

/* ---- texts ---- */

/* Return a permanent copy of `text`; on error return NULL and set *error.
   `what` names the text in the message. */
static const char *keep_text(const char *text, const char *what,
                             opc_error *error) {
  size_t n = strnlen(text, LONGEST_TEXT + 1);
  const char *bad = NULL;
  if (n > LONGEST_TEXT)
    opc_fail(error, OPC_FAILED, NULL, "%s is not a text of at most %d bytes",
             what, LONGEST_TEXT);
  else if (!g_utf8_validate(text, (gssize)n, &bad))
    opc_fail(error, OPC_FAILED, NULL, "%s is not UTF-8: byte %zu is 0x%02x",
             what, (size_t)(bad - text) + 1, (unsigned)(unsigned char)*bad);
  else
    return g_intern_string(text);
  return NULL;
}

int eda_call_verdict(const opc_context *context, const opc_module *synthesizer,
                     size_t gate, const char **verdict, opc_error *error) {
  const eda_synthesizer *s = synthesizer->functions;
  *verdict = "";
  if (!s->verdict) return OPC_OK;
  const char *before = eda_enter(context, synthesizer, error);
  const char *why = s->verdict(synthesizer->self, gate);
  if (why) *verdict = keep_text(why, "a verdict", error);
  opc_leave(context, before);
  return *verdict ? OPC_OK : OPC_FAILED;
}

/* ---- performance and level sets ---- */

enum {
  FIGURES = 6 /* consecutive array pointers in eda_performance, from `ion` on */
};

int eda_call_extract(const opc_context *context, const opc_module *extractor,
                     const eda_slices *slices, eda_performance *out,
                     opc_error *error) {
  const eda_extractor *model = extractor->functions;
  size_t n = slices->count;
  eda_performance lent = {.count = n};
  if (out->outside) lent.outside = fence_new(n, sizeof *out->outside, NULL);
  for (size_t k = 0; k < FIGURES; k++)
    (&lent.ion)[k] = fence_new(n, sizeof(double), NULL);
  const eda_performance kept =
      lent; /* The plugin may change the pointers in `lent`; `kept` retains the
               original pointers. */
  const char *before = eda_enter(context, extractor, error);
  int code = model->extract(extractor->self, slices, &lent, error);
  opc_leave(context, before);
  for (size_t k = 0; k < FIGURES; k++)
    if (!code) code = fence_check((&kept.ion)[k], "figures", error);
  if (!code && kept.outside) code = fence_check(kept.outside, "outside", error);
  for (size_t k = 0; k < FIGURES; k++) {
    if (!code && n) memcpy((&out->ion)[k], (&kept.ion)[k], n * sizeof(double));
    fence_free((&kept.ion)[k]);
  }
  if (!code && n && kept.outside) memcpy(out->outside, kept.outside, n);
  fence_free(kept.outside);
  return code;
}

int eda_call_slice(const opc_context *context, const opc_module *extractor,
                   const eda_printed_gate *gate, size_t n, double *slicing,
                   opc_error *error) {
  const eda_extractor *model = extractor->functions;
  double *lent = fence_new(2 * n, sizeof *lent, NULL);
  const char *before = eda_enter(context, extractor, error);
  model->slice(extractor->self, gate, lent, lent + n);
  opc_leave(context, before);
  int code = fence_check(lent, "places and widths", error);
  if (!code) code = eda_check_slicing(n, lent, lent + n, error);
  if (!code) memcpy(slicing, lent, 2 * n * sizeof *lent);
  fence_free(lent);
  return code;
}

int eda_call_print(const opc_context *context, const opc_module *resist,
                   int layer, eda_field *field, opc_error *error) {
  const eda_resist *model = resist->functions;
  const eda_frame frame = field->frame;
  fence_loan loan;
  fence_lend(field, &loan);
  const char *before = eda_enter(context, resist, error);
  int code = model->print(resist->self, layer, field, error);
  opc_error beyond = {0};
  int fault = fence_return(field, &loan, "level sets", &beyond);
  if (!code && fault) {
    *error = beyond;
    code = fault;
  }
  if (!code) code = eda_check_field(field, &frame, "level set", error);
  opc_leave(context, before);
  return code;
}

/* ---- moves ---- */

/* Number of arrays of eda_moves with one int32_t for each gate. */
enum { OF_GATES = 4 };

/* Return array i of the moves and write the length of the array to *n: first
   the OF_GATES arrays of gates, then the shifts of each layer. Return NULL if
   the moves do not have this array. */
static int32_t *array_of(const eda_moves *m, const eda_gates *gates,
                         const size_t *fragments, size_t i, size_t *n) {
  int32_t *const first[] = {m->l, m->w, m->jog, m->aside};
  *n = i < OF_GATES ? gates->count : fragments[i - OF_GATES];
  return i < OF_GATES ? first[i] : m->shift[i - OF_GATES];
}

/* Check the guard words and the values of all arrays in `lent`. */
static int check_moves(const eda_gates *gates, const eda_moves *lent,
                       const size_t *fragments, opc_error *error) {
  static const char *const names[] = {"moves of L", "moves of W", "jogs",
                                      "moves aside"};
  int code = fence_check(lent->assists, "assists", error);
  if (!code && lent->part) code = fence_check(lent->part, "parts", error);
  for (size_t i = 0, n; i < OF_GATES + gates->layers && !code; i++) {
    const int32_t *array = array_of(lent, gates, fragments, i, &n);
    const char *what = i < OF_GATES ? names[i] : "shifts of fragments";
    if (array) code = fence_check(array, what, error);
  }
  return code ? code : eda_check_moves(gates, lent, fragments, error);
}

int eda_call_update(const opc_context *context, const opc_module *synthesizer,
                    const eda_feedback *feedback, const size_t *fragments,
                    eda_moves *moves, int *done, opc_error *error) {
  const eda_synthesizer *s = synthesizer->functions;
  const eda_gates *g = feedback->gates;
  size_t layers = g->layers, count = g->count;
  int32_t **shift = eda_alloc(layers, sizeof *shift);
  for (size_t k = 0; k < layers; k++)
    if (moves->shift[k])
      shift[k] = fence_new(fragments[k], sizeof **shift, moves->shift[k]);
  eda_moves lent = {
      .l = fence_new(count, sizeof(int32_t), moves->l),
      .w = fence_new(count, sizeof(int32_t), moves->w),
      .jog = fence_new(count, sizeof(int32_t), moves->jog),
      .shift = shift,
      .assists = fence_new(layers, sizeof(eda_boxes), moves->assists)};
  size_t parts = moves->part ? EDA_PARTS * count : 0;
  if (moves->part) lent.part = fence_new(parts, sizeof(eda_part), moves->part);
  if (moves->aside)
    lent.aside = fence_new(count, sizeof(int32_t), moves->aside);
  const eda_moves kept = lent; /* The plugin may change the pointers in `lent`;
                                  `kept` retains the original pointers. */
  const char *before = eda_enter(context, synthesizer, error);
  int code = s->update(synthesizer->self, feedback, &lent, done, error);
  if (!code) code = check_moves(g, &kept, fragments, error);
  opc_leave(context, before);
  for (size_t i = 0, n; i < OF_GATES + layers; i++) {
    int32_t *to = array_of(moves, g, fragments, i, &n);
    int32_t *from = array_of(&kept, g, fragments, i, &n);
    if (!code && to && n) memcpy(to, from, n * sizeof *to);
    fence_free(from);
  }
  if (!code && layers)
    memcpy(moves->assists, kept.assists, layers * sizeof *kept.assists);
  fence_free(kept.assists);
  if (!code && parts) memcpy(moves->part, kept.part, parts * sizeof *kept.part);
  if (kept.part) fence_free(kept.part);
  free(shift);
  return code;
}

/* ---- rulings ---- */

int eda_call_rule(const opc_context *context, const opc_module *regulator,
                  const eda_printed *printed, int smooth, eda_ruling *ruling,
                  opc_error *error) {
  const eda_regulator *r = regulator->functions;
  const eda_gates *g = printed->gates;
  size_t layers = g->layers, count = g->count;
  eda_ruling lent = {
      .vetoes = fence_new(count, sizeof(uint32_t), ruling->vetoes),
      .end = fence_new(2 * count, sizeof(int32_t), ruling->end),
      .added = fence_new(layers, sizeof(eda_boxes), ruling->added),
      .cutouts = fence_new(layers, sizeof(eda_boxes), ruling->cutouts)};
  eda_ruling kept = lent;
  const char *before = eda_enter(context, regulator, error);
  int code =
      (smooth ? r->smooth : r->rule)(regulator->self, printed, &lent, error);
  if (!code) code = fence_check(kept.vetoes, "vetoes", error);
  if (!code) code = fence_check(kept.end, "line ends", error);
  if (!code) code = fence_check(kept.added, "added shapes", error);
  if (!code) code = fence_check(kept.cutouts, "cut-outs", error);
  if (!code) code = eda_check_ruling(g, &kept, error);
  opc_leave(context, before);
  if (!code) {
    memcpy(ruling->vetoes, kept.vetoes, count * sizeof *kept.vetoes);
    memcpy(ruling->end, kept.end, 2 * count * sizeof *kept.end);
    memcpy(ruling->added, kept.added, layers * sizeof *kept.added);
    memcpy(ruling->cutouts, kept.cutouts, layers * sizeof *kept.cutouts);
    ruling->transistors = lent.transistors;
  }
  fence_free(kept.vetoes);
  fence_free(kept.end);
  fence_free(kept.added);
  fence_free(kept.cutouts);
  return code;
}

/* Replace the rule names by permanent copies, valid after the regulator is
   closed. */
static int keep_rules(eda_violation *v, size_t n, opc_error *error) {
  for (size_t i = 0; i < n; i++)
    if (v[i].rule && !(v[i].rule = keep_text(v[i].rule, "a rule", error)))
      return OPC_FAILED;
  return OPC_OK;
}

int eda_call_violations(const opc_context *context, const opc_module *regulator,
                        const eda_printed *printed, eda_violation *violations,
                        size_t most, size_t *count, opc_error *error) {
  const eda_regulator *r = regulator->functions;
  eda_violation *lent = fence_new(most, sizeof *lent, NULL);
  size_t all = 0;
  const char *before = eda_enter(context, regulator, error);
  int code = r->violations(regulator->self, printed, lent, most, &all, error);
  size_t n = all < most ? all : most;
  if (!code) code = fence_check(lent, "violations", error);
  if (!code) code = keep_rules(lent, n, error);
  opc_leave(context, before);
  if (!code) code = eda_check_violations(lent, n, printed->gates->count, error);
  if (!code && n) memcpy(violations, lent, n * sizeof *lent);
  if (!code) *count = all;
  fence_free(lent);
  return code;
}
