/* SPDX-License-Identifier: BSD-3-Clause */
/* OASIS (SEMI P39): record numbers, and a writer. */
#pragma once

#include <eda/formats.h>

OPC_C_BEGIN

/* First bytes of a file. */
#define EDA_OASIS_MAGIC "%SEMI-OASIS\r\n"

/* Record numbers. */
enum {
  EDA_OASIS_PAD = 0,
  EDA_OASIS_START = 1,
  EDA_OASIS_END = 2,
  EDA_OASIS_CELLNAME = 3,
  EDA_OASIS_CELLNAME_NUMBER = 4,
  EDA_OASIS_TEXTSTRING = 5,
  EDA_OASIS_TEXTSTRING_NUMBER = 6,
  EDA_OASIS_PROPNAME = 7,
  EDA_OASIS_PROPNAME_NUMBER = 8,
  EDA_OASIS_PROPSTRING = 9,
  EDA_OASIS_PROPSTRING_NUMBER = 10,
  EDA_OASIS_LAYERNAME = 11,
  EDA_OASIS_LAYERNAME_TEXT = 12,
  EDA_OASIS_CELL_NUMBER = 13,
  EDA_OASIS_CELL = 14,
  EDA_OASIS_XYABSOLUTE = 15,
  EDA_OASIS_XYRELATIVE = 16,
  EDA_OASIS_PLACEMENT = 17,
  EDA_OASIS_PLACEMENT_REAL = 18,
  EDA_OASIS_TEXT = 19,
  EDA_OASIS_RECTANGLE = 20,
  EDA_OASIS_POLYGON = 21,
  EDA_OASIS_PATH = 22,
  EDA_OASIS_TRAPEZOID = 23,
  EDA_OASIS_TRAPEZOID_A = 24,
  EDA_OASIS_TRAPEZOID_B = 25,
  EDA_OASIS_CTRAPEZOID = 26,
  EDA_OASIS_CIRCLE = 27,
  EDA_OASIS_PROPERTY = 28,
  EDA_OASIS_PROPERTY_AGAIN = 29,
  EDA_OASIS_XNAME = 30,
  EDA_OASIS_XNAME_NUMBER = 31,
  EDA_OASIS_XELEMENT = 32,
  EDA_OASIS_XGEOMETRY = 33,
  EDA_OASIS_CBLOCK = 34
};

/* Validation schemes. */
enum { EDA_OASIS_NO_CHECK = 0, EDA_OASIS_CRC32 = 1, EDA_OASIS_SUM32 = 2 };

/* Length of the END record, bytes. */
enum { EDA_OASIS_END_BYTES = 256 };

/* Order of the name tables in the START or END record. */
enum {
  EDA_OASIS_CELLNAMES = 0,
  EDA_OASIS_TEXTSTRINGS = 1,
  EDA_OASIS_PROPNAMES = 2,
  EDA_OASIS_PROPSTRINGS = 3,
  EDA_OASIS_LAYERNAMES = 4,
  EDA_OASIS_XNAMES = 5,
  EDA_OASIS_TABLES = 6
};

/* Standard property that holds GDSII properties, and the number of the GDSII
   property that holds the name of an instance. */
#define EDA_OASIS_GDS_PROPERTY "S_GDS_PROPERTY"
enum { EDA_OASIS_INSTANCE_NAME = 61 };

/* ---- writing ---------------------------------------------------------- */

/* A writer of numbers, strings and shapes to an OASIS file. Bytes are collected
   into compressed blocks; equal shapes are combined into repetitions. The
   caller writes all records except those of shapes: EDA_OASIS_MAGIC, START,
   cells, names and END. The caller detects write errors when closing the file.
   Use a writer from one thread at a time; several writers are independent. */
typedef struct eda_oasis eda_oasis;

/* Return a new writer (eda_oasis_free). If `file` is NULL, bytes are only
   counted. The file must outlive the writer. */
OPC_EXPORT eda_oasis *eda_oasis_new(FILE *file);
/* Free a writer (NULL: do nothing). Collected shapes and bytes are discarded:
   call eda_oasis_end_shapes and eda_oasis_end_block first. The file stays open.
 */
OPC_EXPORT void eda_oasis_free(eda_oasis *out);

/* eda_oasis_place: return the number of bytes written to the file.
   eda_oasis_crc: return the CRC32 of these bytes. eda_oasis_collected: return
   the number of bytes collected for the next block. */
OPC_EXPORT uint64_t eda_oasis_place(const eda_oasis *out);
OPC_EXPORT uint32_t eda_oasis_crc(const eda_oasis *out);
OPC_EXPORT size_t eda_oasis_collected(const eda_oasis *out);

/* Write a byte, an unsigned integer, a signed integer, a real number. */
OPC_EXPORT void eda_oasis_byte(eda_oasis *out, uint32_t b);
OPC_EXPORT void eda_oasis_uint(eda_oasis *out, uint64_t v);
OPC_EXPORT void eda_oasis_sint(eda_oasis *out, int64_t v);
OPC_EXPORT void eda_oasis_real(eda_oasis *out, double v);
/* Write a displacement in any direction (OASIS g-delta). */
OPC_EXPORT void eda_oasis_delta(eda_oasis *out, int64_t x, int64_t y);
/* Write a string: its length, then its bytes. */
OPC_EXPORT void eda_oasis_string(eda_oasis *out, const char *text);

/* Call at the end of a record: write the collected bytes as a block if there
   are at least 2^20 of them. */
OPC_EXPORT void eda_oasis_end_record(eda_oasis *out);
/* Write the collected bytes to the file. eda_oasis_end_block compresses the
   bytes if the result is shorter; eda_oasis_end_plain never does. */
OPC_EXPORT void eda_oasis_end_block(eda_oasis *out);
OPC_EXPORT void eda_oasis_end_plain(eda_oasis *out);

/* Collect a polygon of a cell: n >= 3 points; the polygon is closed, and the
   first point is not repeated at the end. The points are copied. If the layer
   differs from that of the last polygon, the collected shapes are written
   first; therefore pass the polygons of a layer together. */
OPC_EXPORT void eda_oasis_polygon(eda_oasis *out, eda_layer_number layer,
                                  const eda_point *points, size_t n);
/* Write the records of the collected shapes into the current block. Call this
   after the last polygon of a cell, and before writing another record between
   the polygons, such as a text or a placement. */
OPC_EXPORT void eda_oasis_end_shapes(eda_oasis *out);

OPC_C_END
