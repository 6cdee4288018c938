#include "cli/scene/accumulate_job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "accumulation/sequence.h"
#include "cli/render/accumulate_team.h"
#include "cli/render/frames.h"
#include "cli/render/gather_picture.h"
#include "cli/render/lit_picture.h"
#include "cli/scene/backdrop.h"
#include "cli/scene/stereo.h"
#include "cli/scene/views.h"
#include "cli/session_team.h"
#include "cli/stopper.h"
#include "core/base/rank.h"
#include "core/files/disk.h"

/* --- the camera on its way --- */

/* A turntable's camera goes round; one of a file goes on to the next. */
static conic_status camera_on_way(const cli_sample_way *way, double time, conic_camera *camera) {
  const cli_render_job *job = way->job;
  const double *shutter = job->accumulating.shutter;
  double frames = shutter[0] + (shutter[1] - shutter[0]) * time;
  *camera = way->frame_camera;
  if (!job->is_turntable && !job->camera_path)
    return CONIC_OK;
  if (job->is_turntable) {
    const conic_source_scale *scale = conic_source_measure(job->source);
    cli_camera_orbit(scale, job->is_up_given ? job->framing.up : scale->up, frames / (double)job->n_frames, camera);
    return CONIC_OK;
  }
  double place = (double)job->i_view + frames, last = (double)job->cameras.count - 1.0;
  place = place < 0.0 ? 0.0 : place > last ? last : place;
  size_t from = (size_t)place, to = from + 1 < job->cameras.count ? from + 1 : from;
  conic_status status = conic_camera_between(way->session->context, &job->cameras.cameras[from],
                                             &job->cameras.cameras[to], place - (double)from, camera);
  return status == CONIC_OK ? cli_stereo_move(job, camera) : status;
}

conic_status cli_accumulate_camera(cli_session *session, cli_render_job *job, int i_frame, conic_camera *camera) {
  cli_sample_way way = {.session = session, .job = job};
  conic_status status = cli_scene_camera(job, i_frame, camera);
  if (status != CONIC_OK || !job->accumulating.is_shutter_given)
    return status;
  way.frame_camera = *camera;
  return camera_on_way(&way, 0.5, camera);
}

/* --- the scene on its way --- */

static conic_status move_scene(cli_session *session, cli_render_job *job, int i_frame, double time) {
  cli_accumulate_job *own = &job->accumulating;
  conic_status status = CONIC_OK;
  if (!own->motion_path)
    return CONIC_OK;
  if (!own->motion)
    status = conic_motion_read(session->context, own->motion_path, (size_t)job->n_inputs, &job->opening, &own->motion);
  double frame = (double)i_frame + own->shutter[0] + (own->shutter[1] - own->shutter[0]) * time;
  return status == CONIC_OK ? conic_motion_apply(own->motion, job->source, frame) : status;
}

conic_status cli_accumulate_move_middle(cli_session *session, cli_render_job *job, int i_frame) {
  return move_scene(session, job, i_frame, 0.5);
}

/* Cannot fail: nothing is asked for. */
void cli_accumulate_rest(cli_render_job *job) {
  if (job->accumulating.motion)
    conic_source_move(job->source, NULL, 0);
}

/* --- focus --- */

/* The depth at a pixel of the picture; where nothing is there, the median of all there is. */
static conic_status depth_at(cli_session *session, const conic_image *image, const double pixel[2], double *depth) {
  size_t n = (size_t)image->width * (size_t)image->height, n_covered = 0;
  const float *z = image->planes[CONIC_PLANE_Z];
  *depth = (double)z[(size_t)pixel[1] * (size_t)image->width + (size_t)pixel[0]];
  if (*depth > 0.0)
    return CONIC_OK;
  float *covered = malloc(n * sizeof *covered);
  if (!covered)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    if (z[i] > 0.0f)
      covered[n_covered++] = z[i];
  *depth = n_covered ? (double)conic_float_of_rank(covered, n_covered, n_covered / 2) : 1.0;
  free(covered);
  cli_note(session, "focus: nothing is at pixel %g,%g; the median depth, %g", pixel[0], pixel[1], *depth);
  return CONIC_OK;
}

static int is_focus_seen(const cli_accumulate_job *own) {
  return own->aperture > 0.0 && own->focus.kind != CLI_FOCUS_DEPTH;
}

/* `image`, of which the depths count, is of the middle of lens and shutter. */
static conic_status find_focus(cli_session *session, cli_render_job *job, const conic_image *image) {
  const cli_focus *focus = &job->accumulating.focus;
  const double middle[2] = {0.5 * image->width, 0.5 * image->height};
  double *depth = &job->accumulating.focus_depth;
  if (!is_focus_seen(&job->accumulating)) {
    *depth = focus->depth;
    return CONIC_OK;
  }
  if (focus->kind == CLI_FOCUS_PIXEL &&
      (focus->pixel[0] >= (double)image->width || focus->pixel[1] >= (double)image->height)) {
    cli_usage("%s: --focus: pixel %g,%g lies outside of the picture, which has %d x %d", session->command,
              focus->pixel[0], focus->pixel[1], image->width, image->height);
    return CONIC_ERROR_ARGUMENT;
  }
  return depth_at(session, image, focus->kind == CLI_FOCUS_PIXEL ? focus->pixel : middle, depth);
}

/* A width that was meant in other units shows nothing but blur. */
static void tell_wide_lens(const cli_session *session, const cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  double square = 0.0, width = job->accumulating.aperture;
  for (int axis = 0; axis < 3; axis++) {
    double edge = scale->maximum[axis] - scale->minimum[axis];
    square += edge * edge;
  }
  if (width * width > square && square > 0.0)
    cli_warn(session, "--aperture: the lens, %g wide, is wider than the whole scene, %.3g", width, sqrt(square));
}

/* --- the samples --- */

static conic_aperture aperture_of(const cli_accumulate_job *own) {
  return (conic_aperture){own->aperture, own->focus_depth, own->n_blades, 0, {0}};
}

conic_status cli_accumulate_begin(cli_session *session, cli_render_job *job, int i_frame, cli_sample_way *way) {
  conic_camera middle;
  conic_image image;
  memset(&image, 0, sizeof image);
  *way = (cli_sample_way){.session = session, .job = job, .i_frame = i_frame};
  conic_status status = cli_accumulate_camera(session, job, i_frame, &middle);
  if (status == CONIC_OK)
    status = cli_accumulate_move_middle(session, job, i_frame);
  if (status == CONIC_OK && is_focus_seen(&job->accumulating)) {
    status = conic_image_allocate(session->context, middle.width, middle.height, 1u << CONIC_PLANE_Z, &image);
    if (status == CONIC_OK)
      status = conic_source_draw(job->source, job->renderer, &middle, &job->options, &job->view, &image, NULL);
  }
  if (status == CONIC_OK)
    status = find_focus(session, job, &image);
  cli_accumulate_rest(job);
  if (status == CONIC_OK)
    status = cli_scene_camera(job, i_frame, &way->frame_camera);
  conic_image_release(session->context, &image);
  return status;
}

conic_status cli_accumulate_place(const cli_sample_way *way, uint64_t index, conic_sample *sample) {
  const conic_aperture aperture = aperture_of(&way->job->accumulating);
  conic_camera camera = way->frame_camera;
  conic_status status = CONIC_OK;
  if (way->job->accumulating.is_shutter_given)
    status = camera_on_way(way, conic_sample_time(index), &camera);
  if (status == CONIC_OK)
    status = move_scene(way->session, way->job, way->i_frame, conic_sample_time(index));
  return status == CONIC_OK ? conic_sample_place(way->session->context, &camera, &aperture, index, sample) : status;
}

typedef struct accumulating {
  cli_session *session;
  cli_render_job *job;
  int i_frame;
  cli_sample_way way;
  conic_image *image; /* what is written */
  conic_render_statistics statistics;
  double shown_seconds; /* when a preview was written last */
} accumulating;

static conic_status sample_camera(void *cookie, double time, conic_camera *camera) {
  const accumulating *work = cookie;
  return camera_on_way(&work->way, time, camera);
}

static conic_status draw_source_sample(void *cookie, const conic_sample *sample, conic_image *image) {
  accumulating *work = cookie;
  cli_render_job *job = work->job;
  conic_render_options options = job->options;
  conic_render_statistics statistics = {.ms = {0}};
  conic_source_view view = job->view;
  view.chance = conic_sequence_at(sample->index, CONIC_SEQUENCE_SURFACE);
  if (job->is_transparent && cli_light_is_wanted(job)) /* what is lit has one depth and one normal */
    view.transparency = CONIC_TRANSPARENCY_CHANCE;
  const cli_looking looking = {&sample->camera, &options, &view, sample};
  conic_status status = cli_lamps_sample(work->session, job, sample->index, &options.lighting);
  if (status == CONIC_OK)
    status = move_scene(work->session, job, work->i_frame, sample->time);
  if (status == CONIC_OK)
    status = cli_draw_looking(work->session, job, &looking, image, &statistics);
  work->statistics.ms.frame += statistics.ms.frame;
  return status;
}

static conic_status light_source_sample(void *cookie, uint64_t i_sample, const conic_camera *camera,
                                        conic_image *image) {
  const accumulating *work = cookie;
  return cli_light_sample(work->session, work->job, i_sample, camera, image);
}

/* The means so far, over what the middle of the pixels shows. */
static conic_status show_sums(accumulating *work, const conic_accumulation *sums) {
  cli_accumulate_job *own = &work->job->accumulating;
  conic_status status = conic_accumulation_resolve(sums, work->image);
  conic_accumulation_inspect(sums, &own->facts);
  own->reached_noise = conic_accumulation_noise(sums);
  if (status == CONIC_OK)
    cli_backdrop_show(work->job, work->image);
  return status;
}

/* Of a frame's sums, which the caller frees; null without memory. */
static char *sums_name(const cli_render_job *job, int i_frame) {
  char *picture = cli_frame_name(job, job->outputs[0], i_frame);
  size_t room = picture ? strlen(picture) + 8 : 0;
  char *name = picture ? malloc(room) : NULL;
  if (name)
    snprintf(name, room, "%s.sums", picture);
  free(picture);
  return name;
}

static conic_status keep_sums(void *cookie, const conic_accumulation *sums) {
  accumulating *work = cookie;
  const cli_render_job *job = work->job;
  if (!job->accumulating.is_resumable)
    return CONIC_OK;
  char *path = sums_name(job, work->i_frame);
  conic_status status = path ? conic_accumulation_write(sums, path) : CONIC_ERROR_MEMORY;
  free(path);
  return status;
}

void cli_accumulate_forget(const cli_render_job *job, int i_frame) {
  char *path = job->accumulating.n_samples ? sums_name(job, i_frame) : NULL;
  if (path)
    conic_disk_remove(path);
  free(path);
}

/* A run that is stopped keeps the samples that it has, for --resume. Sums are large: nobody watches how long that
 * takes, and a second signal ends it. */
static void keep_stopped_sums(accumulating *work, const conic_accumulation *sums) {
  const cli_render_job *job = work->job;
  conic_accumulation_facts facts;
  conic_accumulation_inspect(sums, &facts);
  if (!job->accumulating.is_resumable || facts.end_sample == 0)
    return;
  cli_stopper_end();
  if (keep_sums(work, sums) != CONIC_OK)
    return;
  char *picture = cli_frame_name(job, job->outputs[0], work->i_frame);
  if (picture)
    cli_note(work->session, "stopped after %llu samples; --resume %s goes on with them",
             (unsigned long long)facts.end_sample, picture);
  free(picture);
}

/* --preview: the picture as it is, every so many seconds, and the first at once. */
static conic_status watch_sums(void *cookie, const conic_accumulation *sums) {
  accumulating *work = cookie;
  const cli_accumulate_job *own = &work->job->accumulating;
  conic_accumulation_facts facts;
  conic_accumulation_inspect(sums, &facts);
  if (own->preview_seconds <= 0.0 || facts.end_sample >= own->n_samples ||
      cli_seconds() - work->shown_seconds < own->preview_seconds)
    return CONIC_OK;
  conic_status status = show_sums(work, sums);
  if (status == CONIC_OK)
    cli_frame_describe(work->job, &work->job->last_camera, work->image);
  if (status == CONIC_OK)
    status = cli_frame_write(work->session, work->job, work->image, work->i_frame);
  if (status == CONIC_OK)
    status = keep_sums(work, sums);
  work->shown_seconds = cli_seconds();
  return status;
}

/* What of them is not of the picture. */
static conic_status refuse_sums(const char *path, const conic_camera *camera, unsigned planes,
                                const conic_accumulation_facts *facts) {
  if (facts->width != camera->width || facts->height != camera->height)
    cli_error(CLI_INPUT, "%s: cannot go on: its samples have %d x %d pixels, and the picture %d x %d", path,
              facts->width, facts->height, camera->width, camera->height);
  else if (facts->first_sample != 0)
    cli_error(CLI_INPUT, "%s: cannot go on: its first sample is number %llu", path,
              (unsigned long long)facts->first_sample);
  else {
    int i = 0;
    while (!((facts->planes ^ planes) >> i & 1))
      i++;
    cli_error(CLI_INPUT, "%s: cannot go on: %s the plane %s, and the picture %s", path,
              facts->planes >> i & 1 ? "it has" : "it lacks", conic_plane_describe((conic_plane)i)->name,
              facts->planes >> i & 1 ? "does not" : "has it");
  }
  return CONIC_ERROR_INPUT;
}

/* Of the sums that are gone on with; null where there are none yet, or, where *status says so, no memory. */
static char *resumed_name(const accumulating *work, conic_status *status) {
  const cli_render_job *job = work->job;
  const cli_accumulate_job *own = &job->accumulating;
  conic_disk_entry entry;
  if (!own->resume_path || !cli_team_is_first(work->session))
    return NULL;
  char *name = job->kept ? sums_name(job, work->i_frame) : malloc(strlen(own->resume_path) + 8);
  if (!name) {
    *status = CONIC_ERROR_MEMORY;
    return NULL;
  }
  if (!job->kept)
    snprintf(name, strlen(own->resume_path) + 8, "%s.sums", own->resume_path);
  if ((!job->kept && !own->is_resumable) || conic_disk_look(name, &entry))
    return name;
  free(name);
  return NULL;
}

/* The sums that are gone on with; or none yet. */
static conic_status begin_sums(accumulating *work, conic_accumulation **sums) {
  const conic_camera *camera = &work->way.frame_camera;
  cli_accumulate_job *own = &work->job->accumulating;
  conic_context *context = work->session->context;
  unsigned planes = (work->job->planes | 1u << CONIC_PLANE_RGBA) & CONIC_ACCUMULATED_PLANES;
  conic_accumulation_facts facts;
  conic_status status = CONIC_OK;
  char *path = resumed_name(work, &status);
  own->n_resumed = 0;
  if (!path)
    return status == CONIC_OK ? conic_accumulation_create(context, camera->width, camera->height, planes, 0, sums)
                              : status;
  status = conic_accumulation_read(context, path, sums);
  if (status == CONIC_OK) {
    conic_accumulation_inspect(*sums, &facts);
    own->n_resumed = facts.end_sample;
    if (facts.width != camera->width || facts.height != camera->height || facts.planes != planes ||
        facts.first_sample != 0)
      status = refuse_sums(path, camera, planes, &facts);
  }
  free(path);
  return status;
}

static conic_status run_samples(accumulating *work, conic_accumulation *sums) {
  const cli_accumulate_job *own = &work->job->accumulating;
  conic_accumulate_options options;
  conic_accumulate_options_init(&options);
  options.camera = work->way.frame_camera;
  options.aperture = aperture_of(own);
  options.end_sample = own->n_samples;
  options.seconds = own->seconds;
  options.noise = own->noise;
  options.cookie = work;
  options.camera_at = own->is_shutter_given ? sample_camera : NULL;
  options.draw = draw_source_sample;
  options.watch = watch_sums;
  if (cli_light_is_wanted(work->job) &&
      !cli_is_gathered(work->job, &work->way.frame_camera)) { /* whose views are lit */
    options.shade = light_source_sample;
    options.sample_planes = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO;
  }
  conic_status status =
      work->job->sharing == CLI_SHARES_SAMPLES
          ? cli_accumulate_together(work->session, work->job, &options, own->is_resumable ? keep_sums : NULL, sums)
          : conic_accumulate(work->session->context, &options, sums);
  if (status != CONIC_ERROR_ARGUMENT || !own->n_resumed)
    return status;
  char *path = resumed_name(work, &status);
  if (path)
    cli_note(work->session, "%s was begun with other inputs, or another view, lens, light or option", path);
  free(path);
  return CONIC_ERROR_INPUT;
}

/* --time and --noise end before N, and a file may hold more than N. */
static void tell_samples(const cli_session *session, const cli_accumulate_job *own) {
  if (own->facts.end_sample != own->n_samples)
    cli_note(session, "the mean of %llu samples of %llu; noise %.2g", (unsigned long long)own->facts.end_sample,
             own->n_samples, own->reached_noise > 0.0 ? own->reached_noise : 0.0);
}

conic_status cli_accumulate_picture(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                                    conic_image *image, conic_render_statistics *statistics) {
  accumulating work = {
      .session = session, .job = job, .i_frame = i_frame, .way = {session, job, i_frame, *camera}, .image = image};
  conic_accumulation *sums = NULL;
  const cli_looking looking = {camera, &job->options, &job->view, NULL};
  int is_first = job->sharing != CLI_SHARES_SAMPLES || cli_team_is_first(session);
  conic_status status = cli_accumulate_move_middle(session, job, i_frame);
  if (status == CONIC_OK && (is_first || is_focus_seen(&job->accumulating)))
    status = cli_draw_looking(session, job, &looking, image, &work.statistics);
  if (status == CONIC_OK)
    status = find_focus(session, job, image);
  cli_accumulate_rest(job);
  if (status == CONIC_OK && i_frame == job->frames.first - 1)
    tell_wide_lens(session, job);
  job->statistics = work.statistics;                            /* for the header of a preview */
  if (status == CONIC_OK && job->accumulating.is_shutter_given) /* the middle was drawn; the way starts at the frame */
    status = cli_scene_camera(job, i_frame, &work.way.frame_camera);
  if (status == CONIC_OK)
    status = conic_image_locate(session->context, camera, 1, image);
  if (status == CONIC_OK)
    status = begin_sums(&work, &sums);
  if (status == CONIC_OK)
    status = run_samples(&work, sums);
  if (status == CONIC_ERROR_CANCELLED && sums && job->sharing != CLI_SHARES_SAMPLES)
    keep_stopped_sums(&work, sums);
  if (status == CONIC_OK && is_first)
    status = show_sums(&work, sums);
  if (status == CONIC_OK && is_first && !job->kept)
    status = keep_sums(&work, sums);
  if (status == CONIC_OK)
    tell_samples(session, &job->accumulating);
  cli_accumulate_rest(job);
  conic_accumulation_destroy(sums);
  *statistics = work.statistics;
  return status;
}
