/* One `conic judge`: its arguments and its results. */
#pragma once

#include "cli/scene/surfaces_drawn.h"

enum { CLI_JUDGE_MOST_REASONS = CONIC_MAX_UNSTABLE_REASONS, CLI_JUDGE_MOST_PARTS = 4, CLI_JUDGE_MOST_FAULTS = 8 };

/* The stages whose times are reported. */
enum {
  CLI_JUDGE_READ,
  CLI_JUDGE_OPEN,
  CLI_JUDGE_JUDGE,
  CLI_JUDGE_EXPLAIN,
  CLI_JUDGE_DIAGNOSE,
  CLI_JUDGE_SHOW,
  CLI_JUDGE_N_STAGES
};

/* A contribution to a pixel that is wrong. */
typedef struct cli_judge_part {
  const char *kind; /* "gaussian", "splat" or "triangle" */
  uint32_t index;
  double weight; /* its share of the pixel */
  double alpha;  /* of a Gaussian */
  double depth, color[3];
  const char *doubt; /* what is in doubt about it; null: nothing */
} cli_judge_part;

/* A wrong pixel, and its contributions, the heaviest first. */
typedef struct cli_judge_worst {
  conic_oracle_fault fault;
  cli_judge_part parts[CLI_JUDGE_MOST_PARTS];
  int n_parts;
  size_t n_blended;
} cli_judge_worst;

/* The findings, for either kind of scene. */
typedef struct cli_judgement {
  size_t pixels[CONIC_N_PIXEL_CLASSES], judged, covered, doubtful, n_whole;
  size_t vague;            /* of a Gaussian scene: pixels whose colours have a range wider than 1/255 */
  cli_judge_worst vaguest; /* the vaguest pixel's Gaussians that are most in doubt */
  const char *reasons[CLI_JUDGE_MOST_REASONS]; /* null past the last */
  size_t explained_by[CLI_JUDGE_MOST_REASONS];
  conic_oracle_plane_verdict planes[CONIC_MAX_PLANES];
  cli_judge_worst worst[CONIC_MAX_FAULTS];
  int n_worst;
  conic_diagnosis faults[CLI_JUDGE_MOST_FAULTS]; /* that would explain the wrong pixels, the best first */
  int n_faults;
  conic_fault_place places[CONIC_MOST_FAULT_PLACES];
  int n_places;
  int is_blank; /* the picture has one colour everywhere, which has many causes and is not diagnosed */
} cli_judgement;

typedef struct cli_judge_job {
  /* The arguments. */
  cli_render_job scene;
  const char *picture_path, *map_path, *report_path; /* null: none */
  unsigned long long n_pixels, max_wrong;            /* n_pixels 0: all */
  int floats;                                        /* a conic_float_kind */
  int transfer, is_transfer_given;                   /* 0 linear, 1 srgb */
  int shows_times, skips_diagnosis, allows_vague;
  conic_picture_options reading;
  int argc; /* the command line, for the report */
  char **argv;

  /* The results. */
  conic_picture picture;
  conic_camera camera;
  uint8_t *classes; /* of each pixel; CONIC_N_PIXEL_CLASSES if it was not judged */
  float *ranges;    /* of each judged pixel of a Gaussian scene, as in conic_gaussian_judging; so are these */
  uint32_t *wrong_values;
  cli_surfaces_drawn drawn; /* what is among a Gaussian scene */
  cli_judgement found;
  conic_image ours; /* conic's own picture, if it is shown */
  double seconds[CLI_JUDGE_N_STAGES];
} cli_judge_job;

/* Whether no more pixels are wrong than allowed. */
int cli_judge_is_right(const cli_judge_job *job);
/* Whether it is right only because too many pixels may be nearly anything. */
int cli_judge_is_undecided(const cli_judge_job *job);

/* Compare the picture with a Gaussian scene's profile, or with a method's reference of splats and triangles. The scene
 * is open and its camera known. */
conic_status cli_judge_gaussians(cli_session *session, cli_judge_job *job);
conic_status cli_judge_splats(cli_session *session, cli_judge_job *job);

/* Finds what the worst pixels are made of. */
conic_status cli_judge_explain(cli_session *session, cli_judge_job *job);

/* Finds which Gaussians make the vaguest pixel so. Called if there are vague pixels. */
conic_status cli_judge_explain_vague(cli_session *session, cli_judge_job *job);

/* Finds the fault that explains the wrong pixels best, into job->found.faults. Called if there are any. */
conic_status cli_judge_diagnose(cli_session *session, cli_judge_job *job);

/* Draws the classes in false colours, with a legend; the caller releases *map. */
conic_status cli_judge_map(cli_session *session, const cli_judge_job *job, conic_image *map);

/* Writes the report's page. */
conic_status cli_judge_report(cli_session *session, cli_judge_job *job);

/* The verdict for people, and what --json says, of a cli_judge_job. */
void cli_judge_print(const cli_judge_job *job);
void cli_judge_members(cli_json *json, const void *cookie);

/* What a fault's value is and may be, and what a contribution is, in one line each. */
void cli_judge_describe(const cli_judge_job *job, const conic_oracle_fault *fault, char *text, size_t room);
void cli_judge_describe_place(const conic_fault_place *place, char *text, size_t room);
void cli_judge_describe_part(const cli_judge_part *part, char *text, size_t room);
