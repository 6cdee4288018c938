/* Pictures of any camera: those of pinholes are drawn at once, and of others gathered from views. */
#ifndef CONIC_GATHER_PICTURE_H
#define CONIC_GATHER_PICTURE_H

#include "cli/scene/render_job.h"

/* How a picture is drawn. */
typedef struct cli_looking {
  const conic_camera *camera;
  const conic_render_options *options;
  const conic_source_view *view;
  const conic_sample *sample; /* of an accumulated picture, which is lit if the job's are; null: of none */
} cli_looking;

/* Whether pictures of a camera are gathered. */
int cli_is_gathered(const cli_render_job *job, const conic_camera *camera);

/* Draws into the image's planes. Errors: as conic_source_draw and conic_gather; ARGUMENT where another option wants a
 * pinhole. */
conic_status cli_draw_looking(cli_session *session, cli_render_job *job, const cli_looking *looking, conic_image *image,
                              conic_render_statistics *statistics);

#endif
