/* The options of a scene and its drawing, which several commands share: their values, and what they mean together. */
#pragma once

#include "cli/command.h"
#include "cli/scene/render_job.h"

enum cli_quality { CLI_QUALITY_DRAFT, CLI_QUALITY_GOOD, CLI_QUALITY_FINAL, CLI_QUALITY_SKETCH };

/* Options that mean something only when all have been read. */
typedef struct cli_scene_words {
  int size[2], is_size_given;
  int quality; /* a cli_quality */
  int profile; /* a conic_gaussian_profile, or beyond these "surface" */
  int is_quality_given, is_method_given, is_samples_given, is_profile_given, is_prefilter_given;
  int isa;
  double cutoff, prefilter;
  int method, ignores_center;
  int passes, is_patch_given;
  int as, is_as_given, usual_as; /* a conic_representation, and what holds where none is given */
  int is_smooth, is_crease_given, is_colored_whole;
  double crease_deg, usual_crease_deg;
  int degree; /* of patches, and */
  cli_length h;
} cli_scene_words;

/* The words of --projection, in the order of conic_camera_kind. */
extern const char *const cli_projection_words[];

/* Parsers of values, as cli_option has them; what `value` points to is said at each. Parsed:
 * gauss, hat, box, or confetti:A,B,N into a conic_kernel, */
int cli_parse_kernel(const char *text, void *value);
/* a length, or auto, into a cli_length; a length above 0 likewise, */
int cli_parse_epsilon(const char *text, void *value);
int cli_parse_near(const char *text, void *value);
/* x, -y, … or X,Y,Z into a double[3], */
int cli_parse_up(const char *text, void *value);
/* a number of stops, or auto, into a job's exposure, */
int cli_parse_exposure(const char *text, void *value);
/* X,Y,Z into a double[3], */
int cli_parse_eye(const char *text, void *eye);
/* FILE=MATRIX into a job's places, */
int cli_parse_place(const char *text, void *value);
/* INPUT into a job's catchers, and its holdouts, */
int cli_parse_catcher(const char *text, void *value);
int cli_parse_holdout(const char *text, void *value);
/* rgba,Z,N … or all, and in pictures cryptomatte, into a job. */
int cli_parse_planes(const char *text, void *value);

/* --camera top, which is no file. */
int cli_scene_is_top(const cli_render_job *job);

/* What the options of the scene and the drawing mean together. */
int cli_scene_check(const cli_session *session, cli_scene_words *words, cli_render_job *job);
