/* SPDX-License-Identifier: BSD-3-Clause */
/* A compiled model for tests, by the Open Source Device Interface, version 0.3:
   the symmetric square law

   I(d, s) = w / l (k / 2 (max(0, vgs - vt)^2 - max(0, vgd - vt)^2) + g vds)

   with the signs of a p-transistor where `type` is below 0. When the model is
   loaded, it attempts all actions that are forbidden to simulations. If one of
   them succeeds, the transistor does not conduct. */
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>

/* ---- the interface, read by a simulator ---- */

typedef struct pair {
  uint32_t row, column;
} pair;

typedef struct entry {
  pair at;
  uint32_t react, flags;
} entry;

typedef struct node {
  const char *name, *unit, *residual_unit;
  uint32_t resist, react, resist_limit, react_limit;
  bool is_flow;
} node;

typedef struct setting {
  const char *const *name;
  uint32_t aliases;
  const char *summary, *unit;
  uint32_t flags, length;
} setting;

typedef struct faults {
  uint32_t flags, count;
  void *fault;
} faults;

typedef struct state {
  char **names;
  double *values;
  char **text_names, **texts;
  double time, *voltage, *before, *after;
  uint32_t flags;
} state;

typedef void load(void *instance, void *model, double *to);

typedef struct descriptor {
  const char *name;
  uint32_t nodes, terminals;
  const node *node;
  uint32_t entries;
  const entry *entry;
  uint32_t collapsible;
  const pair *collapse;
  uint32_t collapsed;
  const void *noise;
  uint32_t noises, settings, of_instance, read_only;
  const setting *setting;
  uint32_t mapping, jacobian, states, state_index, bound_step, instance, model;
  void *(*access)(void *instance, void *model, uint32_t id, uint32_t flags);
  void (*setup_model)(void *handle, void *model, void *simulator, faults *out);
  void (*setup_instance)(void *handle, void *instance, void *model,
                         double temperature, uint32_t terminals,
                         void *simulator, faults *out);
  uint32_t (*eval)(void *handle, void *instance, const void *model,
                   const state *at);
  void (*load_noise)(void *instance, void *model, double at, double *to);
  load *residual_resist, *residual_react, *limit_resist, *limit_react;
  void (*rhs_dc)(void *instance, void *model, double *to, double *voltage);
  void (*rhs_tran)(void *instance, void *model, double *to, double *voltage,
                   double alpha);
  void (*jacobian_resist)(void *instance, void *model);
  void (*jacobian_react)(void *instance, void *model, double alpha);
  void (*jacobian_tran)(void *instance, void *model, double alpha);
} descriptor;

/* ---- state ---- */

enum { D, G, S, B, NODES, ENTRIES = 6 };
enum { W, L, OF_INSTANCE, TYPE = OF_INSTANCE, K, VT, LEAK, SETTINGS };

typedef struct transistor {
  uint32_t node[NODES];
  double *matrix[ENTRIES], slope[ENTRIES], current, size[OF_INSTANCE];
} transistor;

typedef struct card {
  double of[SETTINGS];
} card;

static int is_free; /* 1: a forbidden action succeeded */

__attribute__((constructor)) static void look_around(void) {
  is_free = open("/etc/passwd", O_RDONLY) >= 0 ||
            mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS,
                 -1, 0) != MAP_FAILED;
}

/* ---- work ---- */

static void *access_find(void *instance, void *model, uint32_t id,
                         uint32_t flags) {
  enum { INSTANCE = 4 };
  transistor *t = instance;
  card *c = model;
  return flags & INSTANCE && id < OF_INSTANCE ? &t->size[id] : &c->of[id];
}

static void set_model(void *handle, void *model, void *simulator, faults *out) {
  (void)handle, (void)model, (void)simulator;
  *out = (faults){0};
}

static void set_instance(void *handle, void *instance, void *model,
                         double temperature, uint32_t terminals,
                         void *simulator, faults *out) {
  (void)handle, (void)instance, (void)model, (void)simulator;
  (void)temperature, (void)terminals;
  *out = (faults){0};
}

static uint32_t model_evaluate(void *handle, void *instance, const void *model,
                               const state *at) {
  (void)handle;
  transistor *t = instance;
  const card *c = model;
  double sign = c->of[TYPE] < 0 ? -1 : 1;
  double share = is_free ? 0 : t->size[W] / t->size[L];
  double v[NODES];
  for (int i = 0; i < NODES; i++) v[i] = sign * at->voltage[t->node[i]];
  double on_s = fmax(0, v[G] - v[S] - c->of[VT]);
  double on_d = fmax(0, v[G] - v[D] - c->of[VT]);
  t->current = sign * share *
               (c->of[K] / 2 * (on_s * on_s - on_d * on_d) +
                c->of[LEAK] * (v[D] - v[S]));
  const double slope[] = {c->of[K] * on_d + c->of[LEAK],
                          c->of[K] * (on_s - on_d),
                          -c->of[K] * on_s - c->of[LEAK]};
  for (int i = 0; i < ENTRIES; i++)
    t->slope[i] = share * slope[i % 3] * (i < 3 ? 1 : -1);
  return 0;
}

/* Newton's method: only nonlinear terms contribute to the right side. */
static void add_rest(void *instance, void *model, double *to, double *voltage) {
  const transistor *t = instance;
  double rest = -t->current;
  (void)model;
  for (int i = 0; i < 3; i++) rest += t->slope[i] * voltage[t->node[i]];
  to[t->node[D]] += rest;
  to[t->node[S]] -= rest;
}

static void add_rest_then(void *instance, void *model, double *to,
                          double *voltage, double alpha) {
  (void)alpha;
  add_rest(instance, model, to, voltage);
}

static void add_slopes(void *instance, void *model) {
  const transistor *t = instance;
  (void)model;
  for (int i = 0; i < ENTRIES; i++) *t->matrix[i] += t->slope[i];
}

static void add_slopes_then(void *instance, void *model, double alpha) {
  (void)alpha;
  add_slopes(instance, model);
}

/* No charges, limits or noise. */
static void add_nothing(void *instance, void *model, double *to) {
  (void)instance, (void)model, (void)to;
}
static void add_no_slopes(void *instance, void *model, double alpha) {
  (void)instance, (void)model, (void)alpha;
}
static void add_no_noise(void *instance, void *model, double at, double *to) {
  (void)instance, (void)model, (void)at, (void)to;
}

/* ---- entry ---- */

#define NONE UINT32_MAX
#define NODE(id) \
  { id, "V", "A", NONE, NONE, NONE, NONE, false }
static const node nodes[] = {NODE("d"), NODE("g"), NODE("s"), NODE("b")};

enum { RESIST = 4 };
static const entry entries[] = {{{D, D}, NONE, RESIST}, {{D, G}, NONE, RESIST},
                                {{D, S}, NONE, RESIST}, {{S, D}, NONE, RESIST},
                                {{S, G}, NONE, RESIST}, {{S, S}, NONE, RESIST}};

static const char *const names[] = {"w", "l", "type", "k", "vt", "leak"};
#define SETTING(id, kind) \
  { &names[id], 0, "", "", (uint32_t)(kind) << 30, 0 }
static const setting settings[] = {SETTING(W, 1),    SETTING(L, 1),
                                   SETTING(TYPE, 0), SETTING(K, 0),
                                   SETTING(VT, 0),   SETTING(LEAK, 0)};

#define EXPORT __attribute__((visibility("default")))
extern EXPORT const uint32_t OSDI_VERSION_MAJOR, OSDI_VERSION_MINOR,
    OSDI_NUM_DESCRIPTORS;
extern EXPORT const descriptor OSDI_DESCRIPTORS[];
const uint32_t OSDI_VERSION_MAJOR = 0, OSDI_VERSION_MINOR = 3,
               OSDI_NUM_DESCRIPTORS = 1;
const descriptor OSDI_DESCRIPTORS[] = {{
    .name = "squarelaw",
    .nodes = NODES,
    .terminals = NODES,
    .node = nodes,
    .entries = ENTRIES,
    .entry = entries,
    .settings = SETTINGS,
    .of_instance = OF_INSTANCE,
    .setting = settings,
    .mapping = offsetof(transistor, node),
    .jacobian = offsetof(transistor, matrix),
    .bound_step = NONE,
    .instance = sizeof(transistor),
    .model = sizeof(card),
    .access = access_find,
    .setup_model = set_model,
    .setup_instance = set_instance,
    .eval = model_evaluate,
    .load_noise = add_no_noise,
    .residual_resist = add_nothing,
    .residual_react = add_nothing,
    .limit_resist = add_nothing,
    .limit_react = add_nothing,
    .rhs_dc = add_rest,
    .rhs_tran = add_rest_then,
    .jacobian_resist = add_slopes,
    .jacobian_react = add_no_slopes,
    .jacobian_tran = add_slopes_then,
}};
