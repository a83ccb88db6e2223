/* SPDX-License-Identifier: BSD-3-Clause */
/* Segmentation: find the transistors of a layout and the mask edges that move
   with them (thesis 2.2.5 and 3.2.2), for the whole layout or a window. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>

OPC_C_BEGIN

/* nm. Shapes further than this from a transistor do not influence it: its free
   space and its edges of active end there. The value was chosen for 193 nm,
   where light from half this distance has no influence. With half the value
   isolated transistors get other masks; with twice the value windows must be
   twice as wide. */
#define EDA_SEGMENT_REACH 2000.0

/* Settings of a segmentation. Texts belong to the caller. Zeroed: no further
   layers. */
typedef struct eda_segment_settings {
  double grid; /* nm, > 0: the mask grid */
  /* nm, >= 0; NAN: for each gate the default of EDA_SEGMENT_PARAMETERS. */
  double overhang, line_end;
  /* Further layers, without transistors: two texts for each, its name among the
     gates and in the layout. */
  const char *const *also;
  size_t also_count;
  /* For a window: 1: gates have instances and cells, and faults of notes name
     them; 0: "", which takes less memory. Gates of a window have no numbers
     (0), because the window does not show all of an instance. */
  int paths;
  /* Optional. Receives messages for the user about a whole layout, on the
     calling thread. */
  void (*log)(void *data, int warning, const char *message);
  void *data;
  /* Flavours of transistors (eda/gates.h): two texts for each, its name and the
     marker layers of the layout, separated by blanks if all of several must be
     present. Since 0.6. */
  const char *const *flavours;
  size_t flavour_count;
} eda_segment_settings;

/* Rounding of the layers of a whole layout to the grid. */
typedef struct eda_segment_report {
  size_t moved; /* moved vertices */
  double worst; /* largest displacement, nm */
} eda_segment_report;

/* Return the cell of this name; NULL: the only cell that no other places.
   Return -1 and *error if there is none. [any] */
OPC_EXPORT int32_t eda_segment_top(const eda_layout *layout, const char *name,
                                   opc_error *error);

/* Check the settings. Return OPC_INVALID, about the parameter "also.NAME", if a
   name of a further layer is not a word or a name or layer occurs twice; about
   "flavours.NAME" if a flavour has no marker. [any] */
OPC_EXPORT int eda_segment_check(const eda_segment_settings *settings,
                                 opc_error *error);

/* Find the transistors below a cell, from the layers poly, active, contact,
   nwell, pwell, nimplant, pimplant, notes and the marker layers of flavours.
   *gates belongs to the caller; NULL on failure: OPC_INVALID for missing layers
   and, with its position, for a shape that is not a transistor. Uses all
   threads of the context. [any] */
OPC_EXPORT int eda_segment(const opc_context *context, const eda_layout *layout,
                           int32_t top, const eda_segment_settings *settings,
                           eda_gates **gates, eda_segment_report *report,
                           opc_error *error);

/* Segment the content of a window, in units of the grid; shapes are clipped at
   the window's edge. Clipped edges are fixed, and clipped gates are not
   transistors. Figures and fragments of the others equal those of the whole
   layout, except near the edge: see eda_segment_halo. The layers are those of
   the whole layout. The window may be without transistors or shapes (`extent`
   is then the window). [any] */
OPC_EXPORT int eda_segment_window(const eda_layout *layout, int32_t top,
                                  const eda_segment_settings *settings,
                                  const eda_box *window, eda_gates **gates,
                                  opc_error *error);

/* Return the margin of a window around a place, in grid units, at which results
   equal those of the whole layout. Transistors that the window clips are
   excepted. [any] */
OPC_EXPORT int32_t eda_segment_halo(const eda_segment_settings *settings);

/* Segment a window of a core and `halo` units around it, at least
   eda_segment_halo, and more if relevant transistors are clipped. Transistors
   in or reaching into the core have bit-identical figures to those of the whole
   layout, and the edges in the core belong to the same transistors. [any] */
OPC_EXPORT int eda_segment_core(const eda_layout *layout, int32_t top,
                                const eda_segment_settings *settings,
                                eda_box core, int32_t halo, eda_gates **gates,
                                opc_error *error);

/* Segment a single layer without transistors, one fragment for each edge.
   Return OPC_INVALID if the layer is empty. `moved`: vertices moved by the
   grid. [any] */
OPC_EXPORT int eda_segment_edges(const eda_layout *layout, int32_t top,
                                 int32_t layer, double grid, eda_gates **gates,
                                 size_t *moved, opc_error *error);

/* Return an upper bound of the bytes that eda_segment needs. [any] */
OPC_EXPORT double eda_segment_bytes(const eda_layout *layout, int32_t top,
                                    const eda_segment_settings *settings);

/* Parameters of a step (opcflow/plugin.h) that segments: fields `also` and
   `flavours` (opc_map), `grid`, `overhang` and `line_end` of its struct. */
#define EDA_SEGMENT_PARAMETERS(self)                                         \
  OPC_PARAMETER(                                                             \
      self, also, .type = OPC_MAP,                                           \
      .summary =                                                             \
          "further layers to correct, by the places of their edges: { "      \
          "metal1: M1 } calls the layout's M1 metal1"),                      \
      OPC_PARAMETER(                                                         \
          self, flavours, .type = OPC_MAP,                                   \
          .summary =                                                         \
              "transistors with device tables of their own, by the layers "  \
              "that mark them: { lvt: LVTN, hv: HVI }; several layers, "     \
              "with blanks between, must all cover a gate"),                 \
      OPC_PARAMETER(self, grid, .type = OPC_REAL, .flags = OPC_ABOVE,        \
                    .unit = "nm", .preset = "1 nm", .summary = "mask grid"), \
      OPC_PARAMETER(self, overhang, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
                    .unit = "nm", .follows = "1.29 gate lengths",            \
                    .summary =                                               \
                        "how far past the active a transistor owns "         \
                        "the edges of a poly that goes on; at most 1 um, "   \
                        "if not given"),                                     \
      OPC_PARAMETER(self, line_end, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
                    .unit = "nm", .follows = "3.08 gate lengths",            \
                    .summary =                                               \
                        "poly that ends within this distance of the "        \
                        "active is the transistor's own line end; at most "  \
                        "1 um, if not given")

/* Initialise settings from these fields; the pairs of texts of a map are
   contiguous. */
#define EDA_SEGMENT_SETTINGS(self)                                         \
  {                                                                        \
    .grid = (self)->grid, .overhang = (self)->overhang,                    \
    .line_end = (self)->line_end,                                          \
    .also = (const char *const *)(const void *)(self)->also.pairs,         \
    .also_count = (self)->also.count,                                      \
    .flavours = (const char *const *)(const void *)(self)->flavours.pairs, \
    .flavour_count = (self)->flavours.count                                \
  }

OPC_C_END
