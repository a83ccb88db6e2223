/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "timing": what a simulator found of cells: their logic, and of each
   arc from an input to an output its delay and slew over the input's slew and
   the load, and how these move with the size of each transistor. Times s,
   capacitances F. */
#ifndef EDA_TIMING_H
#define EDA_TIMING_H

#include <eda/devices.h>
#include <eda/pool.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The three sizes of a printed transistor (thesis eq. 3.11 to 3.14): the length
   and width that its current sees, the length that its capacitance sees. A
   change of size is the natural logarithm of printed over drawn. */
enum { EDA_SIZE_L = 0, EDA_SIZE_W = 1, EDA_SIZE_C = 2, EDA_SIZES = 3 };

/* A capacitance of a pin: up to the middle of the supply, which delays see, and
   between the edges of a slew. */
enum { EDA_CAP_DELAY = 0, EDA_CAP_SLEW = 1, EDA_CAPS = 2 };

enum {
  EDA_TIMING_INPUTS = 12, /* at most, of a cell */
  EDA_TIMING_GRID = 16,   /* slews or loads of a cell at most */
  EDA_TIMING_POWERS = 4   /* coefficients of a cubic */
};

typedef struct eda_timing_device {
  const char *name; /* within the cell */
  uint8_t type;     /* EDA_NMOS, EDA_PMOS */
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm, as drawn */
  uint32_t bundle;      /* those that behave alike are one */
  double share;         /* of the bundle's effect */
} eda_timing_device;

/* An input changes, all others stay, and an output follows. */
typedef struct eda_timing_arc {
  uint8_t input, output;
  uint8_t rises; /* the output */
  uint32_t from; /* the inputs before: bit i is that of input i */
  /* [slew * loads + load] */
  double *delay, *slew;
  /* By how many s for each unit of change (1 nm of 100: 0.01):
     [(point * bundles + bundle) * EDA_SIZES + size], at three points. */
  double *delay_by, *slew_by;
} eda_timing_arc;

/* Two inputs that change and move an output together: either both have to
   (transistors in series), and the second is the cause, or each of them would
   do (parallel), and the first is. Delay and slew are told as factors, by how
   long the second comes after the first, in delays of the cause alone, and by
   both slews, each in its input's delay alone. What they are factors of is
   eda_timing_blend of the two inputs' own. */
enum { EDA_TIMING_GAPS = 6 };
typedef struct eda_timing_pair {
  uint8_t first, second, output;
  uint8_t parallel;
  uint32_t from; /* the inputs before both */
  double *at[2]; /* the slews of the first and of the second: two of each, and
                    one between them */
  /* [(slew of first * 2 + of second) * GAPS + gap], [4 * GAPS + gap] with both
     slews between. */
  double *delay, *slew;
} eda_timing_pair;

typedef struct eda_timing_cell {
  const char *name;
  const char *trouble; /* why it has no arcs, or NULL */
  size_t inputs, outputs;
  const char **pin; /* inputs, then outputs */
  uint32_t *port;   /* of each pin: its net */
  uint8_t *level;   /* [output << inputs | pattern] */
  size_t nets;
  int8_t *rail; /* of each net: 1 supply, -1 ground, else 0 */
  size_t devices, bundles;
  eda_timing_device *device;
  size_t slews, loads;
  double *at_slew, *at_load; /* the grid */
  /* Where changes of size were simulated, by numbers in the grid: at the first
     slew and load here, then with the second load, then with the second slew.
     By how much a delay moves is taken as a plane through them. */
  size_t near_slew[2], near_load[2];
  size_t arcs;
  eda_timing_arc *arc;
  int32_t *arc_of; /* [(output * inputs + input) << inputs | from], -1: none */
  /* Of pins, when they rise [1] and fall [0], means over what the other inputs
     are: [(input * 2 + rises) * EDA_CAPS + cap]; and by how much for a change:
     [that * bundles * EDA_SIZES ...]. */
  double *capacitance, *capacitance_by;
  size_t figures;
  double *figure;      /* all figures above, in one array */
  size_t pair_figures; /* those below, behind them */
  /* A pin's capacitance for each pattern of the inputs before it changes:
     [(input << inputs | from) * EDA_CAPS + cap]. */
  double *pin_capacitance;
  /* Patterns that differ only in inputs that stay share a pair. */
  size_t pairs;
  eda_timing_pair *pair;
  int32_t *pair_of; /* [((output * inputs + first) * inputs + second) << inputs
                       | from], -1: none */
} eda_timing_cell;

typedef struct eda_timing {
  size_t count;
  eda_timing_cell *cell;
  double supply, temperature; /* V, C */
  double low, high;           /* where slews begin and end, of 1 */
  eda_pool memory;
} eda_timing;

OPC_EXPORT eda_timing *eda_timing_new(size_t count);
OPC_EXPORT void eda_timing_free(void *timing);
/* Whether all arrays are there and all figures are numbers. */
OPC_EXPORT int eda_timing_check(const void *timing, opc_error *error);
/* A cell by its name (in any case); NULL if it is not there. */
OPC_EXPORT const eda_timing_cell *eda_timing_find(const eda_timing *timing,
                                                  const char *name);

/* Give a cell its arrays of figures once all sizes are set: slews, loads,
   bundles, arcs. */
OPC_EXPORT void eda_timing_cell_figures(eda_pool *pool, eda_timing_cell *cell);

/* Delay and slew of an arc at each slew of the grid, at these loads and changes
   of size ([bundle * EDA_SIZES + size], NULL for none). [any] */
OPC_EXPORT void eda_timing_at(const eda_timing_cell *cell,
                              const eda_timing_arc *arc, double delay_load,
                              double slew_load, const double *change,
                              double *delay, double *slew);

/* A pin's capacitance at these changes of size. [any] */
OPC_EXPORT double eda_timing_capacitance(const eda_timing_cell *cell,
                                         size_t input, int rises, int cap,
                                         const double *change);

/* Where pairs are simulated: gaps between two inputs, in delays of the cause.
 */
OPC_EXPORT extern const double eda_timing_gap[EDA_TIMING_GAPS];

/* What a pair's factors are of: with no gap the mean of what the cause and the
   other input have alone, beyond a delay the cause's only. So a change of
   either input's transistors counts by its part. */
OPC_EXPORT double eda_timing_blend(double gap, double cause, double other);

/* A pair's factors at a gap and two slews, in units as above. [any] */
OPC_EXPORT void eda_timing_pair_at(const eda_timing_pair *pair, double gap,
                                   double first, double second, double *delay,
                                   double *slew);

/* Through the points of a grid: cubics whose slopes are those of parabolas
   through three points (Catmull-Rom on uneven steps); straight on beyond the
   ends. Coefficients of t = x - x0 of each step, [step * 4 + power]. */
OPC_EXPORT void eda_timing_cubic(const double *x, const double *y, size_t n,
                                 double *coefficient);
OPC_EXPORT double eda_timing_cubic_at(const double *x,
                                      const double *coefficient, size_t n,
                                      double at);

/* The input that cells are characterised with has the shape that outputs of
   gates have: a straight line up to a level, then an exponential of the same
   slope. The time, in that of the whole line, when it passes a level (0 where
   it begins, below 1 where it ends); and its points for a simulator, the last
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

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_TIMING(port)                                  \
  {                                                            \
    .name = port, .kind = "timing", .check = eda_timing_check, \
    .release = eda_timing_free                                 \
  }

#ifdef __cplusplus
}
#endif
#endif
