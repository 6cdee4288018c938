/* All that decides the picture that a job draws, as a value: for its key, for files, and for the picture itself. */
#pragma once

#include "cli/scene/render_job.h"

/* Before the scene is opened: begins to look at what it is made of, where anything is to say so. Errors: MEMORY. */
conic_status cli_shot_begin_inputs(cli_session *session, cli_render_job *job);

/* What the job's shot is, with what it was read by and what was read for it; what decides no bit of it is as it is by
 * default. Of a frame whose shot is filled. The job keeps what it points to. Errors: MEMORY, CANCELLED. */
conic_status cli_shot_record(cli_session *session, cli_render_job *job, conic_shot_file *file);

/* The shot of a frame that is drawn, with the focus that was found; and how files are made of it. */
void cli_shot_settle(const cli_render_job *job, conic_shot *shot);
void cli_shot_writing(const cli_render_job *job, conic_shot_writing *writing);

/* The key of work that is kept: of all frames, and of the files that they become. The shot is that of the first.
 * Errors: as cli_shot_record. */
conic_status cli_shot_kept_key(cli_session *session, cli_render_job *job, char key[CONIC_SHA256_ROOM]);

/* The key "shot_key" of the statistics, unless a host's memory is drawn. Errors: as cli_shot_record. */
conic_status cli_shot_report(cli_session *session, cli_json *json, cli_render_job *job);

/* What a frame that is drawn says of itself: the text that its pictures carry, in the job, and the file of
 * --save-shot. Errors: as cli_shot_record, IO. */
conic_status cli_shot_describe(cli_session *session, cli_render_job *job);
conic_status cli_shot_save(cli_session *session, cli_render_job *job, int i_frame);

void cli_shot_release(cli_session *session, cli_render_job *job);
