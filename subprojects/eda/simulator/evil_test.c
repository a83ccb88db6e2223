/* SPDX-License-Identifier: BSD-3-Clause */
/* Replacement of ngspice for tests: a library whose commands attempt the
   actions that the sandbox forbids, such as "written PATH" and "started PATH",
   and print the result. */
#include <stdbool.h> /* needed by sharedspice.h */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <ngspice/sharedspice.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

static SendChar *say;

static int open_as(const char *path, int flags) {
  return open(path, flags, 0600);
}
static int do_append(const char *p) { return open_as(p, O_WRONLY | O_APPEND); }
static int do_create(const char *p) { return open_as(p, O_WRONLY | O_CREAT); }
static int do_change(const char *p) { return open_as(p, O_RDWR); }
static int do_read(const char *p) { return open_as(p, O_RDONLY); }
static int do_truncate(const char *p) { return truncate(p, 0); }
static int do_remove(const char *p) { return unlink(p); }
static int do_folder(const char *p) { return mkdir(p, 0700); }
static int do_link(const char *p) { return symlink("/", p); }
static int do_mode(const char *p) { return chmod(p, 0777); }
static int do_shell(const char *p) {
  char command[4096];
  snprintf(command, sizeof command, "touch '%s'", p);
  return system(command);
}
static int do_exec(const char *p) {
  return execl("/bin/touch", "touch", p, (char *)NULL);
}
static int do_fork(const char *p) {
  (void)p;
  return fork();
}
static int do_parent(const char *p) {
  (void)p;
  return kill(getppid(), SIGTERM);
}
static int do_socket(const char *p) {
  (void)p;
  return socket(AF_INET, SOCK_STREAM, 0);
}
static int do_code(const char *p) {
  (void)p;
  void *at = mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                  MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return at == MAP_FAILED ? -1 : 0;
}
static int do_memory(const char *p) {
  (void)p;
  void *at = mmap(NULL, (size_t)5 << 30, PROT_READ | PROT_WRITE,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return at == MAP_FAILED ? -1 : 0;
}
/* Load the file. If the file cannot be loaded, act as a library without support
   for compiled models. */
static int do_osdi(const char *p) {
  if (dlopen(p, RTLD_NOW | RTLD_LOCAL)) return 0;
  char text[512];
  snprintf(text, sizeof text, "stderr osdi: no such command: %s", dlerror());
  say(text, 0, NULL);
  return -1;
}
static int do_crash(const char *p) {
  (void)p;
  return raise(SIGSEGV);
}
static int do_hang(const char *p) {
  volatile int on = 1;
  while (on) (void)p;
  return 0;
}

static const struct {
  const char *name;
  int (*act)(const char *path);
} deeds[] = {
    {"append", do_append},     {"create", do_create}, {"change", do_change},
    {"read", do_read},         {"remove", do_remove}, {"folder", do_folder},
    {"truncate", do_truncate}, {"link", do_link},     {"mode", do_mode},
    {"shell", do_shell},       {"exec", do_exec},     {"fork", do_fork},
    {"parent", do_parent},     {"socket", do_socket}, {"code", do_code},
    {"memory", do_memory},     {"crash", do_crash},   {"hang", do_hang},
    {"osdi", do_osdi},
};

EXPORT int ngSpice_Init(SendChar *words, SendStat *status, ControlledExit *end,
                        SendData *data, SendInitData *first,
                        BGThreadRunning *thread, void *user) {
  (void)status, (void)end, (void)data, (void)first, (void)thread, (void)user;
  say = words;
  return 0;
}

EXPORT int ngSpice_Circ(char **deck) {
  (void)deck;
  return 0;
}

EXPORT int ngSpice_Command(char *command) {
  char text[256];
  char *path = strchr(command, ' ');
  if (path) *path++ = 0;
  for (size_t i = 0; i < sizeof deeds / sizeof *deeds; i++) {
    if (strcmp(command, deeds[i].name) != 0) continue;
    int got = deeds[i].act(path ? path : "");
    if (deeds[i].act == do_osdi) return 0;
    snprintf(text, sizeof text, "stderr error: %s gave %d (%s)", command, got,
             strerror(errno));
    say(text, 0, NULL);
  }
  return 0;
}

EXPORT char **ngSpice_AllPlots(void) {
  static char *none[] = {NULL};
  return none;
}

EXPORT char **ngSpice_AllVecs(char *plot) {
  (void)plot;
  return ngSpice_AllPlots();
}

EXPORT pvector_info ngGet_Vec_Info(char *name) {
  (void)name;
  return NULL;
}
