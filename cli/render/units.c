#include "cli/render/units.h"

#include "cli/render/frames.h"
#include "source/shared_source.h"
#include "source/source_samples.h"

/* --- what is shared --- */

static int is_stream(const char *path) {
  return strcmp(path, "-") == 0;
}

static int check_streams(const cli_render_job *job) {
  for (int i = 0; i < job->n_inputs; i++)
    if (is_stream(job->inputs[i]))
      return cli_usage("render: several processes cannot share standard input; give files");
  for (int i = 0; i < job->n_outputs; i++)
    if (is_stream(job->outputs[i]) && job->units == CONIC_UNITS_FRAMES)
      return cli_usage("render: several processes cannot share standard output; give files with -o");
  return CLI_DONE;
}

static void set_units(cli_render_job *job, conic_shared_units units, const conic_executor *team) {
  job->units = units;
  job->executor = units == CONIC_UNITS_NONE ? &job->alone.executor : team;
}

int cli_units_choose(const cli_session *session, cli_render_job *job) {
  int n = cli_frames_count(job);
  const conic_executor *team = session->team;
  conic_executor_alone(&job->alone);
  cli_team_watch(&job->alone.executor);
  set_units(job, CONIC_UNITS_NONE, NULL);
  if (!cli_team_is_shared(session) || job->top.is_wanted)
    return CLI_DONE;
  if (!job->film.path && (n >= team->count || (n > 1 && !job->accumulating.n_samples)))
    set_units(job, CONIC_UNITS_FRAMES, team);
  else if (job->accumulating.n_samples)
    set_units(job, CONIC_UNITS_SAMPLES, team);
  else if (!job->shot.view.may_be_coarser)
    set_units(job, CONIC_UNITS_WINDOWS, team);
  if (job->units == CONIC_UNITS_SAMPLES && job->accumulating.seconds > 0.0)
    return cli_usage("render: what --time ends depends on the number of processes; give --noise or a count");
  if (job->units == CONIC_UNITS_SAMPLES && job->accumulating.preview_seconds > 0.0)
    cli_note(session, "--preview: the samples come together at the end only");
  return job->units == CONIC_UNITS_NONE ? CLI_DONE : check_streams(job);
}

void cli_units_settle(cli_render_job *job) {
  int has_windows = conic_source_has_windows(job->source, job->renderer, job->is_transparent) &&
                    !(job->shot.catchers | job->shot.holdouts) &&
                    !(job->abilities & CONIC_SOURCE_MIXES && conic_shot_is_lit(&job->shot));
  if (job->units == CONIC_UNITS_WINDOWS && !has_windows)
    set_units(job, CONIC_UNITS_NONE, NULL);
}

/* --- the source --- */

/* What else looks at a scene than the windows of its pictures. */
static int looks_at_all(const cli_render_job *job) {
  int has_spacings =
      job->epsilon.is_in_spacings || job->near_z.is_in_spacings || job->accumulating.width.is_in_spacings;
  return has_spacings || job->effects.asked & CLI_LOOKS_AROUND || job->boxes_path || job->clusters_path;
}

/* Of what the processes did together in the library, and of which all know whether it failed: tells it. */
static conic_status tell_together(const cli_session *session, conic_status status) {
  if (status != CONIC_OK)
    cli_team_exit(session, status);
  return status;
}

conic_status cli_units_open_source(const cli_session *session, cli_render_job *job) {
  size_t n = (size_t)job->n_inputs;
  int is_parted = job->units == CONIC_UNITS_WINDOWS && !session->host && conic_renderer_has_parts(job->renderer) &&
                  !looks_at_all(job) && !cli_lod_is_wanted(job);
  if (!is_parted)
    return conic_source_open(session->context, job->inputs, n, &job->opening, &job->source);
  return tell_together(session, conic_source_open_shared(session->context, job->executor->team, job->inputs, n,
                                                         &job->opening, &job->source));
}

conic_status cli_units_share_samples(const cli_session *session, cli_render_job *job, conic_status status) {
  if (job->units == CONIC_UNITS_NONE || session->host)
    return status;
  return tell_together(session, conic_source_share_samples(job->source, job->executor->team, status));
}

/* --- who does what --- */

int cli_units_are_others(const cli_session *session, const cli_render_job *job) {
  return job->units == CONIC_UNITS_NONE && !cli_session_speaks(session);
}

int cli_units_make_picture(const cli_session *session, const cli_render_job *job) {
  return job->units <= CONIC_UNITS_FRAMES || cli_session_speaks(session);
}

conic_status cli_shot_begin(const cli_render_job *job, conic_shot_work *work) {
  conic_status status = conic_shot_work_begin(job->source, job->renderer, &job->shot, work);
  work->units = job->units;
  if (job->units > CONIC_UNITS_FRAMES)
    work->executor = job->executor;
  else
    cli_team_watch(&work->alone.executor);
  return status;
}

void cli_units_broadcast(const cli_render_job *job, void *bytes, size_t n_bytes) {
  job->executor->broadcast(job->executor->data, bytes, n_bytes);
}

/* --- frames --- */

void cli_frame_turns_begin(const cli_render_job *job, conic_unit_taker *take, void *cookie, cli_frame_turns *turns) {
  const conic_executor *team = job->executor;
  *turns = (cli_frame_turns){.job = job, .n_frames = cli_frames_count(job), .most = cli_frames_count(job)};
  conic_executor_alone(&turns->alone);
  turns->alone.executor.share(&turns->alone, (uint64_t)turns->n_frames, NULL, NULL);
  if (job->units != CONIC_UNITS_FRAMES)
    return;
  if (team->index == 0)
    turns->most = (turns->n_frames + team->count - 1) / team->count - 1;
  team->share(team->data, (uint64_t)turns->n_frames - 1, take, cookie);
}

int cli_frame_turns_next(cli_frame_turns *turns) {
  int is_shared = turns->job->units == CONIC_UNITS_FRAMES;
  const conic_executor *executor = is_shared ? turns->job->executor : &turns->alone.executor;
  uint64_t unit = turns->n_taken < turns->most ? executor->next(executor->data) : CONIC_NO_UNIT;
  if (unit != CONIC_NO_UNIT) {
    turns->n_taken++;
    return (int)unit;
  }
  int is_last = is_shared && executor->index == 0 && !turns->has_ended;
  turns->has_ended = 1;
  return is_last ? turns->n_frames - 1 : -1;
}

void cli_frame_turns_did(const cli_frame_turns *turns, int i, conic_moment since) {
  const conic_executor *executor = turns->job->executor;
  if (turns->job->units == CONIC_UNITS_FRAMES)
    executor->did(executor->data, "frame", (uint64_t)i, since, 0);
}

/* --- the report --- */

void cli_units_gather(const cli_session *session, cli_render_job *job) {
  if (job->units != CONIC_UNITS_NONE)
    cli_team_report_gather(session, cli_team_units(), &job->team);
}

static const char *name_units(conic_shared_units units) {
  return units == CONIC_UNITS_FRAMES ? "frames" : units == CONIC_UNITS_SAMPLES ? "samples" : "windows";
}

void cli_units_report(cli_json *json, const cli_render_job *job) {
  cli_team_report_write(json, name_units(job->units), &job->team);
}
