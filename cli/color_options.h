/* --color-by, --ramp and --color-range, which commands that draw and that build share. */
#pragma once

#include "cli/arguments.h"
#include "cli/json_write.h"

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
   .is_usual = 1,                                                                                                      \
   .acts = {.on = CLI_SURFACES},                                                                                       \
   .group = "colours made of values",                                                                                  \
   .intro = "Colours of what scans and simulations measure."},                                                         \
      {"ramp",                                                                                                         \
       CLI_PARSED,                                                                                                     \
       (coloring),                                                                                                     \
       "NAME:A,B",                                                                                                     \
       "the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or classes; the " \
       "values at its two ends behind it, or alone [what suits, from the 2nd to the 98th percentile]",                 \
       .choices = cli_ramp_words,                                                                                      \
       .parse = cli_parse_ramp,                                                                                        \
       .acts = {.on = CLI_FACT(VALUED)}},                                                                              \
  {                                                                                                                    \
    "color-range", CLI_PARSED, (coloring), "A,B", "the values at the two ends of the ramp",                            \
        .parse = cli_parse_color_range, .now = "--ramp A,B, or behind its name, --ramp heat:A,B", .acts = {            \
          .on = CLI_FACT(VALUED)                                                                                       \
        }                                                                                                              \
  }

/* "A,B" into a conic_coloring_options; and NAME, NAME:A,B or A,B, where any name is taken until cli_color_check. */
int cli_parse_color_range(const char *text, void *value);
int cli_parse_ramp(const char *text, void *value);

/* Whether the options make sense; where `by` is not given it becomes "auto" if that is the default, or else stays null.
 * Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_color_check(const cli_session *session, conic_coloring_options *coloring, int is_auto);

/* That no texture is named, null: none, whose colours would be others. */
int cli_color_check_texture(const cli_session *session, const conic_coloring_options *coloring, const char *texture);

/* Whether colours are to be made of something else than colours. */
int cli_color_is_asked(const conic_coloring_options *coloring);

/* The object "coloring"; nothing where it is null. */
void cli_color_report(cli_json *json, const conic_coloring *coloring);
