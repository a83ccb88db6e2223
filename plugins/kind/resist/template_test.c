/* SPDX-License-Identifier: BSD-3-Clause */
/* A dark field prints; the level set is the threshold minus the intensity; then
   the plugin is part of a correction that succeeds. */
#include <eda/resist.h>
#include <math.h>
#include <opcflow/testing.h>

int main(void) {
  opc_error error = {0};
  float dark[16] = {0};
  eda_field field = {{0, 0, 100, 100}, 4, 4, dark};
  double x = 30, y = 20, value = NAN;
  opc_module *m = opc_test_module("@ID@", "{ threshold: 0.3 }", &error);
  const eda_resist *resist = m ? m->functions : NULL;
  if (m && !resist->print(m->self, 0, &field, &error))
    eda_field_sample(&field, &x, &y, 1, &value);
  printf("%g %s\n", value, error.message);
  opc_test_module_free(m);
  int code = opc_test_corrects("resist", "{ use: @ID@ }", &error);
  printf("%g %% %s\n", opc_test_metric("ion_max"), code ? error.message : "");
  return code || !(fabs(value - 0.3) < 1e-6);
}
