/* conic verify and conic explain for Gaussian scenes that are composited by a profile. */
#pragma once

#include "cli/scene/render_job.h"

/* The planes of such scenes that can be judged and explained. */
#define CLI_COMPOSITED_PLANES                                                                                          \
  (1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_COUNT |                 \
   1u << CONIC_PLANE_ID | (CONIC_GAUSSIAN_PLANES & ~(1u << CONIC_PLANE_DOUBT)))

/* The words of --floats, by conic_float_kind; a null ends them. */
extern const char *const cli_float_words[];
/* What is said of pixels, by conic_pixel_class; then of those that are not judged. */
extern const char *const cli_class_words[CONIC_N_PIXEL_CLASSES + 1];

/* Whether the scene is composited; known once the arguments are parsed. */
int cli_is_composited(const cli_render_job *scene);
/* The profile and the background that the scene is drawn with. */
conic_gaussian_options cli_gaussian_options(const cli_render_job *scene);

/* Opens the scene and takes its first camera, for what asks about a profile's floats: fills in the options that it is
 * drawn with, and the model of `floats`, a conic_float_kind. */
conic_status cli_gaussians_begin(cli_session *session, cli_render_job *scene, int floats,
                                 conic_gaussian_options *options, conic_float_model *model);

/* Judges the image, or, if it is empty, the picture that conic draws. Returns the exit code. */
int cli_verify_composited(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                          conic_image *image);

/* Explains a pixel. Returns the exit code. */
int cli_explain_composited(cli_session *session, cli_render_job *scene, int x, int y);
/* Writes the object "planes": a pixel as it is drawn, of either kind of scene. */
void cli_explain_planes(cli_json *json, const conic_image *image, int x, int y);
