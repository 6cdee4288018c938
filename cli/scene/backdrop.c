#include "cli/scene/backdrop.h"

#include <string.h>
#include <strings.h>

#include "cli/scene/light_options.h"
#include "core/base/color.h"
#include "core/files/file.h"

/* Chosen by eye: darker than what is lit, so that plaster stands out, and lighter than the shades of scans. */
static const cli_backdrop studio = {.is_given = 1, .top = {0.08f, 0.088f, 0.1f}, .bottom = {0.022f, 0.023f, 0.025f}};

/* Behind Gaussian scenes, which bring their own surroundings. */
static const cli_backdrop night = {.is_given = 1};

int cli_parse_background(const char *text, void *value) {
  cli_render_job *job = value;
  conic_render_options *options = &job->options;
  size_t length = strcspn(text, ":");
  job->is_background_given = 1;
  options->has_background = job->backdrop.is_given = 0;
  if (strcmp(text, "none") == 0)
    return 1;
  if (text[length]) {
    job->backdrop.is_given = 1;
    return cli_parse_color(text, length, job->backdrop.top) &&
           cli_parse_color(text + length + 1, strlen(text + length + 1), job->backdrop.bottom);
  }
  options->has_background = 1;
  return cli_parse_color(text, length, options->background);
}

/* Premultiplied colour over the gradient, which is linear in linear light and sampled in the middle of a row. */
static void put_behind(const cli_backdrop *backdrop, float exposure, conic_image *image) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (int y = 0; y < image->height && rgba; y++) {
    float part = ((float)y + 0.5f) / (float)image->height, color[3];
    for (int c = 0; c < 3; c++)
      color[c] = (backdrop->top[c] + (backdrop->bottom[c] - backdrop->top[c]) * part) * exposure;
    for (int x = 0; x < image->width; x++, rgba += 4) {
      for (int c = 0; c < 3; c++)
        rgba[c] += color[c] * (1.0f - rgba[3]);
      rgba[3] = 1.0f;
    }
  }
}

void cli_backdrop_show(const cli_render_job *job, conic_image *image) {
  if (job->backdrop.is_given)
    put_behind(&job->backdrop, conic_exposure_factor(job->options.exposure), image);
}

static int uses_studio(const cli_render_job *job) {
  return !job->is_plain && !job->is_background_given;
}

/* Not what others compose: EXR, TIFF, PFM and the like. */
static int is_to_look_at(const cli_render_job *job, const char *path) {
  static const char *const endings[] = {"png", "jpg", "jpeg", "webp", "gif", "bmp", "ppm"};
  const char *own = conic_file_ending(path), *ending = *own ? own : job->writing.format ? job->writing.format : "png";
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
    if (strcasecmp(ending, endings[i]) == 0)
      return 1;
  return 0;
}

conic_status cli_backdrop_write(cli_session *session, const cli_render_job *job, const char *path,
                                const conic_image *image) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  conic_image alone, shown = *image;
  if (!uses_studio(job) || !is_to_look_at(job, path) || !rgba)
    return cli_planes_write(session, job, path, image);
  conic_status status =
      conic_image_allocate(session->context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &alone);
  if (status != CONIC_OK)
    return status;
  shown.planes[CONIC_PLANE_RGBA] = alone.planes[CONIC_PLANE_RGBA];
  memcpy(alone.planes[CONIC_PLANE_RGBA], rgba, (size_t)image->width * (size_t)image->height * 4 * sizeof *rgba);
  put_behind(image->is_display ? &night : &studio, 1.0f, &alone);
  status = cli_planes_write(session, job, path, &shown);
  conic_image_release(session->context, &alone);
  return status;
}

void cli_backdrop_report(cli_json *json, const cli_render_job *job) {
  const conic_render_options *options = &job->options;
  const cli_backdrop *gradient = uses_studio(job) ? &studio : &job->backdrop;
  const float *const colors[] = {options->has_background ? options->background : gradient->top, gradient->bottom};
  int n_colors = options->has_background ? 1 : gradient->is_given ? 2 : 0;
  cli_json_array(json, "background");
  for (int i = 0; i < n_colors; i++)
    cli_report_color(json, NULL, colors[i]);
  cli_json_close(json);
}
