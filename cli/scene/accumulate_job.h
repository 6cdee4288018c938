/* Pictures that are the mean of many samples: --accumulate and what goes with it. */
#ifndef CONIC_ACCUMULATE_JOB_H
#define CONIC_ACCUMULATE_JOB_H

#include "cli/arguments.h"
#include "cli/json_write.h"
#include "cli/session.h"
#include "conic/accumulate.h"
#include "conic/motion.h"

struct cli_render_job;

/* Where all is sharp. */
typedef enum cli_focus_kind { CLI_FOCUS_AUTO, CLI_FOCUS_DEPTH, CLI_FOCUS_PIXEL } cli_focus_kind;

typedef struct cli_focus {
  int kind; /* a cli_focus_kind */
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
  double shutter[2];                             /* frames, from the one that is drawn */
  int is_shutter_given, is_lens_given, is_given; /* is_lens_given: --focus or --blades */
  unsigned long long i_sample;                   /* --sample: of commands that ask about one */
  int is_sample_given;
  const char *motion_path; /* null: the scene stands still */
  conic_motion *motion;    /* once it is read */

  /* What came of the last frame. */
  conic_accumulation_facts facts;
  uint64_t n_resumed;
  double reached_noise; /* below 0: not known */
  double aperture;      /* the width in world units */
  double focus_depth;
} cli_accumulate_job;

/* Parsers of values: auto, a depth or X,Y in pixels, into a cli_focus; A:B into a double[2]. */
int cli_parse_focus(const char *text, void *value);
int cli_parse_shutter(const char *text, void *value);

/* What the options mean together with the others. */
int cli_accumulate_check(const cli_session *session, struct cli_render_job *job);
/* The same of those that a sample has, too; and what it is drawn with, unless it is said otherwise. */
int cli_accumulate_settle(const cli_session *session, struct cli_render_job *job);

/* The camera in the middle of the shutter, which stands for the frame. */
conic_status cli_accumulate_camera(cli_session *session, struct cli_render_job *job, int i_frame, conic_camera *camera);

/* The way of a frame's camera through its samples. */
typedef struct cli_sample_way {
  cli_session *session;
  struct cli_render_job *job;
  int i_frame;
  conic_camera frame_camera; /* of the frame itself, at the shutter's 0 */
} cli_sample_way;

/* Finds the way, and where it is sharp, which may take a picture of the middle. */
conic_status cli_accumulate_begin(cli_session *session, struct cli_render_job *job, int i_frame, cli_sample_way *way);
/* Where a sample is taken from, as cli_accumulate_picture has it; the scene is then as at its moment. */
conic_status cli_accumulate_place(const cli_sample_way *way, uint64_t index, conic_sample *sample);

/* Brings the scene to the middle of the shutter, or to rest. */
conic_status cli_accumulate_move_middle(cli_session *session, struct cli_render_job *job, int i_frame);
void cli_accumulate_rest(struct cli_render_job *job);

/* Draws the picture of a frame; its camera is cli_accumulate_camera's. */
conic_status cli_accumulate_picture(cli_session *session, struct cli_render_job *job, int i_frame,
                                    const conic_camera *camera, conic_image *image,
                                    conic_render_statistics *statistics);

/* Removes what a frame's sums were kept in, if they were: it is finished. */
void cli_accumulate_forget(const struct cli_render_job *job, int i_frame);

/* Says in the picture's header what it is the mean of. */
void cli_accumulate_describe(const struct cli_render_job *job, conic_image *image);

void cli_accumulate_report(cli_json *json, const struct cli_render_job *job);

#endif
