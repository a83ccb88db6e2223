/* SPDX-License-Identifier: BSD-3-Clause */
/* All tuned constants of synthesizer.newton. Each has its unit, where its value
   comes from, and what half and twice of it do. Where no source is told, the
   value was chosen by us on the cases below.

   Figures are moves, and the largest |Ion deviation| in %. As it is:
     SRAM (flows/newton.yaml as it is)                       6, 0.194
     NAND2_X1 of the NanGate library at scale 1.3            5, 0.031
     c432                                                    6, 0.219
   "None of the three" means that all figures of these stay the same to the last
   digit. Then harder cases are named:
     HEADS  c432, max_head 10 nm, want_extension 60 nm      10, 0.50
     GRID   c432, mask grid of 4 nm                          8, 0.49
     NOJOG  c432, min_jog 1000 nm, so that W must do it      9, 4.75
     IOFF   c1908, weight.ioff 0.01: the mean is 5.0        17, 40.6
     SMALL  c432 at scale 1.15: a sixth of it does not print  12, 2.6
     AREA   SRAM, weight.area 1                              6, 0.61
   IOFF and SMALL have no good end; they only show where a constant acts. */
#ifndef SYNTHESIZER_NEWTON_TUNING_H
#define SYNTHESIZER_NEWTON_TUNING_H

#include <stdint.h>

static const struct {
  double thin_end[2], slope[2], gain_bound, doubt[2], least_doubt, many,
      doubt_of_many;
  double trust[2], longest, open_step;
  double still, unforeseen, late, coupling, noise_floor;
  double odd_limit, odd_surprise, unanswered;
  double coarse, worthwhile, mean_part, patience;
  double blur, short_end, past_end, before_end;
  double smooth, firm, local, tail, near_jog, leak, leaks;
  uint32_t shapes[3], settled[3], polish, rest;
} tuned = {
    /* ---- the first estimate of a response ---- */

    /* d log I / d log L of Ion and Ioff, where no print tells a slope. A long
       channel has -1; -15 is that of PTM 65 nm at L 65 nm. None of the three;
       SMALL differs, as its drawn mask prints hardly anything. */
    .slope = {-1, -15},

    /* The factor by which the first prints may change the response to L of all
       transistors of a type. Half (1.25): SRAM 6, 0.195, last digits differ.
       Twice: none of the three. */
    .gain_bound = 2.5,

    /* How uncertain a first response to L and to W is, as a part of it.
       L: half NAND2_X1 0.028, twice 0.031. W: none of the three; AREA 0.50 at
       half, 0.56 at twice. */
    .doubt = {0.3, 0.1},

    /* No response gets less uncertain than this part: it changes with the mask.
       Half: c432 0.27. Twice: NAND2_X1 0.040, c432 0.37. */
    .least_doubt = 0.15,

    /* So many transistors of a type tell a common factor from their own ones;
       and how uncertain each response to L is then. `many`: none of the three;
       at twice, SDFFRS_X2 takes 8 moves instead of 9. The doubt: c432 0.23 at
       half, 0.28 at twice. */
    .many = 16,
    .doubt_of_many = 0.15,

    /* ---- moves ---- */

    /* Where the poly is thin (target: balanced). By so much log Ioff of a gate
       is too large, and that of the strips at an end of its width, for the
       strips to be given up: twice. And of a strip beyond the end, for the gate
       to get wider elsewhere: 12 times. By Ioff (mean, largest), area, shots of
       c432, which was 1.9, 29, 2.95, 10784 (now 1.8, 29, 2.95, 10068), and
       largest Ioff and violations of SDFFRS_X2, 90, 0, and of DFF_X1, 10, 0.
       The first: half 2.4, 211, 2.94, 10766; 118; 657. Twice: c432 as it is;
       233; 45. The second at 2: 1.9, 30, 2.99, 11012; 88, 0; 10. At 3: 1.8,
       29, 2.92, 10632; 187, 1; 10. Neither, as it was: 2.3, 43, 2.68, 10056;
       7962, 1; 191. */
    .thin_end = {0.7, 2.5},

    /* A response to L, and to W, stays within this factor of its first
       estimate. That to W is geometry and well known. None of the three.
       L: half HEADS 0.51, GRID 13, 24; twice HEADS 14, 0.39. W: 1.2 AREA 7,
       0.56; twice IOFF and SMALL alone differ. */
    .trust = {4, 1.5},

    /* nm: the longest step of L at first; what moves do lengthens and shortens
       it (trust.c). No case differs, but IHP cells (248 nm) take a print more
       at half. */
    .longest = 20,

    /* nm: how much wider a line gets at a time that does not print at all. None
       of the three; SMALL alone has such lines: half needs 23 moves, not 19. */
    .open_step = 5,

    /* ---- what changes a transistor besides its moves ---- */

    /* nm: a line end that moves further changes its transistor. Half: SRAM
       0.188. Twice: SRAM 0.187, c432 0.115 for one print more. */
    .still = 2,

    /* What the first move of line ends does to log Ion is foreseen; this part
       of it is left open. Half: c432 0.25. Twice: NAND2_X1 0.028, c432 0.23. */
    .unforeseen = 0.15,

    /* What a line end that moves later may do to log Ion. Half: c432 0.32.
       Twice: c432 0.23 for one print more. */
    .late = 0.01,

    /* What neighbours do to log Ion, as a part of the mean move (root mean
       square) of all transistors. Measured at 193 nm, NA 0.75: a tenth at most.
       Half: NAND2_X1 0.029. Twice: c432 0.26. */
    .coupling = 0.1,

    /* What a print of log Ion is always uncertain by. Half and twice change
       last digits. */
    .noise_floor = 1e-4,

    /* ---- odd prints: is_odd, is_foreign ---- */

    /* A change of log Ion counts from this part of `ion_limit` on. None of the
       three. Half (is_odd) HEADS 0.32, twice 22 moves, 0.39; half (is_foreign)
       HEADS 18, 0.72, twice 13, 0.72. */
    .odd_limit = 0.5,

    /* It counts where it is more than so many times the surprise expected. None
       of the three. HEADS 0.72 at half and at twice of is_foreign's. */
    .odd_surprise = 2,

    /* A move of which less than one part in so many arrives has not done what
       was foreseen: the radius shrinks, or the bracket is halved. A quarter
       costs c5315 a print more. */
    .unanswered = 10,

    /* ---- what is worth a move ---- */

    /* W makes good what jogs leave beyond so many times `tolerance`. None of
       the three. Half: no case differs, as `ion_limit` is no less. Twice:
       SDFFRS_X2 0.94 instead of 0.24, GRID 0.61. */
    .coarse = 10,

    /* A move is made if at most this part of the error is expected to be left.
       Half: SRAM 0.25. Twice, which takes whatever a move promises: none of
       the three. */
    .worthwhile = 0.8,

    /* The loop ends where the mean error is below `ion_limit` over this. Half:
       SRAM 6, 0.33, its mean 0.090 instead of 0.033. Twice: SRAM 7, 0.124. */
    .mean_part = 10,

    /* Transistors that the regulator still moves follow it for so many times
       `iterations`. None of the three. 1: HEADS 12, 0.72. 4: no case differs.
     */
    .patience = 2,

    /* ---- jogs: jog.c ---- */

    /* nm: along an edge the print smooths a step of it as a Gaussian of this
       standard deviation, some quarter of the resolution. This and the three
       below fit what jogs did to some thousand gates at 193 nm, NA 0.75. Half:
       SRAM 10, 0.41; c432 0.36. Twice: SRAM 7, 0.42; NAND2_X1 0.051. */
    .blur = 60,

    /* In units of blur: a line that ends within short_end of the gate is thin
       at its end and gives way easily, so that its edges matter, by half, as
       far as past_end beyond the gate; one that goes on holds, and they matter
       only as far as before_end before the gate's end.
       short_end: half SRAM 0.195, NAND2_X1 0.047, c432 0.19 for one print more;
       twice none of the three. past_end: half c432 0.18, twice SRAM 7, c432
       0.29. before_end: half SRAM 0.197, c432 0.23; twice SRAM 7, 0.31, c432
       0.115 for one print more. */
    .short_end = 2,
    .past_end = 1 / 2.0,
    .before_end = 3,

    /* ---- flat edges: shape.c ---- */

    /* These by Ioff (mean, largest, %), area (mean, %) and shots of c432 at
       `price` 1 % (target: balanced), which is 1.8, 35, 2.67, 10114 before
       `leak` and `settled` were there, and 2.3, 29, 2.51, 10091 with them. */

    /* nm: how a print smooths a part of the edges. 40: 1.8, 26, 2.71, 10185;
       60: 1.9, 54, 2.69, 9961. */
    .smooth = 50,

    /* Tikhonov's term, as a part of the response of a whole edge. Half: 3.5,
       62, 2.01, 11482. Twice: 10.8, 756, 3.38, 9410. */
    .firm = 0.15,

    /* What a part of 60 nm answers with, of a whole edge; half is a price four
       times as high. */
    .local = 0.5,

    /* nm: the poly goes at least so far past the active for a part of its own.
       As min_jog's default. */
    .tail = 40,

    /* Grid steps: a length nearer than this is not sought beside the ends of
       parts. Without that search some gates stay 0.9 % of Ion off. */
    .near_jog = 0.02,

    /* What a squared error of Ioff counts against one of Ion until L alone goes
       on, so that which mask is the better one is told. 0.01: 4.1, 40, 2.22,
       10176 (settled 5; as it is with that: 4.2, 40, 2.21, 10157). */
    .leak = 0.003,

    /* Ioff further off than this (a factor's logarithm) is told. */
    .leaks = 0.26,

    /* Prints, by target, in which parts move, and after which W rests and L
       goes on for Ion alone. balanced, which is 2.3, 42, 2.68, 10056: shapes 3,
       settled 7 took Ioff no nearer, two prints later; settled 5: c1908 has 3.1
       instead of 2.5 for a print less. */
    .shapes = {0, 2, 6},
    .settled = {0, 6, 9},

    /* Prints after that until all that is within the limit rests, and after
       that in which those beyond it still move: what rests keeps its neighbours
       and the regulator still. polish 1: c432 .031 of Ion in the mean instead
       of .023, for one print less. */
    .polish = 2,
    .rest = 3,
};

#endif
