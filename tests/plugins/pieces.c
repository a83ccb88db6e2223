/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the steps test.pieces and test.alone (without inputs, for lint)
   with two lists of work units. The second list needs the results of the first.
   Each unit waits and appends a line to a journal. The outputs can be saved.

   In the folder `hold`, a test controls units of the second list: unit I makes
   I.here and waits until the file I is removed. Each process makes PID.begun
   in its first unit; no unit ends before `crowd` processes have done so. */
#include <fcntl.h>
#include <glob.h>
#include <opcflow/pieces.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- state ---- */

enum {
  NONE,
  WORK,    /* `work` fails */
  TAKE,    /* `take` fails */
  CRASH,   /* `work` crashes */
  EXIT,    /* `work` kills the process */
  HUGE_,   /* result larger than allowed */
  PUBLISH, /* `work` publishes a metric */
  WARN,    /* `work` logs a warning and a finding */
  NEST,    /* nested work units */
  RANK     /* `take` fails in the rank `at` only */
};

typedef struct pieces {
  const opc_host *host;
  int64_t count, wait, size, at,
      crowd; /* number of units; time of a unit, ms; numbers
         in a result; index of the faulty unit */
  const double *add;
  const char *journal, *hold;
  int fault, kept;
  char text[32]; /* key of a unit */
  double sum;    /* sum of the first list */
  double *taken; /* results of the current list */
  size_t n, done;
} pieces;

/* ---- work ---- */

/* Return a value that makes the sum depend on the order of addition. */
static double value(const pieces *p, size_t i, size_t k) {
  return 1 /
         (1.0 + (double)i + (double)k * 0.37 + p->sum + (p->add ? *p->add : 0));
}

static void write_journal(const pieces *p, const char *list, size_t i) {
  char line[64];
  int n = snprintf(line, sizeof line, "%s %zu %ld\n", list, i, (long)getpid());
  int file =
      p->journal ? open(p->journal, O_WRONLY | O_APPEND | O_CREAT, 0666) : -1;
  if (file < 0) return;
  (void)!write(file, line, (size_t)n);
  (void)close(file);
}

static int take_nested(void *data, size_t i, const void *bytes, size_t size,
                       opc_error *error) {
  (void)i;
  if (size != sizeof(double))
    return opc_fail(error, OPC_FAILED, NULL, "%zu bytes of a nested piece",
                    size);
  *(double *)data += *(const double *)bytes;
  return OPC_OK;
}

static int work_nested(void *data, size_t i, opc_bytes *out, opc_error *error) {
  const double one = 1 + 0 * (double)i;
  (void)data, (void)error;
  out->add(out, &one, sizeof one);
  return OPC_OK;
}

static int pieces_fault(pieces *p, size_t i, opc_bytes *out, opc_error *error) {
  double three = 0;
  const opc_pieces nested = {.data = &three,
                             .name = "part",
                             .count = 3,
                             .work = work_nested,
                             .take = take_nested};
  switch (p->fault) {
    case WORK:
      return opc_fail(error, OPC_FAILED, NULL, "does not want to");
    case CRASH:
      raise(SIGSEGV);
      break;
    case EXIT:
      (void)kill(getpid(), SIGKILL);
      break;
    case HUGE_:
      out->add(out, p, (size_t)1 << 31);
      break;
    case PUBLISH:
      return p->host->metric(p->host, "sum", 1, error);
    case WARN:
      p->host->log(p->host, OPC_LOG_FINDING, "piece %zu is odd", i);
      break;
    case NEST:
      if (opc_do_pieces(p->host, &nested, error)) return error->code;
      if (three < 3) return opc_fail(error, OPC_FAILED, NULL, "not three");
      break;
    default:
      break;
  }
  return OPC_OK;
}

static void mark(const pieces *p, long number, const char *ending) {
  char path[4096];
  (void)snprintf(path, sizeof path, "%s/%ld%s", p->hold, number, ending);
  int file = open(path, O_WRONLY | O_CREAT, 0666);
  if (file >= 0) (void)close(file);
}

static int is_held(const pieces *p, size_t i) {
  char path[4096];
  (void)snprintf(path, sizeof path, "%s/%zu", p->hold, i);
  return p->sum > 0 && !access(path, F_OK);
}

static int is_crowd(const pieces *p) {
  char pattern[4096];
  glob_t found;
  (void)snprintf(pattern, sizeof pattern, "%s/*.begun", p->hold);
  size_t n = glob(pattern, 0, NULL, &found) ? 0 : found.gl_pathc;
  if (n) globfree(&found);
  return (int64_t)n >= p->crowd;
}

/* Wait as the folder `hold` requires, at most ten minutes. */
static int wait_held(const pieces *p, size_t i, opc_error *error) {
  if (!p->hold) return OPC_OK;
  mark(p, getpid(), ".begun");
  if (is_held(p, i)) mark(p, (long)i, ".here");
  for (int n = 0; is_held(p, i) || !is_crowd(p); n++) {
    if (n == 600000)
      return opc_fail(error, OPC_FAILED, NULL, "is still held in '%s'",
                      p->hold);
    (void)usleep(1000);
  }
  return OPC_OK;
}

static int piece_work(void *data, size_t i, opc_bytes *out, opc_error *error) {
  pieces *p = data;
  if ((int64_t)i == p->at && p->sum > 0 && pieces_fault(p, i, out, error))
    return error->code;
  if (wait_held(p, i, error)) return error->code;
  (void)usleep((useconds_t)(p->wait * (1 + (int64_t)i % 3) * 1000));
  for (int64_t k = 0; k < p->size; k++) {
    double v = value(p, i, (size_t)k);
    out->add(out, &v, sizeof v);
  }
  write_journal(p, p->sum > 0 ? "second" : "first", i);
  return OPC_OK;
}

static int is_rank(int64_t at) {
  const char *rank = getenv("OMPI_COMM_WORLD_RANK");
  return rank && atoi(rank) == at;
}

static int piece_take(void *data, size_t i, const void *bytes, size_t size,
                      opc_error *error) {
  pieces *p = data;
  const double *values = bytes;
  if (p->fault == TAKE && p->sum > 0 && (int64_t)i == p->at)
    return opc_fail(error, OPC_FAILED, NULL, "is not taken");
  if (p->fault == RANK && p->sum > 0 && i == 4 && is_rank(p->at))
    return opc_fail(error, OPC_FAILED, NULL, "is not taken here");
  if (i != p->n || size != (size_t)p->size * sizeof *values ||
      (uintptr_t)bytes % _Alignof(max_align_t))
    return opc_fail(error, OPC_FAILED, NULL, "%zu bytes after %zu pieces", size,
                    p->n);
  p->taken[i] = 0;
  for (int64_t k = 0; k < p->size; k++) p->taken[i] += values[k];
  p->n++;
  return OPC_OK;
}

static const char *key(void *data, size_t i) {
  pieces *p = data;
  (void)snprintf(p->text, sizeof p->text, "%zu", i);
  return i % 10 == 9 ? NULL : p->text; /* some units have no key */
}

/* The first units are cheap, so that the order by cost differs from the order
   by index. */
static double cost(void *data, size_t i) { return (void)data, (double)(i % 3); }

static void pieces_done(void *data, size_t n) { ((pieces *)data)->done = n; }

static int do_list(pieces *p, const char *name, opc_error *error) {
  const opc_pieces list = {.data = p,
                           .name = name,
                           .count = (size_t)p->count,
                           .key = p->kept ? key : NULL,
                           .cost = cost,
                           .work = piece_work,
                           .take = piece_take,
                           .done = pieces_done};
  p->n = p->done = 0;
  int code = opc_do_pieces(p->host, &list, error);
  if (!code && (p->n != list.count || p->done != list.count))
    code = opc_fail(error, OPC_FAILED, NULL, "%zu taken, %zu done of %zu", p->n,
                    p->done, list.count);
  for (size_t i = 0; i < p->n; i++) p->sum = p->sum * 0.9 + p->taken[i];
  return code;
}

static int pieces_run(void *self, void **outputs, opc_error *error) {
  pieces *p = self;
  double *out = outputs[0] = malloc(sizeof *out);
  p->taken = calloc((size_t)p->count + 1, sizeof *p->taken);
  p->sum = 0;
  int code = do_list(p, "first", error);
  p->sum += 1;
  if (!code) code = do_list(p, "second", error);
  *out = p->sum;
  const opc_column columns[] = {{"value", NULL, OPC_REAL, -1, p->taken}};
  if (!code)
    code = opc_put_table(p->host, "pieces", 0, p->n, columns, 1, error);
  if (!code) code = p->host->metric(p->host, "sum", p->sum, error);
  free(p->taken);
  return code;
}

static int number_file(const char *folder, const char *mode, double *number) {
  char path[4096];
  (void)snprintf(path, sizeof path, "%s/number", folder);
  FILE *file = fopen(path, mode);
  if (!file) return 0;
  size_t n = *mode == 'w' ? fwrite(number, sizeof *number, 1, file)
                          : fread(number, sizeof *number, 1, file);
  return !fclose(file) && n == 1;
}

static int pieces_save(void *self, void *const *outputs, const char *folder,
                       opc_error *error) {
  (void)self;
  return number_file(folder, "wb", outputs[0])
             ? OPC_OK
             : opc_fail(error, OPC_IO, NULL, "not saved");
}

static int pieces_restore(void *self, const char *folder, void **outputs,
                          opc_error *error) {
  (void)self;
  outputs[0] = malloc(sizeof(double));
  return number_file(folder, "rb", outputs[0])
             ? OPC_OK
             : opc_fail(error, OPC_IO, NULL, "not restored");
}

static int check_number(const void *object, opc_error *error) {
  (void)object, (void)error;
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(pieces, count, .type = OPC_INT, .preset = "12",
                  .flags = OPC_AT_LEAST, .min = 0,
                  .summary = "pieces of each list"),
    OPC_PARAMETER(pieces, size, .type = OPC_INT, .preset = "3",
                  .flags = OPC_AT_LEAST, .min = 0,
                  .summary = "number of results of a piece"),
    OPC_PARAMETER(pieces, wait, .type = OPC_INT, .flags = OPC_NO_EFFECT,
                  .preset = "0", .summary = "ms"),
    OPC_PARAMETER(pieces, kept, .type = OPC_BOOL, .flags = OPC_NO_EFFECT,
                  .preset = "true", .summary = "pieces have keys"),
#ifdef WITH_INPUT
    OPC_PARAMETER(pieces, add, .type = OPC_INPUT, .choices = "number",
                  .summary = "another number"),
#endif
    OPC_PARAMETER(pieces, journal, .type = OPC_TEXT, .flags = OPC_NO_EFFECT,
                  .summary = "a file to which each piece adds a line"),
    OPC_PARAMETER(pieces, hold, .type = OPC_TEXT, .flags = OPC_NO_EFFECT,
                  .summary = "a folder in which a test controls the pieces"),
    OPC_PARAMETER(pieces, crowd, .type = OPC_INT, .flags = OPC_NO_EFFECT,
                  .preset = "1",
                  .summary = "number of processes that begin together"),
    OPC_PARAMETER(
        pieces, fault, .type = OPC_CHOICE, .flags = OPC_NO_EFFECT,
        .preset = "none",
        .choices = "none|work|take|crash|exit|huge|publish|warn|nest|rank",
        .summary = "fault in the second list"),
    OPC_PARAMETER(pieces, at, .type = OPC_INT, .flags = OPC_NO_EFFECT,
                  .preset = "7",
                  .summary = "index of the piece with the fault"),
};

static const opc_metric metrics[] = {
    {"sum", NULL, OPC_NEUTRAL, 0, "sum of all pieces"},
};

/* ---- entry ---- */

static const opc_port outputs[] = {{"sum", "number", check_number, free}};
static const opc_step functions = {
    OPC_OUTPUTS(outputs), .run = pieces_run, .flags = OPC_STEP_PIECES,
    .save = pieces_save, .restore = pieces_restore};

OPC_PLUGIN(pieces, .id = TEST_ID, .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "Step with work units",
           .flags = OPC_DETERMINISTIC, OPC_PARAMETERS(parameters),
           OPC_METRICS(metrics), OPC_FUNCTIONS(functions));
