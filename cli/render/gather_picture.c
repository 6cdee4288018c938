#include "cli/render/gather_picture.h"

#include <string.h>

#include "accumulation/sequence.h"
#include "cli/render/lit_picture.h"
#include "cli/render/windows_team.h"
#include "conic/gather.h"
#include "core/base/color.h"
#include "raster/frame/statistics.h"
#include "raster/tiles/lights.h"

typedef struct view_drawing {
  cli_session *session;
  cli_render_job *job;
  const cli_looking *looking;
  conic_lighting lighting; /* the options', with lights that stay where they are for all views */
  conic_render_statistics *sum;
} view_drawing;

/* Gaussians have pictures of their own for what a profile defines, but not through a lens, nor of all directions at
 * once. */
static int draws_itself(const cli_render_job *job, const conic_camera *camera) {
  if (!(job->abilities & CONIC_SOURCE_COMPOSITES))
    return 0;
  return camera->kind != CONIC_CAMERA_CUBE &&
         (job->gaussians.profile != CONIC_PROFILE_EXACT || !(job->accumulating.aperture > 0.0));
}

int cli_is_gathered(const cli_render_job *job, const conic_camera *camera) {
  return (camera->kind || camera->lens) && !draws_itself(job, camera);
}

/* Samples, and sides that no one camera sees together, are lit view by view. */
static int lights_views(const cli_render_job *job, const cli_looking *looking) {
  return cli_light_is_wanted(job) && (looking->sample || looking->camera->kind == CONIC_CAMERA_CUBE);
}

static conic_status light_view(const view_drawing *work, const conic_camera *camera, conic_image *image) {
  conic_lighting *lighting = &work->job->options.lighting;
  const conic_lighting own = *lighting;
  *lighting = work->lighting;
  const conic_sample *sample = work->looking->sample;
  conic_status status = sample ? cli_light_sample(work->session, work->job, sample->index, camera, image)
                               : cli_light_picture(work->session, work->job, camera, image);
  *lighting = own;
  return status;
}

/* Of a pinhole, or of what draws itself. */
static conic_status draw_plain(cli_session *session, cli_render_job *job, const cli_looking *looking,
                               conic_image *image, conic_render_statistics *statistics) {
  return job->sharing == CLI_SHARES_WINDOWS ? cli_draw_together(session, job, looking, image, statistics)
                                            : conic_source_draw(job->source, job->renderer, looking->camera,
                                                                looking->options, looking->view, image, statistics);
}

static conic_status draw_gathered_view(void *cookie, const conic_gather_view *gathered, conic_image *image) {
  const view_drawing *work = cookie;
  cli_render_job *job = work->job;
  conic_render_options options = *work->looking->options;
  conic_source_view view = *work->looking->view;
  conic_render_statistics one;
  options.near_z = gathered->near_z;
  options.lighting = work->lighting;
  view.samples = gathered->samples;
  const cli_looking looking = {&gathered->camera, &options, &view, NULL};
  conic_status status = draw_plain(work->session, job, &looking, image, &one);
  if (status == CONIC_OK)
    conic_statistics_add(&one, work->sum);
  if (status == CONIC_OK && lights_views(job, work->looking))
    status = light_view(work, &gathered->camera, image);
  return status;
}

/* Splats reach beyond the box of their centres. */
static void find_reached_box(const cli_render_job *job, conic_gather_options *gather) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  double reach = scale->n_splats ? 4.0 * (double)job->options.kernel.cutoff * scale->splat_length : 0.0;
  conic_source_box(job->source, gather->minimum, gather->maximum);
  for (int axis = 0; axis < 3; axis++) {
    gather->minimum[axis] -= reach;
    gather->maximum[axis] += reach;
  }
}

/* Of a sample, its own place in the views' pixels and on the lens. */
static void place_in_views(const cli_render_job *job, const conic_sample *sample, conic_gather_options *gather) {
  gather->edge = 512; /* as where the views lie changes, so does by what their rays are off: the mean is not */
  for (int axis = 0; axis < 2; axis++)
    gather->shift[axis] = conic_sequence_at(sample->index, CONIC_SEQUENCE_VIEW + axis);
  if (!(job->accumulating.aperture > 0.0))
    return;
  memcpy(gather->lens, sample->lens, sizeof sample->lens);
  gather->lens[2] = sample->lens_forward;
  gather->focus = job->accumulating.focus_depth;
}

static int wants_pinhole(const cli_render_job *job) {
  return job->progressive_path || job->deadline > 0.0 || job->deep_path || job->boxes_path || job->has_mattes;
}

static conic_status gather_picture(cli_session *session, cli_render_job *job, const cli_looking *looking,
                                   conic_image *image, conic_render_statistics *statistics) {
  view_drawing work = {session, job, looking, looking->options->lighting, statistics};
  conic_gather_options gather;
  if (wants_pinhole(job)) {
    cli_usage("render: --progressive, --deadline, --deep, --boxes and --cryptomatte want a perspective camera without "
              "a lens that distorts");
    return CONIC_ERROR_ARGUMENT;
  }
  memset(statistics, 0, sizeof *statistics);
  conic_lighting_place(looking->camera, &work.lighting);
  conic_gather_options_init(&gather);
  gather.camera = *looking->camera;
  gather.near_z = looking->options->near_z;
  gather.samples = looking->view->samples;
  gather.cookie = &work;
  gather.draw = draw_gathered_view;
  find_reached_box(job, &gather);
  if (looking->options->has_background) {
    float factor = job->abilities & CONIC_SOURCE_COMPOSITES ? 1.0f : conic_exposure_factor(looking->options->exposure);
    for (int c = 0; c < 3; c++)
      gather.empty[c] = looking->options->background[c] * factor;
    gather.empty[3] = 1.0f;
  }
  if (looking->sample)
    place_in_views(job, looking->sample, &gather);
  if (lights_views(job, looking))
    gather.view_planes = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  return conic_gather(session->context, &gather, image);
}

conic_status cli_draw_looking(cli_session *session, cli_render_job *job, const cli_looking *looking, conic_image *image,
                              conic_render_statistics *statistics) {
  return cli_is_gathered(job, looking->camera) ? gather_picture(session, job, looking, image, statistics)
                                               : draw_plain(session, job, looking, image, statistics);
}
