/* What conic verify and conic explain do of Gaussian scenes that are composited by a profile. */
#ifndef CONIC_GAUSSIAN_COMMANDS_H
#define CONIC_GAUSSIAN_COMMANDS_H

#include "cli/scene/render_job.h"
#include "conic/gaussian_judge.h"

/* Whether the scene is such a one: known once the arguments are parsed. */
int cli_is_composited(const cli_render_job *scene);
/* The profile and the background as the scene is drawn with. */
conic_gaussian_options cli_gaussian_options(const cli_render_job *scene);

/* Judges the image, or where it is empty, what conic draws. Returns the exit code. */
int cli_verify_composited(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                          conic_image *image);

/* Explains a pixel. Returns the exit code. */
int cli_explain_composited(cli_session *session, cli_render_job *scene, int x, int y);

#endif
