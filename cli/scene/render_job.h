/* One `conic render`: what was asked for, and what came of it. */
#pragma once

#include "cli/device_option.h"
#include "cli/scene/accumulate_job.h"
#include "cli/scene/lamp_job.h"
#include "cli/scene/option_effects.h"
#include "cli/scene/shot_job.h"
#include "cli/scene/top_job.h"
#include "cli/team_report.h"
#include "core/cameras/camera_path.h"
#include "core/files/sha256.h"
#include "core/pictures/cryptomatte.h"

enum { CLI_MAX_OUTPUTS = 8 };

/* Of a turntable or of all views, those that are drawn: numbers from 1. */
typedef struct cli_frames {
  int first, last, step, is_given;
} cli_frames;

/* A film that frames become (cli/render/film.h). */
typedef struct cli_film {
  const char *path;        /* null: none */
  int kind, bits, quality; /* of its ending; of a colour, 8 or 10, or 0: not said; constant: less is better */
  int width, height;
  FILE *pipe;                  /* once it has begun, to the program that makes it, */
  struct conic_output *output; /* in this file */
} cli_film;

/* Two eyes. */
typedef struct cli_stereo {
  double distance;    /* from one to the other, in world units; 0: there is one */
  double convergence; /* the depth at which both pictures agree; 0: none */
  int is_convergence_given;
  int side; /* that is drawn: -1 the left eye, 1 the right, 0 the only one */
} cli_stereo;

enum { CLI_MOST_PLACES = 64, CLI_PLACE_ROOM = 16384 };

typedef struct cli_render_job { /* NOLINT(clang-analyzer-optin.performance.Padding): there is one, read by people */
  /* The picture: what the options say of it, and for each frame what is open (cli/render/fill_shot.h). */
  conic_shot shot;

  /* What else was asked for. */
  cli_effects_job effects;
  const char **inputs;
  const char *const *left_out;   /* names of the scene's options that the command does without; null: it has all */
  int n_inputs, may_lack_inputs; /* no input is no wrong usage: the command then does something else */
  const char *outputs[CLI_MAX_OUTPUTS];
  int n_outputs;
  char kind[8];                 /* of outputs without an ending, where one says it */
  const char *deep_path;        /* --deep; null: none */
  const char *matte_by;         /* --matte-by; null: by input */
  const char *overdraw_path;    /* --show overdraw; null: none */
  int is_overdraw_confetti;     /* and overdraw-confetti */
  const char *clusters_path;    /* --show clusters; null: none */
  const char *boxes_path;       /* --show boxes; null: none */
  int box_level;                /* boxes@N; below 0: what suits */
  int is_shown_twice;           /* --show has two outputs for one thing */
  const char *legend_path;      /* --show legend:OUT; null: none */
  int has_legend;               /* --show legend: in the picture */
  int has_mattes;               /* --aov cryptomatte */
  const char *progressive_path; /* --progressive; null: none */
  const char *camera_path;      /* null: framed */
  const char *view_name;        /* --view; null: the file's only one */
  int is_view_side;             /* it named a side of the scene, and the framing is of that */
  const char *path_file;        /* --path: in place of these; null: none */
  double fps;                   /* frames of a second of it */
  conic_camera_path path;
  int camera_size[2];    /* that the file's cameras are brought to; 0: the file's */
  int is_every_view;     /* --view all: each is a frame */
  conic_cameras cameras; /* the file's */
  size_t i_view;         /* of these, the one that is drawn, or was last: */
  conic_camera camera;
  conic_framing framing;
  int is_up_given, is_azimuth_given, is_elevation_given;
  int projection; /* of the framed camera: a conic_camera_kind */
  double eye[3];  /* --eye: where it stands */
  int is_eye_given;
  int is_shade_given;
  int is_plain; /* --plain: nothing is chosen by what looks best */
  int is_background_given;
  int is_unlit, n_light_words;                 /* --light none, and how many times --light is given */
  int is_light_given, is_sky_given, is_studio; /* of the lights: those of the options (cli/scene/light_options.h) */
  cli_lamp_job lamps;                          /* of these, the lamps, and how large the others are */
  const char *sky_path;                        /* --sky with a picture; null: none */
  int n_directions, has_shadows;               /* --ao, --shadow */
  conic_sky *sky;                              /* of the picture, once it is read */
  int is_transparent;                          /* --transparency */
  int n_frames;                                /* of a turntable, or views; else 1 */
  int is_turntable;
  cli_top_job top; /* --camera top */
  cli_frames frames;
  cli_film film;
  int is_warned;       /* that a picture is empty */
  int is_error_warned; /* that --error is not kept */
  int is_alpha_warned; /* that alpha is not shown */
  int is_hinted;       /* that --error would do, or not */
  int repeat;
  int is_aov_given, is_samples_given, is_prefilter_given, is_color_error_given;
  cli_stereo stereo;               /* --stereo */
  cli_accumulate_job accumulating; /* --accumulate */
  struct cli_kept_frames *kept;    /* --resumable and --resume, of several frames (cli/render/kept_frames.h) */
  unsigned asked_planes;           /* of these, what --aov names */
  unsigned unwritten_planes;       /* drawn for what else is written */
  conic_image_options writing;     /* how pictures are written, but for the tone, which is of rgba alone */
  int tone;                        /* --tone: a conic_tone */
  int is_patch;                    /* --method patch: options.method draws its samples */
  int is_exposure_automatic;       /* until it is found */
  cli_length epsilon, near_z;      /* below 0: automatic; the scene has to be known for them */
  cli_shot_job making;             /* what is written of the shot */
  cli_device device;               /* what draws: */
  conic_renderer *renderer;
  unsigned long long budget; /* the view's */
  int is_memory_given;       /* --memory */
  double deadline;           /* seconds; 0: none */
  double start_seconds;      /* from which it counts */

  /* What is drawn. */
  conic_source_options opening;
  int background_looks; /* bits: the background, and the top and bottom of a backdrop, were given by name or code */
  const char *catchers[CLI_MOST_PLACES], *holdouts[CLI_MOST_PLACES]; /* inputs' names */
  int n_catchers, n_holdouts;
  const char *places[CLI_MOST_PLACES]; /* FILE=MATRIX, of which `place` becomes the opening's */
  int n_places;
  char place[CLI_PLACE_ROOM];
  conic_patches_options patches; /* the opening's, as is the next */
  conic_layers_access access;
  conic_coloring_options coloring; /* the opening's, if it has one; `by` null: not given */
  int is_for_looking;              /* the command makes pictures, several samples a pixel unless said otherwise */
  unsigned abilities;              /* what the source can do, bits of conic_source_ability; known before it is open */
  conic_source *source;

  /* What came of it. */
  conic_render_statistics statistics; /* of the last frame; times are medians where frames repeat */
  conic_camera last_camera;
  double bound; /* of the last picture's plane; below 0: it has none */
  double first_frame_ms, camera_ms, frames_ms, light_ms, write_ms, hash_ms, total_ms;
  double begun_seconds;                /* when reading began */
  conic_cryptomatte_manifest manifest; /* of the last image */
  uint64_t hashes[CONIC_N_PLANES];     /* of the last image, where they are reported */
  unsigned banded_planes;              /* of a picture that nobody held: its planes; 0: it was held */

  /* Of a team (cli/render/units.h). */
  conic_shared_units units;
  const conic_executor *executor; /* by which they are shared: the team's, or */
  conic_alone alone;
  cli_team_report team;             /* what all did */
  char kept_key[CONIC_SHA256_ROOM]; /* what decides the bits, where --resumable or --resume keep frames or strips */
} cli_render_job;

/* Reads the arguments. Returns CLI_DONE, CLI_USAGE after a message, or -1 where help was printed. */
int cli_render_parse(cli_session *session, int argc, char **argv, cli_render_job *job);

/* The same for another command that takes render's camera and drawing options beside `own` ones, and has neither
 * outputs nor several frames. */
int cli_scene_parse(cli_session *session, const cli_option *own, int n_own, int argc, char **argv, cli_render_job *job);
/* Where parsing and checking ended with CLI_DONE, opens the session, does a command's work, whose exit code this
 * returns, and releases the scene. Releases its inputs whatever came before. */
int cli_scene_run(cli_session *session, int exit_code, cli_render_job *scene,
                  int (*work)(cli_session *session, void *job), void *job);
/* What job's options are before any is parsed; cli_scene_parse leaves alone what is no option of its own. */
void cli_scene_defaults(cli_render_job *job);

/* --transparency, once the arguments are parsed. */
void cli_transparency_settle(cli_render_job *job);

/* Wrong usage where an output (null entries are fine), or --json's, is a file that the scene is read from. */
int cli_scene_inputs_stay(const cli_session *session, const cli_render_job *job, const char *const *outputs,
                          int n_outputs);

/* Whether less than everything is to be drawn. */
int cli_lod_is_wanted(const cli_render_job *job);
/* "patch", or the method by which splats are drawn. */
const char *cli_method_name(const cli_render_job *job);

/* Makes the renderer and reads the camera's file: what is missing of these is said before the inputs are read, which
 * may take minutes. Released by cli_scene_release, also after a failure. */
conic_status cli_scene_begin(cli_session *session, cli_render_job *job);
/* Opens the source, unless the caller has lent an open one, and fills in the options what it knows. */
conic_status cli_scene_open(cli_session *session, cli_render_job *job);
void cli_scene_release(cli_session *session, cli_render_job *job);
/* --view all: sees to it that the views that are asked for can be drawn and written, once they are known. */
int cli_render_views_check(const cli_session *session, cli_render_job *job);
/* The shot's camera becomes that of a frame. */
conic_status cli_scene_camera(cli_session *session, cli_render_job *job, int i_frame);

/* --progressive: a picture of each level, of which the last stays in `image`. */
conic_status cli_render_levels(cli_session *session, cli_render_job *job, conic_image *image,
                               conic_shot_outcome *outcome);
/* Opening, and one picture, get what is left of the deadline. */
void cli_deadline_open(cli_render_job *job);
void cli_deadline_begin(cli_render_job *job);
double cli_seconds_left(const cli_render_job *job); /* of the deadline; above 0 */
conic_status cli_render_picture(cli_render_job *job, conic_image *image, conic_shot_outcome *outcome);

/* What kind of file an output is: its name's ending, or, without one, that of --format; and whether it is one of those,
 * null after the last. */
int cli_output_is_one_of(const cli_render_job *job, const char *path, const char *const *endings);

/* Wrong usage where a plane that was asked for goes into no file. */
int cli_planes_check(const cli_session *session, const cli_render_job *job);
/* Whether the outputs can be written, as far as their names tell. */
conic_status cli_planes_check_formats(cli_session *session, const cli_render_job *job);
/* Writes the image as PATH, or as a file a plane, where that is what the kind of file holds: "out.pfm", "out.Z.pfm" …
 */
conic_status cli_planes_write(cli_session *session, const cli_render_job *job, const char *path,
                              const conic_image *drawn);

/* How rgba is written: with the tone. */
conic_image_options cli_picture_writing(const cli_render_job *job);

/* Says what was drawn, and what it took. */
void cli_render_tell(cli_session *session, const cli_render_job *job);
/* Writes the statistics of the finished job to the session's --json file, if any. Returns the exit code. */
int cli_render_report(cli_session *session, cli_render_job *job, const conic_image *image);
