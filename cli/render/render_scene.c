/* A scene as the commands that draw one take it: opened, measured, framed. */

#include "cli/host_keeps.h"
#include "cli/render/shot_again.h"
#include "cli/render/units.h"
#include "cli/scene/light_options.h"
#include "cli/scene/stereo.h"
#include "cli/scene/views.h"
#include "core/files/file.h"
#include "core/files/guard.h"
#include "shots/way.h"
#include "source/source_samples.h"

static conic_status read_path(cli_session *session, cli_render_job *job) {
  conic_status status = conic_camera_path_read(session->context, job->path_file, job->camera_size, &job->path);
  if (status == CONIC_OK)
    status = conic_camera_path_list(session->context, &job->path, job->fps, &job->cameras);
  if (status == CONIC_OK)
    job->n_frames = (int)job->cameras.count;
  return status;
}

static conic_status read_views(cli_session *session, cli_render_job *job) {
  const cli_views_wish wish = {job->camera_path, job->view_name, job->camera_size[0], job->camera_size[1]};
  conic_status status = cli_views_read(session, &wish, &job->cameras, &job->i_view);
  if (status != CONIC_OK)
    return status;
  job->camera = job->cameras.cameras[job->i_view];
  if (job->is_every_view)
    job->n_frames = (int)job->cameras.count;
  return CONIC_OK;
}

conic_status cli_scene_begin(cli_session *session, cli_render_job *job) {
  const char *texture_path = job->opening.texture_path;
  int is_taken;
  if (cli_isa_check(session, job->shot.render.isa) != CLI_DONE)
    return CONIC_ERROR_UNSUPPORTED;
  errno = 0;
  if (texture_path && !conic_file_is_there(texture_path)) {
    cli_error(CLI_INPUT, "%s: cannot read: %s", texture_path, errno ? strerror(errno) : "it is no regular file");
    return CONIC_ERROR_INPUT;
  }
  conic_status status = cli_kept_renderer(session, &job->device, &job->renderer)
                            ? CONIC_OK
                            : cli_device_open(session, &job->device, &job->renderer);
  if (status == CONIC_OK)
    status = cli_shot_again_take_camera(job, &is_taken);
  if (status == CONIC_OK && job->camera_path && !is_taken)
    status = job->path_file ? read_path(session, job) : read_views(session, job);
  return status;
}

/* Lengths in spacings become world units. */
static conic_status resolve_lengths(cli_session *session, cli_render_job *job) {
  const cli_length *lens = &job->accumulating.width;
  double spacing = 1.0;
  conic_status status = CONIC_OK;
  int has_spacings = job->epsilon.is_in_spacings || job->near_z.is_in_spacings || lens->is_in_spacings;
  int is_known = conic_source_measure(job->source)->spacing > 0.0;
  int has_parts = job->abilities && (cli_lod_is_wanted(job) || job->abilities & CONIC_SOURCE_CLUSTERS);
  if (has_spacings && !is_known && has_parts) {
    cli_error(CLI_USAGE,
              "%s: lengths in spacings need every splat; give world units with --error, --budget or a hybrid",
              session->command);
    return CONIC_ERROR_ARGUMENT;
  }
  if (has_spacings)
    status = conic_source_spacing(job->source, &spacing);
  if (job->epsilon.value >= 0.0)
    job->shot.render.epsilon = job->epsilon.value * (job->epsilon.is_in_spacings ? spacing : 1.0);
  if (job->near_z.value >= 0.0)
    job->shot.render.near_z = job->near_z.value * (job->near_z.is_in_spacings ? spacing : 1.0);
  job->shot.aperture.diameter = lens->value * (lens->is_in_spacings ? spacing : 1.0);
  return status;
}

/* Whether what a source looks like all around decides the camera, or, where it is all in memory, how light falls. */
static int is_seen_around(const cli_render_job *job) {
  int is_lit = !job->abilities && job->shot.render.shading != CONIC_SHADE_NONE;
  return !job->is_plain && (!job->camera_path || job->path_file || job->is_turntable || is_lit);
}

/* Finds out which way is up, and says so where that was a guess. */
static conic_status stand_upright(cli_session *session, cli_render_job *job) {
  if (job->is_up_given || !is_seen_around(job))
    return CONIC_OK;
  conic_status status = conic_source_stand(job->source);
  conic_up_basis basis = conic_source_measure(job->source)->up_basis;
  if (status == CONIC_OK && basis != CONIC_UP_HABIT && basis != CONIC_UP_KIND)
    cli_note(session, "up: z, %s; --up says otherwise", conic_up_basis_reason(basis));
  return status;
}

/* Each direction draws the scene again. */
static void tell_of_rereading(const cli_session *session, const cli_render_job *job) {
  enum { LEAST_BYTES = 24 }; /* of a point in memory */
  const uint64_t n_splats = conic_source_measure(job->source)->n_splats, room = job->access.memory_bytes;
  if (job->n_directions && job->abilities & CONIC_SOURCE_STREAMS && job->shot.view.error_px == 0.0 && !job->budget &&
      room && n_splats > room / LEAST_BYTES)
    cli_note(session,
             "all levels are read for each of %d directions, as --memory does not hold them: --error 1 is sooner done",
             (int)job->n_directions);
}

conic_status cli_scene_open(cli_session *session, cli_render_job *job) {
  char key[CONIC_SHA256_ROOM];
  cli_deadline_open(job);
  cli_opening_key(job->inputs, (size_t)job->n_inputs, &job->opening, job->abilities, key);
  conic_guard_go_on(session->context); /* cameras were read; what comes now is of the scene */
  if (!job->source)
    job->source = cli_kept_source(session, key, &job->opening);
  conic_status status = job->source ? CONIC_OK : cli_units_open_source(session, job);
  if (status == CONIC_OK)
    cli_keep_source(session, key, &job->opening, job->source);
  if (status == CONIC_OK && job->opening.gaussians)
    status = conic_source_composite_by(job->source, job->opening.gaussians);
  if (status == CONIC_OK)
    status = resolve_lengths(session, job);
  if (status == CONIC_OK)
    conic_source_settle(job->source, &job->shot.render);
  if (status == CONIC_OK && job->deadline > 0.0)
    conic_source_limit_samples(job->source, cli_seconds_left(job));
  double start = cli_seconds();
  if (is_seen_around(job))
    status = cli_units_share_samples(session, job, status);
  if (status == CONIC_OK)
    status = stand_upright(session, job);
  job->camera_ms += 1e3 * (cli_seconds() - start);
  if (status == CONIC_OK && job->path_file && !job->path.has_up) {
    conic_camera_path_stand(&job->path, job->is_up_given ? job->framing.up : conic_source_measure(job->source)->up);
    status = conic_camera_path_list(session->context, &job->path, job->fps, &job->cameras);
  }
  if (status == CONIC_OK)
    tell_of_rereading(session, job);
  if (status == CONIC_OK)
    cli_lights_settle(job);
  if (status == CONIC_OK && cli_effects_check_open(session, job) != CLI_DONE)
    status = CONIC_ERROR_ARGUMENT;
  return status;
}

void cli_scene_release(cli_session *session, cli_render_job *job) {
  conic_cameras_release(session->context, &job->cameras);
  conic_camera_path_release(session->context, &job->path);
  conic_sky_destroy(job->sky);
  conic_shot_rest(&job->shot, job->source);
  conic_motion_destroy(job->accumulating.motion);
  cli_keep_renderer(session, &job->device, job->renderer);
  if (!cli_source_is_kept(session, job->source))
    conic_source_close(job->source);
}

int cli_scene_run(cli_session *session, int exit_code, cli_render_job *scene,
                  int (*work)(cli_session *session, void *job), void *job) {
  if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE) {
    exit_code = work(session, job);
    cli_scene_release(session, scene);
  }
  free(scene->inputs);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

/* What the options say of a camera that sees all of the scene. */
static conic_shot_framing framing_of(const cli_render_job *job, int i_frame) {
  conic_shot_framing framing;
  conic_shot_framing_init(&framing);
  framing.framing = job->framing;
  framing.kind = (conic_camera_kind)job->projection;
  framing.finds_up = !job->is_up_given;
  framing.finds_azimuth = !job->is_azimuth_given;
  framing.finds_elevation = !job->is_elevation_given;
  framing.is_plain = job->is_plain;
  framing.has_eye = job->is_eye_given;
  memcpy(framing.eye, job->eye, sizeof framing.eye);
  framing.i_turn = i_frame;
  framing.n_turns = job->n_frames;
  framing.finds_near = job->near_z.value < 0.0;
  return framing;
}

/* Of a turntable around a camera of a file. */
static void orbit(const cli_render_job *job, int i_frame, conic_camera *camera) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  double center[3];
  for (int axis = 0; axis < 3; axis++)
    center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
  conic_camera_orbit(center, job->is_up_given ? job->framing.up : scale->up, (double)i_frame / (double)job->n_frames,
                     camera);
}

static conic_status find_camera(cli_render_job *job, int i_frame) {
  conic_camera *camera = &job->shot.camera;
  if (job->is_every_view) {
    job->i_view = (size_t)i_frame;
    *camera = job->camera = job->cameras.cameras[i_frame];
    return CONIC_OK;
  }
  if (job->camera_path) {
    *camera = job->camera;
    orbit(job, i_frame, camera);
    return CONIC_OK;
  }
  const conic_shot_framing framing = framing_of(job, i_frame);
  return conic_shot_frame(job->source, &framing, &job->shot);
}

conic_status cli_scene_camera(cli_session *session, cli_render_job *job, int i_frame) {
  conic_status status = find_camera(job, i_frame);
  const conic_stereo_eye eye = cli_stereo_eye(job);
  return status == CONIC_OK ? conic_camera_move_eye(session->context, &eye, &job->shot.camera) : status;
}
