/* Pictures that are the mean of many samples: --accumulate and what goes with it. */
#pragma once

#include "cli/arguments.h"
#include "cli/json_write.h"

struct cli_render_job;

typedef struct cli_focus {
  int kind; /* a conic_focus_kind */
  double depth;
  double pixel[2];
} cli_focus;

/* Part of a cli_render_job. */
typedef struct cli_accumulate_job {
  /* What was asked for. */
  unsigned long long n_samples; /* 0: pictures are drawn at once */
  double seconds, noise;        /* stops; 0: none */
  double preview_seconds;       /* 0: none */
  const char *resume_path;      /* the picture; null: from the start */
  int is_resumable;
  cli_length width; /* of the lens */
  cli_focus focus;
  int n_blades;
  double shutter[2]; /* frames, from the one that is drawn */
  int is_shutter_given;
  unsigned long long i_sample; /* --sample: of commands that ask about one */
  int is_sample_given;
  const char *motion_path; /* null: the scene stands still */
  conic_motion *motion;    /* once it is read */

  /* What came of the last frame. */
  conic_accumulation_facts facts;
  uint64_t n_resumed;
  double reached_noise; /* below 0: not known */
  double focus_depth;
} cli_accumulate_job;

/* Parsers of values: auto, a depth or X,Y in pixels, into a cli_focus; A:B into a double[2]. */
int cli_parse_focus(const char *text, void *value);
int cli_parse_blades(const char *text, void *value); /* into a cli_accumulate_job */
int cli_parse_shutter(const char *text, void *value);

/* What the options mean together with the others. */
int cli_accumulate_check(const cli_session *session, struct cli_render_job *job);
/* The same of those that a sample has, too; and what it is drawn with, unless it is said otherwise. */
int cli_accumulate_settle(const cli_session *session, struct cli_render_job *job);

/* Draws the shot of a frame, and keeps its sums where that is wanted. */
conic_status cli_accumulate_picture(cli_session *session, struct cli_render_job *job, int i_frame, conic_image *image,
                                    conic_shot_outcome *outcome);

/* Says in the picture's header what it is the mean of. */
void cli_accumulate_describe(const struct cli_render_job *job, conic_image *image);

void cli_accumulate_report(cli_json *json, const struct cli_render_job *job);
