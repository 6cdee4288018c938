#include "cli/scene/background_options.h"

#include "cli/scene/light_options.h"
#include "core/base/color.h"
#include "core/image/image_common.h"
#include "shots/backdrop.h"

/* Chosen by eye: darker than what is lit, so that plaster stands out, and lighter than the shades of scans. Gaussian
 * scenes, which bring their own surroundings, have black behind them. */
static const float studio_top[3] = {0.08f, 0.088f, 0.1f}, studio_bottom[3] = {0.022f, 0.023f, 0.025f};
static const float night[3] = {0.0f, 0.0f, 0.0f};

/* A name or a code, which says how a colour looks; numbers say what it is. */
static int is_looked_at(const char *text) {
  return *text == '#' || (*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z');
}

void cli_backdrop_settle(cli_render_job *job) {
  float *const colors[] = {job->shot.render.background, job->shot.backdrop_top, job->shot.backdrop_bottom};
  const int is_there[] = {job->shot.render.has_background, job->shot.has_backdrop, job->shot.has_backdrop};
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3 && is_there[k] && job->background_looks >> k & 1; c++)
      colors[k][c] = (float)conic_srgb_encode((double)colors[k][c]);
}

int cli_parse_background(const char *text, void *value) {
  cli_render_job *job = value;
  conic_render_options *options = &job->shot.render;
  size_t length = strcspn(text, ":");
  job->is_background_given = 1;
  options->has_background = job->shot.has_backdrop = 0;
  job->background_looks = is_looked_at(text) ? 3 : 0;
  if (strcmp(text, "none") == 0 || strcmp(text, "transparent") == 0)
    return 1;
  if (text[length]) {
    job->background_looks |= is_looked_at(text + length + 1) ? 4 : 0;
    job->shot.has_backdrop = 1;
    return cli_parse_color(text, length, job->shot.backdrop_top) &&
           cli_parse_color(text + length + 1, strlen(text + length + 1), job->shot.backdrop_bottom);
  }
  options->has_background = 1;
  return cli_parse_color(text, length, options->background);
}

int cli_backdrop_is_studio(const cli_render_job *job) {
  return !job->is_plain && !job->is_background_given;
}

conic_status cli_backdrop_show(cli_session *session, const cli_render_job *job, const conic_image *image,
                               conic_image *shown) {
  conic_status status =
      conic_image_allocate(session->context, image->width, image->height, 1u << CONIC_PLANE_RGBA, shown);
  if (status != CONIC_OK)
    return status;
  memcpy(shown->planes[CONIC_PLANE_RGBA], image->planes[CONIC_PLANE_RGBA],
         conic_image_pixels(image) * 4 * sizeof(float));
  if (cli_backdrop_is_studio(job) && image->is_display)
    conic_backdrop_put(night, night, 1.0f, shown);
  else if (cli_backdrop_is_studio(job))
    conic_backdrop_put(studio_top, studio_bottom, 1.0f, shown);
  return CONIC_OK;
}

conic_status cli_backdrop_write(cli_session *session, const cli_render_job *job, const char *path,
                                const conic_image *image) {
  /* Not what others compose: EXR, TIFF, PFM and the like. */
  static const char *const to_look_at[] = {"png", "jpg", "jpeg", "webp", "gif", "bmp", "ppm", NULL};
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  conic_image alone, shown = *image;
  if (!cli_backdrop_is_studio(job) || !cli_output_is_one_of(job, path, to_look_at) || !rgba)
    return cli_planes_write(session, job, path, image);
  conic_status status = cli_backdrop_show(session, job, image, &alone);
  if (status != CONIC_OK)
    return status;
  shown.planes[CONIC_PLANE_RGBA] = alone.planes[CONIC_PLANE_RGBA];
  status = cli_planes_write(session, job, path, &shown);
  conic_image_release(session->context, &alone);
  return status;
}

void cli_backdrop_report(cli_json *json, const cli_render_job *job) {
  const conic_render_options *options = &job->shot.render;
  int is_studio = cli_backdrop_is_studio(job);
  const float *top = is_studio ? studio_top : job->shot.backdrop_top;
  const float *const colors[] = {options->has_background ? options->background : top,
                                 is_studio ? studio_bottom : job->shot.backdrop_bottom};
  int n_colors = options->has_background ? 1 : is_studio || job->shot.has_backdrop ? 2 : 0;
  cli_json_array(json, "background");
  for (int i = 0; i < n_colors; i++)
    cli_report_color(json, NULL, colors[i]);
  cli_json_close(json);
}
