#include "cli/render/strip_pictures.h"

#include "cli/host.h"
#include "cli/render/frame_files.h"
#include "cli/render/frames.h"
#include "cli/render/units.h"
#include "core/base/machine.h"
#include "core/image/image_common.h"
#include "shots/strips/strips.h"
#include "shots/windows.h"
#include "source/source_kind.h"

static uint64_t picture_bytes(const cli_render_job *job, const conic_camera *camera) {
  return conic_planes_pixel_bytes(job->shot.planes) * (uint64_t)camera->width * (uint64_t)camera->height;
}

/* What is said of memory; where nothing is, pictures of what is read whole may have a gibibyte. */
static uint64_t memory_for(const cli_render_job *job) {
  int is_bounded = job->is_memory_given || job->abilities & CONIC_SOURCE_STREAMS;
  return is_bounded && job->access.memory_bytes ? job->access.memory_bytes : UINT64_C(2) << 30;
}

/* Whether the file holds what is drawn, and nothing else is made of the picture. */
static int is_plain_exr(const cli_session *session, const cli_render_job *job) {
  static const char *const exr[] = {"exr", NULL};
  return job->n_outputs == 1 && cli_output_is_one_of(job, job->outputs[0], exr) &&
         !(job->effects.asked & CLI_WRITES_MORE) && !(session->host && session->host->lay_out) &&
         !(job->shot.planes & ~(unsigned)CONIC_WINDOWS_PLANES);
}

int cli_may_be_in_strips(const cli_session *session, const cli_render_job *job) {
  return is_plain_exr(session, job) && job->repeat == 1 && !job->top.is_wanted && !job->accumulating.n_samples &&
         !job->is_exposure_automatic && !conic_shot_is_lit(&job->shot) && job->shot.light.dome_stops == 0.0 &&
         !job->shot.view.may_be_coarser;
}

int cli_memory_check(const cli_session *session, const cli_render_job *job) {
  const int is_file = job->opening.as != CONIC_AS_HYBRID || conic_source_kind_of_file(job->inputs[0]);
  if (!job->is_memory_given || job->abilities & CONIC_SOURCE_STREAMS || job->top.is_wanted ||
      (job->abilities & CONIC_SOURCE_CLUSTERS && is_file) || cli_may_be_in_strips(session, job))
    return CLI_DONE;
  return cli_usage("render: --memory has no effect: beside clouds in levels, a .chy and maps, it bounds one .exr of "
                   "planes as they are drawn, without --ao, --shadow, lamps, --accumulate and --show");
}

int cli_is_in_strips(const cli_session *session, const cli_render_job *job, const conic_camera *camera) {
  return picture_bytes(job, camera) > memory_for(job) / 2 && cli_may_be_in_strips(session, job) &&
         !conic_shot_is_gathered(&job->shot, job->abilities, camera) && !(job->shot.catchers | job->shot.holdouts) &&
         conic_source_has_windows(job->source, job->renderer, job->is_transparent);
}

conic_status cli_refuse_too_large(const cli_session *session, const cli_render_job *job, const conic_camera *camera) {
  uint64_t all = conic_machine_memory(), bytes = picture_bytes(job, camera);
  if (!all || bytes <= all)
    return CONIC_OK;
  return conic_fail(
      session->context, CONIC_ERROR_MEMORY,
      "out of memory: a picture of %d × %d pixels takes %llu bytes, and the machine has %llu; only a lone "
      ".exr of planes as they are drawn is written strip by strip",
      camera->width, camera->height, (unsigned long long)bytes, (unsigned long long)all);
}

typedef struct strip_picture {
  const cli_session *session;
  cli_render_job *job;
  int height;
} strip_picture;

static void describe_strips(void *cookie, const conic_camera *camera, const conic_render_statistics *statistics,
                            conic_image *header) {
  const strip_picture *picture = cookie;
  picture->job->statistics = *statistics;
  cli_frame_describe(picture->job, camera, header);
}

static void tell_finished_rows(void *cookie, int n_rows) {
  const strip_picture *picture = cookie;
  cli_note(picture->session, "%d of %d rows were finished", n_rows, picture->height);
}

conic_status cli_render_in_strips(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                                  conic_render_statistics *statistics) {
  const cli_accumulate_job *own = &job->accumulating;
  strip_picture picture = {session, job, camera->height};
  char *path = cli_frame_name(job, job->outputs[0], i_frame);
  const conic_strips_wish wish = {.path = path,
                                  .written = job->shot.planes & ~job->unwritten_planes,
                                  .writing = &job->writing,
                                  .strip_bytes = memory_for(job) / 4,
                                  .hashes = session->json_path ? job->hashes : NULL,
                                  .cookie = &picture,
                                  .describe = describe_strips,
                                  .found = tell_finished_rows,
                                  .key = *job->kept_key ? job->kept_key : NULL,
                                  .goes_on = own->resume_path != NULL,
                                  .may_begin = own->is_resumable};
  conic_shot_work work;
  conic_status status = cli_shot_begin(job, &work);
  if (!path || status != CONIC_OK)
    status = work.executor->agree(work.executor->data, path ? status : CONIC_ERROR_MEMORY);
  else
    status = conic_strips_draw(&work, camera, &wish, statistics);
  job->banded_planes = wish.written;
  free(path);
  return status;
}
