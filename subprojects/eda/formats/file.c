/* SPDX-License-Identifier: BSD-3-Clause */
/* Closes a written file and reports failures of all earlier writes. */
#include <eda/file.h>

#include <errno.h>
#include <string.h>

int eda_file_close(FILE *file, const char *path, const char *parameter,
                   opc_error *error) {
  int failed = !file || ferror(file), why = errno;
  if (file && fclose(file)) {
    failed = 1;
    why = errno;
  }
  if (!failed) return OPC_OK;
  return opc_fail(error, OPC_IO, parameter, "'%.300s': %s", path,
                  strerror(why));
}
