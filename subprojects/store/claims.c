/* SPDX-License-Identifier: BSD-3-Clause */
/* Claims of processes to keys: locks of single bytes of the file FOLDER/claims,
   which stays empty. The system releases the locks of a process that ends. */
#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

#include "private.h"

/* Number of digits of a key that select the byte; the offset has 60 bits. */
enum { DIGITS = 15 };

/* Lock or unlock the byte of a key. Return FALSE if another process has a
   conflicting lock. */
static gboolean claim_lock(opc_store *store, const char *key, short how) {
  g_autofree char *path = g_build_filename(store->folder, "claims", NULL);
  g_autofree char *digits = g_strndup(key, DIGITS);
  if (store->claims < 0)
    store->claims = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  struct flock lock = {.l_type = how,
                       .l_whence = SEEK_SET,
                       .l_start = (off_t)g_ascii_strtoull(digits, NULL, 16),
                       .l_len = 1};
  return fcntl(store->claims, F_OFD_SETLK, &lock) >= 0 ||
         (errno != EAGAIN && errno != EACCES);
}

gboolean opc_store_claim(opc_store *store, const char *key) {
  return claim_lock(store, key, F_WRLCK);
}

void opc_store_join(opc_store *store, const char *key) {
  (void)claim_lock(store, key, F_RDLCK);
}

void opc_store_leave(opc_store *store, const char *key) {
  (void)claim_lock(store, key, F_UNLCK);
}
