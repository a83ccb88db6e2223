/* SPDX-License-Identifier: BSD-3-Clause */
/* The intensity of a clear mask is 1; then the plugin is part of a correction
   that succeeds. */
#include <eda/litho.h>
#include <math.h>
#include <opcflow/testing.h>

int main(void) {
  opc_error error = {0};
  eda_spectrum mask = {0};
  eda_field field = {0};
  double x = 300, y = 200, value = NAN;
  opc_module *m = opc_test_module("@ID@", "{ blur: 50 nm }", &error);
  const eda_litho *litho = m ? m->functions : NULL;
  if (m && !litho->prepare(m->self, &error) &&
      !eda_mask_spectrum(NULL, &(eda_shapes){0}, 1, (eda_frame){0, 0, 500, 500},
                         litho->band(m->self), &mask, &error) &&
      !litho->image(m->self, 0, &mask, &field, &error))
    eda_field_sample(&field, &x, &y, 1, &value);
  printf("%g %s\n", value, error.message);
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
  opc_test_module_free(m);
  int code = opc_test_corrects("litho", "{ use: @ID@ }", &error);
  printf("%g %% %s\n", opc_test_metric("ion_max"), code ? error.message : "");
  return code || !(fabs(value - 1) < 1e-5);
}
