/* SPDX-License-Identifier: BSD-3-Clause */
/* A rectangle has its own length; twice the length carries half the current;
   then the plugin is part of a correction that succeeds. */
#include <eda/extractor.h>
#include <math.h>
#include <opcflow/testing.h>

int main(void) {
  opc_error error = {0};
  double width[] = {100, 100}, length[] = {60, 30}, edge[] = {50, 50};
  const eda_slices slices = {.count = 2,
                             .slices = 1,
                             .type = (uint8_t[2]){0},
                             .width = width,
                             .length = length,
                             .edge = edge};
  eda_performance p;
  eda_performance_init(&p, 2);
  opc_module *m = opc_test_module("@ID@", "{ alpha: 1 }", &error);
  const eda_extractor *o = m ? m->functions : NULL;
  int good = m && !o->extract(m->self, &slices, &p, &error) &&
             fabs(p.leq_ion[0] - 60) < 1e-6 &&
             fabs(p.ion[1] / p.ion[0] - 2) < 1e-6;
  printf("%g nm, %g A %s\n", p.leq_ion[0], p.ion[0], error.message);
  eda_performance_clear(&p);
  opc_test_module_free(m);
  int code = opc_test_corrects("extractor", "{ use: @ID@ }", &error);
  printf("%g %% %s\n", opc_test_metric("ion_max"), code ? error.message : "");
  return code || !good;
}
