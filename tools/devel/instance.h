/* SPDX-License-Identifier: BSD-3-Clause */
/* Instance of a plugin for `opcflow lint`. Missing required parameters receive
   generated values; a missing slot receives the first plugin of its kind. */
#pragma once

#include "core/binding/binding.h"

/* Input: the plugin, and values of its parameters. */
typedef struct opc_making {
  opc_registry *registry; /* for the plugins in slots */
  const opc_plugin *plugin;
  const char *file;             /* value of required file parameters */
  const char *parameters;       /* in flow syntax; override generated
                                   parameters */
  const opc_parameter *changed; /* parameter to set to `number`, or NULL */
  double number;
  const opc_watch *watch; /* requests to stop a call; may be NULL */
} opc_making;

/* The instance. */
typedef struct opc_instance {
  opc_source *source;
  opc_node *map, *given;
  opc_binding *binding;
  char *file; /* name of the first parameter set to making.file, or NULL */
} opc_instance;

/* Create an instance. The hosts of the instance copy `like`; if `like` is NULL,
   publications are ignored. Return FALSE and add problems on failure. The
   caller clears *instance in any case. */
gboolean opc_instance_make(const opc_making *making, const opc_host *like,
                           opc_problems *problems, opc_instance *instance);
void opc_instance_clear(opc_instance *instance);
