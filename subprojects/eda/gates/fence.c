/* SPDX-License-Identifier: BSD-3-Clause */
/* Guard words and guard pages around arrays. */
#include "gates/fence.h"

#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "imaging/values.h"

enum {
  /* Bytes on each side; out-of-bounds writes within FENCE damage no other
     data. */
  FENCE = EDA_VALUES_SPARE,
  WORD = 0xA5, /* as int32_t a large negative number, as double a tiny negative
                  number */
  PAGE = 4096,
  ALIGNED = 16,    /* bytes; alignment of arrays as by malloc */
  GUARD = 1 << 20, /* bytes of guard pages on each side */
  RETIRED = 8192   /* number of freed arrays whose addresses stay unused */
};

/* Header before the array. The sizes precede the guard words, so that a short
   write before the array does not change the sizes. */
typedef struct fence {
  size_t bytes;
  size_t paged; /* accessible bytes between guard pages; 0: no guard pages */
  char words[FENCE - 2 * sizeof(size_t)];
} fence;

/* Return whether the environment requests guard pages. */
static int fence_has_pages(void) {
  static int known = -1;
  int has = __atomic_load_n(&known, __ATOMIC_RELAXED);
  if (has < 0) {
#ifdef __SANITIZE_ADDRESS__
    has = 0; /* the sanitizer has its own guard pages */
#else
    has = !g_strcmp0(g_getenv("OPCFLOW_GUARD"), "pages");
#endif
    __atomic_store_n(&known, has, __ATOMIC_RELAXED);
  }
  return has;
}

/* ---- guard pages ---- */

static size_t round_up(size_t bytes, size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

/* Return inaccessible memory. */
static void *pages_reserve(void *at, size_t bytes) {
  int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void *pages = mmap(at, bytes, PROT_NONE, flags | (at ? MAP_FIXED : 0), -1, 0);
  return pages == MAP_FAILED ? NULL : pages;
}

/* Return the header of an array of `bytes` between guard pages. The array is
   zeroed; all other bytes between the guard pages are guard words, at least
   FENCE bytes after the array. Return NULL if no address space is left. */
static fence *paged_new(size_t bytes) {
  size_t tail = round_up(bytes, ALIGNED) + FENCE;
  size_t paged = round_up(sizeof(fence) + tail, PAGE);
  char *pages = pages_reserve(NULL, GUARD + paged + GUARD);
  if (!pages) return NULL;
  if (mprotect(pages + GUARD, paged, PROT_READ | PROT_WRITE)) {
    munmap(pages, GUARD + paged + GUARD);
    return NULL;
  }
  fence *f = (fence *)(pages + GUARD + paged - tail - sizeof(fence));
  memset(pages + GUARD, WORD, paged);
  memset(f + 1, 0, bytes);
  f->paged = paged;
  return f;
}

static char *paged_start(const fence *f) {
  return (char *)((uintptr_t)f / PAGE * PAGE);
}

/* Make an array inaccessible. The addresses are used again after RETIRED other
   arrays, so that a pointer kept from an earlier call does not point to a new
   array. */
static void paged_retire(const fence *f) {
  static GMutex lock;
  static struct {
    char *pages;
    size_t bytes;
  } retired[RETIRED], oldest;
  static size_t next;
  size_t bytes = GUARD + f->paged + GUARD;
  char *pages = paged_start(f) - GUARD;
  (void)pages_reserve(pages, bytes);
  g_mutex_lock(&lock);
  oldest = retired[next];
  retired[next].pages = pages;
  retired[next].bytes = bytes;
  next = (next + 1) % RETIRED;
  if (oldest.pages) munmap(oldest.pages, oldest.bytes);
  g_mutex_unlock(&lock);
}

/* ---- arrays ---- */

void *fence_new(size_t count, size_t size, const void *from) {
  size_t bytes = count * size;
  fence *f = fence_has_pages() ? paged_new(bytes) : NULL;
  if (!f) {
    f = eda_alloc_shared(1, sizeof *f + bytes + FENCE);
    memset((char *)(f + 1) + bytes, WORD, FENCE);
  }
  memset(f->words, WORD, sizeof f->words);
  f->bytes = bytes;
  if (from && bytes) memcpy(f + 1, from, bytes);
  return f + 1;
}

void fence_free(void *array) {
  fence *f = array ? (fence *)array - 1 : NULL;
  if (f && f->paged)
    paged_retire(f);
  else
    eda_free(f);
}

static int is_whole(const char *words, size_t n) {
  size_t i = 0;
  while (i < n && (unsigned char)words[i] == WORD) i++;
  return i == n;
}

static int fence_overrun(const char *side, const char *what, opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "writes %s the array of %s", side,
                  what);
}

int fence_check(const void *array, const char *what, opc_error *error) {
  const fence *f = (const fence *)array - 1;
  const char *after = (const char *)array + f->bytes, *first = paged_start(f);
  /* Test the words before the array first: if they are damaged, the sizes may
     be wrong. */
  if (!is_whole(f->words, sizeof f->words) ||
      (f->paged && !is_whole(first, (size_t)((const char *)f - first))))
    return fence_overrun("before", what, error);
  size_t n = f->paged ? (size_t)(first + f->paged - after) : FENCE;
  return is_whole(after, n) ? OPC_OK : fence_overrun("beyond", what, error);
}

void fence_field(eda_field *field) {
  size_t bytes = (size_t)field->nx * (size_t)field->ny * sizeof(float);
  size_t capacity = 0;
  char *values = (char *)field->coefficients;
  eda_grow_to(&values, &capacity, bytes + FENCE, 1);
  memset(values + bytes, WORD, FENCE);
  field->coefficients = (float *)values;
}

/* ---- fields lent with guard pages ---- */

static GMutex lent_lock;
static fence_loan *lent;

/* Remove a loan from the list. Return whether it was in the list. */
static int loan_end(const float *values) {
  fence_loan **at = &lent;
  g_mutex_lock(&lent_lock);
  while (*at && (*at)->values != values) at = &(*at)->next;
  int found = *at != NULL;
  if (found) *at = (*at)->next;
  g_mutex_unlock(&lent_lock);
  return found;
}

/* Free values that are lent, and return 1; return 0 for other values. For
   eda_values_take. */
static int loan_take(float *values) {
  if (!loan_end(values)) return 0;
  fence_free(values);
  return 1;
}

void fence_lend(eda_field *field, fence_loan *loan) {
  loan->n = (size_t)field->nx * (size_t)field->ny;
  loan->values = loan->own = field->coefficients;
  if (!fence_has_pages()) {
    fence_field(field);
    loan->values = loan->own = field->coefficients;
    return;
  }
  loan->values = fence_new(loan->n, sizeof(float), loan->own);
  field->coefficients = loan->values;
  g_mutex_lock(&lent_lock);
  loan->next = lent;
  lent = loan;
  eda_values_take = loan_take;
  g_mutex_unlock(&lent_lock);
}

int fence_return(eda_field *field, const fence_loan *loan, const char *what,
                 opc_error *error) {
  int kept = field->coefficients == loan->values;
  if (loan->values == loan->own)
    return kept ? fence_check_field(loan->own, loan->n, what, error) : OPC_OK;
  int code = kept ? fence_check(loan->values, what, error) : OPC_OK;
  if (kept) memcpy(loan->own, loan->values, loan->n * sizeof(float));
  if (kept) field->coefficients = loan->own;
  if (!kept) free(loan->own);
  (void)loan_take(loan->values);
  return code;
}

int fence_check_field(const float *values, size_t n, const char *what,
                      opc_error *error) {
  return is_whole((const char *)(values + n), FENCE)
             ? OPC_OK
             : fence_overrun("beyond", what, error);
}
