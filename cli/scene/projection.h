/* How the framed camera maps what it sees to the picture: --projection and --eye. */
#ifndef CONIC_PROJECTION_H
#define CONIC_PROJECTION_H

#include "cli/scene/render_job.h"

/* The words of --projection, in the order of conic_camera_kind. */
extern const char *const cli_projection_words[];

/* X,Y,Z into a double[3]. */
int cli_parse_eye(const char *text, void *eye);

/* Turns a pinhole that frames the scene into what was asked for. */
void cli_project(const cli_render_job *job, const conic_framing *framing, conic_camera *camera);

#endif
