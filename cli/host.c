#include "cli/host.h"

#include "cli/command.h"
#include "cli/host_keeps.h"
#include "cli/shell.h"
#include "core/files/guard.h"
#include "shots/shot_inputs.h"
#include "shots/shot_key.h"
#include "shots/way.h"

int cli_host_program(int argc, char **argv) {
  char **arguments = cli_shell_begin(&argc, argv);
  return arguments ? cli_program(argc, arguments, NULL) : cli_error(CLI_RESOURCE, "out of memory");
}

int cli_host_run(cli_host *host, int argc, char **argv) {
  const cli_command *command = argc > 0 ? cli_find_command(argv[0]) : NULL;
  cli_session session = {.command = command ? command->name : "conic", .host = host, .json_path = "-"};
  host->status = CONIC_OK;
  cli_host *before = cli_session_host(host);
  int exit_code =
      command ? command->run(&session, argc, argv) : cli_usage("there is no command '%s'", argc > 0 ? argv[0] : "");
  if (exit_code == CLI_RESOURCE && host->status == CONIC_OK)
    host->status = CONIC_ERROR_IO; /* outputs that cannot be written are found before the library is asked */
  cli_session_close(&session);
  cli_session_host(before);
  return exit_code;
}

/* --- a picture that is a shot already --- */

typedef struct shot_request {
  const char **inputs;
  size_t n_inputs;
  const conic_source_options *opening;
  conic_shot shot;
  const char *sky_path, *motion_path;
  conic_image *image;
  conic_shot_outcome *outcome;
} shot_request;

static conic_status open_again(cli_session *session, const shot_request *wish, conic_source **source) {
  char key[CONIC_SHA256_ROOM];
  const unsigned abilities = cli_kept_abilities(session, wish->inputs, wish->n_inputs, wish->opening);
  cli_opening_key(wish->inputs, wish->n_inputs, wish->opening, abilities, key);
  *source = cli_kept_source(session, key, wish->opening);
  if (*source)
    return CONIC_OK;
  conic_status status = conic_source_open(session->context, wish->inputs, wish->n_inputs, wish->opening, source);
  if (status == CONIC_OK)
    cli_keep_source(session, key, wish->opening, *source);
  return status;
}

static conic_status read_besides(cli_session *session, const shot_request *wish, conic_sky **sky,
                                 conic_motion **motion) {
  conic_status status = CONIC_OK;
  if (wish->sky_path)
    status = conic_sky_read(session->context, wish->sky_path, wish->shot.render.lighting.up, sky);
  if (status == CONIC_OK && wish->motion_path)
    status = conic_motion_read(session->context, wish->motion_path, wish->n_inputs, wish->opening, motion);
  return status;
}

static conic_status draw_shot(cli_session *session, conic_source *source, conic_renderer *renderer,
                              shot_request *wish) {
  conic_shot *shot = &wish->shot;
  conic_sky *sky = NULL;
  conic_motion *motion = NULL;
  conic_status status = read_besides(session, wish, &sky, &motion);
  shot->light.sky = sky;
  shot->motion = motion;
  if (status == CONIC_OK)
    status = conic_shot_draw(source, renderer, shot, wish->image, wish->outcome);
  conic_shot_rest(shot, source);
  conic_motion_destroy(motion);
  conic_sky_destroy(sky);
  return status;
}

static conic_status run_shot(cli_session *session, shot_request *wish) {
  cli_device device = {.name = "cpu"};
  conic_source *source = NULL;
  conic_renderer *renderer = NULL;
  conic_status status =
      cli_kept_renderer(session, &device, &renderer) ? CONIC_OK : conic_renderer_create(session->context, &renderer);
  if (status == CONIC_OK)
    status = open_again(session, wish, &source);
  if (status == CONIC_OK)
    status = draw_shot(session, source, renderer, wish);
  cli_keep_renderer(session, &device, renderer);
  if (!cli_source_is_kept(session, source))
    conic_source_close(source);
  return status;
}

int cli_host_draw(cli_host *host, int n_inputs, const char **inputs, const conic_source_options *opening,
                  const conic_shot *shot, const char *sky_path, const char *motion_path, int threads,
                  conic_image *image, conic_shot_outcome *outcome) {
  cli_session session = {.command = "render", .host = host, .threads = threads, .isa = shot->render.isa};
  shot_request wish = {inputs, (size_t)n_inputs, opening, *shot, sky_path, motion_path, image, outcome};
  host->status = CONIC_OK;
  cli_host *before = cli_session_host(host);
  int exit_code = cli_session_open(&session);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(run_shot(&session, &wish));
  cli_session_close(&session);
  cli_session_host(before);
  return exit_code;
}

/* --- what a shot is made of --- */

static conic_status read_inputs(cli_session *session, const shot_request *wish) {
  conic_source *source = NULL;
  conic_sky *sky = NULL;
  conic_motion *motion = NULL;
  conic_guard_go_on(session->context);
  conic_status status = conic_source_open(session->context, wish->inputs, wish->n_inputs, wish->opening, &source);
  if (status == CONIC_OK)
    status = read_besides(session, wish, &sky, &motion);
  conic_motion_destroy(motion);
  conic_sky_destroy(sky);
  conic_source_close(source);
  return status;
}

static conic_status tell_of_inputs(cli_session *session, const conic_shot_names *names, conic_shot_file *file,
                                   unsigned abilities) {
  conic_shot_inputs inputs = {0};
  char *text = NULL;
  conic_status status = conic_shot_inputs_find(session->context, names, &inputs);
  file->inputs = inputs.inputs;
  file->n_inputs = inputs.n;
  conic_shot_file_plain(file, abilities);
  if (status == CONIC_OK)
    status = conic_shot_file_print(session->context, file, CONIC_SHOT_WHOLE, &text);
  if (status == CONIC_OK)
    cli_host_note(session->host, 't', "shot", text, strlen(text) + 1);
  conic_shot_text_release(session->context, text);
  conic_shot_inputs_release(session->context, &inputs);
  return status == CONIC_OK && session->host->facts_are_lost ? CONIC_ERROR_MEMORY : status;
}

static conic_status look(cli_session *session, const conic_shot_file *file, const char **scene) {
  conic_shot_file now = *file;
  conic_shot_names names = {.scene = scene};
  for (size_t i = 0; i < file->n_inputs; i++) {
    const conic_shot_input *input = &file->inputs[i];
    const char **const places[CONIC_N_SHOT_ROLES] = {&scene[names.n_scene], &names.texture, &names.sky, &names.motion,
                                                     NULL};
    if (input->role == CONIC_SHOT_PART)
      continue;
    *places[input->role] = input->name;
    names.n_scene += input->role == CONIC_SHOT_SCENE;
  }
  now.reading.texture_path = names.texture;
  const shot_request wish = {scene, names.n_scene, &now.reading, now.shot, names.sky, names.motion, NULL, NULL};
  conic_status status = read_inputs(session, &wish);
  const unsigned abilities = conic_source_abilities(scene, names.n_scene, &now.reading);
  return status == CONIC_OK ? tell_of_inputs(session, &names, &now, abilities) : status;
}

int cli_host_look(cli_host *host, const conic_shot_file *file) {
  cli_session session = {.command = "render", .host = host};
  const char **scene = calloc(file->n_inputs + 1, sizeof *scene);
  host->status = CONIC_OK;
  cli_host *before = cli_session_host(host);
  int exit_code = scene ? cli_session_open(&session) : CLI_RESOURCE;
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(look(&session, file, scene));
  cli_session_close(&session);
  cli_session_host(before);
  free(scene);
  return exit_code;
}
