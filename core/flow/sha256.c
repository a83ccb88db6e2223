/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/sha256.h"

#include <string.h>

#if defined(__x86_64__)

#include <cpuid.h>
#include <immintrin.h>

static gboolean is_fast(void) {
  unsigned a, b, c, d;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_SSE4_1)) return FALSE;
  return __get_cpuid_count(7, 0, &a, &b, &c, &d) && b & bit_SHA;
}

/* FIPS 180-4, 4.2.2 */
static const uint32_t constants[64] __attribute__((aligned(16))) = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1,
    0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3,
    0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786,
    0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147,
    0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13,
    0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
    0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a,
    0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
    0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

/* The instructions keep a, b, e, f in one register and c, d, g, h in another;
   each pair of them does four of the 64 rounds. */
__attribute__((target("sha,sse4.1"))) static void add_blocks(
    uint32_t *state, const uint8_t *data, size_t blocks) {
  const __m128i swap = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  __m128i *out = (__m128i *)(void *)state;
  __m128i t = _mm_shuffle_epi32(_mm_loadu_si128(out), 0xb1);
  __m128i cdgh = _mm_shuffle_epi32(_mm_loadu_si128(out + 1), 0x1b);
  __m128i abef = _mm_alignr_epi8(t, cdgh, 8);
  cdgh = _mm_blend_epi16(cdgh, t, 0xf0);
  for (; blocks--; data += 64) {
    __m128i w[4], old_abef = abef, old_cdgh = cdgh;
    for (int i = 0; i < 4; i++)
      w[i] = _mm_shuffle_epi8(
          _mm_loadu_si128((const __m128i *)(const void *)(data + 16 * i)),
          swap);
#pragma GCC unroll 16
    for (int i = 0; i < 16; i++) {
      if (i >= 4) {
        t = _mm_alignr_epi8(w[(i + 3) & 3], w[(i + 2) & 3], 4);
        t = _mm_add_epi32(t, _mm_sha256msg1_epu32(w[i & 3], w[(i + 1) & 3]));
        w[i & 3] = _mm_sha256msg2_epu32(t, w[(i + 3) & 3]);
      }
      t = _mm_add_epi32(
          w[i & 3],
          _mm_load_si128((const __m128i *)(const void *)(constants + 4 * i)));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, t);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(t, 0x0e));
    }
    abef = _mm_add_epi32(abef, old_abef);
    cdgh = _mm_add_epi32(cdgh, old_cdgh);
  }
  t = _mm_shuffle_epi32(abef, 0x1b);
  cdgh = _mm_shuffle_epi32(cdgh, 0xb1);
  _mm_storeu_si128(out, _mm_blend_epi16(t, cdgh, 0xf0));
  _mm_storeu_si128(out + 1, _mm_alignr_epi8(cdgh, t, 8));
}

#else

static gboolean is_fast(void) { return FALSE; }

static void add_blocks(uint32_t *state, const uint8_t *data, size_t blocks) {
  (void)state;
  (void)data;
  (void)blocks;
}

#endif

void opc_sha256_begin(opc_sha256 *sum) {
  /* FIPS 180-4, 5.3.3 */
  static const uint32_t start[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372,
                                    0xa54ff53a, 0x510e527f, 0x9b05688c,
                                    0x1f83d9ab, 0x5be0cd19};
  *sum = (opc_sha256){0};
  memcpy(sum->state, start, sizeof start);
  if (!is_fast()) sum->slow = g_checksum_new(G_CHECKSUM_SHA256);
}

void opc_sha256_add(opc_sha256 *sum, const void *data, size_t n) {
  if (sum->slow) {
    g_checksum_update(sum->slow, data, (gssize)n);
    return;
  }
  const uint8_t *p = data;
  size_t used = sum->length % 64;
  sum->length += n;
  if (used) {
    size_t some = MIN(n, 64 - used);
    memcpy(sum->rest + used, p, some);
    if (used + some < 64) return;
    add_blocks(sum->state, sum->rest, 1);
    p += some;
    n -= some;
  }
  add_blocks(sum->state, p, n / 64);
  memcpy(sum->rest, p + n / 64 * 64, n % 64);
}

char *opc_sha256_end(opc_sha256 *sum) {
  if (sum->slow) {
    char *text = g_strdup(g_checksum_get_string(sum->slow));
    g_checksum_free(sum->slow);
    return text;
  }
  /* A one, zeros, and the length in bits fill the last block. */
  uint8_t end[72] = {0x80};
  size_t used = sum->length % 64, zeros = (used < 56 ? 56 : 120) - used;
  uint64_t bits = sum->length * 8;
  for (int i = 0; i < 8; i++)
    end[zeros + (size_t)i] = (uint8_t)(bits >> (56 - 8 * i));
  opc_sha256_add(sum, end, zeros + 8);
  char text[65];
  for (int i = 0; i < 8; i++)
    g_snprintf(text + 8 * i, 9, "%08x", sum->state[i]);
  return g_strdup(text);
}
