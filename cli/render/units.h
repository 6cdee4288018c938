/* Which units a team (cli/session_team.h) shares of one `conic render`: frames one by one, or of each frame the samples
 * or the windows; and the executor by which it does. */
#pragma once

#include "cli/scene/render_job.h"
#include "shots/stage.h"

/* Decides what is shared, once the views are known. Wrong usage where the team cannot do what is asked for. */
int cli_units_choose(const cli_session *session, cli_render_job *job);

/* Once the source is open: what is not drawn in windows is not shared. */
void cli_units_settle(cli_render_job *job);

/* Opens the job's source: each process the part of the scene that it reads, and what its windows see, where nothing is
 * asked for but pictures in windows. Errors: as conic_source_open. */
conic_status cli_units_open_source(const cli_session *session, cli_render_job *job);

/* Collective, where anything is shared: all look at the source from around, each at a part of it. `status` is what this
 * process came to before. */
conic_status cli_units_share_samples(const cli_session *session, cli_render_job *job, conic_status status);

/* Whether this process has nothing to do with the render, as the first does it alone. */
int cli_units_are_others(const cli_session *session, const cli_render_job *job);

/* Whether a picture that is drawn comes together in this process, which writes it. */
int cli_units_make_picture(const cli_session *session, const cli_render_job *job);

/* Begins to draw the job's shot: by this process, or by all that share units of a picture. Errors: as
 * conic_shot_work_begin; the work then still says who draws. */
conic_status cli_shot_begin(const cli_render_job *job, conic_shot_work *work);

/* Collective, where anything is shared: what all came to. Alone, the status itself. Here, so that who reads a caller's
 * code alone sees that OK means its own OK, too. */
static inline conic_status cli_units_agree(const cli_render_job *job, conic_status status) {
  conic_status of_all = job->executor->agree(job->executor->data, status);
  return status != CONIC_OK ? status : of_all;
}
/* The same: the first process's bytes come to all. */
void cli_units_broadcast(const cli_render_job *job, void *bytes, size_t n_bytes);

/* The frames that this process draws. */
typedef struct cli_frame_turns {
  const cli_render_job *job;
  conic_alone alone; /* where frames are not what is shared */
  int n_frames, n_taken, most;
  int has_ended;
} cli_frame_turns;

/* Collective. The frames from 0: -1 after the last. The first process draws the last frame, which the report is about.
 * What is handed over of frames goes to `take`, which may be null. */
void cli_frame_turns_begin(const cli_render_job *job, conic_unit_taker *take, void *cookie, cli_frame_turns *turns);
int cli_frame_turns_next(cli_frame_turns *turns);
/* Notes that this process did one. */
void cli_frame_turns_did(const cli_frame_turns *turns, int i, conic_moment since);

/* Collective, after success: what each process had to do with it, for the report. */
void cli_units_gather(const cli_session *session, cli_render_job *job);
void cli_units_report(cli_json *json, const cli_render_job *job);
