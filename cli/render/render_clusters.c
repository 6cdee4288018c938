/* conic render --clusters: what belongs to which cluster of a hybrid. */
#include "cli/scene/render_job.h"
#include "core/coloring/color_ramp.h"

conic_status cli_clusters_write(cli_session *session, const cli_render_job *job, const char *path,
                                const conic_image *image) {
  conic_image map;
  const uint32_t *cluster = image->planes[CONIC_PLANE_CLUSTER];
  const float *from = image->planes[CONIC_PLANE_RGBA];
  conic_status status =
      conic_image_allocate(session->context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &map);
  if (status != CONIC_OK)
    return status;
  float *to = map.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
    float color[3], light = (from[4 * i] + from[4 * i + 1] + from[4 * i + 2]) / 3.0f;
    if (cluster[i] == CONIC_NO_ID)
      continue;
    conic_number_color(cluster[i], color);
    for (int channel = 0; channel < 3; channel++)
      to[4 * i + (size_t)channel] = color[channel] * light;
    to[4 * i + 3] = 1.0f;
  }
  status = conic_image_write_as(session->context, path, &map, &job->writing);
  conic_image_release(session->context, &map);
  return status;
}
