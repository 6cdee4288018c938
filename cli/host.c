#include "cli/host.h"

#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "cli/scene/render_job.h"

int cli_host_run(cli_host *host, int argc, char **argv) {
  const cli_command *command = argc > 0 ? cli_find_command(argv[0]) : NULL;
  cli_session session = {.command = command ? command->name : "conic", .host = host, .json_path = "-"};
  host->status = CONIC_OK;
  cli_session_host(&session);
  int exit_code =
      command ? command->run(&session, argc, argv) : cli_usage("there is no command '%s'", argc > 0 ? argv[0] : "");
  if (exit_code == CLI_RESOURCE && host->status == CONIC_OK)
    host->status = CONIC_ERROR_IO; /* outputs that cannot be written are found before the library is asked */
  cli_session_close(&session);
  cli_session_host(NULL);
  return exit_code;
}

/* --- a picture that is a shot already --- */

typedef struct shot_request {
  conic_shot shot;
  const char *sky_path, *motion_path;
  conic_image *image;
  conic_shot_outcome *outcome;
} shot_request;

static conic_status draw_shot(cli_session *session, cli_render_job *job, shot_request *wish) {
  conic_shot *shot = &job->shot; /* whose motion, and sky, go with the job */
  *shot = wish->shot;
  shot->light.sky = NULL;
  shot->motion = NULL;
  conic_status status = CONIC_OK;
  if (wish->sky_path)
    status = conic_sky_read(session->context, wish->sky_path, shot->render.lighting.up, &job->sky);
  shot->light.sky = job->sky;
  if (status == CONIC_OK && wish->motion_path)
    status = conic_motion_read(session->context, wish->motion_path, (size_t)job->n_inputs, &job->opening,
                               &job->accumulating.motion);
  shot->motion = job->accumulating.motion;
  return status == CONIC_OK ? conic_shot_draw(job->source, job->renderer, shot, wish->image, wish->outcome) : status;
}

static int run_shot(cli_session *session, int argc, char **argv, shot_request *wish) {
  cli_render_job job;
  int exit_code = cli_render_parse(session, argc, argv, &job);
  job.session = session;
  if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE) {
    conic_status status = cli_scene_begin(session, &job);
    if (status == CONIC_OK)
      status = cli_scene_open(session, &job);
    if (status == CONIC_OK)
      status = draw_shot(session, &job, wish);
    exit_code = cli_exit_of(status);
    cli_scene_release(session, &job);
  }
  free(job.inputs);
  return exit_code;
}

int cli_host_draw(cli_host *host, int n_inputs, char **inputs, const conic_shot *shot, const char *sky_path,
                  const char *motion_path, conic_image *image, conic_shot_outcome *outcome) {
  cli_session session = {.command = "render", .host = host};
  shot_request wish = {*shot, sky_path, motion_path, image, outcome};
  static char command[] = "render", end[] = "--";
  char **argv = calloc((size_t)n_inputs + 3, sizeof *argv);
  host->status = CONIC_OK;
  cli_session_host(&session);
  int exit_code = CLI_RESOURCE;
  if (argv) {
    argv[0] = command;
    argv[1] = end;
    memcpy(argv + 2, inputs, (size_t)n_inputs * sizeof *argv);
    exit_code = run_shot(&session, n_inputs + 2, argv, &wish);
    cli_session_close(&session);
  }
  if (exit_code == CLI_RESOURCE && host->status == CONIC_OK)
    host->status = argv ? CONIC_ERROR_IO : CONIC_ERROR_MEMORY;
  cli_session_host(NULL);
  free(argv);
  return exit_code;
}
