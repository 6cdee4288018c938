/* conic render --exposure auto. */
#include <string.h>

#include "cli/render/gather_picture.h"
#include "cli/render/lit_picture.h"
#include "cli/scene/render_job.h"
#include "core/base/message.h"

/* Of a picture without background, of one sample a pixel; of what is read while it is drawn, where that is to be seen
 * early, its first level. */
conic_status cli_choose_exposure(cli_session *session, cli_render_job *job, const conic_camera *camera) {
  conic_render_options plain = job->options;
  conic_source_view view = job->view;
  conic_render_statistics statistics;
  conic_image image;
  if (!job->is_exposure_automatic)
    return CONIC_OK;
  plain.has_background = 0;
  plain.exposure = 0.0;
  view.samples = 1;
  view.most_levels = view.may_be_coarser ? 1 : 0;
  unsigned planes = 1u << CONIC_PLANE_RGBA;
  if (job->lamps.n_lamps) /* without which it may be dark */
    planes |= 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  conic_status status = conic_image_allocate(session->context, camera->width, camera->height, planes, &image);
  if (status != CONIC_OK)
    return status;
  status = cli_draw_looking(session, job, &(cli_looking){camera, &plain, &view, NULL}, &image, &statistics);
  if (status == CONIC_OK && job->lamps.n_lamps)
    status = cli_light_picture(session, job, camera, &image);
  if (status == CONIC_OK) {
    job->options.exposure = conic_image_exposure(&image);
    job->is_exposure_automatic = 0; /* kept for all frames */
    job->frames_ms += statistics.ms.frame;
    conic_log(session->context, CONIC_LOG_INFO, "exposure: %g stops", job->options.exposure);
  }
  conic_image_release(session->context, &image);
  return status;
}
