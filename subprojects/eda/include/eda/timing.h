/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind (opcflow/step.h) "timing": the logic of standard cells, and
   simulated delays and slews of arcs from inputs to outputs. A slew is the
   duration of a transition between two voltage levels. The tables of each arc
   are functions of input slew and load, with sensitivities to transistor sizes.
   Times in s, capacitances in F. Thesis: docs/background/physics.md. [any]:
   opcflow/plugin.h. */
#pragma once

#include <eda/devices.h>
#include <eda/pool.h>
#include <stdio.h>

OPC_C_BEGIN

/* Sizes of a printed transistor (thesis eq. 3.11 to 3.14): effective length and
   width for the current, effective length for the capacitance. A change of a
   size is ln(printed / drawn). */
enum { EDA_SIZE_L = 0, EDA_SIZE_W = 1, EDA_SIZE_C = 2, EDA_SIZES = 3 };

/* Capacitances of a pin: mean up to half the supply voltage, for delays; mean
   between the voltage levels of a slew. */
enum { EDA_CAP_DELAY = 0, EDA_CAP_SLEW = 1, EDA_CAPS = 2 };

/* Limits of the tables of a cell. */
enum {
  EDA_TIMING_INPUTS = 12, /* largest number of inputs */
  EDA_TIMING_GRID = 16,   /* largest number of slews, and of loads; the smallest
                             number of both is 2 */
  EDA_TIMING_POWERS = 4   /* coefficients of a cubic */
};

/* A transistor of a cell. */
typedef struct eda_timing_device {
  const char *name; /* name in the cell */
  uint8_t type;     /* EDA_NMOS, EDA_PMOS */
  uint32_t drain, gate, source, bulk;
  double length, width; /* drawn size, nm */
  uint32_t bundle; /* index of the bundle: a group of equivalent transistors
                      with common sensitivities */
  double share;    /* weight: the change of size of a bundle is the sum of
                      share * change over the transistors of the bundle */
} eda_timing_device;

/* An arc: a change of one input, the others constant, switches an output. */
typedef struct eda_timing_arc {
  uint8_t input, output;
  uint8_t rises; /* 1: the output rises */
  uint32_t from; /* inputs before the change: bit i is input i */
  /* Tables, [slew * loads + load]. */
  double *delay, *slew;
  /* Sensitivities of delay and slew to changes of sizes, s, at three points
     (near_slew): [(point * bundles + bundle) * EDA_SIZES + size]. */
  double *delay_by, *slew_by;
} eda_timing_arc;

/* Two inputs that change and switch an output together. With transistors in
   series both changes are necessary, and the second is the cause; in parallel
   one suffices, and the first is the cause. `delay` and `slew` are factors that
   multiply eda_timing_blend. They depend on the gap (time between the changes /
   delay of the cause alone) and on both slews (slew / delay of this input
   alone). */
enum { EDA_TIMING_GAPS = 6 };
typedef struct eda_timing_pair {
  uint8_t first, second, output;
  uint8_t parallel;
  uint32_t from; /* inputs before both changes */
  double *at[2]; /* simulated slews of the first input and of the second input:
                    two at the corners [0], [1], and one between [2] */
  /* Corners: [(first slew * 2 + second slew) * EDA_TIMING_GAPS + gap]; between:
     [4 * EDA_TIMING_GAPS + gap]. */
  double *delay, *slew;
} eda_timing_pair;

/* A cell. */
typedef struct eda_timing_cell {
  const char *name;
  const char *trouble; /* reason for a cell without arcs, or NULL */
  size_t inputs, outputs;
  const char **pin; /* names of inputs, then outputs */
  uint32_t *port;   /* net of each pin */
  uint8_t *level;   /* logic level, [output << inputs | states of the inputs] */
  size_t nets;      /* number of nets */
  int8_t *rail;     /* of each net: 1 supply, -1 ground, otherwise 0 */
  size_t devices, bundles;
  eda_timing_device *device;
  size_t slews, loads;
  double *at_slew, *at_load; /* grid of slews and loads */
  /* Indices of the three grid points where changes of sizes were simulated:
     (slew 0, load 0), (slew 0, load 1), (slew 1, load 0). A sensitivity at
     other slews and loads is on the plane through these points. */
  size_t near_slew[2], near_load[2];
  size_t arcs;
  eda_timing_arc *arc;
  int32_t *arc_of; /* [(output * inputs + input) << inputs | from], -1: none */
  /* Capacitance of input pins, mean over the states of other inputs, at i =
     (input * 2 + rises) * EDA_CAPS + cap; its sensitivity at [(i * bundles +
     bundle) * EDA_SIZES + size]. */
  double *capacitance, *capacitance_by;
  size_t figures;
  double *figure;      /* array that contains all tables above */
  size_t pair_figures; /* further elements, for the tables below */
  /* Capacitance of an input pin for each state of the inputs before a change:
     [(input << inputs | from) * EDA_CAPS + cap]. */
  double *pin_capacitance;
  /* States that differ only in constant inputs may share a pair. */
  size_t pairs;
  eda_timing_pair *pair;
  int32_t *pair_of; /* [((output * inputs + first) * inputs + second) << inputs
                       | from], -1: none */
} eda_timing_cell;

/* The data object. */
typedef struct eda_timing {
  size_t count; /* number of cells */
  eda_timing_cell *cell;
  double supply, temperature; /* V, C */
  double low, high;           /* voltage levels of slews / supply */
  eda_pool memory;            /* owns all arrays and texts */
} eda_timing;

/* Return zeroed timing with `count` cells, whose arrays the caller allocates
   from timing->memory; free it (NULL: do nothing). */
OPC_EXPORT eda_timing *eda_timing_new(size_t count);
OPC_EXPORT void eda_timing_free(void *timing);
/* Return OPC_OK if each cell has a name and, unless `trouble` is set, inputs,
   outputs, a grid and tables with finite figures; else OPC_FAILED. */
OPC_EXPORT int eda_timing_check(const void *timing, opc_error *error);
/* Return a cell by name (upper and lower case are equal); NULL if missing. */
OPC_EXPORT const eda_timing_cell *eda_timing_find(const eda_timing *timing,
                                                  const char *name);

/* Allocate the tables of a cell from a pool: `figure` and all arrays in it. The
   numbers (inputs, bundles, slews, loads, arcs, pairs) and the arrays `arc` and
   `pair` must be set before. */
OPC_EXPORT void eda_timing_cell_figures(eda_pool *pool, eda_timing_cell *cell);

/* Compute delay[slews] and slew[slews] of an arc at all slews of the grid.
   Loads are in F. change[bundle * EDA_SIZES + size]: changes of sizes; NULL:
   none. [any] */
OPC_EXPORT void eda_timing_at(const eda_timing_cell *cell,
                              const eda_timing_arc *arc, double delay_load,
                              double slew_load, const double *change,
                              double *delay, double *slew);

/* Return the capacitance of an input pin; `change`: as for eda_timing_at.
   [any] */
OPC_EXPORT double eda_timing_capacitance(const eda_timing_cell *cell,
                                         size_t input, int rises, int cap,
                                         const double *change);

/* Simulated gaps between two inputs / delay of the cause. */
OPC_EXPORT extern const double eda_timing_gap[EDA_TIMING_GAPS];

/* Return the value that a pair's factor multiplies: a weighted mean of the
   values of cause and other input alone. The weight of the other input falls
   from 1/2 at gap 0 to 0 at gap 1 and beyond. */
OPC_EXPORT double eda_timing_blend(double gap, double cause, double other);

/* Compute the factors of a pair at a gap and two slews, all relative to delays
   as in eda_timing_pair. [any] */
OPC_EXPORT void eda_timing_pair_at(const eda_timing_pair *pair, double gap,
                                   double first, double second, double *delay,
                                   double *slew);

/* eda_timing_cubic: compute interpolating cubics through n >= 2 points
   (Catmull-Rom with unequal steps); coefficient[i * EDA_TIMING_POWERS + power],
   i < n - 1, is for powers of x - x[i]. eda_timing_cubic_at: evaluate the
   cubics at `at`; linear beyond both ends. */
OPC_EXPORT void eda_timing_cubic(const double *x, const double *y, size_t n,
                                 double *coefficient);
OPC_EXPORT double eda_timing_cubic_at(const double *x,
                                      const double *coefficient, size_t n,
                                      double at);

/* Ramp at the inputs of characterised cells: a straight line up to a level,
   then an exponential with continuous slope. The unit of time is the duration
   of the straight line if continued from level 0 to 1. eda_timing_ramp: return
   the time at which the ramp passes a level < 1. eda_timing_ramp_points: write
   points of the ramp for a simulator; the last one has level 1. */
OPC_EXPORT double eda_timing_ramp(int rises, double level);
enum { EDA_TIMING_RAMP = 8 };
OPC_EXPORT void eda_timing_ramp_points(int rises, double time[EDA_TIMING_RAMP],
                                       double level[EDA_TIMING_RAMP]);
/* Return the unit of time, s, for a slew between levels of `timing`. [any] */
OPC_EXPORT double eda_timing_ramp_time(const eda_timing *timing, double slew,
                                       int rises);
/* Write a ramp from level `from` to level `to` (0 or 1, times the supply; may
   be equal) as "pwl(...)" and a new line. The ramp passes half the supply at
   the time `middle`, s. [any] */
OPC_EXPORT void eda_timing_ramp_write(FILE *out, const eda_timing *timing,
                                      int from, int to, double slew,
                                      double middle);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_TIMING(port)                                  \
  {                                                            \
    .name = port, .kind = "timing", .check = eda_timing_check, \
    .release = eda_timing_free                                 \
  }

OPC_C_END
