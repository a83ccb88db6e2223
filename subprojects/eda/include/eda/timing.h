/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "timing": simulated cells with their logic, and delay and slew of
   each arc from an input to an output, as tables of input slew and load. Each
   has its sensitivity to the size of each transistor. Times in s, capacitances
   in F. */
#pragma once

#include <eda/devices.h>
#include <eda/pool.h>
#include <stdio.h>

OPC_C_BEGIN

/* Sizes of a printed transistor (thesis eq. 3.11 to 3.14): the length and width
   effective for the current, the length effective for the capacitance. A change
   of size is the natural logarithm of printed over drawn. */
enum { EDA_SIZE_L = 0, EDA_SIZE_W = 1, EDA_SIZE_C = 2, EDA_SIZES = 3 };

/* Capacitances of a pin: up to the middle of the supply, for delays, and
   between the levels of a slew. */
enum { EDA_CAP_DELAY = 0, EDA_CAP_SLEW = 1, EDA_CAPS = 2 };

/* Largest numbers of a cell. */
enum {
  EDA_TIMING_INPUTS = 12,
  EDA_TIMING_GRID = 16, /* slews, and loads */
  EDA_TIMING_POWERS = 4 /* coefficients of a cubic */
};

typedef struct eda_timing_device {
  const char *name; /* within the cell */
  uint8_t type;     /* EDA_NMOS, EDA_PMOS */
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm, as drawn */
  uint32_t bundle;      /* number of its group of equivalent transistors */
  double share;         /* share of the group's effect */
} eda_timing_device;

/* An arc: one input changes, all others stay, and an output follows. */
typedef struct eda_timing_arc {
  uint8_t input, output;
  uint8_t rises; /* the output */
  uint32_t from; /* state of the inputs before: bit i is input i */
  /* [slew * loads + load] */
  double *delay, *slew;
  /* Sensitivities in s per unit of change (1 nm of 100: 0.01): [(point *
     bundles + bundle) * EDA_SIZES + size], at three points. */
  double *delay_by, *slew_by;
} eda_timing_arc;

/* Two inputs that change and switch an output together. Either both are needed
   (transistors in series), and the second is the cause, or one suffices
   (parallel), and the first is the cause. Delay and slew are factors. They
   depend on the gap between the inputs in units of the delay of the cause
   alone, and on both slews in units of the delay of each input alone. The
   factors multiply eda_timing_blend of the two inputs' own values. */
enum { EDA_TIMING_GAPS = 6 };
typedef struct eda_timing_pair {
  uint8_t first, second, output;
  uint8_t parallel;
  uint32_t from; /* state of the inputs before both change */
  double *at[2]; /* slews of the first and of the second: two each, and one
                    between */
  /* [(slew of first * 2 + of second) * GAPS + gap], [4 * GAPS + gap] with both
     slews between. */
  double *delay, *slew;
} eda_timing_pair;

typedef struct eda_timing_cell {
  const char *name;
  const char *trouble; /* reason why the cell has no arcs, or NULL */
  size_t inputs, outputs;
  const char **pin; /* inputs, then outputs */
  uint32_t *port;   /* net of each pin */
  uint8_t *level;   /* [output << inputs | pattern] */
  size_t nets;
  int8_t *rail; /* each net: 1 supply, -1 ground, otherwise 0 */
  size_t devices, bundles;
  eda_timing_device *device;
  size_t slews, loads;
  double *at_slew, *at_load; /* grid of slews and loads */
  /* Grid points where changes of size were simulated: the first slew and load
     here, then with the second load, then with the second slew. The sensitivity
     of a delay is the plane through the three. */
  size_t near_slew[2], near_load[2];
  size_t arcs;
  eda_timing_arc *arc;
  int32_t *arc_of; /* [(output * inputs + input) << inputs | from], -1: none */
  /* Capacitance of pins for rising [1] and falling [0] edges, averaged over the
     states of the other inputs: [(input * 2 + rises) * EDA_CAPS + cap]; and its
     sensitivity: [that * bundles * EDA_SIZES ...]. */
  double *capacitance, *capacitance_by;
  size_t figures;
  double *figure;      /* all figures above, in one array */
  size_t pair_figures; /* number of pair figures, stored behind them */
  /* Capacitance of a pin for each state of the inputs before it changes:
     [(input << inputs | from) * EDA_CAPS + cap]. */
  double *pin_capacitance;
  /* States that differ only in inputs that stay share a pair. */
  size_t pairs;
  eda_timing_pair *pair;
  int32_t *pair_of; /* [((output * inputs + first) * inputs + second) << inputs
                       | from], -1: none */
} eda_timing_cell;

typedef struct eda_timing {
  size_t count;
  eda_timing_cell *cell;
  double supply, temperature; /* V, C */
  double low, high;           /* levels of slews as fractions of the supply */
  eda_pool memory;
} eda_timing;

OPC_EXPORT eda_timing *eda_timing_new(size_t count);
OPC_EXPORT void eda_timing_free(void *timing);
/* Check that all arrays exist and all figures are numbers. */
OPC_EXPORT int eda_timing_check(const void *timing, opc_error *error);
/* Return a cell by name (without case), NULL if there is none. */
OPC_EXPORT const eda_timing_cell *eda_timing_find(const eda_timing *timing,
                                                  const char *name);

/* Allocate a cell's arrays of figures after the numbers of slews, loads,
   bundles and arcs are set. */
OPC_EXPORT void eda_timing_cell_figures(eda_pool *pool, eda_timing_cell *cell);

/* Compute delay and slew of an arc at each slew of the grid, at these loads and
   changes of size ([bundle * EDA_SIZES + size], NULL: none). [any] */
OPC_EXPORT void eda_timing_at(const eda_timing_cell *cell,
                              const eda_timing_arc *arc, double delay_load,
                              double slew_load, const double *change,
                              double *delay, double *slew);

/* Return the capacitance of a pin at these changes of size. [any] */
OPC_EXPORT double eda_timing_capacitance(const eda_timing_cell *cell,
                                         size_t input, int rises, int cap,
                                         const double *change);

/* Simulated gaps between two inputs, in delays of the cause. */
OPC_EXPORT extern const double eda_timing_gap[EDA_TIMING_GAPS];

/* Return the weighted mean that a pair's factors multiply: for gap 0 the mean
   of the values of the cause and the other input alone; for gaps beyond one
   delay the value of the cause. A change of either input's transistors enters
   with its weight. */
OPC_EXPORT double eda_timing_blend(double gap, double cause, double other);

/* Compute a pair's factors at a gap and two slews, in the units above. [any] */
OPC_EXPORT void eda_timing_pair_at(const eda_timing_pair *pair, double gap,
                                   double first, double second, double *delay,
                                   double *slew);

/* Compute interpolating cubics on a grid: slopes from parabolas through three
   points (Catmull-Rom with unequal steps), linear beyond the ends. Coefficients
   of t = x - x0 of each step, [step * 4 + power]. */
OPC_EXPORT void eda_timing_cubic(const double *x, const double *y, size_t n,
                                 double *coefficient);
OPC_EXPORT double eda_timing_cubic_at(const double *x,
                                      const double *coefficient, size_t n,
                                      double at);

/* The input of characterised cells has the shape of a gate's output: a straight
   line up to a level, then an exponential with the same slope. Return the time,
   as a fraction of the whole line, at which the input passes a level (0 at the
   start, below 1 at the end); and its points for a simulator, the last with
   level 1. */
OPC_EXPORT double eda_timing_ramp(int rises, double level);
enum { EDA_TIMING_RAMP = 8 };
OPC_EXPORT void eda_timing_ramp_points(int rises, double time[EDA_TIMING_RAMP],
                                       double level[EDA_TIMING_RAMP]);
/* Return the time of the whole line for a slew between the levels of `timing`.
   [any] */
OPC_EXPORT double eda_timing_ramp_time(const eda_timing *timing, double slew,
                                       int rises);
/* Write the points of an input that goes from one level to another (each 0 or
   1, of the supply; equal: it stays) as "pwl(...)" and a new line. It passes
   the middle of the supply at `middle`, s. [any] */
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
