/* Which options of a scene go together. */

#include "cli/color_options.h"
#include "cli/host_keeps.h"
#include "cli/outputs.h"
#include "cli/scene/background_options.h"
#include "cli/scene/scene_options.h"
#include "cli/scene/views.h"

/* A layered cloud knows what its values mean without all of them. */
static int is_colored_by_value(const cli_render_job *job) {
  const char *by = job->coloring.by;
  return strcmp(by, "height") != 0 && strcmp(by, "normal") != 0 && job->n_inputs == 1 &&
         (conic_layers_is_url(job->inputs[0]) || conic_layers_is_file(job->inputs[0]));
}

/* Colours that are made of something need all of it at once. */
static int check_colors(const cli_session *session, cli_scene_words *words, cli_render_job *job) {
  int answer = cli_color_check(session, &job->coloring, !job->is_plain);
  if (answer == CLI_DONE)
    answer = cli_color_check_texture(session, &job->coloring, job->opening.texture_path);
  if (!job->coloring.by)
    return answer;
  job->opening.coloring = &job->coloring;
  words->is_colored_whole = cli_color_is_asked(&job->coloring) && !is_colored_by_value(job);
  if (job->is_up_given)
    memcpy(job->coloring.up, job->framing.up, sizeof job->coloring.up);
  return answer;
}

int cli_scene_is_top(const cli_render_job *job) {
  return job->camera_path && strncmp(job->camera_path, "top", 3) == 0 &&
         (!job->camera_path[3] || job->camera_path[3] == ':');
}

/* ":GSD", ":GSD:EPSG" or "::EPSG" behind it. */
static int parse_top(const char *text, cli_top_job *top) {
  char digits[40];
  unsigned long long epsg;
  if (!*text)
    return 1;
  const size_t length = strcspn(++text, ":");
  snprintf(digits, sizeof digits, "%.*s", (int)length, text);
  if (length &&
      (length >= sizeof digits || !cli_parse_number(digits, &top->gsd) || top->gsd < 1e-12 || top->gsd > 1e12))
    return 0;
  if (!text[length])
    return length > 0;
  if (!cli_parse_count(text + length + 1, &epsg) || epsg < 1 || epsg > 65535)
    return 0;
  top->epsg = (int)epsg;
  return 1;
}

/* Of a map, north is up, and up is z. */
static int settle_top(const cli_session *session, cli_render_job *job) {
  const double *up = job->framing.up;
  if (!cli_scene_is_top(job))
    return CLI_DONE;
  if (!parse_top(job->camera_path + 3, &job->top))
    return cli_usage("%s: --camera: \"%s\" is not understood; of a map it takes top, top:GSD or top:GSD:EPSG",
                     session->command, job->camera_path);
  if (job->is_up_given && (up[0] != 0.0 || up[1] != 0.0 || !(up[2] > 0.0)))
    return cli_usage("%s: of --camera top, z points up", session->command);
  job->top.is_wanted = job->is_up_given = 1;
  memcpy(job->framing.up, (const double[3]){0.0, 0.0, 1.0}, sizeof job->framing.up);
  job->camera_path = NULL;
  return CLI_DONE;
}

/* Values that are none, whatever else is given. */
static int check_each_value(const cli_session *session, const cli_scene_words *words, const cli_render_job *job) {
  const char *command = session->command;
  if (job->n_inputs == 0)
    return job->may_lack_inputs ? CLI_DONE : cli_usage("%s: no input; see conic help %s", command, command);
  if (words->is_smooth && words->is_crease_given)
    return cli_usage("%s: --crease all rounds all edges, and a number those up to an angle; give one of both", command);
  if (job->sky_path && !job->n_directions && !(job->is_aov_given && job->shot.planes & 1u << CONIC_PLANE_AO))
    return cli_usage("%s: the light of %s comes from so many directions as --ao says; give it, too", command,
                     job->sky_path);
  if (job->shot.light.reflectance > 0.0 && !job->sky_path)
    return cli_usage("%s: --reflect mirrors the picture of --sky; give it, too", command);
  if (job->is_unlit && job->n_light_words > 1)
    return cli_usage("%s: --light none does not go with another --light", command);
  if (words->passes != 1 && words->passes != 3)
    return cli_usage("%s: --passes takes 3 or 1", command);
  if (job->shot.render.tile & (job->shot.render.tile - 1))
    return cli_usage("%s: --tile takes 8, 16, 32 or 64", command);
  if (job->shot.light.dome_stops > 0.0 && cli_scene_is_top(job))
    return cli_usage("%s: --shade edl is not of --camera top; conic sheet --plan draws it", command);
  if (job->shot.light.dome_stops > 0.0 && !job->is_for_looking && strcmp(command, "verify") != 0)
    return cli_usage("%s: --shade edl is of conic render, sheet and verify", command);
  if (job->projection == CONIC_CAMERA_CUBE && job->framing.height != 6 * job->framing.width)
    return cli_usage("%s: --projection cube is six times as high as wide", command);
  return CLI_DONE;
}

/* Which input a text of so many letters names: by its name, or by the last part of it where no other input has the
 * same; -1: none; -2: several. */
static int find_input(const cli_render_job *job, const char *text, size_t length) {
  int found = -1, n_found = 0;
  for (int i = 0; i < job->n_inputs; i++) {
    const char *name = job->inputs[i], *slash = strrchr(name, '/');
    if (strlen(name) == length && strncmp(name, text, length) == 0) {
      for (int k = i + 1; k < job->n_inputs; k++)
        if (strcmp(job->inputs[k], name) == 0)
          return -2;
      return i;
    }
    if (slash && strlen(slash + 1) == length && strncmp(slash + 1, text, length) == 0) {
      found = i;
      n_found++;
    }
  }
  return n_found > 1 ? -2 : found;
}

static const char *not_one(int found) {
  return found == -2 ? "several inputs have this name" : "it is none of the inputs";
}

/* The text of conic_source_options.place. */
static int settle_places(const cli_session *session, cli_render_job *job) {
  size_t used = 0;
  for (int k = 0; k < job->n_places; k++) {
    const char *text = job->places[k], *equals = strrchr(text, '=');
    const int i = find_input(job, text, (size_t)(equals - text));
    if (i < 0)
      return cli_usage("%s: --place %.*s: %s", session->command, (int)(equals - text), text, not_one(i));
    used += (size_t)snprintf(job->place + used, CLI_PLACE_ROOM - used, "%s%d:%s", k ? ";" : "", i, equals + 1);
    if (used >= CLI_PLACE_ROOM)
      return cli_usage("%s: --place has too many digits", session->command);
  }
  if (job->n_places)
    job->opening.place = job->place;
  return CLI_DONE;
}

static int settle_roles(const cli_session *session, const cli_render_job *job, const char *option,
                        const char *const *names, int n, uint64_t *inputs) {
  for (int k = 0; k < n; k++) {
    const int i = find_input(job, names[k], strlen(names[k]));
    if (i < 0)
      return cli_usage("%s: --%s %s: %s", session->command, option, names[k], not_one(i));
    if (i >= 53)
      return cli_usage("%s: --%s %s: it is none of the first 53 inputs", session->command, option, names[k]);
    *inputs |= 1ull << i;
  }
  return CLI_DONE;
}

/* Gaussian scenes with surfaces among them. */
static int takes_both(const char *command) {
  return strcmp(command, "verify") == 0 || strcmp(command, "judge") == 0 || strcmp(command, "explain") == 0 ||
         strcmp(command, "gradient") == 0;
}

int cli_scene_check(const cli_session *session, cli_scene_words *words, cli_render_job *job) {
  int answer = check_each_value(session, words, job);
  if (job->n_inputs == 0)
    return answer;
  if (answer == CLI_DONE)
    answer = settle_top(session, job);
  if (answer == CLI_DONE)
    answer = check_colors(session, words, job);
  if (answer == CLI_DONE)
    answer = settle_places(session, job);
  if (answer == CLI_DONE)
    answer = settle_roles(session, job, "catcher", job->catchers, job->n_catchers, &job->shot.catchers);
  if (answer == CLI_DONE)
    answer = settle_roles(session, job, "holdout", job->holdouts, job->n_holdouts, &job->shot.holdouts);
  if (answer != CLI_DONE)
    return answer;
  job->is_every_view = cli_views_are_all(job->view_name);
  job->opening.as = job->is_patch ? CONIC_AS_PATCHES : (conic_representation)words->as;
  job->opening.is_whole = words->is_colored_whole;
  job->abilities = cli_kept_abilities(session, job->inputs, (size_t)job->n_inputs, &job->opening);
  if (job->opening.most_raw && job->abilities & CONIC_SOURCE_STREAMS && !job->budget && job->shot.view.error_px == 0.0)
    job->shot.view.error_px = 2.0; /* --quality sketch */
  if (job->abilities & CONIC_SOURCE_COMPOSITES)
    cli_backdrop_settle(job);
  if (job->abilities & CONIC_SOURCE_CLUSTERS) /* of which any part may be drawn, unless --memory says less */
    job->access.memory_bytes = 0;
  job->opening.is_whole =
      !cli_lod_is_wanted(job) && !job->boxes_path && !(job->is_for_looking && job->abilities & CONIC_SOURCE_STREAMS);
  answer = cli_effects_check(session, words, job);
  if (answer == CLI_DONE && job->abilities & CONIC_SOURCE_MIXES && !job->is_for_looking &&
      !takes_both(session->command))
    answer = cli_usage("%s: it is of Gaussians, or of surfaces: leave the others out; conic render, verify, judge, "
                       "explain and gradient take both",
                       session->command);
  if (answer == CLI_DONE && job->shot.planes >> CONIC_PLANE_BOUND & 1 &&
      (job->shot.n_samples || job->progressive_path || !(job->shot.view.error_px > 0.0 || job->budget)))
    answer = cli_usage("%s: --aov bound is of pictures by --error or --budget, without --accumulate and --progressive",
                       session->command);
  job->shot.view.is_alone &=
      job->shot.view.error_px > 0.0 && !job->opening.cache && !(job->effects.asked & CLI_DRAWS_MORE);
  if (answer == CLI_DONE && job->abilities & CONIC_SOURCE_CLUSTERS && job->n_inputs != 1)
    answer = cli_usage("%s: a hybrid is drawn by itself, and made of one file", session->command);
  return answer == CLI_DONE ? cli_device_check(session, &job->device) : answer;
}

void cli_transparency_settle(cli_render_job *job) {
  if (!job->is_transparent)
    return;
  job->shot.view.transparency = CONIC_TRANSPARENCY_LAYERS;
  job->opening.keeps_alpha = 1;
}

int cli_scene_inputs_stay(const cli_session *session, const cli_render_job *job, const char *const *outputs,
                          int n_outputs) {
  const char *const beside[] = {job->camera_path, job->opening.texture_path, job->accumulating.motion_path};
  int answer = cli_check_inputs_stay(session, job->inputs, job->n_inputs, outputs, n_outputs);
  return answer == CLI_DONE ? cli_check_inputs_stay(session, beside, 3, outputs, n_outputs) : answer;
}
