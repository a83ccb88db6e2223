/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the reader of kernel sets of the ICCAD 2013 contest. */
#include "files.h"

#include <eda/memory.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { HEADER = 24, MOST_KERNELS = 4096 };

/* ---- weights ---- */

/* Read the next number of a text. *line receives the number of its line. Return
   0 if the next word is not a number. */
static int next_number(FILE *file, double *value, size_t *line) {
  char word[64];
  size_t n = 0;
  int c;
  while ((c = getc(file)) == ' ' || c == '\t' || c == '\r' || c == '\n')
    *line += c == '\n';
  for (; c != EOF && c != ' ' && c != '\t' && c != '\r' && c != '\n';
       c = getc(file))
    if (n < sizeof word - 1) word[n++] = (char)c;
  if (c == '\n') ungetc(c, file);
  word[n] = 0;
  char *end;
  *value = strtod(word, &end);
  return n && !*end && isfinite(*value);
}

static int read_weights(FILE *file, const char *path, size_t most,
                        kernel_set *set, opc_error *error) {
  size_t line = 1;
  double number;
  if (!next_number(file, &number, &line) || number != floor(number) ||
      number < 1 || number > MOST_KERNELS)
    return opc_fail(error, OPC_IO, NULL,
                    "%s:%zu: expected a number of kernels from 1 to %d", path,
                    line, MOST_KERNELS);
  set->count = (size_t)number;
  if (most > set->count)
    return opc_fail(error, OPC_INVALID, "kernels",
                    "'kernels' is %zu, but '%s' has %zu kernels", most, path,
                    set->count);
  if (most) set->count = most;
  set->weight = eda_alloc(set->count, sizeof *set->weight);
  for (size_t i = 0; i < set->count; i++)
    if (!next_number(file, &set->weight[i], &line) || set->weight[i] < 0)
      return opc_fail(error, OPC_IO, NULL,
                      "%s:%zu: expected the weight of kernel %zu", path, line,
                      i);
  return OPC_OK;
}

/* ---- kernels ---- */

static uint32_t big_endian(const uint8_t *p) {
  return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 |
         p[3];
}

static int take_size(const char *path, const uint8_t *head, kernel_set *set,
                     opc_error *error) {
  uint32_t rows = big_endian(head), columns = big_endian(head + 4);
  if (rows != columns || rows % 2 == 0 || rows > KERNEL_MOST)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s': %u x %u frequencies at byte 0, expected an odd "
                    "square of at most %d",
                    path, rows, columns, KERNEL_MOST);
  if (set->data && (int)rows != set->size)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s': %u frequencies across at byte 0, expected %d as in "
                    "the preceding kernels",
                    path, rows, set->size);
  set->size = (int)rows;
  set->half = set->size / 2;
  if (!set->data)
    set->data = eda_alloc(set->count * rows * rows * 2, sizeof *set->data);
  return OPC_OK;
}

static int read_kernel(const char *path, FILE *file, size_t s, kernel_set *set,
                       opc_error *error) {
  uint8_t head[HEADER], row[KERNEL_MOST * 8];
  size_t got = fread(head, 1, HEADER, file), at = got;
  if (got == HEADER && take_size(path, head, set, error)) return error->code;
  size_t n = (size_t)set->size;
  for (size_t l = 0; got && at >= HEADER && l < n; l++) {
    got = fread(row, 1, 8 * n, file);
    at += got;
    if (got < 8 * n) break;
    float *out = set->data + 2 * (s * n + l) * n;
    for (size_t i = 0; i < 2 * n; i++) {
      uint32_t bits = big_endian(row + 4 * i);
      memcpy(&out[i], &bits, 4);
      if (!isfinite(out[i]))
        return opc_fail(error, OPC_IO, NULL,
                        "'%s': value at byte %zu is not a finite number", path,
                        at - 8 * n + 4 * i);
      int x = (int)i / 2 - set->half, y = (int)l - set->half;
      if (out[i] != 0) set->radius = fmax(set->radius, hypot(x, y));
    }
  }
  if (at < HEADER || at < HEADER + 8 * n * n)
    return opc_fail(error, OPC_IO, NULL, "'%s': ends at byte %zu", path, at);
  if (getc(file) != EOF)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s': more than %zu x %zu frequencies, at byte %zu", path,
                    n, n, at);
  return OPC_OK;
}

/* ---- sets ---- */

static FILE *open_file(const char *path, opc_error *error) {
  struct stat about;
  if (!stat(path, &about) && !S_ISREG(about.st_mode)) {
    opc_fail(error, OPC_IO, NULL, "'%s': is not a regular file", path);
    return NULL;
  }
  FILE *file = fopen(path, "rb");
  if (!file) opc_fail(error, OPC_IO, NULL, "'%s': %s", path, strerror(errno));
  return file;
}

static int read_kernels(const char *path, kernel_set *set, opc_error *error) {
  const char *slash = strrchr(path, '/');
  size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
  char *name = eda_alloc(folder + 32, 1);
  memcpy(name, path, folder);
  int code = OPC_OK;
  for (size_t s = 0; s < set->count && !code; s++) {
    snprintf(name + folder, 32, "fh%zu.bin", s);
    FILE *file = open_file(name, error);
    code = file ? read_kernel(name, file, s, set, error) : error->code;
    if (file) fclose(file);
  }
  free(name);
  return code;
}

int kernel_set_read(const char *path, size_t most, kernel_set *out,
                    opc_error *error) {
  *out = (kernel_set){0};
  FILE *file = open_file(path, error);
  if (!file) return error->code;
  int code = read_weights(file, path, most, out, error);
  fclose(file);
  if (!code) code = read_kernels(path, out, error);
  if (!code && out->radius == 0)
    code = opc_fail(error, OPC_IO, NULL,
                    "'%s': the kernels pass only the zero order", path);
  if (code) kernel_set_clear(out);
  return code;
}

void kernel_set_clear(kernel_set *set) {
  free(set->weight);
  free(set->data);
  *set = (kernel_set){0};
}
