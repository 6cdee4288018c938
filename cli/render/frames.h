/* The frames of a turntable, or the views of a file: which are drawn, what their files are called, and where the
 * cameras stand. */
#pragma once

#include "cli/scene/render_job.h"

/* Parsers of values: "36" into the job's number of frames, and "A:B:STEP", "A:B" or "A" into a cli_frames. */
int cli_parse_turntable(const char *text, void *value);
int cli_parse_frames(const char *text, void *value);

/* Sees to it that the frames that are asked for are there, and that none of their files is written over another one, or
 * over an input, when each of `paths` (null entries are fine) gives one a frame. Returns CLI_DONE, or an exit code
 * after a message. */
int cli_frames_check(const cli_session *session, cli_render_job *job, const char *const *paths, int n_paths);

/* Whether there are several, with numbers in the names of their files. */
int cli_frames_are_many(const cli_render_job *job);

/* Whether more than one is drawn, as far as the options tell. */
int cli_frames_are_several(const cli_render_job *job);

/* How many are drawn. */
int cli_frames_count(const cli_render_job *job);

/* The name of a frame's file, from 0, which the caller frees; null without memory. In a turntable "name.exr" becomes
 * "name.0001.exr", and "name_%03d.exr" becomes "name_001.exr"; views are
 * counted from 0, and of these "%s.exr" is the view's own name. Of two eyes, cli_stereo_name comes on top. */
char *cli_frame_name(const cli_render_job *job, const char *path, int i_frame);
