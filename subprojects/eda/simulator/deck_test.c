/* SPDX-License-Identifier: BSD-3-Clause */
/* Accepted statements, and all known ways to circumvent the filter. */
#include "simulator/deck.h"

#include <glib.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char *folder; /* contains all files; removed at the end */

static char *path_of(const char *name) {
  return g_build_filename(folder, name, NULL);
}

static void file_put(const char *name, const char *text, gssize length) {
  g_autofree char *path = path_of(name);
  g_assert_true(g_file_set_contents(path, text, length, NULL));
}

/* Return a deck that includes a file. */
static char *deck_of(const char *name) {
  g_autofree char *path = path_of(name);
  return g_strdup_printf("title\n.include \"%s\"\n.end\n", path);
}

static void refused_file(const char *name, const char *where,
                         const char *words) {
  opc_error error;
  g_autofree char *deck = deck_of(name);
  char *out = deck_write(deck, NULL, &error);
  if (out) g_error("'%s' came through as '%s'", name, out);
  g_assert_cmpint(error.code, ==, OPC_INVALID);
  g_test_message("%s", error.message);
  if (!strstr(error.message, where) || !strstr(error.message, words))
    g_error("'%s', expected '%s' and '%s'", error.message, where, words);
}

/* Check that a file with these bytes is rejected at LINE:COLUMN. */
static void assert_refused(const char *bytes, gssize length, const char *where,
                           const char *words) {
  g_autofree char *at = g_strdup_printf("/evil.pm:%s: ", where);
  file_put("evil.pm", bytes, length);
  refused_file("evil.pm", at, words);
}

static char *taken(const char *text) {
  opc_error error;
  file_put("good.pm", text, -1);
  g_autofree char *deck = deck_of("good.pm");
  char *out = deck_write(deck, NULL, &error);
  if (!out) g_error("%s", error.message);
  return out;
}

static void assert_becomes(const char *text, const char *want) {
  char *got = taken(text);
  g_autofree char *all = g_strdup_printf("opcflow\n%s.end\n", want);
  g_assert_cmpstr(got, ==, all);
  free(got);
}

static void test_taken(void) {
  assert_becomes(
      "* a comment \xc3\xa9\n\n.MODEL n NMOS (level=54\r\n"
      "  * between\n\t+\ttox = '1n*(1+x)' ) ; why\r\n",
      ".MODEL n NMOS (level=54\n+  tox = '1n*(1+x)' )\n");
  assert_becomes(
      ".param a=1 b={2*a} $ c\n.subckt f d g s b w=1u l=60n\n"
      "m1 d g s b n w={w} l='l'\nr1 d s 1k\n.ends f\n.global vdd\n"
      ".func sq(x) {x*x}\n.options tnom=27 scale=1u reltol = 1e-3\n"
      "b1 a 0 v=v(d)*2\n.end\n.control\nshell false\n",
      ".param a=1 b={2*a}\n.subckt f d g s b w=1u l=60n\n"
      "m1 d g s b n w={w} l='l'\nr1 d s 1k\n.ends f\n.global vdd\n"
      ".func sq(x) {x*x}\n.options tnom=27 scale=1u reltol = 1e-3\n"
      "b1 a 0 v=v(d)*2\n");
  assert_becomes(".param a={1+\n+ 2*(3+4)} b=1\n",
                 ".param a={1+\n+  2*(3+4)} b=1\n");
  assert_becomes("*#shell false\n*ng_script\n  *#shell false\n", "");
}

/* The deck itself has no title line: its first line is a statement. */
static void test_own(void) {
  opc_error error;
  char *out = deck_write(
      "*ng_script\nv1 a 0 1\n.options temp=27\n"
      ".save v(a)\n.nodeset v(a)=1\n.end\nshell false\n",
      NULL, &error);
  g_assert_cmpstr(out, ==,
                  "opcflow\nv1 a 0 1\n.options temp=27\n.save v(a)\n"
                  ".nodeset v(a)=1\n.end\n");
  free(out);
  g_assert_null(
      deck_write("t\nv1 a 0 1\n.control\nop\n.endc\n.end", NULL, &error));
  g_assert_nonnull(strstr(error.message, "deck:3:1: '.control' is refused"));
}

static void test_statements(void) {
  static const char *const evil[] = {
      ".control",  ".CONTROL", ".endc",      ".controlx", ".csparam",
      ".exec",     ".shell",   ".save",      ".print",    ".plot",
      ".measure",  ".meas",    ".write",     ".tran",     ".temp",
      ".title",    ".hdl",     ".biaschk",   ".incpslt",  ".libsave",
      ".osdi",     ".nodeset", ".codemodel", ".lib",      ".prot",
      ".sndprint", ".width",   ".ic",        ".data",     ".",
      "shell",     "system",   "set",        "source",    "write",
      "a1",        "n1",       "u1",         "p1",        "@",
      "1",         "#",        "=",          "\"shell\"", "'.control'",
      "{shell}",   "%shell",   "!",          "&",         "_x",
      ".include",  "unset",    "alias",      "pre_osdi",  "y1"};
  for (size_t i = 0; i < G_N_ELEMENTS(evil); i++) {
    g_autofree char *text =
        g_strdup_printf(".param a=1\n \t%s touch x y z\n.endc\n", evil[i]);
    assert_refused(text, -1, "2:3", "");
  }
  assert_refused(".param a=1\n  .control\nshell touch x\n", -1, "2:3",
                 "'.control' is refused");
  assert_refused("\r\n\t.Control\r\n", -1, "2:2", "'.Control' is refused");
  assert_refused(".param a=1\n(.control)\n", -1, "2:2",
                 "'.control' is refused");
  assert_refused("(.param a=1)\n", -1, "1:2", "'.param' is refused");
  assert_refused("'.param' a=1\n", -1, "1:1", "'.param' is refused");
  assert_refused(",.control\n", -1, "1:2", "'.control' is refused");
  assert_refused("shell touch x\n", -1, "1:1", "'shell' is refused");
}

/* Forbidden parts in accepted statements. */
static void test_hidden(void) {
  assert_refused(".options editor=ed\n", -1, "1:10", "option 'editor'");
  assert_refused(".options reltol=1e-3\n+ spicepath=/tmp\n", -1, "2:3",
                 "'spicepath'");
  assert_refused(".option temp=125\n", -1, "1:9", "option 'temp'");
  assert_refused(".option reltol=`touch x`\n", -1, "1:9", "requires a number");
  assert_refused(".option reltol='1'\n", -1, "1:9", "requires a number");
  assert_refused(".option reltol=1\"x\"\n", -1, "1:9", "requires a number");
  assert_refused(".option reltol=\n", -1, "1:9", "requires a number");
  assert_refused(".model m filesource(file=\"x\")\n", -1, "1:10",
                 "'filesource'");
  assert_refused(".model m d_source (input_file=x)\n", -1, "1:10",
                 "'d_source'");
  assert_refused(".model m numos\n+ output file=x\n", -1, "1:10", "'numos'");
  assert_refused(".model m 'nmos'\n", -1, "1:10", "models of kind");
  assert_refused(".model m\n", -1, "1:1", "without a name and a kind");
  assert_refused(".model m r(r=1 file=\"x\")\n", -1, "1:16",
                 "must not open a file");
  assert_refused("v1 a 0 dc 0 FILE=\"x\"\n", -1, "1:13",
                 "must not open a file");
  assert_refused("v1 a 0 pwl {'} ' file=\"x\" '\n", -1, "1:16",
                 "must not open a file");
  assert_refused(".param f='file'\n", -1, "1:10", "must not open a file");
  assert_refused("r1 a b `touch x`\n", -1, "1:1", "'`'");
  assert_refused(".param a=1 \\\\\n.control\n", -1, "1:1", "ends in");
  assert_refused(".param a=1 \\\\\t\r\n+ b=1\n", -1, "1:1", "ends in");
  assert_refused("+ .control\n", -1, "1:1", "has no statement to continue");
  assert_refused(".param a={1\n.control\n", -1, "2:1", "'.control' is refused");
  assert_refused(".options reltol={1\n+ } editor=x\n", -1, "1:10",
                 "requires a number");
}

/* A second model of the same name is refused, except in another subcircuit, in
   branches of .if, or if the file is included twice. */
static void test_twice(void) {
  assert_refused(".model m nmos vto=1\n.model M nmos vto=2\n", -1, "2:8",
                 "'M' is defined twice, first at ");
  static const char *const good[] = {
      (".subckt a x\n.model m r r=1\n.ends\n"
       ".subckt b x\n.model m r r=2\n.ends\n.model m r r=3\n"),
      ".if (1)\n.model m r r=1\n.else\n.model m r r=2\n.endif\n",
      ".model m.1 nmos lmin=1\n.model m.2 nmos lmin=2\n"};
  for (size_t i = 0; i < G_N_ELEMENTS(good); i++) free(taken(good[i]));
  file_put("card.pm", ".model m r r=1\n", -1);
  free(taken(".include card.pm\n.include card.pm\n"));
}

static void test_bytes(void) {
  assert_refused(".param a\0=1\n", 12, "1:8", "byte 0x00");
  assert_refused("\0.control\n", 10, "1:1", "byte 0x00");
  assert_refused(".par\xc3\xa9m a=1\n", -1, "1:1", "byte 0xc3");
  assert_refused(".param a=\xff\n", -1, "1:10", "byte 0xff");
  assert_refused(".param a=1\n\f.control\n", -1, "2:1", "byte 0x0c");
  assert_refused(".param a=1\n\v.control\n", -1, "2:1", "byte 0x0b");
  assert_refused(".param a='\xc3\xa9'\n", -1, "1:1", "byte 0xc3");
  assert_refused(".param a='1\x1b'\n", -1, "1:10", "byte 0x1b");
  assert_refused(".param a='1\n", -1, "1:10", "not closed");
  assert_becomes("\xEF\xBB\xBF.param a=1\n", ".param a=1\n");
  assert_refused("\xEF\xBB\xBF.control\n", -1, "1:1", "'.control' is refused");
  assert_refused(".param a=1\n\xEF\xBB\xBF.control\n", -1, "2:1", "byte 0xef");
  /* A single carriage return counts as a blank. */
  assert_becomes(".param a=1\r.control\n", ".param a=1 .control\n");
}

/* ---- files ---- */

static void test_folder(void) {
  g_autofree char *inner = path_of("inner"), *link = path_of("inner/link");
  g_autofree char *into = path_of("inner/into"), *fifo = path_of("inner/fifo");
  g_assert_cmpint(g_mkdir(inner, 0700), ==, 0);
  g_assert_cmpint(symlink("../outer.pm", link), ==, 0);
  g_assert_cmpint(symlink("/", into), ==, 0);
  g_assert_cmpint(mkfifo(fifo, 0600), ==, 0);
  file_put("outer.pm", ".param outer=1\n", -1);
  file_put("inner/beside.pm", ".param beside=1\n.end\n.param no=1\n", -1);
  static const char *const outside[] = {"../outer.pm", "link", "/etc/hostname",
                                        "into/etc/hostname",
                                        "../inner/../outer.pm"};
  for (size_t i = 0; i < G_N_ELEMENTS(outside); i++) {
    g_autofree char *text = g_strdup_printf("\n.include '%s'\n", outside[i]);
    file_put("inner/a.pm", text, -1);
    refused_file("inner/a.pm", "inner/a.pm:2:10: ", "is outside of");
  }
  static const char *const absent[] = {"nowhere", "~/x", "$HOME/x", "fifo",
                                       "."};
  for (size_t i = 0; i < G_N_ELEMENTS(absent); i++) {
    g_autofree char *text = g_strdup_printf("\n.include '%s'\n", absent[i]);
    file_put("inner/a.pm", text, -1);
    refused_file("inner/a.pm", "inner/a.pm:2:10: ", absent[i]);
  }
  file_put("inner/a.pm", ".inc 'a.pm'\n", -1);
  refused_file("inner/a.pm", "inner/a.pm:1:", "too deep");
  file_put("inner/b\xc3\xa9side.pm", ".include beside.pm\n", -1);
  file_put("inner/\xc3\xa4.pm", ".inc 'b\xc3\xa9side.pm'\n.param a=1\n", -1);
  opc_error error;
  g_autofree char *deck = deck_of("inner/\xc3\xa4.pm");
  char *out = deck_write(deck, NULL, &error);
  g_assert_cmpstr(out, ==, "opcflow\n.param beside=1\n.param a=1\n.end\n");
  free(out);
  g_unlink(link), g_unlink(into), g_unlink(fifo);
}

/* Each file includes the next file twice: 2^16 includes in total. */
static void test_bomb(void) {
  for (int i = 0; i < 16; i++) {
    g_autofree char *name = g_strdup_printf("b%d.pm", i);
    g_autofree char *text =
        i < 15 ? g_strdup_printf(".inc b%d.pm\n.inc b%d.pm\n", i + 1, i + 1)
               : g_strdup(".param a=1\n");
    file_put(name, text, -1);
  }
  refused_file("b0.pm", ".pm:", "more than 10000 files");
}

static void test_library(void) {
  opc_error error;
  file_put("l.lib",
           ".param all=1\n.lib tt\n.param a=1\n.endl\n.lib ss\n.shell x\n"
           ".param a=2\n.endl ss\n.lib open\n",
           -1);
  file_put("use.pm", ".lib 'l.lib' TT\n", -1);
  g_autofree char *deck = deck_of("use.pm");
  char *out = deck_write(deck, NULL, &error);
  g_assert_null(out);
  g_assert_nonnull(strstr(error.message, "l.lib:9:1: section 'open'"));
  file_put(
      "l.lib",
      ".param all=1\n.lib tt\n.param a=1\n.endl\n.lib ss\n.shell x\n.endl ss\n",
      -1);
  out = deck_write(deck, NULL, &error);
  g_assert_cmpstr(out, ==, "opcflow\n.param a=1\n.end\n");
  free(out);
  file_put("use.pm", ".lib 'l.lib' ss\n", -1);
  refused_file("use.pm", "l.lib:6:1: ", "'.shell' is refused");
  file_put("use.pm", ".lib 'l.lib' ff\n", -1);
  refused_file("use.pm", "use.pm:1:14: ", "no section 'ff'");
  file_put("use.pm", ".lib '../l.lib' ff\n", -1);
  refused_file("use.pm", "use.pm:1:6: ", "");
  file_put("use.pm", ".include l.lib\n", -1);
  out = deck_write(deck, NULL, &error);
  g_assert_cmpstr(out, ==, "opcflow\n.param all=1\n.end\n");
  free(out);
}

/* Compiled models named by the deck add kinds of models and instances. */
static void test_osdi(void) {
  static const char text[] =
      ".subckt f d g s b\nN1 d g s b m w=1u\n.model m Compiled type=1\n"
      ".model r compiledrf type=1\n.model n nmos level=54\n.ends\n";
  opc_error error;
  file_put("o.osdi", "\x7f\0ELF\0COMPILED\0compiledrfx\0", 26);
  file_put("o.lib", text, -1);
  refused_file("o.lib", "o.lib:2:1: ", "'N1' is refused");
  g_autofree char *object = path_of("o.osdi"), *file = path_of("o.lib");
  g_autofree char *deck =
      g_strdup_printf("t\n.osdi \"%s\"\n.include \"%s\"\n.end\n", object, file);
  char *osdi, *out = deck_write(deck, &osdi, &error);
  g_assert_cmpstr(out, ==,
                  "opcflow\n.subckt f d g s b\nN1 d g s b m w=1u\n"
                  ".model m Compiled type=1\n.model n nmos level=54\n"
                  ".ends\n.end\n");
  g_assert_cmpstr(osdi, ==, object);
  free(out);
  g_free(osdi);
  file_put("o.lib", ".osdi o.osdi\n", -1);
  refused_file("o.lib", "o.lib:1:1: ", "'.osdi' is refused");
  file_put("o.lib", ".model m 'compiled'\n", -1);
  g_assert_null(deck_write(deck, &osdi, &error));
  g_assert_nonnull(strstr(error.message, "o.lib:1:10: models of kind"));
  g_assert_null(osdi);
  g_assert_null(deck_write("t\n.osdi /none/at.all\n.end", &osdi, &error));
  g_assert_nonnull(strstr(error.message, "deck:2:7: "));
  g_assert_null(deck_write("t\n.osdi\n.end", &osdi, &error));
  g_assert_nonnull(strstr(error.message, "deck:2:1: .osdi requires one file"));
}

static void clear_folder(const char *path) {
  GDir *dir = g_dir_open(path, 0, NULL);
  const char *name;
  while (dir && (name = g_dir_read_name(dir))) {
    g_autofree char *child = g_build_filename(path, name, NULL);
    clear_folder(child);
  }
  if (dir) g_dir_close(dir);
  g_remove(path);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("deck-test-XXXXXX", NULL);
  g_test_add_func("/deck/taken", test_taken);
  g_test_add_func("/deck/own", test_own);
  g_test_add_func("/deck/statements", test_statements);
  g_test_add_func("/deck/hidden", test_hidden);
  g_test_add_func("/deck/twice", test_twice);
  g_test_add_func("/deck/bytes", test_bytes);
  g_test_add_func("/deck/folder", test_folder);
  g_test_add_func("/deck/bomb", test_bomb);
  g_test_add_func("/deck/library", test_library);
  g_test_add_func("/deck/osdi", test_osdi);
  int code = g_test_run();
  clear_folder(folder);
  g_free(folder);
  return code;
}
