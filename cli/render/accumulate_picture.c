#include "cli/render/frame_files.h"
#include "cli/render/frames.h"
#include "cli/render/shot_record.h"
#include "cli/render/units.h"
#include "cli/stopper.h"
#include "core/files/disk.h"

/* A width that was meant in other units shows nothing but blur. */
static void tell_wide_lens(const cli_session *session, const cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  double square = 0.0, width = job->shot.aperture.diameter;
  for (int axis = 0; axis < 3; axis++) {
    double edge = scale->maximum[axis] - scale->minimum[axis];
    square += edge * edge;
  }
  if (width * width > square && square > 0.0)
    cli_warn(session, "--aperture: the lens, %g wide, is wider than the whole scene, %.3g", width, sqrt(square));
}

/* --- the samples --- */

typedef struct kept_sums {
  cli_session *session;
  cli_render_job *job;
  int i_frame;
  double shown_seconds; /* when a preview was written last */
} kept_sums;

static conic_status keep_sums(void *cookie, const conic_accumulation *sums) {
  kept_sums *work = cookie;
  const cli_render_job *job = work->job;
  if (!job->accumulating.is_resumable)
    return CONIC_OK;
  char *path = cli_sums_name(job, work->i_frame);
  conic_status status = path ? conic_accumulation_write(sums, path) : CONIC_ERROR_MEMORY;
  free(path);
  return status;
}

/* A run that is stopped keeps the samples that it has, for --resume. Sums are large: nobody watches how long that
 * takes, and a second signal ends it. */
static void keep_stopped_sums(void *cookie, const conic_accumulation *sums) {
  kept_sums *work = cookie;
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
static conic_status watch_sums(void *cookie, const conic_accumulation *sums, conic_image *image,
                               const conic_render_statistics *statistics) {
  kept_sums *work = cookie;
  cli_render_job *job = work->job;
  cli_accumulate_job *own = &job->accumulating;
  conic_accumulation_inspect(sums, &own->facts);
  if (own->preview_seconds <= 0.0 || own->facts.end_sample >= own->n_samples ||
      cli_seconds() - work->shown_seconds < own->preview_seconds)
    return CONIC_OK;
  conic_status status = conic_sums_show(&job->shot, sums, image);
  job->statistics = *statistics; /* for the header */
  if (status == CONIC_OK)
    status = cli_shot_describe(work->session, job);
  if (status == CONIC_OK)
    cli_frame_describe(job, &job->last_camera, image);
  if (status == CONIC_OK)
    status = cli_frame_write(work->session, job, image, work->i_frame);
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
static char *resumed_name(const kept_sums *work, conic_status *status) {
  const cli_render_job *job = work->job;
  const cli_accumulate_job *own = &job->accumulating;
  conic_disk_entry entry;
  if (!own->resume_path || !cli_session_speaks(work->session))
    return NULL;
  char *name = job->kept ? cli_sums_name(job, work->i_frame) : malloc(strlen(own->resume_path) + 8);
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

static conic_status find_sums(void *cookie, const conic_camera *camera, unsigned planes, conic_accumulation **sums) {
  kept_sums *work = cookie;
  conic_accumulation_facts facts;
  conic_status status = CONIC_OK;
  char *path = resumed_name(work, &status);
  if (!path)
    return status;
  status = conic_accumulation_read(work->session->context, path, sums);
  if (status == CONIC_OK) {
    conic_accumulation_inspect(*sums, &facts);
    work->job->accumulating.n_resumed = facts.end_sample;
    if (facts.width != camera->width || facts.height != camera->height || facts.planes != planes ||
        facts.first_sample != 0)
      status = refuse_sums(path, camera, planes, &facts);
  }
  free(path);
  return status;
}

/* Sums that were kept have the key of another picture. */
static conic_status tell_other_sums(const kept_sums *work) {
  conic_status status = CONIC_ERROR_MEMORY;
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

conic_status cli_accumulate_picture(cli_session *session, cli_render_job *job, int i_frame, conic_image *image,
                                    conic_shot_outcome *outcome) {
  cli_accumulate_job *own = &job->accumulating;
  kept_sums work = {.session = session, .job = job, .i_frame = i_frame};
  const conic_sums_keeper keeper = {.cookie = &work,
                                    .find = find_sums,
                                    .keep = own->is_resumable ? keep_sums : NULL,
                                    .keeps_end = own->is_resumable && !job->kept,
                                    .watch = own->preview_seconds > 0.0 ? watch_sums : NULL,
                                    .stopped = keep_stopped_sums};
  conic_shot_work drawing;
  own->n_resumed = 0;
  own->focus_depth = 0.0;
  if (i_frame == job->frames.first - 1)
    tell_wide_lens(session, job);
  conic_status status = cli_shot_begin(job, &drawing);
  drawing.keeper = &keeper;
  drawing.seconds = own->seconds;
  if (!session->json_path && !own->is_resumable && !own->resume_path) /* nobody asks for their means */
    drawing.planes &= ~job->unwritten_planes;
  if (status == CONIC_OK)
    status = conic_shot_work_draw(&drawing, image, outcome);
  if (status == CONIC_ERROR_ARGUMENT && own->n_resumed)
    return tell_other_sums(&work);
  if (status != CONIC_OK)
    return status;
  own->facts = outcome->samples;
  own->reached_noise = outcome->noise;
  own->focus_depth = outcome->focus_depth;
  tell_samples(session, own);
  return CONIC_OK;
}
