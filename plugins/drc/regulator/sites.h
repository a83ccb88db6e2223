/* SPDX-License-Identifier: BSD-3-Clause */
/* Places where the print is looked at: contacts, lines of poly outside of
   gates, and the gaps between them. */
#ifndef OPCFLOW_REGULATOR_SITES_H
#define OPCFLOW_REGULATOR_SITES_H

#include "bins.h"
#include "rules.h"

enum {
  SITE_ENCLOSURE, /* a contact that its layer must cover */
  SITE_CONTACT,   /* a contact that poly must not touch */
  SITE_LINE,      /* across a line of poly, as long as it must be wide */
  SITE_GAP        /* the middle between two edges of poly, or of active */
};

typedef struct site {
  opc_box box;      /* grid steps */
  int32_t gate;     /* the nearest one, -1 for none */
  int32_t repair;   /* its number (of a gap: of its trims); -1: none */
  uint8_t kind, layer;
  uint8_t sides;    /* those that are looked at, 1 << LEFT and so on; of a gap
                       the lower one of the two walls */
  uint8_t failing;  /* at the last look */
} site;

/* What is drawn, by place. */
typedef struct drawing {
  bins edges[OPC_MASKS];   /* of poly and active */
  bins gates;
  bins contacts;           /* those that poly must not touch */
  bins pads;               /* contacts that poly must cover */
  bins widths;             /* edges of active that a gate's width moves */
  const opc_fragment **width;   /* of each of them */
} drawing;

typedef struct sites {
  site *at;
  size_t n, room;
  int failed;              /* for want of memory */
} sites;

/* Clear both with the functions below, also on failure. */
int drawing_make(drawing *d, const opc_host *host, const opc_gates *gates,
                 const limits *rules, sites *out, opc_error *error);
void drawing_clear(drawing *d);
void sites_clear(sites *s);

#endif
