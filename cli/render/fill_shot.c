#include "cli/render/fill_shot.h"

#include "cli/render/shot_again.h"
#include "cli/scene/stereo.h"
#include "shots/stage.h"

void cli_shot_take_options(cli_render_job *job) {
  const cli_accumulate_job *own = &job->accumulating;
  conic_shot *shot = &job->shot;
  shot->light.n_directions = (uint64_t)job->n_directions;
  shot->light.has_shadows = job->has_shadows;
  shot->light.n_lamps = job->lamps.n_lamps;
  memcpy(shot->light.sun_radius_deg, job->lamps.sun_radius_deg, sizeof shot->light.sun_radius_deg);
  shot->n_samples = own->n_samples;
  shot->noise = own->noise;
  shot->aperture.n_blades = own->n_blades;
  shot->aperture.focus = own->focus.depth;
  shot->focus_kind = (conic_focus_kind)own->focus.kind;
  memcpy(shot->focus_pixel, own->focus.pixel, sizeof shot->focus_pixel);
  shot->is_shutter_open = own->is_shutter_given;
  memcpy(shot->shutter, own->shutter, sizeof shot->shutter);
}

/* A turntable's camera goes round; one of a file goes on to the next. */
static conic_camera_way find_way(const cli_render_job *job) {
  conic_camera_way way = {.kind = CONIC_WAY_STILL};
  const conic_source_scale *scale = conic_source_measure(job->source);
  if (job->is_turntable) {
    way.kind = CONIC_WAY_ORBIT;
    way.frames_a_turn = (double)job->n_frames;
    for (int axis = 0; axis < 3; axis++)
      way.center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
    memcpy(way.up, job->is_up_given ? job->framing.up : scale->up, sizeof way.up);
  } else if (job->camera_path) {
    way.kind = CONIC_WAY_CAMERAS;
    way.cameras = job->cameras.cameras;
    way.n_cameras = job->cameras.count;
    way.place = (double)job->i_view;
  }
  return way;
}

/* By the scene's `up`, which the lights have once it is open. */
static conic_status read_sky(cli_session *session, cli_render_job *job) {
  conic_status status = CONIC_OK;
  if (job->sky_path && !job->sky)
    status = conic_sky_read(session->context, job->sky_path, job->shot.render.lighting.up, &job->sky);
  job->shot.light.sky = job->sky;
  return status;
}

static conic_status read_motion(cli_session *session, cli_render_job *job) {
  cli_accumulate_job *own = &job->accumulating;
  conic_status status = CONIC_OK;
  if (own->motion_path && !own->motion)
    status = conic_motion_read(session->context, own->motion_path, (size_t)job->n_inputs, &job->opening, &own->motion);
  job->shot.motion = own->motion;
  return status;
}

conic_status cli_shot_fill(cli_session *session, cli_render_job *job, int i_frame) {
  conic_shot *shot = &job->shot;
  conic_status status = cli_scene_camera(session, job, i_frame);
  shot->way = find_way(job);
  shot->eye = cli_stereo_eye(job);
  shot->frame = (double)i_frame;
  memcpy(shot->light.lamps, job->lamps.lamps, sizeof shot->light.lamps);
  cli_shot_again_fill(job);
  if (status == CONIC_OK)
    status = read_sky(session, job);
  if (status == CONIC_OK)
    status = read_motion(session, job);
  return status == CONIC_OK ? cli_shot_again_check(session, job) : status;
}

conic_status cli_choose_exposure(cli_render_job *job) {
  if (!job->is_exposure_automatic)
    return CONIC_OK;
  double start = cli_seconds();
  cli_deadline_begin(job);
  conic_status status = conic_shot_expose_together(job->source, job->renderer, job->executor, job->units, &job->shot);
  if (status == CONIC_OK)
    job->is_exposure_automatic = 0; /* kept for all frames */
  job->frames_ms += 1e3 * (cli_seconds() - start);
  return status;
}
