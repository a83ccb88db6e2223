/* SPDX-License-Identifier: BSD-3-Clause */
/* An instance of a plugin for `opcflow lint`. Required parameters are made up
   where the user leaves them out; a slot has the first plugin of its kind. */
#pragma once

#include "core/binding/binding.h"

typedef struct opc_making {
  opc_registry *registry; /* for the plugins in slots */
  const opc_plugin *plugin;
  const char *file;             /* for parameters that must be one */
  const char *parameters;       /* a map in flow syntax, over the made-up one */
  const opc_parameter *changed; /* one with another number; NULL: none */
  double number;
  const opc_watch *watch; /* who may stop it; NULL: nobody */
} opc_making;

typedef struct opc_instance {
  opc_source *source;
  opc_node *map, *given;
  opc_binding *binding;
  char *file; /* the first parameter that got making.file, "slot.name"; NULL */
} opc_instance;

/* Make it, with hosts like `like` (NULL: that do nothing). FALSE and problems
   if it is refused. *instance is cleared in any case. */
gboolean opc_instance_make(const opc_making *making, const opc_host *like,
                           opc_problems *problems, opc_instance *instance);
void opc_instance_clear(opc_instance *instance);
