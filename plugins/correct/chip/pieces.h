/* until ranks lands */
#ifndef PIECES_H
#define PIECES_H
#include <opcflow/step.h>
typedef struct opc_bytes opc_bytes;
struct opc_bytes { void (*add)(opc_bytes *bytes, const void *from, size_t size); };
typedef struct opc_pieces {
  void *data; const char *name; size_t count;
  const char *(*key)(void *data, size_t i);
  double (*cost)(void *data, size_t i);
  int (*work)(void *data, size_t i, opc_bytes *out, opc_error *error);
  int (*take)(void *data, size_t i, const void *bytes, size_t size, opc_error *error);
  void (*done)(void *data, size_t done);
} opc_pieces;
int pieces_run(const opc_host *host, const opc_pieces *p, opc_error *error);
enum { OPC_STEP_PIECES = 4 };
#endif
