/* SPDX-License-Identifier: BSD-3-Clause */
/* Standard normal numbers as functions of their indices. */
#include <eda/random.h>
#include <eda/simd.h>
#include <math.h>
#include <string.h>

#include "variation.h"

/* ---- single numbers ---- */

uint64_t normal_key(uint64_t seed, uint32_t stream, uint64_t chip) {
  uint64_t key = eda_random_mix(seed + EDA_RANDOM_STEP * (stream + 1u));
  return eda_random_mix(key + EDA_RANDOM_STEP * (chip + 1));
}

double normal_at(uint64_t seed, uint32_t stream, uint64_t chip, uint32_t k) {
  uint64_t key = normal_key(seed, stream, chip);
  uint64_t a = eda_random_mix(key + EDA_RANDOM_STEP * (2 * (uint64_t)k + 1));
  uint64_t b = eda_random_mix(key + EDA_RANDOM_STEP * (2 * (uint64_t)k + 2));
  double u = ((double)(a >> 11) + 0.5) / 9007199254740992.0;
  double t = (double)(b >> 11) / 9007199254740992.0;
  return sqrt(-2 * log(u)) * cos(2 * M_PI * t);
}

/* ---- LANES pairs at a time ---- */

/* A bijective hash of 32 bits: C. Wellons, "Prospecting for hash functions"
   (2018), constants of lowbias32. */
static inline uint32_t mix32(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/* Return ln u for u = (bits of a float in (0, 1]): u = 2^e m with m from
   sqrt(1/2) to sqrt(2), ln m = 2 artanh((m - 1) / (m + 1)) to the 9th order. */
static inline float ln_of(float u) {
  int32_t bits, part;
  memcpy(&bits, &u, sizeof bits);
  int32_t e = (bits - 0x3f3504f3) >> 23;
  part = bits - e * (1 << 23);
  float m;
  memcpy(&m, &part, sizeof m);
  float s = (m - 1) / (m + 1), q = s * s;
  float series =
      2.0F +
      q * (0.666666667F + q * (0.4F + q * (0.285714286F + q * 0.222222222F)));
  return (float)e * 0.693147181F + s * series;
}

/* Return sin(2 pi x) for |x| <= 1/4; error below 4e-6. */
static inline float sin_turn(float x) {
  float q = x * x;
  return x * (6.2831853F +
              q * (-41.341702F +
                   q * (81.605249F + q * (-76.705860F + q * 42.058694F))));
}

EDA_WIDE void normal_pairs(uint64_t key, uint32_t first, float *a, float *b) {
  uint32_t low = (uint32_t)key, high = (uint32_t)(key >> 32);
  for (uint32_t k = 0; k < LANES; k++) {
    uint32_t h = mix32((first + k) * 0x9e3779b9u + low);
    uint32_t g = mix32(h ^ high);
    float u = ((float)(int32_t)(h >> 8) + 0.5F) * (1.0F / 16777216.0F);
    float t = (float)((int32_t)g >> 8) * (1.0F / 16777216.0F);
    float radius = sqrtf(-2.0F * ln_of(u)), turn = fabsf(t);
    float sine = sin_turn(0.25F - fabsf(turn - 0.25F));
    a[k] = radius * sin_turn(0.25F - turn);
    b[k] = radius * (t < 0 ? -sine : sine);
  }
}
