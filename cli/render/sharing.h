/* How a team (cli/session_team.h) shares one `conic render`: frames one by one, or of each frame the samples or
 * the windows. Alone, each function does what one process does. */
#ifndef CONIC_SHARING_H
#define CONIC_SHARING_H

#include "cli/scene/render_job.h"
#include "core/base/clock.h"

/* Which of the frames this process draws. */
typedef struct cli_frame_turns {
  int n_frames, n_taken, most; /* that are taken one by one */
  int has_ended;
} cli_frame_turns;

/* Decides what is shared, once the views are known. Wrong usage where the team cannot do what is asked for. */
int cli_sharing_choose(const cli_session *session, cli_render_job *job);

/* Whether each process may open the part of the scene that it reads, and what its windows see, in the place of all of
 * it: nothing is asked for but pictures in windows. */
int cli_sharing_may_part_source(const cli_session *session, const cli_render_job *job);

/* Of what a team's processes did together in the library, and of which all know whether it failed: tells it. Hands the
 * status on. */
conic_status cli_sharing_tell(const cli_session *session, conic_status status);

/* Once the source is open: what is not drawn in windows is not shared. */
void cli_sharing_settle(cli_render_job *job);

/* Whether this process has nothing to do with the render, as the first does it alone. */
int cli_sharing_is_idle(const cli_session *session, const cli_render_job *job);

/* The team as what draws shots by it; null: this process is alone. */
const conic_executor *cli_sharing_executor(cli_render_job *job);

/* Whether a picture that is drawn comes together in this process, which writes it. */
int cli_sharing_has_picture(const cli_session *session, const cli_render_job *job);

/* Collective. The frames from 0: -1 after the last. The first process draws the last frame, which the report is about.
 */
void cli_frame_turns_begin(const cli_session *session, const cli_render_job *job, cli_frame_turns *turns);
int cli_frame_turns_next(const cli_session *session, const cli_render_job *job, cli_frame_turns *turns);

/* Notes that this process did a unit of the work: "frame" 3, since `start`. */
void cli_sharing_note(const cli_session *session, cli_render_job *job, const char *name, uint64_t number,
                      conic_moment start, uint64_t sent_bytes);

/* Collective, at the end of what was shared: what all came to. Alone, the status itself. */
conic_status cli_sharing_end(const cli_session *session, const cli_render_job *job, conic_status status);

/* Collective, after success: what each process had to do with it, for the report. */
void cli_sharing_gather(const cli_session *session, cli_render_job *job);
void cli_sharing_report(cli_json *json, const cli_render_job *job);
void cli_sharing_release(cli_render_job *job);

#endif
