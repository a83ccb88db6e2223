/* SPDX-License-Identifier: BSD-3-Clause */
/* Derived defaults (opc_parameter.follows): if the user does not set such a
   parameter, the plugin computes the value from other data, for example from
   the wavelength. The plugin calls opc_follow as soon as that data is known.
   [main]: see plugin.h. */
#ifndef OPCFLOW_FOLLOW_H
#define OPCFLOW_FOLLOW_H

#include <opcflow/table.h>
#include <stdio.h>

OPC_C_BEGIN

/* Return the value of the expression `follows`, in the unit of the parameter;
   NAN leaves the field unchanged. */
typedef double opc_follow_value(const void *data, const char *follows);

/* Set each field of the instance `self` that is NAN to the derived default of
   its parameter. `data` is passed to `value`. Logs one line of all derived
   values: "ID: WHENCE: NAME VALUE UNIT, ..."; `whence` names the origin of
   `data`. [main] */
OPC_UNUSED static void opc_follow(const opc_host *host, const char *id,
                                  void *self, const opc_parameter *parameters,
                                  size_t n, opc_follow_value *value,
                                  const void *data, const char *whence) {
  char used_fields[2048];
  size_t i, used = 0;
  used_fields[0] = 0;
  for (i = 0; i < n; i++) {
    const opc_parameter *p = &parameters[i];
    double *field = (double *)(void *)((char *)self + p->offset);
    if (!p->follows || p->type != OPC_REAL || *field == *field) continue;
    *field = value(data, p->follows);
    if (*field != *field || used + 1 >= sizeof used_fields) continue;
    used += (size_t)snprintf(used_fields + used, sizeof used_fields - used,
                             "%s%s %g %s", used ? ", " : "", p->name, *field,
                             p->unit ? p->unit : "");
  }
  if (used)
    host->log(host, OPC_LOG_INFO, "%s: %s: %s", id, whence, used_fields);
}

/* Publish the table `settings` of a step: one row for each parameter with a
   derived default, with the value in use. Returns 0, or an error code with
   *error filled. [main], while a step runs. */
OPC_UNUSED static int opc_put_followed(const opc_host *host, const void *self,
                                       const opc_parameter *parameters,
                                       size_t n, opc_error *error) {
  typedef struct row {
    const char *name, *unit, *follows;
    double value;
  } row;
  row *rows = (row *)calloc(n + 1, sizeof *rows);
  size_t i, count = 0;
  int code;
  if (!rows) return opc_fail(error, OPC_FAILED, NULL, "no memory");
  for (i = 0; i < n; i++) {
    const opc_parameter *p = &parameters[i];
    if (!p->follows) continue;
    rows[count].name = p->name;
    rows[count].unit = p->unit;
    rows[count].follows = p->follows;
    memcpy(&rows[count++].value, (const char *)self + p->offset,
           sizeof(double));
  }
  {
    const opc_column columns[] = {
        {"parameter", NULL, OPC_TEXT, 0, &rows->name},
        {"value", NULL, OPC_REAL, -1, &rows->value},
        {"unit", NULL, OPC_TEXT, 0, &rows->unit},
        {"if_not_given", NULL, OPC_TEXT, 0, &rows->follows}};
    code = opc_put_rows(host, "settings", 0, count, sizeof *rows,
                        OPC_ARRAY(columns), error);
  }
  free(rows);
  return code;
}

OPC_C_END
#endif
