/* SPDX-License-Identifier: BSD-3-Clause */
/* Model-based sub-resolution assist features (SRAF): scatter bars in the clear
   field that narrow the process variability band. The band is the area between
   the outermost and the innermost contour under variations of dose and focus.

   The derivative of the band's area with respect to the mask transmission is
   computed from the images at the two contours. R. Socha and others use the
   derivative of the intensity instead ("Contact hole reticle optimization by
   using interference mapping lithography", SPIE 5377, 2004). Scatter bars are
   placed where the derivative is most negative. The derivative includes the
   displacement of feature edges that preserves the nominal contour. */
#pragma once

#include <eda/srafs.h>
#include <opcflow/plugin.h>

struct loop;

/* Parameters and state of the search. */
typedef struct sraf_search_state {
  /* Parameters; `most` = 0 disables the search. */
  int64_t most, rounds, every; /* largest number of scatter bars; number of
                                  searches; iterations between two searches */
  double min_gain; /* smallest reduction of the band's area by a scatter bar,
                      nm^2 */
  double dose, defocus; /* dose (%) and defocus (nm) of the band's contours */
  double least_width, width, distance, space; /* smallest and largest width,
                                                 distance from shapes, space
                                                 between scatter bars, nm */
  double min_length, length;                  /* smallest and largest length,
                                                 nm */
  double margin; /* smallest distance of the intensity from the printing
                    threshold, relative to the clear field */
  /* Scatter bars of the current mask. */
  eda_box_list srafs;
  size_t dropped; /* number of removed scatter bars */
  int64_t round;  /* number of finished searches */
  uint32_t next;  /* iteration of the next search */
} sraf_search_state;

/* Check the parameters. Returns OPC_INVALID if the optical model provides no
   gradient or other scatter bars exist. Call after correct_assists_begin. */
OPC_EXPORT int correct_search_begin(struct loop *loop, opc_error *error);
/* Free the scatter bars. */
OPC_EXPORT void correct_search_clear(struct loop *loop);

/* Narrow the scatter bars that print or nearly print (within `margin`). Search
   for more scatter bars if a search is due. `done`: 1: all synthesizers have
   finished, so the next search is due. Call after each simulation. */
OPC_EXPORT int correct_search_watch(struct loop *loop, int done,
                                    opc_error *error);

/* Declare the parameters of the field `search` of the step `state`. */
#define SEARCH_LENGTH(state, name_, member, from_, text)                  \
  OPC_PARAMETER_NAMED("search." name_, state, search.member,              \
                      .former = "seek." name_, .type = OPC_REAL,          \
                      .flags = OPC_ABOVE, .unit = "nm", .follows = from_, \
                      .summary = text)
#define SEARCH_COUNT(state, name_, member, preset_, least, text)         \
  OPC_PARAMETER_NAMED("search." name_, state, search.member,             \
                      .former = "seek." name_, .type = OPC_INT,          \
                      .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = least, \
                      .max = 100000, .preset = preset_, .summary = text)
#define SEARCH_PARAMETERS(state)                                               \
  SEARCH_COUNT(state, "most", most, "0", 0,                                    \
               "Largest number of scatter bars placed by the gradient of the " \
               "band between doses and foci; 0: none"),                        \
      SEARCH_COUNT(state, "rounds", rounds, "3", 1, "Number of searches"),     \
      SEARCH_COUNT(state, "every", every, "6", 1,                              \
                   "Number of iterations between two searches"),               \
      OPC_PARAMETER_NAMED(                                                     \
          "search.min_gain", state, search.min_gain, .former = "seek.worth",   \
          .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm^2",                \
          .follows = "0.003775 (lambda/NA)^2",                                 \
          .summary =                                                           \
              "Smallest reduction of the band's area by a scatter bar"),       \
      OPC_PARAMETER_NAMED(                                                     \
          "search.dose", state, search.dose, .former = "seek.dose",            \
          .type = OPC_REAL, .flags = OPC_ABOVE | OPC_BELOW, .unit = "%",       \
          .preset = "4 %", .max = 100,                                         \
          .summary = "Dose variation of the band, up and down"),               \
      OPC_PARAMETER_NAMED("search.defocus", state, search.defocus,             \
                          .former = "seek.defocus", .type = OPC_REAL,          \
                          .unit = "nm", .follows = "0.073 lambda/NA^2",        \
                          .summary = "Defocus at the lower dose of the band"), \
      SEARCH_LENGTH(state, "least_width", least_width, "0.093 lambda/NA",      \
                    "Smallest width of a scatter bar"),                        \
      SEARCH_LENGTH(state, "width", width, "0.249 lambda/NA",                  \
                    "Largest width of a scatter bar"),                         \
      SEARCH_LENGTH(state, "min_length", min_length, "0.249 lambda/NA",        \
                    "Smallest length of a scatter bar"),                       \
      SEARCH_LENGTH(state, "length", length, "1.554 lambda/NA",                \
                    "Largest length of a scatter bar"),                        \
      SEARCH_LENGTH(state, "distance", distance, "0.28 lambda/NA",             \
                    "Distance of scatter bars from drawn shapes"),             \
      SEARCH_LENGTH(state, "space", space, "0.187 lambda/NA",                  \
                    "Space between scatter bars"),                             \
      OPC_PARAMETER_NAMED(                                                     \
          "search.margin", state, search.margin, .former = "seek.margin",      \
          .type = OPC_REAL, .flags = OPC_AT_LEAST, .preset = "0.01", .min = 0, \
          .summary =                                                           \
              "Smallest intensity margin to printing, clear "                  \
              "field 1; scatter bars with a smaller margin are narrowed")
