/* SPDX-License-Identifier: BSD-3-Clause */
/* GDSII records: record types and number formats. Used by the plugins read.gds
   and write.gds (GDSII Stream Format Manual, release 6.0).

   A record consists of its length (2 bytes), its type and its data type (1 byte
   each), and the data. The length counts all bytes of the record, including
   these four. All numbers are big-endian. */
#pragma once

#include <math.h>
#include <stdint.h>
#include <stdio.h>

/* Record types. */
enum {
  EDA_GDS_HEADER = 0x00,
  EDA_GDS_BGNLIB = 0x01,
  EDA_GDS_LIBNAME = 0x02,
  EDA_GDS_UNITS = 0x03,
  EDA_GDS_ENDLIB = 0x04,
  EDA_GDS_BGNSTR = 0x05,
  EDA_GDS_STRNAME = 0x06,
  EDA_GDS_ENDSTR = 0x07,
  EDA_GDS_BOUNDARY = 0x08,
  EDA_GDS_PATH = 0x09,
  EDA_GDS_SREF = 0x0a,
  EDA_GDS_AREF = 0x0b,
  EDA_GDS_TEXT = 0x0c,
  EDA_GDS_LAYER = 0x0d,
  EDA_GDS_DATATYPE = 0x0e,
  EDA_GDS_WIDTH = 0x0f,
  EDA_GDS_XY = 0x10,
  EDA_GDS_ENDEL = 0x11,
  EDA_GDS_SNAME = 0x12,
  EDA_GDS_COLROW = 0x13,
  EDA_GDS_NODE = 0x15,
  EDA_GDS_TEXTTYPE = 0x16,
  EDA_GDS_PRESENTATION = 0x17,
  EDA_GDS_STRING = 0x19,
  EDA_GDS_STRANS = 0x1a,
  EDA_GDS_MAG = 0x1b,
  EDA_GDS_ANGLE = 0x1c,
  EDA_GDS_REFLIBS = 0x1f,
  EDA_GDS_FONTS = 0x20,
  EDA_GDS_PATHTYPE = 0x21,
  EDA_GDS_GENERATIONS = 0x22,
  EDA_GDS_ATTRTABLE = 0x23,
  EDA_GDS_STRTYPE = 0x25,
  EDA_GDS_ELFLAGS = 0x26,
  EDA_GDS_ELKEY = 0x27,
  EDA_GDS_NODETYPE = 0x2a,
  EDA_GDS_PROPATTR = 0x2b,
  EDA_GDS_PROPVALUE = 0x2c,
  EDA_GDS_BOX = 0x2d,
  EDA_GDS_BOXTYPE = 0x2e,
  EDA_GDS_PLEX = 0x2f,
  EDA_GDS_BGNEXTN = 0x30,
  EDA_GDS_ENDEXTN = 0x31,
  EDA_GDS_TAPENUM = 0x32,
  EDA_GDS_TAPECODE = 0x33,
  EDA_GDS_STRCLASS = 0x34,
  EDA_GDS_FORMAT = 0x36,
  EDA_GDS_MASK = 0x37,
  EDA_GDS_ENDMASKS = 0x38,
  EDA_GDS_LIBDIRSIZE = 0x39,
  EDA_GDS_SRFNAME = 0x3a,
  EDA_GDS_LIBSECUR = 0x3b
};

/* Data types. */
enum {
  EDA_GDS_NOTHING = 0,
  EDA_GDS_BITS = 1,
  EDA_GDS_INT2 = 2,
  EDA_GDS_INT4 = 3,
  EDA_GDS_REAL8 = 5,
  EDA_GDS_ASCII = 6
};

/* PROPATTR number of the property that holds the name of an instance. */
enum { EDA_GDS_INSTANCE_NAME = 61 };

/* Return a number of 2 bytes, without sign; return a number of 4 bytes, with
   sign. */
static inline uint32_t eda_gds_u16(const uint8_t *p) {
  return (uint32_t)p[0] << 8 | p[1];
}
static inline int32_t eda_gds_i32(const uint8_t *p) {
  return (int32_t)((uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 |
                   (uint32_t)p[2] << 8 | p[3]);
}

/* Return the value of an 8-byte GDSII real: sign, 7-bit exponent to base 16
   with bias 64, 56-bit fraction. The result is exact, except that fractions of
   more than 53 bits are rounded once. */
static inline double eda_gds_real(const uint8_t *p) {
  uint64_t fraction = 0;
  for (int i = 1; i < 8; i++) fraction = fraction << 8 | p[i];
  double value = ldexp((double)fraction, 4 * ((p[0] & 0x7f) - 64) - 56);
  return p[0] & 0x80 ? -value : value;
}

/* Write a number of 2 bytes, without sign; write a number of 4 bytes, with
   sign. */
static inline void eda_gds_put_u16(uint8_t *p, uint32_t v) {
  p[0] = (uint8_t)(v >> 8);
  p[1] = (uint8_t)v;
}
static inline void eda_gds_put_i32(uint8_t *p, int32_t v) {
  eda_gds_put_u16(p, (uint32_t)v >> 16);
  eda_gds_put_u16(p + 2, (uint32_t)v & 0xffff);
}

/* Write an 8-byte GDSII real; |v| must be less than 16^63. The written value is
   exact for |v| >= 16^-65; smaller values are written as 0. */
static inline void eda_gds_put_real(uint8_t *p, double v) {
  int e;
  double m = frexp(fabs(v), &e); /* |v| = m 2^e, m in [1/2, 1) */
  int sixteens = (int)ceil(e / 4.0);
  uint64_t fraction = (uint64_t)ldexp(m, 56 + e - 4 * sixteens);
  if (!fraction || sixteens < -64) fraction = 0, sixteens = -64;
  p[0] = (uint8_t)(sixteens + 64) | (v < 0 && fraction ? 0x80 : 0);
  for (int i = 7; i > 0; i--, fraction >>= 8) p[i] = (uint8_t)fraction;
}
