/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of the step `variation`: statistics of currents over the
   variation of dose, focus, mask size, overlay and line edges. */
#pragma once

#include <correct/settings.h>
#include <eda/delays.h>
#include <eda/print.h>
#include <eda/samples.h>
#include <opcflow/step.h>

/* ---- sources of variation ---- */

/* Variables. Dose (%), focus (nm) and displacement of all mask edges (nm) of
   poly and active; displacement of active against poly (nm). */
enum {
  POLY_DOSE,
  POLY_FOCUS,
  POLY_MASK,
  ACTIVE_DOSE,
  ACTIVE_FOCUS,
  ACTIVE_MASK,
  OVERLAY_X,
  OVERLAY_Y,
  VARIABLES
};

/* Sources: the variables, with both overlays in one, and the line edges. */
enum { SOURCE_OVERLAY = OVERLAY_X, SOURCE_EDGES, SOURCES };
extern const char *const variation_sources[SOURCES];

/* Range of all variables, in standard deviations. Samples beyond it (6e-5 of a
   normal distribution) are set to its end; the surrogate is fitted within. */
static const double variation_range = 4;

/* ---- surrogate.c ---- */

/* Figures of a transistor, relative to drawn: equivalent length of Ion, and
   change of all slices of the nominal image that results in Ioff, nm; ln W, ln
   area, and ln of the length of Ion (for delays). The currents follow from the
   lengths and W by curves (below), because these figures are smooth functions
   of the variables. Ioff and its equivalent length are not, because the
   shortest slices dominate Ioff where its slope is steep. */
enum { LENGTH, LENGTH_OFF, WIDTH, AREA, LOG_LENGTH, FIGURES };

/* A polynomial in the scaled variables. Each variable is divided by the end of
   its range (variation_range standard deviations), so that the scaled range is
   -1 to 1. Term t is the product over v of variable v to the power[t][v]. */
typedef struct surrogate {
  size_t terms, gates;
  uint8_t (*power)[VARIABLES];
  float *coefficient[FIGURES]; /* [term * gates + gate] */
} surrogate;

/* Set up the terms for the variables with used[v] != 0. The degree is 4 in the
   variables of poly and in overlay, and 3 in those of active. Across these
   groups, all products of degree 2 are terms, and products of degree 3 without
   variables of active. */
void surrogate_init(surrogate *s, const int used[VARIABLES], size_t gates);
void surrogate_clear(surrogate *s);

/* Write the values of all terms at a point; u: scaled variables. */
void surrogate_features(const surrogate *s, const double u[VARIABLES],
                        double *out);

/* Fit all figures by least squares (QR, GSL). `point`: [points][VARIABLES] as
   `u`; `value`: [(point * FIGURES + figure) * gates + gate], NAN if the gate
   does not print at the point. Return OPC_FAILED if there are fewer points than
   terms. The caller checks that each gate prints at enough points. */
int surrogate_fit(surrogate *s, const opc_context *context, size_t points,
                  const double (*point)[VARIABLES], const float *value,
                  opc_error *error);

/* Return a figure of a gate from the values of the terms. */
double surrogate_at(const surrogate *s, const double *features, int figure,
                    size_t gate);

/* ---- curves.c ---- */

enum { ION, IOFF, CURRENTS };

/* Currents over length, on the lengths first + i * step, i < count: ln of
   (current per W, over the drawn current per drawn W). The gates are
   rectangular, or have the nominal image, with all slices longer by length -
   drawn length. Gates with equal curves share one curve. */
typedef struct curves {
  double first, step;
  size_t count, gates, kinds;
  uint32_t *kind;         /* [gates] */
  float *value[CURRENTS]; /* [kind * count + i] */
} curves;

/* Allocate one curve for each gate, for lengths from `low` to `high`. */
void curves_init(curves *c, size_t gates, double low, double high);
void curves_clear(curves *c);

/* Compute the curves of the gates `first` to first + in->count - 1 from their
   slices. `drawn`: currents, `width`: drawn W, of all gates. `length`: drawn
   lengths, for curves of the nominal image; NULL: rectangular gates. [any] */
int curves_fill(curves *c, const opc_context *context,
                const opc_module *extractor, size_t first, const eda_slices *in,
                const eda_performance *drawn, const double *width,
                const double *length, opc_error *error);

/* Replace equal curves by one shared curve. */
void curves_share(curves *c);

/* Return the value at a length, interpolated linearly; at the nearest end
   beyond the ends. */
double curves_at(const curves *c, size_t gate, int current, double length);
/* Return the length with this value, by bisection of the falling curve. */
double curves_length(const curves *c, size_t gate, int current, double value);

/* ---- roughness.c ---- */

/* Line-edge roughness: standard deviation of an edge (nm), correlation length
   (nm) and Hurst exponent h. The covariance of an edge at a distance r is
   sigma^2 exp(-(r / length)^(2 h)); the two edges of a gate are independent. */
typedef struct roughness {
  double sigma, length, hurst;
} roughness;

/* Effect of roughness on ln Ion and ln Ioff of a gate: shift of the median,
   standard deviations, and their correlation. */
typedef struct roughness_effect {
  float shift[CURRENTS], sigma[CURRENTS], correlation;
} roughness_effect;

/* Moments of the currents of a point of a gate, for each length of a curve:
   coefficients of Hermite polynomials of the standardised change of length. */
enum { ORDER = 6 };
typedef struct roughness_moments {
  const curves *curves;
  double (*of)[CURRENTS][ORDER + 1]; /* [kind * count + i] */
} roughness_moments;

void roughness_moments_init(roughness_moments *m, const roughness *r,
                            const curves *of, const opc_context *context);
void roughness_moments_clear(roughness_moments *m);

/* Number of lengths, relative to the nominal length of a gate, for which the
   effect is known, and the distance between them, nm. */
enum { KNOTS = 25, KNOT_ZERO = 16 };
static const double knot_step = 1;

/* Compute the effects for a gate with the given slices, all of which change by
   (k - KNOT_ZERO) * knot_step in length, k < KNOTS. [any] */
void roughness_of_gate(const roughness *r, const roughness_moments *m,
                       size_t gate, size_t slices, const double *width,
                       const double *length, roughness_effect out[KNOTS]);

/* Mismatch: standard deviation of the threshold voltage of a transistor with
   W L = 1 um^2, V (inversely proportional to the root of W L: M. J. M. Pelgrom
   et al., IEEE J. Solid-State Circuits 24, 1433 (1989)). A threshold higher by
   dV changes ln Ion by -ion dV, and log10 Ioff by -dV / swing. */
typedef struct mismatch {
  double vt, ion, swing;
} mismatch;

/* Return the standard deviation of the threshold voltage, V, of a gate with the
   drawn W L `area`, nm^2. [any] */
double mismatch_sigma(const mismatch *m, double area);

/* Add the mismatch of a gate with the drawn W L `area`, nm^2, to the effect of
   its line edges, which is independent. [any] */
void mismatch_add(const mismatch *m, double area, roughness_effect e[KNOTS]);

/* ---- normals.c ---- */

/* Return number `k` of a stream of standard normal numbers of a chip. All
   numbers are functions of their indices, so that any order and number of
   threads produces the same numbers. Method: Box and Muller, Ann. Math. Stat.
   29, 610 (1958), on a hash of the indices (eda/random.h). */
double normal_at(uint64_t seed, uint32_t stream, uint64_t chip, uint32_t k);

enum { LANES = 16 };

/* Write pairs of standard normal numbers for LANES gates from `first` on, of a
   chip with the key normal_key. */
uint64_t normal_key(uint64_t seed, uint32_t stream, uint64_t chip);
void normal_pairs(uint64_t key, uint32_t first, float *a, float *b);

/* ---- chips.c ---- */

/* The model of a circuit from which chips are sampled. */
typedef struct circuit {
  const opc_context *context;
  const surrogate *surrogate;
  const curves *curves;                   /* of rectangular gates, for Ion */
  const curves *leakage;                  /* of the nominal image, for Ioff */
  const roughness_effect *rough;          /* [gate * KNOTS + knot] */
  const double *drawn_length;             /* nm, [gates] */
  const double *drawn_width, *drawn_area; /* the same, nm and nm^2 */
  const double *nominal; /* equivalent length of Ion without variation,
                            nm, [gates] */
  size_t gates;
  const uint8_t *type;
  const uint32_t *neighbour; /* [gates], the nearest other gate */
  const double *ioff;        /* drawn, [gates] */
  double global[VARIABLES];  /* standard deviations divided by the end of each
                                range */
  double field[VARIABLES]; /* the same for the part that varies in the field */
  size_t tiles;            /* at least 1 */
  const uint32_t *tile_of; /* [gates], part of the layout that is
                              small against the correlation length of
                              the field; NULL if `tiles` is 1 */
  const double *mix;       /* [tiles * tiles], lower triangle: the
                              Cholesky factor of the correlation */
  const struct delay_model *delays; /* NULL: no delays */
  uint64_t kept;                    /* chips whose line edges are kept */
  float *edges; /* change of ln L by line edges, [chip * gates + gate] */
  uint64_t seed;
} circuit;

/* Figures of one chip: total Ioff, and mean Ion of the n- and of the
   p-transistors; delay of the longest path (ps); smallest and largest Ion. All
   but the delay are relative to drawn. */
enum {
  CHIP_LEAKAGE,
  CHIP_ION_N,
  CHIP_ION_P,
  CHIP_DELAY,
  CHIP_LEAST,
  CHIP_MOST,
  CHIP
};

enum { BLOCK = 64 }; /* chips of a work unit */

/* Sums over chips, for the moments of ln Ion and ln Ioff of a gate. */
typedef struct moments {
  double sum[2], square[2], cube[2]; /* [current] */
  double product;                    /* ln Ion times ln Ioff */
  double neighbour;                  /* ln Ion times ln Ion of the neighbour */
} moments;

/* Write the scaled variables of a chip at a tile. */
void circuit_variables(const circuit *c, const uint32_t stream[SOURCES],
                       uint64_t chip, size_t tile, double u[VARIABLES]);

/* Sample chips `first` to first + count - 1. stream[s]: number of the stream of
   source s. `chip`: [CHIP][count]. `moments`: [gates], or NULL. */
int circuit_sample(const circuit *c, const uint32_t stream[SOURCES],
                   uint64_t first, size_t count, float *const chip[CHIP],
                   moments *moments, opc_error *error);

/* ---- delays.c ---- */

/* Delays of paths, ps: polynomials in the terms of the surrogate, by tile, and
   the effect of a change of ln L of single gates by line edges. */
typedef struct delay_model {
  size_t paths, tiles, terms;
  float *time;   /* at the sizes of eda_delays, [paths] */
  float *global; /* [(path * tiles + tile) * terms + term] */
  size_t *first; /* [paths + 1]: first element of a path in: */
  uint32_t *gate;
  float *local;
} delay_model;

void delay_model_init(delay_model *m, const circuit *c, const eda_delays *d);
void delay_model_clear(delay_model *m);

/* Compute the longest delay of BLOCK chips. `terms`: values of the terms,
   [(tile * terms + term) * BLOCK + chip]; `edges`: change of ln L by line
   edges, the length with the changed Ion, [gate * BLOCK + chip]. */
void delays_longest(const delay_model *m, const float *terms,
                    const float *edges, float *out);

/* Add the coefficients of the change of a delay by the gates of a tile, ps, to
   out[terms]. */
void delay_global(const circuit *c, const eda_delays *d, const eda_delay *delay,
                  size_t tile, double *out);
/* Return the change of a delay, ps, for a change of ln Ion of the term's gate
   by line edges. */
double delay_local(const circuit *c, const eda_delay_term *term);

/* ---- statistics.c ---- */

/* Clopper-Pearson interval of a probability, both ends at 2.5 %. */
typedef struct interval {
  double value, low, high;
} interval;
interval interval_of(size_t successes, size_t n);

/* Mean, standard deviation, skewness, and quantiles of n values; sorts them. */
enum { QUANTILES = 7 };
extern const double statistics_at[QUANTILES];
typedef struct statistics {
  double mean, sigma, skewness, quantile[QUANTILES];
} statistics;
statistics statistics_of(float *value, size_t n);

/* Share of the variance of a figure by a source: alone (first order) and with
   all interactions (total), with the standard error of each. */
typedef struct share {
  double first, first_error, total, total_error;
} share;

/* Compute the shares of one source from the values of a figure for n chips. All
   sources have the streams A in `a` and the streams B in `b`. In `ab`, this
   source has the stream B and all others have A. Saltelli et al., Comput. Phys.
   Commun. 181, 259 (2010), table 2 (b), (f). */
share share_of(const double *a, const double *b, const double *ab, size_t n);

/* ---- the step ---- */

/* Root mean square and largest error over points and gates: Ion in %, Ioff in
   decades, L in nm, W and area in %. */
enum { ERROR_ION, ERROR_IOFF, ERROR_LENGTH, ERROR_WIDTH, ERROR_AREA, ERRORS };
typedef struct surrogate_error {
  double rms[ERRORS], max[ERRORS];
} surrogate_error;

/* A field, simulated at a focus and a mask displacement. */
typedef struct image {
  double focus, mask;
  eda_field field;
} image;

typedef struct variation {
  const opc_host *host;
  const eda_mask *given; /* parameters */
  correct_settings with;
  double dose, focus, mask_edge, overlay; /* sigma */
  double field_dose, field_focus, field_overlay, field_length;
  roughness rough;
  mismatch mismatch;
  double ion_error, ioff_error, length_error;
  double leakage_limit, speed_limit, ion_limit;
  int64_t chips, seed, tables;
  const char *file;
  const eda_mask *mask; /* `given` with all transistors and shapes */
  const eda_gates *gates;
  eda_performance design;
  double sigma[VARIABLES]; /* total standard deviation, in its unit */
  surrogate surrogate;
  curves curves, leakage; /* as in circuit */
  surrogate_error error;  /* on points that were left out */
  size_t points, left_out, images[2];
  size_t open, failed, outside; /* measurements of transistors */
  const eda_delays *delays;     /* parameter */
  delay_model delay_model;
  double clock, delay_limit; /* s; % */
  const char *sdf;
  roughness_effect *effect; /* [gate * KNOTS + knot] */
  double *nominal;          /* as in circuit */
  circuit circuit;
  uint32_t *tile_of, *neighbour;
  double *mix;
  float *chip[CHIP];
  moments *moments; /* of the first moment_chips chips */
  size_t moment_chips;
} variation;

/* Numbers of the streams of the sources: a chip has the same numbers in every
   run and for every mask, so that masks are compared on equal chips. */
extern const uint32_t variation_stream[SOURCES];

/* ---- conditions.c ---- */

/* Simulate images, fit the surrogate, estimate its error on other images, and
   refine until the error is below the limits. Set surrogate, curves, error,
   effect and nominal. */
int variation_respond(variation *v, opc_error *error);

/* ---- results.c, histograms.c, delay_tables.c ---- */

/* Mean and covariance of the terms of the surrogate; free both. */
typedef struct term_moments {
  double *mean, *covariance; /* [terms], [terms * terms] */
} term_moments;
void terms_sample(const variation *v, term_moments *m);

int variation_report(variation *v, const eda_samples *chips, opc_error *error);
/* Compute the sizes of the transistors of the first v->tables chips. */
eda_samples *chips_sizes(const variation *v);
/* Write each of these chips as a table. */
int chips_report(const variation *v, const eda_samples *chips,
                 opc_error *error);
/* Report the paths, and write the SDF file. */
int delays_report(const variation *v, opc_error *error);
int variation_draw(const variation *v, opc_error *error);
