/* SPDX-License-Identifier: BSD-3-Clause */
/* SHA-256 (FIPS 180-4), with the instructions that processors have for it:
   layouts are large, and each one that a run reads goes into its manifest. */
#ifndef OPCFLOW_CORE_SHA256_H
#define OPCFLOW_CORE_SHA256_H

#include <glib.h>
#include <stdint.h>

typedef struct opc_sha256 {
  GChecksum *slow; /* where the processor has no instructions */
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  uint8_t rest[64];
} opc_sha256;

void opc_sha256_begin(opc_sha256 *sum);
void opc_sha256_add(opc_sha256 *sum, const void *data, size_t n);

/* In hexadecimal (g_free); releases what `sum` holds. */
char *opc_sha256_end(opc_sha256 *sum);

#endif
