/* SPDX-License-Identifier: BSD-3-Clause */
/* GDSII records: their numbers and how numbers stand in them. Shared by the
   plugins read.gds and write.gds. (GDSII Stream Format Manual, release 6.0.)

   A record is its length (2 bytes, with these 4), its type, its data type,
   then the data; everything is big-endian. */
#ifndef OPCFLOW_GDS_RECORDS_H
#define OPCFLOW_GDS_RECORDS_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>

enum {
  GDS_HEADER = 0x00,
  GDS_BGNLIB = 0x01,
  GDS_LIBNAME = 0x02,
  GDS_UNITS = 0x03,
  GDS_ENDLIB = 0x04,
  GDS_BGNSTR = 0x05,
  GDS_STRNAME = 0x06,
  GDS_ENDSTR = 0x07,
  GDS_BOUNDARY = 0x08,
  GDS_PATH = 0x09,
  GDS_SREF = 0x0a,
  GDS_AREF = 0x0b,
  GDS_TEXT = 0x0c,
  GDS_LAYER = 0x0d,
  GDS_DATATYPE = 0x0e,
  GDS_WIDTH = 0x0f,
  GDS_XY = 0x10,
  GDS_ENDEL = 0x11,
  GDS_SNAME = 0x12,
  GDS_COLROW = 0x13,
  GDS_NODE = 0x15,
  GDS_TEXTTYPE = 0x16,
  GDS_PRESENTATION = 0x17,
  GDS_STRING = 0x19,
  GDS_STRANS = 0x1a,
  GDS_MAG = 0x1b,
  GDS_ANGLE = 0x1c,
  GDS_REFLIBS = 0x1f,
  GDS_FONTS = 0x20,
  GDS_PATHTYPE = 0x21,
  GDS_GENERATIONS = 0x22,
  GDS_ATTRTABLE = 0x23,
  GDS_STRTYPE = 0x25,
  GDS_ELFLAGS = 0x26,
  GDS_ELKEY = 0x27,
  GDS_NODETYPE = 0x2a,
  GDS_PROPATTR = 0x2b,
  GDS_PROPVALUE = 0x2c,
  GDS_BOX = 0x2d,
  GDS_BOXTYPE = 0x2e,
  GDS_PLEX = 0x2f,
  GDS_BGNEXTN = 0x30,
  GDS_ENDEXTN = 0x31,
  GDS_TAPENUM = 0x32,
  GDS_TAPECODE = 0x33,
  GDS_STRCLASS = 0x34,
  GDS_FORMAT = 0x36,
  GDS_MASK = 0x37,
  GDS_ENDMASKS = 0x38,
  GDS_LIBDIRSIZE = 0x39,
  GDS_SRFNAME = 0x3a,
  GDS_LIBSECUR = 0x3b
};

/* Data types. */
enum {
  GDS_NOTHING = 0,
  GDS_BITS = 1,
  GDS_INT2 = 2,
  GDS_INT4 = 3,
  GDS_REAL8 = 5,
  GDS_ASCII = 6
};

/* The property that holds an instance's name. */
enum { GDS_INSTANCE_NAME = 61 };

static inline uint32_t gds_u16(const uint8_t *p) {
  return (uint32_t)p[0] << 8 | p[1];
}

static inline int32_t gds_i32(const uint8_t *p) {
  return (int32_t)((uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 |
                   (uint32_t)p[2] << 8 | p[3]);
}

/* Sign, 7 bits of exponent to 16 less 64, 56 bits of fraction: exact but for
   fractions of more than 53 bits, which are rounded once. */
static inline double gds_real(const uint8_t *p) {
  uint64_t fraction = 0;
  for (int i = 1; i < 8; i++) fraction = fraction << 8 | p[i];
  double value = ldexp((double)fraction, 4 * ((p[0] & 0x7f) - 64) - 56);
  return p[0] & 0x80 ? -value : value;
}

static inline void gds_put_u16(uint8_t *p, uint32_t v) {
  p[0] = (uint8_t)(v >> 8);
  p[1] = (uint8_t)v;
}

static inline void gds_put_i32(uint8_t *p, int32_t v) {
  gds_put_u16(p, (uint32_t)v >> 16);
  gds_put_u16(p + 2, (uint32_t)v & 0xffff);
}

/* Exact for |v| from 16^-65 to below 16^63, 0 for what is smaller. */
static inline void gds_put_real(uint8_t *p, double v) {
  int e;
  double m = frexp(fabs(v), &e); /* |v| = m 2^e, m in [1/2, 1) */
  int sixteens = (int)ceil(e / 4.0);
  uint64_t fraction = (uint64_t)ldexp(m, 56 + e - 4 * sixteens);
  if (!fraction || sixteens < -64) fraction = 0, sixteens = -64;
  p[0] = (uint8_t)(sixteens + 64) | (v < 0 && fraction ? 0x80 : 0);
  for (int i = 7; i > 0; i--, fraction >>= 8) p[i] = (uint8_t)fraction;
}

#endif
