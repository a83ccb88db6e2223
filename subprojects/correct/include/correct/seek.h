/* SPDX-License-Identifier: BSD-3-Clause */
/* Model-based sub-resolution assist features (SRAF): scatter bars in the clear
   field that narrow the process variability band, the band between the
   outermost and innermost contours.

   The derivative of the band's area by the mask transmission is the gradient of
   the images at the two borders (compare R. Socha and others, "Contact hole
   reticle optimization by using interference mapping lithography", SPIE 5377,
   2004, for the intensity). Bars are placed where the derivative is most
   negative, after compensation by the edges of the features, which hold the
   nominal contour in place. */
#pragma once

#include <eda/bars.h>
#include <opcflow/plugin.h>

struct loop;

typedef struct sought_bars {
  /* Parameters; `most` = 0 disables the search. */
  int64_t most, rounds, every;
  double worth;                               /* smallest reduction of the band
                                                 by a bar, nm^2 */
  double dose, defocus;                       /* %, nm */
  double least_width, width, distance, space; /* nm */
  double min_length, length;                  /* nm */
  double margin;                              /* distance to the printing
                                                 threshold, clear field 1 */
  /* Bars of the present mask. */
  eda_box_list bars;
  size_t dropped;
  int64_t round;
  uint32_t next; /* iteration of the next round */
} sought_bars;

OPC_EXPORT int correct_seek_begin(struct loop *loop, opc_error *error);
OPC_EXPORT void correct_seek_clear(struct loop *loop);

/* Narrow bars that print, and search for more when a round is due or all
   synthesizers are `done`. Call after each simulation. */
OPC_EXPORT int correct_seek_watch(struct loop *loop, int done,
                                  opc_error *error);

#define SEEK_LENGTH(state, name_, member, from_, text)                     \
  OPC_PARAMETER_NAMED("seek." name_, state, seek.member, .type = OPC_REAL, \
                      .flags = OPC_ABOVE, .unit = "nm", .follows = from_,  \
                      .summary = text)
#define SEEK_COUNT(state, name_, member, preset_, least, text)            \
  OPC_PARAMETER_NAMED("seek." name_, state, seek.member, .type = OPC_INT, \
                      .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = least,  \
                      .max = 100000, .preset = preset_, .summary = text)
#define SEEK_PARAMETERS(state)                                                 \
  SEEK_COUNT(state, "most", most, "0", 0,                                      \
             "assist bars at most where the model's gradient says that they "  \
             "narrow the band between doses and foci; 0: none"),               \
      SEEK_COUNT(state, "rounds", rounds, "3", 1, "times that it looks"),      \
      SEEK_COUNT(state, "every", every, "6", 1, "iterations between them"),    \
      OPC_PARAMETER_NAMED("seek.worth", state, seek.worth, .type = OPC_REAL,   \
                          .flags = OPC_ABOVE, .unit = "nm^2",                  \
                          .follows = "0.003775 (lambda/NA)^2",                 \
                          .summary =                                           \
                              "of the band: what a bar takes away at "         \
                              "least"),                                        \
      OPC_PARAMETER_NAMED("seek.dose", state, seek.dose, .type = OPC_REAL,     \
                          .flags = OPC_ABOVE | OPC_BELOW, .unit = "%",         \
                          .preset = "4 %", .max = 100,                         \
                          .summary =                                           \
                              "of the band: how far the dose goes up "         \
                              "and down"),                                     \
      OPC_PARAMETER_NAMED("seek.defocus", state, seek.defocus,                 \
                          .type = OPC_REAL, .unit = "nm",                      \
                          .follows = "0.073 lambda/NA^2",                      \
                          .summary =                                           \
                              "of the band: the focus of its lower "           \
                              "dose"),                                         \
      SEEK_LENGTH(state, "least_width", least_width, "0.093 lambda/NA",        \
                  "width of a bar, at least"),                                 \
      SEEK_LENGTH(state, "width", width, "0.249 lambda/NA",                    \
                  "... and at most"),                                          \
      SEEK_LENGTH(state, "min_length", min_length, "0.249 lambda/NA",          \
                  "length of a bar, at least"),                                \
      SEEK_LENGTH(state, "length", length, "1.554 lambda/NA",                  \
                  "... and at most"),                                          \
      SEEK_LENGTH(state, "distance", distance, "0.28 lambda/NA",               \
                  "from drawn shapes to a bar"),                               \
      SEEK_LENGTH(state, "space", space, "0.187 lambda/NA", "between bars"),   \
      OPC_PARAMETER_NAMED("seek.margin", state, seek.margin, .type = OPC_REAL, \
                          .flags = OPC_AT_LEAST, .preset = "0.01", .min = 0,   \
                          .summary =                                           \
                              "a bar gets narrower while it comes so "         \
                              "near to printing, intensity; clear "            \
                              "field 1")
