/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists of facts: checksums, differences, and the latest lists of each name. */
#include <store/facts.h>
#include <string.h>
#include <sys/utsname.h>

/* ---- lists ---- */

void opc_facts_add(GVariantBuilder *facts, char about, const char *path,
                   const char *shown, const char *sum) {
  g_autofree char *valid = g_utf8_make_valid(shown, -1);
  g_autofree char *bytes =
      strcmp(valid, shown)
          ? g_compute_checksum_for_string(G_CHECKSUM_SHA256, shown, -1)
          : NULL;
  g_variant_builder_add(facts, "(ysss)", (guchar)about, path, valid,
                        bytes ? bytes : sum);
}

char *opc_facts_sum(GVariant *facts) {
  g_autofree char *text = g_variant_print(facts, FALSE);
  return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text, -1);
}

/* Processors of one class compute equal bits. */
const char *opc_facts_machine(void) {
  static struct utsname about;
  if (!*about.machine && uname(&about)) return "?";
#if defined(__x86_64__)
  if (__builtin_cpu_supports("fma") && __builtin_cpu_supports("avx2"))
    return "x86_64 with AVX2 and FMA";
#endif
  return about.machine;
}

/* ---- differences ---- */

typedef struct fact {
  guchar about;
  const char *path, *shown, *sum; /* members of the variant */
} fact;

static guint fact_hash(gconstpointer f) {
  return g_str_hash(((const fact *)f)->path) + ((const fact *)f)->about;
}

static gboolean fact_equal(gconstpointer a, gconstpointer b) {
  return ((const fact *)a)->about == ((const fact *)b)->about &&
         !strcmp(((const fact *)a)->path, ((const fact *)b)->path);
}

/* Return all facts in their order, and index them by kind and path. */
static fact *facts_read(GVariant *facts, gsize *n, GHashTable *all) {
  *n = g_variant_n_children(facts);
  fact *list = g_new(fact, *n);
  for (gsize i = 0; i < *n; i++) {
    fact *f = &list[i];
    g_variant_get_child(facts, i, "(y&s&s&s)", &f->about, &f->path, &f->shown,
                        &f->sum);
    g_hash_table_insert(all, f, f);
  }
  return list;
}

typedef struct comparison {
  opc_fact_text *text;
  const void *data;
  GString *out;
} comparison;

/* Describe the facts of `a` that are missing in `b` and, if `forward` is set,
   the facts that differ in `b`. Return the number of these facts. */
static guint facts_compare(const comparison *c, const fact *a, gsize n_a,
                           GHashTable *b, gboolean forward) {
  enum { MOST = 3 }; /* described differences; others are counted */
  guint n = 0;
  for (gsize i = 0; i < n_a; i++) {
    const fact *f = &a[i], *its = g_hash_table_lookup(b, f);
    if (its && (!forward ||
                (!strcmp(f->shown, its->shown) && !strcmp(f->sum, its->sum))))
      continue;
    if (n++ >= MOST) continue;
    const char *other = its ? its->shown : NULL;
    g_autofree char *text =
        c->text(c->data, (char)f->about, f->path, forward ? other : f->shown,
                forward ? f->shown : other);
    g_string_append_printf(c->out, "%s%s", c->out->len ? "; " : "", text);
  }
  if (n > MOST) g_string_append_printf(c->out, "; and %u more", n - MOST);
  return n;
}

/* Return a description of the differences between two lists (g_free): at most
   three changed or new facts, at most three missing facts, and the number of
   others. *count receives the number of differences. */
static char *facts_difference(GVariant *before, GVariant *now,
                              opc_fact_text *text, const void *data,
                              guint *count) {
  const comparison c = {text, data, g_string_new(NULL)};
  g_autoptr(GHashTable) old = g_hash_table_new(fact_hash, fact_equal);
  g_autoptr(GHashTable) new = g_hash_table_new(fact_hash, fact_equal);
  gsize n_old, n_new;
  g_autofree fact *olds = facts_read(before, &n_old, old);
  g_autofree fact *news = facts_read(now, &n_new, new);
  *count = facts_compare(&c, news, n_new, old, TRUE);
  *count += facts_compare(&c, olds, n_old, new, FALSE);
  return g_string_free(c.out, FALSE);
}

/* ---- the latest lists ---- */

enum { MOST_EARLIER = 32 };
#define EARLIER_TYPE G_VARIANT_TYPE("aa(ysss)")

static char *earlier_key(const char *name) {
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, name, -1);
  return g_strconcat(sum, ".facts", NULL);
}

char *opc_facts_reason(opc_store *store, const char *name, GVariant *now,
                       opc_fact_text *text, const void *data) {
  g_autofree char *key = earlier_key(name);
  g_autoptr(GVariant) all = opc_store_get(store, key, EARLIER_TYPE);
  char *best = NULL;
  guint least = G_MAXUINT;
  for (gsize i = 0; all && i < g_variant_n_children(all); i++) {
    g_autoptr(GVariant) before = g_variant_get_child_value(all, i);
    guint count;
    char *why = facts_difference(before, now, text, data, &count);
    if (!count) {
      g_free(why);
      why = g_strdup("the stored result was removed");
    }
    if (count < least) {
      g_free(best);
      best = g_steal_pointer(&why);
      least = count;
    }
    g_free(why);
  }
  return best ? best : g_strdup("not seen before");
}

void opc_facts_keep(opc_store *store, const char *name, GVariant *facts) {
  g_autofree char *key = earlier_key(name);
  g_autoptr(GVariant) all = opc_store_get(store, key, EARLIER_TYPE);
  GVariantBuilder out;
  g_variant_builder_init(&out, EARLIER_TYPE);
  g_variant_builder_add_value(&out, facts);
  gsize n = all ? g_variant_n_children(all) : 0, kept = 1;
  for (gsize i = 0; i < n && kept < MOST_EARLIER; i++) {
    g_autoptr(GVariant) one = g_variant_get_child_value(all, i);
    if (g_variant_equal(one, facts)) continue;
    g_variant_builder_add_value(&out, one);
    kept++;
  }
  (void)opc_store_put(store, key, g_variant_builder_end(&out));
}
