/* conic render: splats, raw points or meshes in, pictures out. */

#include "cli/command.h"
#include "cli/host_keeps.h"
#include "cli/render/fill_shot.h"
#include "cli/render/film.h"
#include "cli/render/frame_files.h"
#include "cli/render/frames.h"
#include "cli/render/kept_frames.h"
#include "cli/render/shot_again.h"
#include "cli/render/shot_record.h"
#include "cli/render/strip_pictures.h"
#include "cli/render/units.h"
#include "cli/scene/stereo.h"
#include "core/base/real.h"
#include "source/lean_drawing.h"

CONIC_DEFINE_ORDER(compare_frames, conic_render_statistics, ms.frame)

/* Each time's own median over the frames. */
static double median_of(conic_render_statistics *frames, size_t n, size_t offset) {
  for (size_t i = 0; i < n; i++) /* sorted by the frame's time, so each other time takes its turn there */
    memmove(&frames[i].ms.frame, (const char *)&frames[i].ms + offset, sizeof(double));
  qsort(frames, n, sizeof *frames, compare_frames);
  return n % 2 ? frames[n / 2].ms.frame : 0.5 * (frames[n / 2 - 1].ms.frame + frames[n / 2].ms.frame);
}

static void take_medians(cli_render_job *job, conic_render_statistics *frames, size_t n) {
  conic_render_milliseconds ms;
  conic_render_statistics last = frames[n - 1];
  job->first_frame_ms = frames[0].ms.frame;
  if (n > 1) {
    frames++;
    n--;
  }
  ms.frame = median_of(frames, n, offsetof(conic_render_milliseconds, frame));
  ms.lod = median_of(frames, n, offsetof(conic_render_milliseconds, lod));
  ms.setup = median_of(frames, n, offsetof(conic_render_milliseconds, setup));
  ms.bin = median_of(frames, n, offsetof(conic_render_milliseconds, bin));
  ms.visibility = median_of(frames, n, offsetof(conic_render_milliseconds, visibility));
  ms.accumulate = median_of(frames, n, offsetof(conic_render_milliseconds, accumulate));
  ms.resolve = median_of(frames, n, offsetof(conic_render_milliseconds, resolve));
  job->statistics = last;
  job->statistics.ms = ms;
}

/* A picture without anything in it is more often a mistaken camera than what was wanted. */
static void warn_of_empty(cli_session *session, cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  uint64_t skipped = s->splats_skipped + s->triangles_skipped;
  if (s->pixels_covered || job->is_warned)
    return;
  job->is_warned = 1;
  if (skipped)
    conic_log(session->context, CONIC_LOG_WARNING,
              "%s: the picture is empty: %llu cannot be drawn, all else is out of sight", job->inputs[0],
              (unsigned long long)skipped);
  else
    conic_log(session->context, CONIC_LOG_WARNING, "%s: the picture is empty: all is out of sight%s", job->inputs[0],
              job->opening.where ? ", or left out by --where" : "");
}

/* A hint, once, where far more splats are drawn than pixels can show, and it is known that a tenth would do. */
static void hint_at_error(cli_session *session, cli_render_job *job, const conic_camera *camera) {
  enum { MANY = 100000, MANY_A_PIXEL = 30, TIMES = 10 };
  const conic_render_statistics *s = &job->statistics;
  const double n_samples = (double)job->shot.view.samples * (double)job->shot.view.samples;
  if (job->is_hinted || session->host || session->is_quiet || job->is_plain || job->shot.n_samples ||
      s->splats_drawn < MANY || (double)s->splats_drawn * n_samples < (double)MANY_A_PIXEL * (double)s->pixels_covered)
    return;
  job->is_hinted = 1;
  const double saving = conic_lean_saving(job->source, camera, &job->shot.render);
  if (saving >= TIMES)
    cli_note(session, "--error 1 would draw 1 of %.0f of the splats, none off by more than a pixel", saving);
}

/* The finest that a hybrid has of one kind may not be as fine as it was asked to be; surfels alone, of which nothing
 * was asked, may stand out by more than a pixel. */
static void warn_of_error(cli_session *session, cli_render_job *job) {
  const conic_source_choice *choice = conic_source_chosen(job->source);
  double wanted = job->shot.view.error_px, reached = choice->error_px;
  const char *const kinds[] = {"--only triangles ", "--only surfels "};
  const char *kind = job->shot.view.only_kind < 0 ? "it " : kinds[job->shot.view.only_kind];
  int is_asked = wanted > 0.0, is_free = !is_asked && job->shot.view.budget == 0,
      is_faded = is_asked && choice->color_error > job->shot.view.color_error;
  if (job->is_error_warned || (reached <= (is_asked ? wanted : 1.0) && !is_faded))
    return;
  if (is_asked && reached > wanted)
    conic_log(session->context, CONIC_LOG_WARNING, "%s: %scannot keep --error %g: the picture is up to %.3g pixels off",
              job->inputs[0], kind, wanted, reached);
  else if (is_faded)
    conic_log(session->context, CONIC_LOG_WARNING, "%s: %scannot keep --error %g:%g: colours are up to %.3g steps off",
              job->inputs[0], kind, wanted, job->shot.view.color_error, choice->color_error);
  else if (is_free && job->shot.view.only_kind == CONIC_HYBRID_SURFELS)
    conic_log(session->context, CONIC_LOG_WARNING,
              "%s: --only surfels stand out from the mesh: the picture is up to %.3g pixels off", job->inputs[0],
              reached);
  else
    return;
  job->is_error_warned = 1;
}

static void warn_of_alpha(cli_session *session, cli_render_job *job) {
  const conic_drawing meshes = {.triangles = conic_source_chosen(job->source)->drawing.triangles};
  if (job->is_transparent || job->is_alpha_warned || !conic_drawing_is_transparent(&meshes))
    return;
  job->is_alpha_warned = 1;
  conic_log(session->context, CONIC_LOG_WARNING,
            "%s: drawn opaque, where its materials let light through: "
            "--transparency shows that",
            job->inputs[0]);
}

/* Fragments are counted once, and where somebody asks for them: what is hidden needs no look otherwise. */
static conic_status render_repeats(cli_session *session, cli_render_job *job, int i_frame, conic_image *image,
                                   conic_render_statistics *repeats) {
  conic_shot_outcome outcome;
  conic_status status = CONIC_OK;
  for (int i = 0; i < job->repeat && status == CONIC_OK; i++) {
    job->shot.render.skip_hidden = i > 0 || !session->json_path;
    status = job->shot.n_samples     ? cli_accumulate_picture(session, job, i_frame, image, &outcome)
             : job->progressive_path ? cli_render_levels(session, job, image, &outcome)
                                     : cli_render_picture(job, image, &outcome);
    repeats[i] = outcome.statistics;
    repeats[i].fragments = repeats[0].fragments;
    job->light_ms += outcome.light_ms;
    job->bound = outcome.bound;
  }
  return status;
}

/* Of windows, the picture comes together in the first process; others need it where it is gathered or lit, for all go
 * along to draw views and maps. */
static int needs_image(const cli_session *session, const cli_render_job *job, int is_gathered) {
  return job->units != CONIC_UNITS_WINDOWS || cli_units_make_picture(session, job) || is_gathered ||
         conic_shot_is_lit(&job->shot);
}

/* What lists splats of a picture, or shows it while it comes, is of one pinhole. */
static conic_status check_gathered(const cli_render_job *job, int is_gathered) {
  if (!is_gathered ||
      !(job->progressive_path || job->deadline > 0.0 || job->deep_path || job->boxes_path || job->has_mattes))
    return CONIC_OK;
  cli_usage("render: --progressive, --deadline, --deep, --show boxes and --aov cryptomatte want a perspective camera "
            "without a lens that distorts");
  return CONIC_ERROR_ARGUMENT;
}

/* One that is written while it is drawn. */
static conic_status render_in_strips(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                                     conic_render_statistics *statistics) {
  job->shot.render.skip_hidden = !session->json_path;
  conic_status status = cli_units_make_picture(session, job) ? cli_shot_describe(session, job) : CONIC_OK;
  status = cli_units_agree(job, status);
  if (status == CONIC_OK)
    status = cli_render_in_strips(session, job, i_frame, camera, statistics);
  if (status == CONIC_OK && cli_units_make_picture(session, job))
    status = cli_shot_save(session, job, i_frame);
  if (status != CONIC_OK || !cli_units_make_picture(session, job))
    return status;
  job->frames_ms += statistics->ms.frame;
  take_medians(job, statistics, 1);
  warn_of_empty(session, job);
  warn_of_error(session, job);
  warn_of_alpha(session, job);
  return CONIC_OK;
}

static void hand_picture_over(const cli_session *session, const cli_render_job *job, int i_frame,
                              const conic_camera *camera, const conic_image *image) {
  conic_shot shot;
  conic_shot_writing writing = {0};
  if (!session->host)
    return;
  cli_shot_settle(job, &shot);
  cli_shot_writing(job, &writing);
  const cli_drawn drawn = {.i_frame = i_frame,
                           .view = job->cameras.count ? job->cameras.names[job->i_view] : "",
                           .image = image,
                           .camera = camera,
                           .shot = &shot,
                           .opening = &job->opening,
                           .writing = &writing,
                           .sky_path = job->sky ? job->sky_path : NULL,
                           .motion_path = job->accumulating.motion ? job->accumulating.motion_path : NULL};
  cli_host_take(session, &drawn);
}

static conic_status render_frame(cli_session *session, cli_render_job *job, int i_frame, conic_image *image,
                                 conic_render_statistics *repeats) {
  conic_camera camera;
  double start = cli_seconds();
  conic_status status = cli_shot_fill(session, job, i_frame);
  if (status == CONIC_OK)
    status = conic_shot_camera(session->context, &job->shot, 0.5, &camera);
  if (status != CONIC_OK)
    return status;
  int is_gathered = conic_shot_is_gathered(&job->shot, job->abilities, &camera);
  job->last_camera = camera;
  job->camera_ms += 1e3 * (cli_seconds() - start);
  status = check_gathered(job, is_gathered);
  if (status == CONIC_OK)
    status = cli_choose_exposure(job);
  if (session->host || image->width != camera.width || image->height != camera.height)
    cli_host_release_image(session, image);
  if (status == CONIC_OK && cli_is_in_strips(session, job, &camera))
    return render_in_strips(session, job, i_frame, &camera, repeats);
  if (status == CONIC_OK)
    status = cli_refuse_kept_picture(job);
  if (status == CONIC_OK)
    status = cli_refuse_too_large(session, job, &camera);
  if (status == CONIC_OK && !conic_image_planes(image) && needs_image(session, job, is_gathered))
    status = cli_host_allocate_image(session, camera.width, camera.height, job->shot.planes, image);
  if (status == CONIC_OK)
    status = render_repeats(session, job, i_frame, image, repeats);
  if (status != CONIC_OK || !cli_units_make_picture(session, job))
    return status;
  for (int i = 0; i < job->repeat; i++)
    job->frames_ms += repeats[i].ms.frame;
  take_medians(job, repeats, (size_t)job->repeat);
  warn_of_empty(session, job);
  warn_of_error(session, job);
  warn_of_alpha(session, job);
  hint_at_error(session, job, &camera);
  status = cli_shot_describe(session, job);
  if (status == CONIC_OK)
    status = cli_frame_files_write(session, job, &camera, image, i_frame);
  if (status == CONIC_OK)
    status = cli_shot_save(session, job, i_frame);
  if (status == CONIC_OK)
    hand_picture_over(session, job, i_frame, &camera, image);
  return status;
}

typedef struct plane_hashes {
  const conic_image *image;
  uint64_t *hashes;
} plane_hashes;

static void hash_plane(void *data, size_t i) {
  const plane_hashes *work = data;
  work->hashes[i] = conic_image_hash(work->image, (conic_plane)i);
}

/* Only where they are reported: it takes a while. */
static void hash_image(const cli_session *session, cli_render_job *job, const conic_image *image) {
  double start = cli_seconds();
  int is_hashed = job->banded_planes || session->host; /* row by row; a host has the planes */
  if (session->json_path && !is_hashed)
    conic_parallel_for(session->context, CONIC_N_PLANES, hash_plane, (&(plane_hashes){image, job->hashes}));
  job->hash_ms = 1e3 * (cli_seconds() - start);
}

/* That of all frames is the first one's, whoever draws that. */
static conic_status choose_first_exposure(cli_session *session, cli_render_job *job) {
  conic_status status = CONIC_OK;
  if ((job->units == CONIC_UNITS_NONE && !cli_frames_are_several(job)) || !job->is_exposure_automatic)
    return CONIC_OK;
  if (cli_session_speaks(session) || job->units == CONIC_UNITS_WINDOWS) { /* of which all draw some */
    status = cli_shot_fill(session, job, job->frames.first - 1);
    if (status == CONIC_OK)
      status = cli_choose_exposure(job);
  }
  status = cli_units_agree(job, status);
  if (status == CONIC_OK)
    cli_units_broadcast(job, &job->shot.render.exposure, sizeof job->shot.render.exposure);
  job->is_exposure_automatic = 0;
  return status;
}

/* All frames, or of a team's those that this process takes. */
static conic_status render_frames(cli_session *session, cli_render_job *job, conic_image *image,
                                  conic_render_statistics *repeats) {
  cli_frame_turns turns;
  conic_status status = CONIC_OK;
  cli_frame_turns_begin(job, job->kept ? cli_kept_frames_take : NULL, job->kept, &turns);
  for (int i; status == CONIC_OK && (i = cli_frame_turns_next(&turns)) >= 0;) {
    conic_moment start = conic_moment_now();
    int i_frame = job->frames.first - 1 + i * job->frames.step, is_finished = 0;
    if (cli_frames_are_many(job))
      cli_session_part(session, job->is_turntable ? "frame" : "view", i + 1, turns.n_frames);
    if (!session->json_path || i < turns.n_frames - 1) /* which the report is about */
      status = cli_kept_frames_look(session, job, i_frame, &is_finished);
    if (is_finished)
      continue;
    for (int eye = 0; eye < cli_stereo_eyes(job) && status == CONIC_OK; eye++) {
      cli_stereo_begin(job, eye);
      status = render_frame(session, job, i_frame, image, repeats);
    }
    if (status == CONIC_OK)
      status = cli_kept_frames_add(session, job, i_frame);
    cli_frame_turns_did(&turns, i, start);
  }
  return status;
}

static int render_scene(cli_session *session, cli_render_job *job) {
  conic_image image;
  int exit_code = CLI_DONE;
  memset(&image, 0, sizeof image);
  conic_render_statistics *repeats = calloc((size_t)job->repeat, sizeof *repeats);
  conic_status status = repeats ? CONIC_OK : CONIC_ERROR_MEMORY;
  status = cli_units_agree(job, status);
  if (status == CONIC_OK)
    status = choose_first_exposure(session, job);
  if (status == CONIC_OK)
    status = cli_kept_frames_begin(session, job);
  if (status == CONIC_OK)
    status = cli_units_agree(job, cli_film_end(session, job, render_frames(session, job, &image, repeats)));
  if (status == CONIC_OK)
    status = cli_kept_frames_end(session, job);
  if (status == CONIC_OK)
    cli_units_gather(session, job);
  if (status == CONIC_OK && cli_session_speaks(session)) {
    hash_image(session, job, &image);
    job->total_ms = 1e3 * (cli_seconds() - job->start_seconds);
    if (conic_image_planes(&image))
      cli_render_tell(session, job);
    exit_code = cli_render_report(session, job, &image);
  } else
    exit_code = cli_exit_of(status);
  cli_kept_frames_release(session, job);
  cli_host_release_image(session, &image);
  conic_cryptomatte_manifest_release(session->context, &job->manifest);
  free(repeats);
  return exit_code;
}

/* What cannot be written is said before anything is read. */
static conic_status check_formats(cli_session *session, const cli_render_job *job) {
  const char *const maps[] = {job->overdraw_path, job->clusters_path, job->boxes_path, job->legend_path};
  conic_status status = cli_planes_check_formats(session, job);
  for (int i = 0; i < 4 && status == CONIC_OK; i++)
    if (maps[i])
      status = conic_image_check_output_as(session->context, maps[i], 1u << CONIC_PLANE_RGBA, &job->writing);
  return status;
}

static int run(cli_session *session, int argc, char **argv) {
  cli_render_job job;
  double start = cli_seconds();
  int exit_code = cli_render_parse(session, argc, argv, &job);
  enum { MANY = 16 };
  job.start_seconds = start;
  if (exit_code == CLI_DONE) {
    session->draws_many_frames =
        job.is_every_view || (double)job.repeat * cli_frames_count(&job) >= MANY || job.accumulating.n_samples >= MANY;
    exit_code = cli_session_open(session);
  }
  if (exit_code == CLI_DONE) {
    conic_status status =
        job.top.is_wanted ? cli_top_check_formats(session->context, &job) : check_formats(session, &job);
    if (status == CONIC_OK)
      status = cli_scene_begin(session, &job);
    const int checked = status == CONIC_OK ? cli_render_views_check(session, &job) : CLI_DONE;
    if (checked != CLI_DONE)
      status = checked == CLI_RESOURCE ? CONIC_ERROR_IO : CONIC_ERROR_ARGUMENT;
    if (status == CONIC_OK && cli_units_choose(session, &job) != CLI_DONE)
      status = CONIC_ERROR_ARGUMENT;
    conic_moment begun = conic_moment_now();
    job.begun_seconds = begun.clock_s;
    if (status == CONIC_OK && !cli_units_are_others(session, &job))
      status = cli_shot_begin_inputs(session, &job);
    if (status == CONIC_OK && !cli_units_are_others(session, &job))
      status = cli_scene_open(session, &job);
    if (status == CONIC_OK)
      cli_units_settle(&job);
    if (status == CONIC_OK)
      cli_lamps_warn(session, &job);
    cli_team_trace(session, "open", "scene", 0, begun, 0);
    exit_code = cli_exit_of(status);
    if (status == CONIC_OK && !cli_units_are_others(session, &job))
      exit_code = job.top.is_wanted ? cli_top_render(session, &job) : render_scene(session, &job);
    cli_scene_release(session, &job);
    cli_team_report_release(&job.team);
  }
  cli_shot_again_release(session, job.making.again);
  cli_shot_release(session, &job);
  free(job.inputs);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_render = {
    .name = "render",
    .is_shared = 1,
    .summary = "draws splats, points or meshes into pictures",
    .usage = "conic render IN… -o OUT [options]",
    .run = run,
    .description =
        "Draws one or more inputs as one scene into a picture. It reads " CLI_READABLE ", "
        "those from .lpc on also from http:// URLs, and " CLI_READABLE_GAUSSIANS "; - is "
        "standard input. What a file does not say (normals, "
        "sizes of points, what points up, the camera) is estimated. The ending of OUT says what is written. Lengths "
        "are in the units of the file or, with an x behind them (2x), multiples of the typical distance between "
        "neighbouring points.",
    .examples = {{"draw a scan, seen from the right and from above",
                  "conic render scan.ply --azimuth 60 --elevation 40 -o scan.png"},
                 {"write depth and normals beside the colour", "conic render scan.ply --aov rgba,Z,N -o scan.exr"},
                 {"draw a Gaussian scene from the cameras of a COLMAP folder, as gsplat 1.6 does",
                  "conic render scene.spz --profile gsplat-1.6 --camera sparse/0 --view all -o views/%s.exr"},
                 {"draw 36 pictures around the scene", "conic render scan.ply --turntable 36 -o turn_%04d.png"}},
};
