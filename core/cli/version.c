/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/cli/cli.h"

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean json = FALSE;
  const cli_option options[] = {{"json", NULL, "as JSON", &json, NULL, NULL},
                                {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 0, 0, rest);
  if (code >= 0) return code;
  if (!json) {
    cli_print("opcflow %s (plugin interface %u.%u)\n", OPC_VERSION,
              OPC_ABI_MAJOR, OPC_ABI_MINOR);
    return CLI_GOOD;
  }
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "opcflow");
  json_builder_add_string_value(b, OPC_VERSION);
  json_builder_set_member_name(b, "interface_major");
  json_builder_add_int_value(b, OPC_ABI_MAJOR);
  json_builder_set_member_name(b, "interface_minor");
  json_builder_add_int_value(b, OPC_ABI_MINOR);
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
  g_object_unref(b);
  return CLI_GOOD;
}

const cli_verb cli_version = {.name = "version",
                              .arguments = "",
                              .summary = "Tell the version",
                              .run = run};
