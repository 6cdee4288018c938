/* The class of every pixel in false colours, with a legend below. */

#include "cli/commands/gaussian_commands.h"
#include "cli/judge/judge_job.h"
#include "core/coloring/legend.h"

/* By class, then for pixels that were not judged; linear. Wrong pixels must be visible from afar. */
static const float class_colors[CONIC_N_PIXEL_CLASSES + 1][3] = {
    {0.03f, 0.08f, 0.03f}, {0.05f, 0.30f, 0.10f}, {0.85f, 0.55f, 0.02f}, {1.00f, 0.02f, 0.05f}, {0.02f, 0.02f, 0.02f}};

/* Puts the second picture under the first. */
static conic_status stack_pictures(cli_session *session, const conic_image *above, const conic_image *below,
                                   conic_image *both) {
  int width = above->width > below->width ? above->width : below->width;
  conic_status status = conic_image_allocate(session->context, width, above->height + below->height, 1u, both);
  if (status != CONIC_OK)
    return status;
  float *to = both->planes[CONIC_PLANE_RGBA];
  for (int y = 0; y < both->height; y++) {
    const conic_image *from = y < above->height ? above : below;
    const float *row = (const float *)from->planes[CONIC_PLANE_RGBA] +
                       4 * (size_t)from->width * (size_t)(from == above ? y : y - above->height);
    for (int x = 0; x < width; x++) {
      float *pixel = to + 4 * ((size_t)y * (size_t)width + (size_t)x);
      if (x < from->width)
        memcpy(pixel, row + (size_t)x * 4, 4 * sizeof *pixel);
      pixel[3] = 1.0f;
    }
  }
  return CONIC_OK;
}

static conic_status paint_classes(cli_session *session, const cli_judge_job *job, conic_image *map) {
  conic_status status = conic_image_allocate(session->context, job->camera.width, job->camera.height, 1u, map);
  if (status != CONIC_OK)
    return status;
  float *pixel = map->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < job->found.n_whole; i++, pixel += 4) {
    memcpy(pixel, class_colors[job->classes[i]], sizeof class_colors[0]);
    pixel[3] = 1.0f;
  }
  return CONIC_OK;
}

conic_status cli_judge_map(cli_session *session, const cli_judge_job *job, conic_image *map) {
  conic_image classes, legend = {.width = 0};
  const int n_rows = CONIC_N_PIXEL_CLASSES + (job->found.judged < job->found.n_whole);
  memset(map, 0, sizeof *map);
  conic_status status = paint_classes(session, job, &classes);
  if (status == CONIC_OK)
    status = conic_legend_make_list(session->context, "pixels", cli_class_words, class_colors, n_rows, &legend);
  if (status == CONIC_OK)
    status = stack_pictures(session, &classes, &legend, map);
  conic_image_release(session->context, &classes);
  conic_image_release(session->context, &legend);
  return status;
}
