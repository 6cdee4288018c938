#include "cli/render/sharing.h"

#include <string.h>

#include "cli/render/frames.h"
#include "cli/render/kept_frames.h"
#include "cli/session_team.h"
#include "shots/shot_plan.h"
#include "source/source_parts.h"

static int is_stream(const char *path) {
  return strcmp(path, "-") == 0;
}

static int check_streams(const cli_render_job *job) {
  for (int i = 0; i < job->n_inputs; i++)
    if (is_stream(job->inputs[i]))
      return cli_usage("render: several processes cannot share standard input; give files");
  for (int i = 0; i < job->n_outputs; i++)
    if (is_stream(job->outputs[i]) && job->sharing == CONIC_UNITS_FRAMES)
      return cli_usage("render: several processes cannot share standard output; give files with -o");
  return CLI_DONE;
}

int cli_sharing_choose(const cli_session *session, cli_render_job *job) {
  int n = cli_frames_count(job);
  job->sharing = CONIC_UNITS_NONE;
  if (!cli_team_is_shared(session) || job->top.is_wanted)
    return CLI_DONE;
  if (n >= session->team->count || (n > 1 && !job->accumulating.n_samples))
    job->sharing = CONIC_UNITS_FRAMES;
  else if (job->accumulating.n_samples)
    job->sharing = CONIC_UNITS_SAMPLES;
  else if (!job->shot.view.may_be_coarser)
    job->sharing = CONIC_UNITS_WINDOWS;
  if (job->sharing == CONIC_UNITS_SAMPLES && job->accumulating.seconds > 0.0)
    return cli_usage("render: what --time ends depends on the number of processes; give --noise or a count");
  if (job->sharing == CONIC_UNITS_SAMPLES && job->accumulating.preview_seconds > 0.0)
    cli_note(session, "--preview: the samples come together at the end only");
  return job->sharing == CONIC_UNITS_NONE ? CLI_DONE : check_streams(job);
}

/* What else looks at a scene than the windows of its pictures. */
static int looks_at_all(const cli_render_job *job) {
  int has_spacings =
      job->epsilon.is_in_spacings || job->near_z.is_in_spacings || job->accumulating.width.is_in_spacings;
  return has_spacings || job->is_transparent || job->has_mattes || job->deep_path || job->boxes_path ||
         job->clusters_path || job->progressive_path || conic_shot_is_lit(&job->shot) || job->accumulating.n_samples;
}

int cli_sharing_may_part_source(const cli_session *session, const cli_render_job *job) {
  return job->sharing == CONIC_UNITS_WINDOWS && !session->host && conic_renderer_has_parts(job->renderer) &&
         !looks_at_all(job);
}

conic_status cli_sharing_tell(const cli_session *session, conic_status status) {
  if (status != CONIC_OK)
    cli_team_exit(session, status);
  return status;
}

void cli_sharing_settle(cli_render_job *job) {
  if (job->sharing == CONIC_UNITS_WINDOWS && !conic_source_has_windows(job->source, job->renderer, job->is_transparent))
    job->sharing = CONIC_UNITS_NONE;
}

int cli_sharing_is_idle(const cli_session *session, const cli_render_job *job) {
  return job->sharing == CONIC_UNITS_NONE && !cli_team_is_first(session);
}

int cli_sharing_has_picture(const cli_session *session, const cli_render_job *job) {
  return job->sharing <= CONIC_UNITS_FRAMES || cli_team_is_first(session);
}

void cli_frame_turns_begin(const cli_session *session, const cli_render_job *job, cli_frame_turns *turns) {
  *turns = (cli_frame_turns){.n_frames = cli_frames_count(job), .most = cli_frames_count(job)};
  if (job->sharing != CONIC_UNITS_FRAMES)
    return;
  int count = session->team->count;
  if (session->team->index == 0)
    turns->most = (turns->n_frames + count - 1) / count - 1;
  session->team->share((uint64_t)turns->n_frames - 1, job->kept ? cli_kept_frames_take : NULL, job->kept);
}

int cli_frame_turns_next(const cli_session *session, const cli_render_job *job, cli_frame_turns *turns) {
  if (job->sharing != CONIC_UNITS_FRAMES)
    return turns->n_taken < turns->n_frames ? turns->n_taken++ : -1;
  uint64_t unit = turns->n_taken < turns->most ? session->team->next() : CONIC_NO_UNIT;
  if (unit != CONIC_NO_UNIT) {
    turns->n_taken++;
    return (int)unit;
  }
  int is_last = session->team->index == 0 && !turns->has_ended;
  turns->has_ended = 1;
  return is_last ? turns->n_frames - 1 : -1;
}

conic_status cli_sharing_end(const cli_session *session, const cli_render_job *job, conic_status status) {
  if (job->sharing == CONIC_UNITS_NONE)
    return status;
  if (status != CONIC_OK)
    session->team->stop();
  int exit_code = cli_team_agree(session, cli_exit_of(status));
  return status != CONIC_OK || exit_code == CLI_DONE ? status : CONIC_ERROR_CANCELLED;
}

void cli_sharing_note(const cli_session *session, cli_render_job *job, const char *name, uint64_t number,
                      conic_moment start, uint64_t sent_bytes) {
  job->n_units++;
  job->busy_seconds += cli_seconds() - start.clock_s;
  cli_team_trace(session, "unit", name, number, start, sent_bytes);
}

/* --- the executor --- */

static const cli_team *team_of(void *data) {
  return ((const cli_render_job *)data)->session->team;
}

static void share_units(void *data, uint64_t n, conic_unit_taker *take, void *cookie) {
  team_of(data)->share(n, take, cookie);
}

static uint64_t next_unit(void *data) {
  return team_of(data)->next();
}

static void allow_units(void *data, uint64_t end) {
  team_of(data)->allow(end);
}

static void hand_bytes(void *data, const void *bytes, size_t n_bytes) {
  team_of(data)->hand(bytes, n_bytes);
}

static conic_status agree_on(void *data, conic_status status) {
  const cli_render_job *job = data;
  return cli_sharing_end(job->session, job, status);
}

static void broadcast_bytes(void *data, void *bytes, size_t n_bytes) {
  team_of(data)->broadcast(bytes, n_bytes);
}

static void note_unit(void *data, const char *name, uint64_t number, conic_moment since, uint64_t handed_bytes) {
  cli_render_job *job = data;
  cli_sharing_note(job->session, job, name, number, since, handed_bytes);
}

static void trace_part(void *data, const char *kind, const char *name, uint64_t number, conic_moment since,
                       uint64_t bytes) {
  cli_team_trace(((const cli_render_job *)data)->session, kind, name, number, since, bytes);
}

const conic_executor *cli_sharing_executor(cli_render_job *job) {
  const cli_team *team = job->session->team;
  if (!cli_team_is_shared(job->session))
    return NULL;
  job->executor = (conic_executor){.data = job,
                                   .index = team->index,
                                   .count = team->count,
                                   .cut_for = team->cut_for,
                                   .team = cli_team_of_library(job->session, &job->library_team),
                                   .share = share_units,
                                   .next = next_unit,
                                   .allow = allow_units,
                                   .hand = hand_bytes,
                                   .agree = agree_on,
                                   .broadcast = broadcast_bytes,
                                   .did = note_unit,
                                   .trace = trace_part};
  return &job->executor;
}

/* --- the report --- */

void cli_sharing_gather(const cli_session *session, cli_render_job *job) {
  if (job->sharing != CONIC_UNITS_NONE)
    cli_team_shares_gather(session, job->n_units, job->busy_seconds, &job->shares);
}

static const char *name_sharing(conic_shared_units sharing) {
  return sharing == CONIC_UNITS_FRAMES ? "frames" : sharing == CONIC_UNITS_SAMPLES ? "samples" : "windows";
}

void cli_sharing_report(cli_json *json, const cli_render_job *job) {
  cli_team_shares_report(json, name_sharing(job->sharing), &job->shares);
}

void cli_sharing_release(cli_render_job *job) {
  cli_team_shares_release(&job->shares);
}
