/* --color-by, --ramp and --color-range, which commands that draw and that build share. */
#ifndef CONIC_COLOR_OPTIONS_H
#define CONIC_COLOR_OPTIONS_H

#include "cli/arguments.h"
#include "cli/json_write.h"
#include "conic/coloring.h"

extern const char *const cli_color_words[], *const cli_ramp_words[]; /* for completion */

/* Rows of a command's table, into a conic_coloring_options whose `by` is null before. */
#define CLI_COLOR_OPTIONS(coloring)                                                                                    \
  {"color-by",                                                                                                         \
   CLI_TEXT,                                                                                                           \
   &(coloring)->by,                                                                                                    \
   "WHAT",                                                                                                             \
   "what the points' colours are made of: rgb, intensity, height, classification, normal, or a value in the file "     \
   "by its name; auto: rgb, or else intensity [auto]",                                                                 \
   .choices = cli_color_words,                                                                                         \
   .group = "colours made of values"},                                                                                 \
      {"ramp",                                                                                                         \
       CLI_TEXT,                                                                                                       \
       &(coloring)->ramp,                                                                                              \
       "NAME",                                                                                                         \
       "the colours of --color-by: sequential, grey, heat, diverging, terrain or classes [what suits]",                \
       .choices = cli_ramp_words},                                                                                     \
  {                                                                                                                    \
    "color-range", CLI_PARSED, (coloring), "A,B",                                                                      \
        "the values at the two ends of the ramp [the 2nd and 98th percentile]", .parse = cli_parse_color_range         \
  }

/* "A,B" into a conic_coloring_options. */
int cli_parse_color_range(const char *text, void *value);

/* Whether the options make sense; where `by` is not given it becomes "auto" if that is the default, or else stays null.
 * Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_color_check(const cli_session *session, conic_coloring_options *coloring, int is_auto);

/* Whether colours are to be made of something else than colours. */
int cli_color_is_asked(const conic_coloring_options *coloring);

/* The object "coloring"; nothing where it is null. */
void cli_color_report(cli_json *json, const conic_coloring *coloring);

#endif
