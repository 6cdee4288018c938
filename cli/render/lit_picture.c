#include "cli/render/lit_picture.h"

#include <math.h>
#include <string.h>

#include "accumulation/sequence.h"
#include "cli/render/sharing.h"
#include "cli/render/windows_team.h"
#include "cli/scene/light_options.h"
#include "cli/session_team.h"
#include "core/image/image_common.h"
#include "lighting/light_sharing.h"

enum { USUAL_DIRECTIONS = 64 };

int cli_light_is_wanted(const cli_render_job *job) {
  return job->n_directions > 0 || job->has_shadows || job->lamps.n_lamps > 0;
}

void cli_light_want_planes(cli_render_job *job) {
  unsigned needed = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL;
  if (job->planes & 1u << CONIC_PLANE_AO && job->n_directions == 0)
    job->n_directions = USUAL_DIRECTIONS;
  if (job->planes & 1u << CONIC_PLANE_SHADOW)
    job->has_shadows = 1;
  if (job->planes & 1u << CONIC_PLANE_RGBA)
    needed |= 1u << CONIC_PLANE_ALBEDO;
  if (cli_light_is_wanted(job))
    job->unwritten_planes |= needed & ~job->planes;
  job->planes |= job->unwritten_planes;
}

int cli_light_check(const cli_render_job *job) {
  if (job->sky_path && job->n_directions == 0)
    return cli_usage("render: the light of %s comes from so many directions as --ao says; give it, too", job->sky_path);
  if (cli_light_is_wanted(job) && job->abilities & CONIC_SOURCE_COMPOSITES)
    return cli_usage("render: --ao, --shadow and lamps are of surfaces; give --profile surface, too");
  if (cli_light_is_wanted(job) && job->top.is_wanted)
    return cli_usage("render: --ao, --shadow and lamps are not of --camera top");
  return CLI_DONE;
}

/* What draws the maps. */
typedef struct map_drawer {
  cli_session *session;
  cli_render_job *job;
  conic_render_options options;
  conic_light_sharing *sharing; /* null: this process lights alone */
} map_drawer;

/* Of a map that all draw, the first process gets the pixels; the others look into an empty one. */
static conic_status draw_map_together(const map_drawer *drawer, const cli_looking *looking, conic_image *depth) {
  conic_render_statistics unused;
  if (!cli_team_is_first(drawer->session))
    memset(depth->planes[CONIC_PLANE_Z], 0, conic_image_pixels(depth) * sizeof(float));
  return cli_draw_together(drawer->session, drawer->job, looking, depth, &unused);
}

/* The nearest splat is what hides. */
static conic_status draw_light_map(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  const map_drawer *drawer = cookie;
  cli_render_job *job = drawer->job;
  conic_render_options options = drawer->options;
  conic_source_view view = job->view;
  options.near_z = near_z;
  view.samples = 1;
  if (job->is_transparent) {
    view.transparency = CONIC_TRANSPARENCY_CHANCE;
    view.chance = conic_sequence_at(drawer->sharing ? drawer->sharing->i_map : job->i_light_map, CONIC_SEQUENCE_SHADOW);
    job->i_light_map += !job->accumulating.n_samples; /* the maps of a sample share its chance */
    options.passes = 3;
  }
  const cli_looking looking = {camera, &options, &view, NULL};
  return drawer->sharing && !drawer->sharing->is_apart
             ? draw_map_together(drawer, &looking, depth)
             : conic_source_draw(job->source, job->renderer, camera, &options, &view, depth, NULL);
}

static map_drawer drawer_of(cli_session *session, cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  map_drawer drawer = {session, job, job->options, NULL};
  drawer.options.passes = CONIC_PASS_OF_HIDING;
  drawer.options.epsilon = scale->epsilon;
  drawer.options.splat_length = CONIC_MAP_LENGTHS * scale->splat_length;
  drawer.options.cull_back = 0;
  drawer.options.shading = CONIC_SHADE_NONE;
  return drawer;
}

/* The source's box holds centres and corners: splats reach beyond by their size. */
static conic_casters casters_of(const cli_render_job *job, map_drawer *drawer) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  double reach = scale->n_splats ? (double)job->options.kernel.cutoff * scale->splat_length : 0.0;
  conic_casters casters = {
      .draw = draw_light_map, .cookie = drawer, .epsilon = reach, .epsilon_is_drawn = !job->is_transparent};
  conic_source_box(job->source, casters.minimum, casters.maximum);
  for (int axis = 0; axis < 3; axis++) {
    casters.minimum[axis] -= 4.0 * reach;
    casters.maximum[axis] += 4.0 * reach;
  }
  return casters;
}

/* What was chosen last is a map's. */
static conic_status choose_again(cli_render_job *job, const conic_camera *camera, const conic_image *image) {
  conic_image depth = {.width = image->width, .height = image->height};
  if (cli_is_gathered(job, camera)) /* of several choices */
    return CONIC_OK;
  if (!(job->abilities & CONIC_SOURCE_STREAMS))
    return conic_source_choose(job->source, camera, &job->options, &job->view);
  depth.planes[CONIC_PLANE_Z] = image->planes[CONIC_PLANE_Z];
  return conic_source_draw(job->source, job->renderer, camera, &job->options, &job->view, &depth, NULL);
}

/* What light falls on is the first process's to say. */
static void send_receivers(const cli_session *session, conic_image *image) {
  size_t n = conic_image_pixels(image) * sizeof(float);
  session->team->broadcast(image->planes[CONIC_PLANE_Z], n);
  session->team->broadcast(image->planes[CONIC_PLANE_NORMAL], 3 * n);
}

/* A picture by itself, where `status` says that nothing is wrong; of a team that shares it, by all. */
static conic_status light_whole(map_drawer *drawer, const conic_lighter *lighter, const conic_camera *camera,
                                conic_status status, conic_image *image) {
  conic_team team;
  cli_session *session = drawer->session;
  conic_light_sharing sharing = {.team = cli_team_of_library(session, &team)};
  if (drawer->job->sharing == CLI_SHARES_WINDOWS) {
    status = cli_sharing_end(session, drawer->job, status);
    drawer->sharing = &sharing;
    if (status == CONIC_OK)
      send_receivers(session, image);
  }
  return status == CONIC_OK ? conic_image_light_shared(lighter->context, lighter->casters, camera, lighter->render,
                                                       lighter->options, drawer->sharing, image)
                            : status;
}

/* As one of many samples, unless i_sample is null. */
static conic_status light_image(cli_session *session, cli_render_job *job, const uint64_t *i_sample,
                                const conic_camera *camera, conic_image *image) {
  conic_lighting_options options;
  double start = cli_seconds();
  map_drawer drawer = drawer_of(session, job);
  conic_casters casters = casters_of(job, &drawer);
  conic_render_options render = job->options;
  conic_lighter lighter = {session->context, &casters, &render, &options};
  job->i_light_map = i_sample ? *i_sample : 0;
  conic_lighting_options_init(&options);
  options.n_directions = (uint64_t)job->n_directions;
  options.has_shadows = job->has_shadows;
  options.lamps = job->lamps.lamps;
  options.n_lamps = (size_t)job->lamps.n_lamps;
  options.samples = job->view.samples;
  options.isa = job->options.isa;
  conic_status status = CONIC_OK;
  if (job->sky_path && !job->sky)
    status = conic_sky_read(session->context, job->sky_path, job->options.lighting.up, &job->sky);
  options.sky = job->sky;
  if (status == CONIC_OK && i_sample)
    status = cli_lamps_sample(session, job, *i_sample, &render.lighting);
  if (status == CONIC_OK && i_sample)
    status = conic_lighter_shade(&lighter, *i_sample, camera, image);
  else
    status = light_whole(&drawer, &lighter, camera, status, image);
  if (status == CONIC_OK && !i_sample && cli_sharing_has_picture(session, job))
    status = choose_again(job, camera, image);
  job->light_ms += 1e3 * (cli_seconds() - start);
  return status;
}

conic_status cli_light_picture(cli_session *session, cli_render_job *job, const conic_camera *camera,
                               conic_image *image) {
  int is_lit = camera->kind == CONIC_CAMERA_CUBE; /* side by side, as it was drawn */
  return cli_light_is_wanted(job) && !is_lit ? light_image(session, job, NULL, camera, image) : CONIC_OK;
}

conic_status cli_light_sample(cli_session *session, cli_render_job *job, uint64_t i_sample, const conic_camera *camera,
                              conic_image *image) {
  return light_image(session, job, &i_sample, camera, image);
}
