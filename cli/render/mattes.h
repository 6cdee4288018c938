/* Cryptomattes: what each pixel is of, by the inputs' names, or by a hybrid's clusters. */
#pragma once

#include "cli/scene/render_job.h"

/* Fills a finished picture's planes of mattes; job->manifest, whose text the picture has then, names what is in
 * them. */
conic_status cli_fill_mattes(cli_session *session, cli_render_job *job, const conic_camera *camera, conic_image *image);
