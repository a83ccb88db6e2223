/* SPDX-License-Identifier: BSD-3-Clause */
/* Segmentation: find the transistors of a layout, or of a window, and the mask
   edges that control them (thesis 2.2.5 and 3.2.2; thesis: see
   docs/background/physics.md). [any]: see opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>

OPC_C_BEGIN

/* Distance, nm, beyond which shapes do not influence the segmentation of a
   transistor. It limits eda_gates.space and the distance from a gate to the
   edges of the active that belong to the gate. Chosen
   for 193 nm, where the optical influence ends at half this distance. Half the
   value changes the masks of isolated transistors; twice the value needs
   windows of twice the width. */
#define EDA_SEGMENT_REACH 2000.0

/* Settings of a segmentation. The caller owns all texts. Fields may be 0,
   except `grid`. */
typedef struct eda_segment_settings {
  double grid; /* nm, > 0: the mask grid */
  /* Length beyond the active in which edges of a continuing poly belong to the
     transistor, nm, >= 0; NAN: the default of EDA_SEGMENT_PARAMETERS, which
     depends on the length of each gate. */
  double overhang;
  /* Largest distance from the active to a poly end that is the line end of the
     transistor, nm, >= 0; NAN: as for `overhang`. */
  double line_end;
  /* Further layers, without transistors. For layer k, also[2 * k] is the name
     in eda_gates and also[2 * k + 1] the name in the layout. */
  const char *const *also;
  size_t also_count; /* number of further layers */
  /* For windows. 1: set eda_gates.instance and .cell, and name the cell in
     errors of notes; 0: set both to "" to save memory. eda_gates.number is 0 in
     windows, because a window may contain only a part of an instance. */
  int paths;
  /* Optional. Callback for messages to the user; not called for windows. Runs
     on the calling thread. */
  void (*log)(void *data, int warning, const char *message);
  void *data;
  /* Flavours of transistors (eda/gates.h). For flavour k, flavours[2 * k] is
     the name, and flavours[2 * k + 1] the names of its marker layers in the
     layout, separated by blanks. All marker layers of a flavour must cover the
     gate. Since 0.6. */
  const char *const *flavours;
  size_t flavour_count; /* number of flavours */
} eda_segment_settings;

/* Rounding of all layers to the grid. */
typedef struct eda_segment_report {
  size_t moved; /* number of vertices that rounding moved */
  double worst; /* largest displacement, nm */
} eda_segment_report;

/* Return the number of the cell `name`; for NULL that of the top cell
   (eda_layout_top). Return -1 and *error if there is none. [any] */
OPC_EXPORT int32_t eda_segment_top(const eda_layout *layout, const char *name,
                                   opc_error *error);

/* Check the settings. The names of further layers consist of letters, digits
   and '_' and do not end in "_drawn"; no name and no layer occurs twice.
   Otherwise return OPC_INVALID with an error of the parameter "also.NAME".
   Return OPC_INVALID with an error of "flavours.NAME" if a flavour has no
   marker layer. [any] */
OPC_EXPORT int eda_segment_check(const eda_segment_settings *settings,
                                 opc_error *error);

/* Segment the layout of a cell. Used layers: poly, active, contact, nwell,
   pwell, nimplant, pimplant, notes, further layers and markers of flavours;
   only poly, active and further layers must exist. The caller frees *gates,
   NULL on failure. Return OPC_INVALID for a missing layer, for an empty further
   layer, and if poly and active do not overlap. Return OPC_INVALID and the
   position for a crossing of poly and active that is not a transistor. Return
   OPC_CANCELLED if the user stops the run. [any] */
OPC_EXPORT int eda_segment(const opc_context *context, const eda_layout *layout,
                           int32_t top, const eda_segment_settings *settings,
                           eda_gates **gates, eda_segment_report *report,
                           opc_error *error);

/* Segment a window, in grid units. Shapes are clipped at its border; clipped
   edges are fixed, and clipped gates are no transistors. The other gates and
   fragments equal those of the whole layout, except near the border
   (eda_segment_halo). The layers are those of the whole layout. The window may
   contain no shapes; gates->extent is then the part of the window within the
   bounds of the layout. [any] */
OPC_EXPORT int eda_segment_window(const eda_layout *layout, int32_t top,
                                  const eda_segment_settings *settings,
                                  const eda_box *window, eda_gates **gates,
                                  opc_error *error);

/* Return a width, grid units. At more than this distance from the border of a
   window, results equal those of the whole layout, except for clipped
   transistors. [any] */
OPC_EXPORT int32_t eda_segment_halo(const eda_segment_settings *settings);

/* Segment a window that consists of `core` and a margin of max(`halo`,
   eda_segment_halo) grid units. The margin grows until no transistor that
   influences the core is clipped. For transistors that touch the core, all data
   are bit-identical to those of the whole layout. Edges in the core belong to
   the same transistors as in the whole layout. [any] */
OPC_EXPORT int eda_segment_core(const eda_layout *layout, int32_t top,
                                const eda_segment_settings *settings,
                                eda_box core, int32_t halo, eda_gates **gates,
                                opc_error *error);

/* Segment a single layer without transistors, one fragment for each edge.
   Return OPC_INVALID if the layer is empty. *moved: number of vertices moved by
   rounding to the grid. [any] */
OPC_EXPORT int eda_segment_edges(const eda_layout *layout, int32_t top,
                                 int32_t layer, double grid, eda_gates **gates,
                                 size_t *moved, opc_error *error);

/* Estimate the memory of eda_segment, bytes: that of the flat layers, and as
   much for the merged layers. [any] */
OPC_EXPORT double eda_segment_bytes(const eda_layout *layout, int32_t top,
                                    const eda_segment_settings *settings);

/* Parameters (opcflow/plugin.h) of a step that calls eda_segment. The step has
   the fields `also`, `flavours` (opc_map), `grid`, `overhang`, `line_end`. */
#define EDA_SEGMENT_PARAMETERS(self)                                         \
  OPC_PARAMETER(                                                             \
      self, also, .type = OPC_MAP,                                           \
      .summary =                                                             \
          "further layers to correct by edge placement, and their layers "   \
          "in the layout: { metal1: M1 }"),                                  \
      OPC_PARAMETER(                                                         \
          self, flavours, .type = OPC_MAP,                                   \
          .summary =                                                         \
              "transistor flavours (own device tables) and their marker "    \
              "layers: { lvt: LVTN, hv: HVI }; several layers, separated "   \
              "by blanks, must all cover a gate"),                           \
      OPC_PARAMETER(self, grid, .type = OPC_REAL, .flags = OPC_ABOVE,        \
                    .unit = "nm", .preset = "1 nm", .summary = "mask grid"), \
      OPC_PARAMETER(self, overhang, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
                    .unit = "nm", .follows = "1.29 gate lengths",            \
                    .summary =                                               \
                        "length beyond the active in which edges of a "      \
                        "continuing poly belong to the transistor; "         \
                        "default at most 1 um"),                             \
      OPC_PARAMETER(self, line_end, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
                    .unit = "nm", .follows = "3.08 gate lengths",            \
                    .summary =                                               \
                        "largest distance from the active to a poly end "    \
                        "that is the line end of the transistor; default "   \
                        "at most 1 um")

/* Initialise eda_segment_settings from these fields of a step. */
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
