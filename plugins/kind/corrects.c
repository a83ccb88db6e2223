/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements opc_test_corrects of <opcflow/testing.h>, the acceptance test of
   plugins: corrects a NAND gate with a plugin in a slot of the correction loop.
   The layout and the device table are sample files of kind.step. */
#include <glib.h>
#include <opcflow/kind.h>
#include <opcflow/testing.h>
#include <string.h>

enum { MOST_ITERATIONS = 80 };

/* Deviation, %, below which a drawn mask needs no correction. */
static const double ion_limit = 0.5;

/* Slots of the loop and their plugins, which the tested plugin replaces in its
   slot. "%s" stands for the folder of the samples. */
static const struct {
  const char *slot, *plugin;
} slots[] = {
    {"litho", "{ use: litho.hopkins, na: 0.75, sigma: 0.75 }"},
    {"resist",
     "{ use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }"},
    {"extractor", "{ use: extractor.plain, devices: '%s/ptm65.yaml' }"},
    {"synthesizer", "{ use: synthesizer.dpb }"},
    {"regulator", "{ use: regulator.drc, min_extension: 40 nm }"},
};

/* ---- files ---- */

static gboolean samples_write(opc_error *error) {
  static const char *const names[] = {"nand2.cif", "ptm65.yaml"};
  opc_module *m = opc_test_module("kind.step", "{}", error);
  const opc_kind *kind = m ? m->functions : NULL;
  gsize found = 0;
  for (size_t i = 0; kind && i < kind->n_samples; i++) {
    const opc_sample *sample = &kind->samples[i];
    g_autofree char *path =
        g_build_filename(opc_test_folder(), sample->name, NULL);
    for (size_t k = 0; k < G_N_ELEMENTS(names); k++)
      if (!strcmp(names[k], sample->name) &&
          g_file_set_contents(path, sample->bytes, (gssize)sample->size, NULL))
        found++;
  }
  opc_test_module_free(m);
  if (found == G_N_ELEMENTS(names)) return TRUE;
  opc_fail(error, OPC_NO_PLUGIN, NULL,
           "the acceptance test needs the plugins of opcflow: add `pkg-config "
           "--variable=pluginsdir opcflow` to OPCFLOW_PLUGIN_PATH");
  return FALSE;
}

/* ---- steps ---- */

/* A module of the kind step with one output. */
typedef struct stage {
  opc_module *module;
  void *output;
} stage;

/* Run a step. If `from` is not NULL, the output of `from` is the input named
   `input`. */
static int stage_run(stage *s, const char *id, const char *mapping,
                     const char *input, const stage *from, opc_error *error) {
  s->module = opc_test_module(id, mapping, error);
  if (!s->module) return error->code;
  if (from) opc_test_input(s->module, input, from->output);
  return opc_test_run(s->module, &s->output, error);
}

static void stage_clear(stage *s) {
  if (s->output) opc_test_release(s->module, &s->output);
  opc_test_module_free(s->module);
}

/* ---- the correction ---- */

/* Return the parameters of the loop, "{ litho: {...}, ... }", with the plugin
   in its slot (g_free). */
static char *correction_text(const char *slot, const char *plugin) {
  GString *text = g_string_new(NULL);
  g_string_append_printf(text,
                         "{ guard: off, ion_limit: %g %%, max_iterations: %d",
                         ion_limit, MOST_ITERATIONS);
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++)
    g_string_append_printf(
        text, ", %s: %s", slots[i].slot,
        strcmp(slot, slots[i].slot) ? slots[i].plugin : plugin);
  g_string_replace(text, "%s", opc_test_folder(), 0);
  g_string_append(text, " }");
  return g_string_free(text, FALSE);
}

static int correction_judge(opc_error *error) {
  static const char *const none[] = {"worse", "lost", "failed"};
  double most = opc_test_metric("ion_max"),
         drawn = opc_test_metric("ion_max_drawn"),
         iterations = opc_test_metric("iterations");
  if (!(iterations < MOST_ITERATIONS))
    return opc_fail(error, OPC_FAILED, NULL,
                    "not converged after %d iterations, largest |Ion "
                    "deviation| %.3g %%",
                    MOST_ITERATIONS, most);
  for (size_t i = 0; i < G_N_ELEMENTS(none); i++)
    if (!(opc_test_metric(none[i]) < 1))
      return opc_fail(error, OPC_FAILED, NULL,
                      "%g of %g transistors are %s, largest |Ion deviation| "
                      "%.3g %%, as drawn %.3g %%",
                      opc_test_metric(none[i]), opc_test_metric("transistors"),
                      strcmp(none[i], "worse") ? none[i] : "worse than drawn",
                      most, drawn);
  if (!(most < drawn || most <= ion_limit))
    return opc_fail(error, OPC_FAILED, NULL,
                    "the largest |Ion deviation| is %.3g %%, as drawn %.3g %%",
                    most, drawn);
  return OPC_OK;
}

int opc_test_corrects(const char *slot, const char *plugin, opc_error *error) {
  stage layout = {NULL, NULL}, gates = layout, mask = layout;
  gboolean known = FALSE;
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++)
    known |= !strcmp(slot, slots[i].slot);
  if (!known)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s' is no slot of the correction loop", slot);
  if (!samples_write(error)) return error->code;
  g_autofree char *read = g_strdup_printf(
      "{ file: '%s/nand2.cif', layers: { poly: CP, active: CA, contact: CC, "
      "nwell: CW } }",
      opc_test_folder());
  g_autofree char *correct = correction_text(slot, plugin);
  int code = stage_run(&layout, "read.cif", read, NULL, NULL, error);
  if (!code)
    code = stage_run(&gates, "segment.transistors", "{}", "layout", &layout,
                     error);
  if (!code) opc_test_forget();
  if (!code)
    code = stage_run(&mask, "correct", correct, "gates", &gates, error);
  if (!code) code = correction_judge(error);
  stage_clear(&mask);
  stage_clear(&gates);
  stage_clear(&layout);
  return code;
}
