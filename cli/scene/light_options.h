/* The lights of a picture: --light and --sky, and what they are where nobody said. */
#pragma once

#include "cli/scene/render_job.h"

/* Rows of an option table: light that is hidden. */
#define CLI_HIDDEN_LIGHT(job)                                                                                          \
  {"ao",                                                                                                               \
   CLI_INT,                                                                                                            \
   &(job)->n_directions,                                                                                               \
   "N",                                                                                                                \
   "light from all around falls only where nothing hides it, as so many directions tell: 64 look smooth, 1024 are "    \
   "exact",                                                                                                            \
   1,                                                                                                                  \
   65536,                                                                                                              \
   .group = "shadow and transparency",                                                                                 \
   .intro = "What hides light, and what lets it through.",                                                             \
   .is_usual = 1,                                                                                                      \
   .acts = {.on = CLI_SURFACES}},                                                                                      \
  {                                                                                                                    \
    "shadow", CLI_FLAG, &(job)->has_shadows, NULL, "the lights cast shadows, but for those at your eye",               \
        .is_usual = 1, .acts = {                                                                                       \
          .on = CLI_SURFACES                                                                                           \
        }                                                                                                              \
  }

/* R,G,B, or one number for a grey, each 0 to 1e6; 0 where it is none. `text` has `length` letters. */
int cli_parse_color(const char *text, size_t length, float color[3]);
/* Each 0 to `most`. */
int cli_parse_color_to(const char *text, size_t length, double most, float color[3]);

/* The key `key` as an array, in the digits that a float holds. */
void cli_report_color(cli_json *json, const char *key, const float color[3]);

/* Parsers of values, into a cli_render_job. --light may be given again:
 * X,Y,Z, camera:X,Y,Z or head, each with :COLOR behind it or without, and then :RADIUSdeg but for head; lamp:, and
 * what cli_parse_lamp takes; studio; none. */
int cli_parse_light(const char *text, void *value);
/* COLOR, or COLOR:COLOR of the sky and the ground. */
int cli_parse_sky(const char *text, void *value);

/* What the options about light mean together, once the scene is open and it is known what points up. */
void cli_lights_settle(cli_render_job *job);
/* The key "lights" of the statistics, and "sky". */
void cli_lights_report(cli_json *json, const cli_render_job *job);
