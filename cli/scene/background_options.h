/* What is behind a picture, besides the one colour that the renderer puts there: a gradient from top to bottom. */
#pragma once

#include "cli/scene/render_job.h"

/* A parser of values, into a cli_render_job: COLOR, COLOR:COLOR of the top and the bottom, or none. */
int cli_parse_background(const char *text, void *value);

/* cli_planes_write; where nobody chose a background, and PATH is a picture to look at, with one. */
conic_status cli_backdrop_write(cli_session *session, const cli_render_job *job, const char *path,
                                const conic_image *image);

/* A copy of a picture's colours as it is shown, with that background or its own; the caller releases it. Errors:
 * MEMORY. */
conic_status cli_backdrop_show(cli_session *session, const cli_render_job *job, const conic_image *image,
                               conic_image *shown);

/* Whether files to look at get that background. */
int cli_backdrop_is_studio(const cli_render_job *job);

/* The key "background" of the statistics. */
void cli_backdrop_report(cli_json *json, const cli_render_job *job);

/* Gaussian pictures have display values: names and codes of colours become these, once it is known that there are
 * Gaussians. */
void cli_backdrop_settle(cli_render_job *job);
