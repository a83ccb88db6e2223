/* SPDX-License-Identifier: BSD-3-Clause */
/* From a layout to its transistors and the mask edges that move them (thesis
   2.2.5 and 3.2.2): of all of it, or of a window. */
#ifndef EDA_SEGMENT_H
#define EDA_SEGMENT_H

#include <eda/gates.h>
#include <eda/layout.h>

#ifdef __cplusplus
extern "C" {
#endif

/* nm. Nothing that is further from a transistor than this belongs to it or
   counts for it: its free space ends there, and so do the edges of active that
   it owns. Ours: light of 193 nm tells nothing of what is twice as near; at
   half of it lone transistors would have other masks, at double of it windows
   would have to show twice as much. */
#define EDA_SEGMENT_REACH 2000.0

/* How to segment. Texts are the caller's. Zeroed: no further layers. */
typedef struct eda_segment_settings {
  double grid; /* nm, > 0: the mask grid */
  /* nm, >= 0; NAN: of each gate what EDA_SEGMENT_PARAMETERS say. */
  double overhang, line_end;
  /* Further layers, whose edges are of no transistor: of each two texts, its
     name among the gates and in the layout. */
  const char *const *also;
  size_t also_count;
  /* Of a window: 1: its gates have instances and cells, and notes' faults name
     them; 0: "", which takes less memory. They have no numbers (0), as a window
     does not show all of an instance. */
  int paths;
  /* NULL, or who is told what a user may want to know of a whole layout. From
     the calling thread. */
  void (*tell)(void *data, int warning, const char *message);
  void *data;
  /* Flavours of transistors (eda/gates.h): of each two texts, its name and the
     layout's layers that mark it, with blanks between if all of several do.
     Since 0.6. */
  const char *const *flavours;
  size_t flavour_count;
} eda_segment_settings;

/* What the grid did to the layers of a whole layout. */
typedef struct eda_segment_report {
  size_t moved; /* vertices */
  double worst; /* nm */
} eda_segment_report;

/* The cell of that name, NULL: the only one that no other places. -1 and
 *error if there is none. [any] */
OPC_EXPORT int32_t eda_segment_top(const eda_layout *layout, const char *name,
                                   opc_error *error);

/* OPC_INVALID, about the parameter "also.NAME", if names of further layers are
   no words, or if names or layers are there twice; about "flavours.NAME" if one
   has no marker. [any] */
OPC_EXPORT int eda_segment_check(const eda_segment_settings *settings,
                                 opc_error *error);

/* The transistors below a cell, from the layers poly, active, contact, nwell,
   pwell, nimplant, pimplant, notes and those that mark flavours. *gates is the
   caller's; NULL on failure: OPC_INVALID for layers that are not there and for
   what is no transistor, with its place. By all threads of the context. [any]
 */
OPC_EXPORT int eda_segment(const opc_context *context, const eda_layout *layout,
                           int32_t top, const eda_segment_settings *settings,
                           eda_gates **gates, eda_segment_report *report,
                           opc_error *error);

/* The same of what lies in a window, in units of the grid: its shapes, cut off
   at the window's edge. What is cut there is fixed, and is no transistor; of
   those within there are the same figures as of a whole layout, and their
   fragments, but near the edge: see eda_segment_halo. The layers are those that
   the whole layout would have; there need not be a transistor, nor a shape
   (`extent` is then the window). [any] */
OPC_EXPORT int eda_segment_window(const eda_layout *layout, int32_t top,
                                  const eda_segment_settings *settings,
                                  const eda_box *window, eda_gates **gates,
                                  opc_error *error);

/* How many grid units a window has to show around a place, so that all there
   is as in the whole layout, but for transistors that it cuts. [any] */
OPC_EXPORT int32_t eda_segment_halo(const eda_segment_settings *settings);

/* A window of a core and `halo` units around it, at least eda_segment_halo, and
   more where transistors that matter are cut there: those that lie in the core
   or reach there have the figures that they have in the whole layout to the
   bit, and the edges in the core belong to the same. [any] */
OPC_EXPORT int eda_segment_core(const eda_layout *layout, int32_t top,
                                const eda_segment_settings *settings,
                                eda_box core, int32_t halo, eda_gates **gates,
                                opc_error *error);

/* A layer alone, its edges one fragment each, without transistors. OPC_INVALID
   if it is empty. `moved`: vertices, by the grid. [any] */
OPC_EXPORT int eda_segment_edges(const eda_layout *layout, int32_t top,
                                 int32_t layer, double grid, eda_gates **gates,
                                 size_t *moved, opc_error *error);

/* The bytes that eda_segment takes at most. [any] */
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

/* Initialiser of settings from these fields: pairs of texts lie one after
   another. */
#define EDA_SEGMENT_SETTINGS(self)                                         \
  {                                                                        \
    .grid = (self)->grid, .overhang = (self)->overhang,                    \
    .line_end = (self)->line_end,                                          \
    .also = (const char *const *)(const void *)(self)->also.pairs,         \
    .also_count = (self)->also.count,                                      \
    .flavours = (const char *const *)(const void *)(self)->flavours.pairs, \
    .flavour_count = (self)->flavours.count                                \
  }

#ifdef __cplusplus
}
#endif
#endif
