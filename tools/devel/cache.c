/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow cache: prints the size of the store of results, clears the store, or
   sets the limit of the size. */
#include <inttypes.h>
#include <string.h>

#include <store/store.h>
#include "tools/devel/verbs.h"

static gboolean json;

static const cli_option options[] = {
    {"json", "print the result as JSON", .flag = &json}, {0}};

/* Return a size as text, such as "1.2 GB" (g_free). */
static char *size_text(guint64 bytes) {
  static const char *const units[] = {"kB", "MB", "GB", "TB"};
  double size = (double)bytes / 1e3;
  size_t i = 0;
  while (size >= 999.95 && i + 1 < G_N_ELEMENTS(units)) {
    size /= 1e3;
    i++;
  }
  return g_strdup_printf("%.1f %s", size, units[i]);
}

static void print_size(const opc_store *store) {
  const opc_store_size size = opc_store_measure(store);
  if (json) {
    JsonObject *o = json_object_new();
    json_object_set_string_member(o, "folder", opc_store_folder(store));
    json_object_set_int_member(o, "entries", (gint64)size.entries);
    json_object_set_int_member(o, "bytes", (gint64)size.bytes);
    json_object_set_int_member(o, "limit", (gint64)size.limit);
    cli_print_object(o);
    return;
  }
  g_autofree char *bytes = size_text(size.bytes);
  g_autofree char *limit = size_text(size.limit);
  cli_print("%s: %s of at most %s, %" PRIu64 " entries\n",
            opc_store_folder(store), bytes, limit, size.entries);
}

static int set_limit(opc_store *store, const GPtrArray *words,
                     opc_error *error) {
  guint64 bytes;
  g_autofree char *text =
      words->len == 3 ? g_strdup_printf("%s %s", (char *)words->pdata[1],
                                        (char *)words->pdata[2])
                      : g_strdup(words->len == 2 ? words->pdata[1] : "");
  if (!opc_store_read_size(text, &bytes))
    return opc_fail(error, OPC_INVALID, NULL,
                    "'cache limit' requires a size, e.g. '5 GB', found '%s'",
                    text);
  return opc_store_set_limit(store, bytes, error) ? OPC_OK : error->code;
}

static int cache_change(opc_store *store, const GPtrArray *words,
                        opc_error *error) {
  const char *what = words->len ? words->pdata[0] : "";
  if (!words->len) return OPC_OK;
  if (!strcmp(what, "limit")) return set_limit(store, words, error);
  if (!strcmp(what, "clear") && words->len == 1)
    return opc_store_clear(store, error) ? OPC_OK : error->code;
  return opc_fail(error, OPC_INVALID, NULL,
                  "'cache' accepts 'clear' or 'limit SIZE', found '%s'", what);
}

static int cache_run(const cli_verb *verb, const GPtrArray *arguments) {
  opc_error error = {0};
  (void)verb;
  g_autoptr(opc_store) store = opc_store_open(&error);
  if (!store && !error.code)
    return cli_error(CLI_USAGE,
                     "OPCFLOW_STORE is empty: no results are stored");
  if (!store || cache_change(store, arguments, &error)) return cli_fail(&error);
  print_size(store);
  return CLI_GOOD;
}

const cli_verb devel_cache = {CLI_CACHE, .options = options, .least = 0,
                              .most = 3, .run = cache_run};
