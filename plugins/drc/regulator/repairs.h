/* SPDX-License-Identifier: BSD-3-Clause */
/* What fails at the sites of a print, and the patches of the mask that mend
   it. */
#ifndef OPCFLOW_REGULATOR_REPAIRS_H
#define OPCFLOW_REGULATOR_REPAIRS_H

#include "trims.h"

/* A site that failed once: by side, how far off the drawn edge is, the piece of
   it that a patch moves (along the edge), how far the mask may go past it, how
   far it goes, and what prints. */
typedef struct repair {
  uint32_t site;
  int32_t edge[SIDES], from[SIDES], to[SIDES];   /* grid steps */
  int32_t room[SIDES], grow[SIDES];
  /* What moves the corners at both ends of that piece, NULL for nothing. */
  const opc_fragment *corner[SIDES][2];
  uint32_t back[SIDES];  /* the round in which it last went back */
  double value[SIDES];   /* nm from the side of the box outwards to the contour */
  response response[SIDES];
  double flanked[SIDES]; /* what printed when the sides beside last went out for
                            it; 0: they did not */
} repair;

typedef struct repairs {
  repair *at;
  size_t n, most;
  trims trims;
} repairs;

void repairs_clear(repairs *r);

/* Look at the sites of a print. Repairs are made for those that fail and can be
   mended. */
int repairs_look(const opc_host *host, const opc_printed *p, const limits *rules,
                 const drawing *d, sites *s, repairs *r, opc_error *error);

/* Let patches grow where the print needs it, and edges go back that made poly
   print as one. */
int repairs_grow(const opc_host *host, const opc_printed *p, const limits *rules,
                 const drawing *d, sites *s, repairs *r, opc_error *error);

/* The patches of all. 0 if there is no memory. */
int repairs_patches(const opc_printed *p, const limits *rules, const sites *s,
                    const repairs *r, box_list patch[OPC_MASKS]);

/* The sites that fail, with the reason where they cannot be mended. */
void repairs_report(const opc_host *host, const opc_printed *p,
                    const limits *rules, const sites *s, const repairs *r,
                    violations *out);

#endif
