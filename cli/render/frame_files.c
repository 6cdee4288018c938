#include "cli/render/frame_files.h"

#include "cli/outputs.h"
#include "cli/render/film.h"
#include "cli/render/frames.h"
#include "cli/render/mattes.h"
#include "cli/scene/background_options.h"
#include "cli/scene/surfaces_drawn.h"
#include "core/coloring/color_ramp.h"
#include "core/coloring/legend.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "raster/frame/samples.h"
#include "source/top/top_view.h"

/* --- the picture --- */

/* What the picture says of itself in its header. */
void cli_frame_describe(const cli_render_job *job, const conic_camera *camera, conic_image *image) {
  const conic_render_statistics *s = &job->statistics;
  image->n_attributes = 0;
  cli_name_attribute(image, "conicVersion", conic_version(), 0);
  cli_name_attribute(image, "conicMethod", cli_method_name(job), 0);
  cli_name_attribute(image, "conicEpsilonMode", s->epsilon_is_fixed ? "fixed" : "auto", 0);
  cli_name_attribute(image, "conicEpsilon", NULL, s->epsilon);
  cli_name_attribute(image, "conicNear", NULL, s->near_z);
  cli_name_attribute(image, "conicCutoff", NULL, (double)job->shot.render.kernel.cutoff);
  cli_name_attribute(image, "conicPrefilter", NULL,
                     job->abilities & CONIC_SOURCE_COMPOSITES ? job->shot.gaussians.prefilter
                                                              : (double)job->shot.render.prefilter);
  cli_name_attribute(image, "conicExposure", NULL, job->shot.render.exposure);
  cli_name_attribute(image, "conicSamples", NULL, (double)job->shot.view.samples);
  cli_name_attribute(image, "conicFx", NULL, camera->fx);
  cli_name_attribute(image, "conicFy", NULL, camera->fy);
  cli_name_attribute(image, "conicCx", NULL, camera->cx);
  cli_name_attribute(image, "conicCy", NULL, camera->cy);
  conic_attribute *matrix = &image->attributes[image->n_attributes++];
  memset(matrix, 0, sizeof *matrix);
  snprintf(matrix->name, sizeof matrix->name, "conicWorldToCamera");
  matrix->type = CONIC_ATTRIBUTE_MATRIX;
  memcpy(matrix->values, camera->cam_from_world, sizeof camera->cam_from_world);
  matrix->values[15] = 1.0;
  image->shot = job->making.text;
  cli_accumulate_describe(job, image);
  conic_image_describe_camera(image, camera);
}

/* Display values are past all curves. */
static void check_tone(const cli_session *session, cli_render_job *job, const conic_image *image) {
  if (job->tone == CONIC_TONE_SRGB || !image->is_display)
    return;
  conic_log(session->context, CONIC_LOG_WARNING, "%s: no --tone: the colours are display values, not linear",
            job->inputs[0]);
  job->tone = CONIC_TONE_SRGB; /* said once */
}

conic_status cli_frame_write(cli_session *session, cli_render_job *job, const conic_image *image, int i_frame) {
  conic_moment start = conic_moment_now();
  conic_status status = CONIC_OK;
  check_tone(session, job, image);
  for (int i = 0; i < job->n_outputs && status == CONIC_OK; i++) {
    char *path = cli_frame_name(job, job->outputs[i], i_frame);
    status = path ? cli_backdrop_write(session, job, path, image) : CONIC_ERROR_MEMORY;
    free(path);
  }
  job->write_ms += 1e3 * (cli_seconds() - start.clock_s);
  if (job->units != CONIC_UNITS_FRAMES) /* whose units write */
    cli_team_trace(session, "write", "picture", (uint64_t)i_frame, start, 0);
  return status;
}

/* --- its sums --- */

char *cli_sums_name(const cli_render_job *job, int i_frame) {
  char *picture = cli_frame_name(job, job->outputs[0], i_frame);
  size_t room = picture ? strlen(picture) + 8 : 0;
  char *name = picture ? malloc(room) : NULL;
  if (name)
    snprintf(name, room, "%s.sums", picture);
  free(picture);
  return name;
}

void cli_sums_forget(const cli_render_job *job, int i_frame) {
  char *path = job->accumulating.n_samples ? cli_sums_name(job, i_frame) : NULL;
  if (path)
    conic_disk_remove(path);
  free(path);
}

/* --- the legend --- */

static conic_status write_legend(cli_session *session, const cli_render_job *job, const conic_coloring *coloring,
                                 const char *length) {
  conic_image legend;
  conic_status status = conic_legend_make(session->context, coloring, length, &legend);
  if (status != CONIC_OK)
    return status;
  const conic_image_options writing = cli_picture_writing(job);
  status = conic_image_write_as(session->context, job->legend_path, &legend, &writing);
  conic_image_release(session->context, &legend);
  return status;
}

static conic_status show_legend(cli_session *session, cli_render_job *job, conic_image *image) {
  const conic_coloring *coloring = conic_source_coloring(job->source);
  conic_georeference reference = {0};
  if (!job->has_legend && !job->legend_path)
    return CONIC_OK;
  if (!coloring) {
    conic_log(session->context, CONIC_LOG_WARNING, "%s: no legend: the colours are the file's own", job->inputs[0]);
    job->has_legend = 0; /* said once */
    job->legend_path = NULL;
    return CONIC_OK;
  }
  conic_status status = conic_source_georeference(job->source, &reference);
  const char *length = reference.unit_m > 0.0 ? conic_unit_name(reference.unit_m) : "";
  if (status == CONIC_OK && job->has_legend)
    conic_legend_draw(coloring, length, image);
  if (status == CONIC_OK && job->legend_path)
    status = write_legend(session, job, coloring, length);
  conic_georeference_release(session->context, &reference);
  job->legend_path = NULL; /* once, however many frames */
  return status;
}

/* --- pictures beside it --- */

/* The clusters of a hybrid in colours of their own, as they are shaded in the picture. */
static conic_status make_cluster_map(conic_context *context, const conic_image *image, conic_image *map) {
  const uint32_t *cluster = image->planes[CONIC_PLANE_CLUSTER];
  const float *from = image->planes[CONIC_PLANE_RGBA];
  conic_status status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, map);
  if (status != CONIC_OK)
    return status;
  float *to = map->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
    float color[3], light = (from[4 * i] + from[4 * i + 1] + from[4 * i + 2]) / 3.0f;
    if (cluster[i] == CONIC_NO_ID)
      continue;
    conic_number_color(cluster[i], color);
    for (int channel = 0; channel < 3; channel++)
      to[4 * i + (size_t)channel] = color[channel] * light;
    to[4 * i + 3] = 1.0f;
  }
  return CONIC_OK;
}

/* What --show makes of the picture: the counts in false colours, clusters, the nodes of an octree; and what is behind
 * its pixels, --deep. */
typedef enum beside { OVERDRAW, CLUSTERS, BOXES, DEEP, N_BESIDE } beside;

static conic_status make_beside(cli_session *session, const cli_render_job *job, beside what,
                                const conic_camera *camera, const conic_image *image, conic_image *map) {
  conic_context *context = session->context;
  if (what == CLUSTERS)
    return make_cluster_map(context, image, map);
  if (what == BOXES)
    return conic_source_draw_boxes(job->source, camera, job->box_level, image, map);
  return job->is_overdraw_confetti ? conic_image_overdraw_confetti(context, image, map)
                                   : conic_image_overdraw(context, image, map);
}

static conic_status write_deep_gaussians(cli_session *session, const cli_render_job *job, const char *path,
                                         const conic_camera *camera, const conic_image *image) {
  cli_surfaces_drawn drawn;
  conic_gaussian_options options = job->shot.gaussians;
  conic_status status = cli_draw_surfaces(job, camera, 1u << CONIC_PLANE_ID, &drawn);
  options.isa = job->shot.render.isa;
  if (status == CONIC_OK)
    status = conic_gaussians_write_deep(session->context, conic_source_gaussians(job->source), camera, &options,
                                        drawn.given ? &drawn.image : NULL, path, image);
  conic_image_release(session->context, &drawn.image);
  return status;
}

static conic_status write_deep(cli_session *session, const cli_render_job *job, const char *path,
                               const conic_camera *camera, const conic_image *image) {
  const conic_drawing *drawing = &conic_source_chosen(job->source)->drawing;
  conic_contributions *contributions;
  conic_status status =
      conic_contributions_create_drawing(session->context, drawing, camera, &job->shot.render, &contributions);
  if (status != CONIC_OK)
    return status;
  status = conic_contributions_write(contributions, path, image);
  conic_contributions_destroy(contributions);
  return status;
}

static conic_status write_beside(cli_session *session, cli_render_job *job, beside what, const conic_camera *camera,
                                 const conic_image *image, int i_frame) {
  const char *const names[N_BESIDE] = {job->overdraw_path, job->clusters_path, job->boxes_path, job->deep_path};
  double start = cli_seconds();
  conic_image map;
  if (!names[what])
    return CONIC_OK;
  char *path = cli_frame_name(job, names[what], i_frame);
  conic_status status = path ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (path && what == DEEP) {
    status = job->abilities & CONIC_SOURCE_COMPOSITES ? write_deep_gaussians(session, job, path, camera, image)
                                                      : write_deep(session, job, path, camera, image);
  } else if (path && (status = make_beside(session, job, what, camera, image, &map)) == CONIC_OK) {
    status = conic_image_write_as(session->context, path, &map, &job->writing);
    conic_image_release(session->context, &map);
  }
  free(path);
  job->write_ms += 1e3 * (cli_seconds() - start);
  return status;
}

conic_status cli_frame_files_write(cli_session *session, cli_render_job *job, const conic_camera *camera,
                                   conic_image *image, int i_frame) {
  cli_frame_describe(job, camera, image);
  conic_status status = job->has_mattes ? cli_fill_mattes(session, job, camera, image) : CONIC_OK;
  if (status == CONIC_OK)
    status = show_legend(session, job, image);
  if (status == CONIC_OK)
    status = cli_frame_write(session, job, image, i_frame);
  if (status == CONIC_OK)
    status = cli_film_add(session, job, image);
  for (beside what = 0; what < N_BESIDE && status == CONIC_OK; what++)
    status = write_beside(session, job, what, camera, image, i_frame);
  return status;
}
