/* How the framed camera maps what it sees to the picture: --projection and --eye. */
#ifndef CONIC_PROJECTION_H
#define CONIC_PROJECTION_H

#include "cli/scene/render_job.h"

/* The words of --projection, in the order of conic_camera_kind. */
extern const char *const cli_projection_words[];

/* X,Y,Z into a double[3]. */
int cli_parse_eye(const char *text, void *eye);

/* Changes the framing to that of the pinhole that cli_project wants. */
void cli_project_frame(const cli_render_job *job, conic_framing *framing);

/* Turns a pinhole that frames the scene so into what was asked for, by the framing as it was: an orthographic camera
 * stands where a pinhole of its angle would. */
void cli_project(const cli_render_job *job, const conic_framing *framing, conic_camera *camera);

#endif
