/* --resumable and --resume of several frames: which are finished stands in OUT.frames (core/files/finished.h),
 * which the first process of a team writes for all. A frame is finished when its files are there and have the hashes
 * that they were written with. */
#pragma once

#include "cli/scene/render_job.h"

typedef struct cli_kept_frames cli_kept_frames;

/* What the two options mean together with the others, also for one picture. */
int cli_kept_frames_check(const cli_session *session, const cli_render_job *job);

/* Collective, once the scene is open and the exposure known: finds the job's key, reads what is to be gone on with, and
 * begins OUT.frames; nothing where neither frames nor strips are kept. Errors: INPUT (of another scene, or with other
 * options), IO, MEMORY. */
conic_status cli_kept_frames_begin(cli_session *session, cli_render_job *job);

/* What takes what is handed over of frames, so that the first process notes those of all. */
void cli_kept_frames_take(void *cookie, int from, const void *bytes, size_t n_bytes);

/* Whether a frame, from 0, is finished; collective where all processes draw it. Errors: CANCELLED. */
conic_status cli_kept_frames_look(cli_session *session, cli_render_job *job, int i_frame, int *is_finished);
/* Notes that it is, with the files that were written since the last one was. Errors: IO, MEMORY. */
conic_status cli_kept_frames_add(cli_session *session, cli_render_job *job, int i_frame);

/* Collective, after all frames: what came of the notes. Says how many frames were there. */
conic_status cli_kept_frames_end(cli_session *session, cli_render_job *job);
/* How many frames were there. */
int cli_kept_frames_count(const cli_render_job *job);
void cli_kept_frames_release(cli_session *session, cli_render_job *job);

/* Of one picture: wrong usage where it is drawn at once, so that nothing of it could be kept. */
conic_status cli_refuse_kept_picture(const cli_render_job *job);
