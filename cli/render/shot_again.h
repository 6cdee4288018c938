/* Drawing again what a shot or a picture says: conic render F.shot.json, and --again PICTURE. What it says becomes the
 * options' values and words before they are read, so that all rules about them hold; what no option says is put in its
 * place when a frame's shot is filled. */
#pragma once

#include "cli/scene/render_job.h"

typedef struct cli_shot_again cli_shot_again;

/* Reads the arguments of render: cli_render_parse. */
typedef int cli_render_parser(cli_session *session, int argc, char **argv, cli_render_job *job);

/* Reads the shot that the arguments name, finds its inputs, and reads the arguments anew. Returns as `parse`. */
int cli_shot_again_parse(cli_session *session, int argc, char **argv, cli_render_parser *parse, cli_render_job *job);

/* The options' values as the shot has them, before the arguments are read. */
void cli_shot_again_begin(cli_session *session, cli_render_job *job);

/* Whether the shot's camera counts; then it becomes the job's, of the size that is asked for. Errors: ARGUMENT (it has
 * another shape). */
conic_status cli_shot_again_take_camera(cli_render_job *job, int *is_taken);

/* Puts into a frame's shot, whose camera is there, what no option has said. */
void cli_shot_again_fill(cli_render_job *job);

/* Once all inputs are read: what they led to has to be what it was. Errors: INPUT, MEMORY, CANCELLED. */
conic_status cli_shot_again_check(cli_session *session, cli_render_job *job);

void cli_shot_again_release(cli_session *session, cli_shot_again *again);
