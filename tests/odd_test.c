/* SPDX-License-Identifier: BSD-3-Clause */
/* Extreme settings and files, one at a time. With limited memory and after
   SIGTERM, each run ends in time, with a result or a message. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/files.h>

/* A_WHILE: time after which a long run receives SIGTERM, ms. STOP: largest time
   from SIGTERM to the end of the run, s. MOST: largest time of any other run,
   s. Only a run that hangs exceeds these limits, also on a loaded machine. */
enum { A_WHILE = 500, STOP = 60, MOST = 300 };
/* Limit of the address space. A run that needs more must report the limit. Runs
   under AddressSanitizer have no limit, because the sanitizer maps
   terabytes. */
#ifdef __SANITIZE_ADDRESS__
static const rlim_t memory_limit = RLIM_INFINITY;
#else
static const rlim_t memory_limit = (rlim_t)6 << 30;
#endif

static char *folder, *command;

/* ---- running ---- */

static void limit_memory(gpointer unused) {
  (void)unused;
  const struct rlimit most = {memory_limit, memory_limit};
  setrlimit(RLIMIT_AS, &most);
}

/* Valid settings with very long run times. */
static const char *const long_ones[] = {
    "mask.litho.error=1e-4",
    "litho.hopkins, source: quasar",
    "litho.hopkins, source: dipole",
    "litho.hopkins, zernike: [0, 10]",
    "litho.abbe",
    "mask.margin=100um",
    "mask.max_iterations=100000",
    "picture.width=8000",
    "layout.scale=100",
    "table.lengths",
};

static gboolean is_long(const char *set) {
  for (size_t i = 0; i < G_N_ELEMENTS(long_ones); i++)
    if (set && strstr(set, long_ones[i])) return TRUE;
  return FALSE;
}

/* Run a verb; return the exit code, and the messages in *message. */
static int verb_run(const char *verb, const char *flow, const char *set,
                    char **message) {
  const gint64 patience = is_long(set) ? A_WHILE : MOST * 1000;
  const char *argv[] = {command, verb, flow, "--set", set, NULL};
  if (!set) argv[3] = NULL;
  GPid child;
  int err, status = 0, asked = 0;
  g_assert_true(g_spawn_async_with_pipes(
      NULL, (char **)argv, NULL,
      G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL, limit_memory,
      NULL, &child, NULL, NULL, &err, NULL));
  gint64 start = g_get_monotonic_time(), now;
  while (!waitpid(child, &status, WNOHANG)) {
    now = g_get_monotonic_time() - start;
    if (!asked && now > patience * 1000) {
      kill(child, SIGTERM);
      asked = 1;
    }
    if (now > patience * 1000 + STOP * G_USEC_PER_SEC) {
      kill(child, SIGKILL);
      g_error("'%s' does not stop", set ? set : flow);
    }
    g_usleep(5000);
  }
  char text[4096];
  ssize_t n = read(err, text, sizeof text - 1);
  text[MAX(n, 0)] = 0;
  close(err);
  *message = g_strdup(text);
  g_assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/* ---- settings ---- */

static const char *const settings[] = {
#include "odd_settings.inc"
};

/* Check that a run ends with a result or a message. */
static void expect_end(const char *set, int code, const char *message) {
  g_assert_true(code == 0 || code == 1 || code == 2 || code == 4 || code == 5 ||
                (code == 130 && is_long(set)));
  if (code) g_assert_cmpstr(message, !=, "");
  g_assert_null(strstr(message, "crashed"));
  opc_remove_tree("runs");
}

/* Return the flow for a setting. Settings of optics and resist require the flow
   that calibrates thresholds. */
static const char *flow_for(const char *set) {
  return g_str_has_prefix(set, "mask.litho") ||
                 g_str_has_prefix(set, "mask.resist")
             ? "odd.yaml"
             : "light.yaml";
}

static void test_settings(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(settings); i++) {
    g_autofree char *message = NULL;
    g_test_timer_start();
    int code = verb_run("run", flow_for(settings[i]), settings[i], &message);
    g_test_message("%s: exit %d, %.1f s, %s", settings[i], code,
                   g_test_timer_elapsed(), message);
    expect_end(settings[i], code, message);
  }
}

/* Settings of other flows, for steps that are missing in the flow above. */
static const struct {
  const char *flow, *set;
} others[] = {
    {"devices", "devices.length.step=1e-9 nm"},
    {"devices", "devices.length.to=1000000 nm"},
    {"devices", "devices.length={ list: [1e-300 nm] }"},
    {"devices", "devices.supply=1e-300 V"},
    {"devices", "devices.supply=20 V"},
    {"devices", "devices.temperature=-200 C"},
    {"devices", "devices.overrides={ toxe: 1e300 }"},
    {"devices", "devices.overrides={ toxe: nan }"},
    {"devices", "devices.nmos=nobody"},
    {"circuit", "circuit.supply=1e-300 V"},
    {"circuit", "circuit.load=0 F"},
    {"circuit", "circuit.slew=1e-3 s"},
    {"circuit", "circuit.edges=[0 %, 100 %]"},
    {"circuit", "circuit.edges=[1e300 %]"},
    {"circuit", "circuit.most=100000"},
    {"circuit", "netlist.file=SOURCE/data/devices/opcflow65.pm"},
    {"netlist", "netlist.file=/dev/full"},
    {"netlist", "netlist.file=../out.sp"},
    {"characterize", "table.from=-1e300 nm"},
    {"characterize", "table.from=-1 mm"},
    {"characterize", "table.to=1 m"},
    {"characterize", "table.grid=1e-9 nm"},
    {"characterize", "table.lengths=[10000 nm]"},
    {"characterize", "table.margin=1 m"},
    {"search", "best.sweep={ mask.dose: [1] }"},
    {"search",
     "best.sweep={ mask.max_iterations: { from: 1, to: 1e9, step: "
     "1e-3 } }"},
    {"search", "best.minimise=mask.nothing"},
    {"search", "best.flow=SOURCE/flows/search.yaml"},
    {"convert", "layout.file=SOURCE/meson.build"},
    {"newton", "gds.file=a/../../x.gds"},
    {"newton", "gds.layers={ poly: 1e9 }"},
    {"newton",
     "mask.extractor={ use: extractor.gamma, devices: "
     "SOURCE/data/devices/ptm65.yaml, slices: 10000 }"},
    {"newton",
     "mask.extractor={ use: extractor.gamma, devices: "
     "SOURCE/data/devices/ptm65.yaml, nmos: { ion_edge: 1e300 } }"},
    {"newton", "mask.litho={ use: litho.kernels, focus: SOURCE/meson.build }"},
};

static void test_others(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  for (size_t i = 0; i < G_N_ELEMENTS(others); i++) {
    g_autofree char *message = NULL;
    g_autofree char *flow =
        g_strdup_printf("%s/flows/%s.yaml", source, others[i].flow);
    g_auto(GStrv) parts = g_strsplit(others[i].set, "SOURCE", -1);
    g_autofree char *set = g_strjoinv(source, parts);
    g_test_timer_start();
    int code = verb_run("run", flow, set, &message);
    g_test_message("%s %s: exit %d, %.1f s, %s", others[i].flow, set, code,
                   g_test_timer_elapsed(), message);
    expect_end(set, code, message);
  }
}

/* Optics that need more memory than any machine has are rejected before the
   run. */
static void test_optics(void) {
  static const struct {
    const char *set, *why;
  } odd[] = {
      {"mask.litho.na=1e-3",
       "wavelength / na, the unit of an image's lengths, "
       "is 193 um, expected 12 nm to 4 um"},
      {"mask.litho.wavelength=193~um", "is 257 um"},
      {"mask.litho.wavelength=1~nm", "is 0.00133 um"},
      {"mask.litho.zernike=[0,~1e9]", "term 2 is 1e+09 waves, more than 10"}};
  for (size_t i = 0; i < G_N_ELEMENTS(odd); i++) {
    g_autofree char *set = g_strdelimit(g_strdup(odd[i].set), "~", ' ');
    g_autofree char *message = NULL;
    g_assert_cmpint(verb_run("check", "odd.yaml", set, &message), ==, 2);
    g_assert_nonnull(strstr(message, odd[i].why));
  }
}

/* A step is refused before it begins if the memory does not suffice. */
static void test_memory(void) {
  if (memory_limit == RLIM_INFINITY) {
    g_test_skip("memory of a sanitized program cannot be limited");
    return;
  }
  g_autofree char *message = NULL;
  int code = verb_run("run", "light.yaml", "window.margin=1 m", &message);
  g_assert_cmpint(code, ==, 4);
  g_assert_nonnull(
      strstr(message, "step 'window' (process.window): requires "));
  g_assert_nonnull(strstr(message,
                          "the limit on address space (ulimit -v) has "
                          "only "));
  opc_remove_tree("runs");
}

/* ---- files of invalid kinds ---- */

/* `check` reports invalid kinds of input files. */
static void test_files(void) {
  static const char *const parameters[] = {
      "layout.file", "mask.extractor.devices", "mask.resist.table_file"};
  static const struct {
    const char *path, *why;
  } odd[] = {{"pipe", "is a pipe, not a regular file"},
             {"socket", "is a socket, not a regular file"},
             {".", "is a folder, not a regular file"},
             {"/dev/zero", "is a device, not a regular file"},
             {"/dev/random", "is a device, not a regular file"}};
  struct sockaddr_un address = {.sun_family = AF_UNIX, .sun_path = "socket"};
  int s = socket(AF_UNIX, SOCK_STREAM, 0);
  g_assert_cmpint(bind(s, (struct sockaddr *)&address, sizeof address), ==, 0);
  g_assert_cmpint(mkfifo("pipe", 0600), ==, 0);
  for (size_t i = 0; i < G_N_ELEMENTS(odd); i++) {
    g_autofree char *message = NULL;
    g_assert_cmpint(verb_run("check", odd[i].path, NULL, &message), ==, 5);
    g_assert_nonnull(strstr(message, odd[i].why));
    for (size_t k = 0; k < G_N_ELEMENTS(parameters); k++) {
      g_autofree char *set =
          g_strdup_printf("%s=%s", parameters[k], odd[i].path);
      g_autofree char *words = NULL;
      g_assert_cmpint(verb_run("check", "odd.yaml", set, &words), ==, 5);
      g_assert_nonnull(strstr(words, odd[i].why));
    }
  }
  close(s);
}

/* A hash covers the size that the file had when opened. */
static void test_sum(void) {
  opc_error error = {0};
  g_assert_null(opc_file_sha256("pipe", NULL, &error));
  g_assert_nonnull(strstr(error.message, "is not a regular file"));
  g_assert_null(opc_file_sha256("/dev/zero", NULL, &error));
  g_assert_true(g_file_set_contents("plain", "abc", 3, NULL));
  g_autofree char *sum = opc_file_sha256("plain", NULL, &error);
  g_autofree char *want =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, "abc", 3);
  g_assert_cmpstr(sum, ==, want);
}

/* ---- main ---- */

/* Thresholds that need no calibration. */
#define RESIST                                             \
  "{ use: resist.threshold, anchor: ~, threshold: 0.404, " \
  "active_threshold: 0.271 }"

/* Two flows of one layout: odd.yaml calibrates thresholds, light.yaml has more
   steps. Accurate simulations have the accuracy of the fast ones, so that the
   code of the shipped flows runs in a tenth of the time. */
static void set_up(void) {
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  command = g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *odd = g_strdup_printf(
      "opcflow: 1\nextends: %s/flows/demo.yaml\nname: odd\nsteps:\n"
      "  mask: { max_iterations: 2, fine: 3e-3, margin: 1 um }\n",
      source);
  g_assert_true(g_file_set_contents("odd.yaml", odd, -1, NULL));
  g_autofree char *light = g_strdup_printf(
      "opcflow: 1\nextends: %s/flows/window.yaml\nname: light\nsteps:\n"
      "  mask: { max_iterations: 2, fine: 3e-3, margin: 1 um, resist: " RESIST
      " }\n"
      "  window: { dose: [0 %%], defocus: [0 nm], resist: " RESIST
      " }\n"
      "  cost: { use: cost.fracture, mask: ${mask} }\n"
      "  picture: { use: draw.mask, mask: ${mask}, file: mask.png }\n",
      source);
  g_assert_true(g_file_set_contents("light.yaml", light, -1, NULL));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up();
  g_test_add_func("/odd/files", test_files);
  g_test_add_func("/odd/sum", test_sum);
  g_test_add_func("/odd/optics", test_optics);
  g_test_add_func("/odd/memory", test_memory);
  g_test_add_func("/odd/settings", test_settings);
  g_test_add_func("/odd/others", test_others);
  int failed = g_test_run();
  opc_remove_tree(folder);
  return failed;
}
