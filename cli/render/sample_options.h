/* The lens and the shutter of pictures that are means of samples; and single samples, which commands ask about. */
#pragma once

#include "cli/render/frames.h"

/* Rows of an option table; `own` is a cli_accumulate_job's address. */
#define CLI_LENS_OPTIONS(own)                                                                                          \
  {"aperture",                                                                                                         \
   CLI_PARSED,                                                                                                         \
   &(own)->width,                                                                                                      \
   "D[:BLADES]",                                                                                                       \
   "the diameter of the lens: a length, also in spacings (2x); what is out of focus blurs; of one that is not round "  \
   "the number of its corners behind it [0: a pinhole]",                                                               \
   .parse = cli_parse_length,                                                                                          \
   .parse_tail = cli_parse_blades,                                                                                     \
   .tail = (own),                                                                                                      \
   .acts = {.needs = CLI_SAMPLES}},                                                                                    \
      {"focus",                                                                                                        \
       CLI_PARSED,                                                                                                     \
       &(own)->focus,                                                                                                  \
       "Z",                                                                                                            \
       "the depth at which all is sharp; X,Y: what is at that pixel; auto: what is in the picture's middle [auto]",    \
       .parse = cli_parse_focus,                                                                                       \
       .acts = {.on = CLI_SAMPLES, .needs = CLI_FACT(LENS)}},                                                          \
      {"blades",                                                                                                       \
       CLI_INT,                                                                                                        \
       &(own)->n_blades,                                                                                               \
       "N",                                                                                                            \
       "the corners of the lens",                                                                                      \
       0,                                                                                                              \
       CONIC_MAX_BLADES,                                                                                               \
       .now = "--aperture D:BLADES"},                                                                                  \
      {"shutter",                                                                                                      \
       CLI_PARSED,                                                                                                     \
       (own)->shutter,                                                                                                 \
       "A:B",                                                                                                          \
       "open from A to B, in frames from the one drawn, along a --turntable, the cameras of a file or --motion: "      \
       "0:0.5 "                                                                                                        \
       "blurs half the way to the next; up to 100000 either way [closed]",                                             \
       .parse = cli_parse_shutter,                                                                                     \
       .is_given = &(own)->is_shutter_given,                                                                           \
       .acts = {.on = CLI_SAMPLES, .needs = CLI_FACT(WAY)}},                                                           \
  {                                                                                                                    \
    "motion", CLI_TEXT, &(own)->motion_path, "FILE",                                                                   \
        "where the inputs are at which frame, as matrices, or what shape they have, as files (JSON) [they stand "      \
        "still]",                                                                                                      \
        .acts = {                                                                                                      \
          .needs = CLI_SAMPLES                                                                                         \
        }                                                                                                              \
  }

/* The same with the sample's number, and the frame whose sample it is; `job` is a cli_render_job's address. */
#define CLI_SAMPLE_OPTIONS(job)                                                                                        \
  {"sample",                                                                                                           \
   CLI_COUNT,                                                                                                          \
   &(job)->accumulating.i_sample,                                                                                      \
   "I",                                                                                                                \
   "of conic render --accumulate, sample I, from 0, instead of a picture that is drawn at once",                       \
   0,                                                                                                                  \
   CONIC_MAX_ACCUMULATED - 1,                                                                                          \
   .is_given = &(job)->accumulating.is_sample_given,                                                                   \
   .group = "samples of final pictures"},                                                                              \
      CLI_LENS_OPTIONS(&(job)->accumulating),                                                                          \
      {"turntable",                                                                                                    \
       CLI_PARSED,                                                                                                     \
       (job),                                                                                                          \
       "N",                                                                                                            \
       "the picture is one of N around the scene",                                                                     \
       .parse = cli_parse_turntable,                                                                                   \
       .acts.with = "frames|shutter"},                                                                                 \
  {                                                                                                                    \
    "frames", CLI_PARSED, &(job)->frames, "A", "of --turntable, which, from 1 [1]", .parse = cli_parse_frames,         \
                                                                                    .acts.with = "turntable"           \
  }

/* What these mean together with the others, for a command that looks at one picture. */
int cli_sample_check(const cli_session *session, cli_render_job *job);

/* The frame that is looked at, from 0. */
int cli_sample_frame(const cli_render_job *job);

/* The camera of the picture that is looked at: of the sample that is asked for, or else of the frame. */
conic_status cli_sample_camera(cli_session *session, cli_render_job *job, conic_camera *camera);
