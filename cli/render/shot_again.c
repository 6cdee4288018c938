#include "cli/render/shot_again.h"

#include "cli/render/shot_record.h"
#include "cli/scene/scene_options.h"
#include "core/files/disk.h"
#include "core/files/file.h"

struct cli_shot_again {
  conic_context *context; /* of the shot; the session's is not open yet */
  conic_shot_file *file;
  const char *path; /* of what was named */
  int argc;         /* what the user said */
  char **argv;
  cli_scene_words words; /* and what the shot says of options that mean something together */
  const char **scene;    /* where the inputs are */
  size_t n_scene;
  const char *texture, *sky, *motion;
  char **paths; /* all of these, to be released */
  size_t n_paths;
  int holds_all; /* the outputs hold any plane */
  int has_camera, is_checked;
};

/* --- what the user said --- */

static int gives(const cli_shot_again *again, const char *name) {
  size_t n = strlen(name);
  for (int i = 1; i < again->argc && strcmp(again->argv[i], "--") != 0; i++) {
    const char *argument = again->argv[i] + 2;
    if (strncmp(again->argv[i], "--", 2) == 0 && strncmp(argument, name, n) == 0 &&
        (argument[n] == '\0' || argument[n] == '='))
      return 1;
  }
  return 0;
}

static int gives_one(const cli_shot_again *again, const char *const *names) {
  for (; *names; names++)
    if (gives(again, *names))
      return 1;
  return 0;
}

static const char *const framing_options[] = {"azimuth", "elevation", "fov", "zoom", "projection", "eye", "up", NULL};

/* --- inputs --- */

static char *keep_path(cli_shot_again *again, const char *path, size_t n_folder, const char *name) {
  char **paths = realloc(again->paths, (again->n_paths + 1) * sizeof *paths);
  size_t room = n_folder + strlen(name) + 1;
  char *kept = paths ? malloc(room) : NULL;
  if (paths)
    again->paths = paths;
  if (kept) {
    snprintf(kept, room, "%.*s%s", (int)n_folder, path, name);
    again->paths[again->n_paths++] = kept;
  }
  return kept;
}

typedef struct looking_for {
  const conic_shot_input *input;
  char *found, *changed;    /* where it is, or what has its name */
  conic_shot_input instead; /* the latter */
} looking_for;

/* Of a URL there is but the length, and of what it holds else nobody knows. */
static int is_same_input(const conic_shot_input *is, const conic_shot_input *was) {
  return strcmp(is->sha256, was->sha256) == 0 && is->is_sampled == was->is_sampled &&
         (!was->n_bytes || is->n_bytes == was->n_bytes);
}

static conic_status look_at_place(cli_shot_again *again, char *path, looking_for *looking) {
  conic_shot_input input = {.name = path};
  conic_disk_entry entry;
  if (!path)
    return CONIC_ERROR_MEMORY;
  if (looking->found || !conic_disk_look(path, &entry))
    return CONIC_OK;
  conic_status status = conic_shot_input_look(again->context, path, &input);
  if (status == CONIC_OK && is_same_input(&input, looking->input))
    looking->found = path;
  else if (status == CONIC_OK && !looking->changed) {
    looking->changed = path;
    looking->instead = input;
  }
  return status;
}

/* Whether a shot may lead to where its input's name says. Who wrote a shot as a file means so; a picture may come from
 * anybody, and leads to what lies below its folder. */
static int may_lead_to(const cli_shot_again *again, const char *name) {
  int is_below = !conic_disk_is_absolute(name);
  for (const char *part = name; is_below && part; part = strchr(part, '/')) {
    part += *part == '/';
    is_below = strncmp(part, "..", 2) != 0 || (part[2] && part[2] != '/');
  }
  return is_below || conic_shot_is_file(again->path);
}

/* Among the inputs that were given, by its name; beside the shot; in the folder that one is in. */
static conic_status look_for_input(cli_shot_again *again, const cli_render_job *first, looking_for *looking) {
  const char *name = looking->input->name, *base = conic_file_name(name);
  size_t n_folder = (size_t)(conic_file_name(again->path) - again->path);
  conic_status status = CONIC_OK;
  for (int i = 0; i < first->n_inputs && status == CONIC_OK; i++)
    if (strcmp(conic_file_name(first->inputs[i]), base) == 0)
      status = look_at_place(again, keep_path(again, "", 0, first->inputs[i]), looking);
  int may_lead = may_lead_to(again, name);
  if (status == CONIC_OK && may_lead && !conic_disk_is_absolute(name))
    status = look_at_place(again, keep_path(again, again->path, n_folder, name), looking);
  if (status == CONIC_OK && may_lead)
    status = look_at_place(again, keep_path(again, "", 0, name), looking);
  if (status == CONIC_OK)
    status = look_at_place(again, keep_path(again, again->path, n_folder, base), looking);
  return status == CONIC_OK ? look_at_place(again, keep_path(again, "", 0, base), looking) : status;
}

static int tell_changed(const cli_shot_again *again, const char *name, const conic_shot_input *was,
                        const conic_shot_input *is) {
  if (strcmp(was->sha256, is->sha256) != 0)
    return cli_error(CLI_INPUT, "%s: it has changed: %s was drawn from %.12s…, and this is %.12s…", name, again->path,
                     was->sha256, is->sha256);
  return cli_error(CLI_INPUT, "%s: it has changed: %s was drawn from %llu bytes, and this has %llu", name, again->path,
                   (unsigned long long)was->n_bytes, (unsigned long long)is->n_bytes);
}

static int find_input(cli_shot_again *again, const cli_render_job *first, const conic_shot_input *input,
                      const char **path) {
  looking_for looking = {.input = input};
  *path = input->name;
  if (conic_layers_is_url(input->name))
    return CLI_DONE;
  if (!*input->sha256)
    return cli_error(CLI_INPUT, "%s: %s was drawn from what cannot be read again", input->name, again->path);
  conic_status status = look_for_input(again, first, &looking);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  *path = looking.found;
  if (looking.found)
    return CLI_DONE;
  if (looking.changed)
    return tell_changed(again, looking.changed, input, &looking.instead);
  return cli_error(CLI_INPUT,
                   "%s: it is not there, and %s was drawn from it; it was looked for beside that, here, and among the "
                   "inputs",
                   input->name, again->path);
}

static int find_again_inputs(cli_shot_again *again, const cli_render_job *first) {
  const conic_shot_file *file = again->file;
  int answer = CLI_DONE;
  again->scene = calloc(file->n_inputs + 1, sizeof *again->scene);
  if (!again->scene)
    return cli_error(CLI_RESOURCE, "render: out of memory");
  for (size_t i = 0; i < file->n_inputs && answer == CLI_DONE; i++) {
    const conic_shot_input *input = &file->inputs[i];
    if (input->role == CONIC_SHOT_SCENE)
      answer = find_input(again, first, input, &again->scene[again->n_scene++]);
    else if (input->role == CONIC_SHOT_TEXTURE && !gives(again, "texture"))
      answer = find_input(again, first, input, &again->texture);
    else if (input->role == CONIC_SHOT_SKY && !gives(again, "sky"))
      answer = find_input(again, first, input, &again->sky);
    else if (input->role == CONIC_SHOT_MOTION && !gives(again, "motion"))
      answer = find_input(again, first, input, &again->motion);
  }
  if (answer == CLI_DONE && again->n_scene == 0)
    answer = cli_error(CLI_INPUT, "%s: it says of no input that it was drawn from", again->path);
  return answer;
}

/* Inputs that were given say where its own are, and nothing else. */
static int check_given(const cli_shot_again *again, const cli_render_job *first) {
  if (first->view_name && !first->camera_path && !first->is_view_side)
    return cli_usage("render: --view is of a file of cameras, and a shot has one; give --camera, too");
  for (int i = 0; i < first->n_inputs; i++) {
    int is_named = strcmp(first->inputs[i], again->path) == 0;
    for (size_t j = 0; j < again->file->n_inputs && !is_named; j++)
      is_named = strcmp(conic_file_name(first->inputs[i]), conic_file_name(again->file->inputs[j].name)) == 0;
    if (!is_named)
      return cli_usage("%s: %s was not drawn from it; what is given beside a shot says where its inputs are",
                       first->inputs[i], again->path);
  }
  return CLI_DONE;
}

/* --- reading --- */

static void tell_of_shot(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  if (level == CONIC_LOG_ERROR)
    cli_error(CLI_INPUT, "%s", message);
}

static int read_named_shot(cli_shot_again *again) {
  conic_context_options options;
  conic_context_options_init(&options);
  options.log = tell_of_shot;
  options.threads = 1;
  conic_status status = conic_context_create(&options, &again->context);
  if (status == CONIC_OK)
    status = conic_shot_file_read(again->context, again->path, &again->file);
  return cli_exit_of(status);
}

int cli_shot_again_parse(cli_session *session, int argc, char **argv, cli_render_parser *parse, cli_render_job *job) {
  cli_shot_again *again = calloc(1, sizeof *again);
  cli_render_job first = *job;
  int answer = again ? CLI_DONE : CLI_RESOURCE;
  if (!again)
    cli_error(answer, "render: out of memory");
  if (answer == CLI_DONE) {
    again->argc = argc;
    again->argv = argv;
    again->path = first.making.again_path;
    for (int i = 0; i < first.n_inputs && !again->path; i++)
      if (conic_shot_is_file(first.inputs[i]))
        again->path = first.inputs[i];
    answer = read_named_shot(again);
  }
  if (answer == CLI_DONE)
    answer = check_given(again, &first);
  if (answer == CLI_DONE)
    answer = find_again_inputs(again, &first);
  if (answer == CLI_DONE) {
    int is_reframed = gives_one(again, framing_options) || first.is_view_side;
    again->has_camera =
        again->file->shot.camera.width && !again->file->map.is_wanted && !is_reframed && !gives(again, "camera");
    if (is_reframed && !again->file->map.is_wanted && !gives(again, "camera"))
      cli_note(session, "%s: the scene is framed anew; what is not said of the camera is as without a shot",
               again->path);
    again->holds_all = first.n_outputs == 0;
    for (int i = 0; i < first.n_outputs; i++)
      again->holds_all |=
          conic_file_has_ending(first.outputs[i], "exr") || conic_file_has_ending(first.outputs[i], "pfm");
    session->again = again;
    answer = parse(session, argc, argv, job);
    session->again = NULL;
  } else
    memset(job, 0, sizeof *job);
  free(first.inputs);
  if (answer == CLI_DONE)
    job->making.again = again;
  else
    cli_shot_again_release(session, again);
  return answer;
}

void cli_shot_again_release(cli_session *session, cli_shot_again *again) {
  (void)session;
  if (!again)
    return;
  if (again->context)
    conic_shot_file_destroy(again->context, again->file);
  conic_context_destroy(again->context);
  for (size_t i = 0; i < again->n_paths; i++)
    free(again->paths[i]);
  free(again->paths);
  free(again->scene);
  free(again);
}

/* --- values --- */

static void begin_accumulation(const conic_shot *shot, cli_accumulate_job *own) {
  own->n_samples = shot->n_samples;
  own->noise = shot->noise;
  own->width = (cli_length){shot->aperture.diameter, 0};
  own->n_blades = shot->aperture.n_blades;
  own->focus = (cli_focus){.kind = (int)shot->focus_kind, .depth = shot->aperture.focus};
  memcpy(own->focus.pixel, shot->focus_pixel, sizeof own->focus.pixel);
  own->is_shutter_given = shot->is_shutter_open;
  memcpy(own->shutter, shot->shutter, sizeof own->shutter);
}

static void begin_light(const cli_shot_again *again, cli_render_job *job) {
  const conic_shot *shot = &again->file->shot;
  job->is_sky_given = 1;
  job->sky_path = again->sky;
  job->n_directions = (int)shot->light.n_directions;
  job->has_shadows = shot->light.has_shadows;
  if (gives(again, "light")) {
    job->shot.render.lighting.n_lights = 0;
    return;
  }
  job->is_light_given = 1;
  job->lamps.n_lamps = shot->light.n_lamps;
  memcpy(job->lamps.lamps, shot->light.lamps, sizeof job->lamps.lamps);
  memcpy(job->lamps.sun_radius_deg, shot->light.sun_radius_deg, sizeof job->lamps.sun_radius_deg);
}

/* What is drawn where nobody asks for planes. */
enum { USUAL_PLANES = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z };

/* The planes that the outputs can hold: what an EXR has in it does not keep a PNG from being made. */
static unsigned planes_for(const cli_shot_again *again, unsigned planes) {
  enum { LOOKED_AT = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO };
  planes &= ~(unsigned)CONIC_MATTE_PLANES;
  return again->holds_all || planes == USUAL_PLANES || !(planes & LOOKED_AT) ? planes : planes & LOOKED_AT;
}

static void begin_reading(const cli_shot_again *again, cli_render_job *job) {
  const conic_source_options *reading = &again->file->reading;
  job->opening.n_neighbours = reading->n_neighbours;
  job->opening.columns = reading->columns;
  job->opening.colors_are = reading->colors_are;
  job->opening.where = reading->where;
  job->opening.place = reading->place;
  job->opening.most_raw = reading->most_raw;
  job->opening.texture_path = again->texture;
  if (!reading->coloring)
    return;
  job->coloring = *reading->coloring;
  const double *up = reading->coloring->up;
  if (up[0] != 0.0 || up[1] != 0.0 || up[2] != 0.0) {
    job->is_up_given = 1;
    memcpy(job->framing.up, up, sizeof job->framing.up);
  }
}

/* What the shot says of options that mean something together, where the user says nothing of it. */
static const cli_scene_words *choose_words(cli_shot_again *again) {
  const conic_shot *shot = &again->file->shot;
  const conic_source_options *reading = &again->file->reading;
  int composites = reading->gaussians != NULL, is_plain = !reading->finds_dots;
  int is_patch = reading->as == CONIC_AS_PATCHES;
  cli_scene_words *words = &again->words;
  *words = (cli_scene_words){.quality = CLI_QUALITY_GOOD,
                             .passes = shot->render.passes,
                             .method = is_patch ? CONIC_N_METHODS : (int)shot->render.method,
                             .degree = reading->patches ? reading->patches->surface.degree : 3,
                             .cutoff = (double)shot->render.kernel.cutoff,
                             .prefilter = (double)shot->render.prefilter,
                             .usual_as = is_patch ? CONIC_AS_AUTO : (int)reading->as,
                             .usual_crease_deg = reading->crease_deg};
  words->is_method_given = (is_patch || !composites) && !gives(again, "quality");
  words->is_samples_given = !gives(again, "quality") && !gives(again, "accumulate") && shot->n_samples == 0;
  words->is_smooth = reading->is_smooth && !gives(again, "crease");
  if (is_patch && reading->patches && !gives(again, "method"))
    words->h = (cli_length){reading->patches->surface.h, reading->h_in_spacings};
  if (gives(again, "profile"))
    return words;
  words->profile = composites ? (int)shot->gaussians.profile : CONIC_N_GAUSSIAN_PROFILES;
  words->is_profile_given = composites && (is_plain || shot->gaussians.profile != CONIC_PROFILE_EXACT);
  words->ignores_center = shot->gaussians.ignores_center != 0;
  words->is_prefilter_given = shot->gaussians.prefilter > 0.0;
  if (words->is_prefilter_given)
    words->prefilter = shot->gaussians.prefilter;
  return words;
}

static void begin_map(const conic_shot_map *map, cli_top_job *top) {
  if (!map->is_wanted)
    return;
  top->gsd = map->pixel;
  top->epsg = map->epsg;
  memcpy(top->box.low, map->minimum, sizeof top->box.low);
  memcpy(top->box.high, map->maximum, sizeof top->box.high);
}

static void begin_writing(const conic_shot_writing *writing, cli_render_job *job) {
  job->tone = (int)writing->tone;
  job->writing.is_half = writing->is_half;
  job->writing.compression = writing->compression;
  job->has_legend = writing->has_legend;
  job->has_mattes = writing->has_mattes;
  job->matte_by = writing->matte_by;
  job->is_background_given = writing->is_bare;
}

void cli_shot_again_begin(cli_session *session, cli_render_job *job) {
  cli_shot_again *again = session->again;
  if (!again)
    return;
  const conic_shot *shot = &again->file->shot;
  const int is_map = again->file->map.is_wanted;
  job->shot = *shot;
  job->shot.render.epsilon = -1.0;
  job->shot.render.splat_length = 0.0; /* the source says it again */
  job->epsilon = (cli_length){shot->render.epsilon >= 0.0 ? shot->render.epsilon : -1.0, 0};
  if (gives(again, "accumulate")) /* which places its samples itself */
    job->shot.view.samples = 1;
  job->budget = shot->view.budget;
  job->is_transparent = shot->view.transparency != CONIC_TRANSPARENCY_NONE;
  job->is_plain = !again->file->reading.finds_dots;
  job->shot.planes = planes_for(again, shot->planes);
  job->is_aov_given = job->shot.planes != (is_map ? 1u << CONIC_PLANE_RGBA : USUAL_PLANES);
  if (!job->is_aov_given)
    job->shot.planes = USUAL_PLANES;
  job->is_shade_given = 1;
  job->camera_path = is_map ? "top" : again->has_camera ? again->path : NULL;
  if (!again->has_camera)
    job->projection = (int)shot->camera.kind;
  job->framing.width = shot->camera.width ? shot->camera.width : job->framing.width;
  job->framing.height = shot->camera.height ? shot->camera.height : job->framing.height;
  job->accumulating.motion_path = again->motion;
  job->making.scene = again->scene;
  job->making.n_scene = (int)again->n_scene;
  job->making.words = choose_words(again);
  begin_accumulation(shot, &job->accumulating);
  begin_light(again, job);
  begin_reading(again, job);
  begin_map(&again->file->map, &job->top);
  begin_writing(&again->file->writing, job);
}

/* What a camera sees stays as large, for the picture's shorter side; of another shape more or less is seen at the
 * longer one. Directions all around have one shape. */
static int resize_camera(const cli_shot_again *again, int width, int height, conic_camera *camera) {
  const double was[2] = {camera->width, camera->height}, is[2] = {width, height};
  const double scale = fmin(width, height) / fmin(camera->width, camera->height);
  if (fabs(is[0] * was[1] - is[1] * was[0]) <= fmax(was[0], was[1])) { /* but for a pixel's part the same shape */
    conic_camera_resize(camera, width, height);
    return 1;
  }
  if (camera->kind == CONIC_CAMERA_EQUIRECTANGULAR || camera->kind == CONIC_CAMERA_CUBE)
    return cli_usage("render: --size %dx%d would stretch %s, which looks all around, by %d x %d", width, height,
                     again->path, camera->width, camera->height) == CLI_DONE;
  camera->width = width;
  camera->height = height;
  camera->cx = 0.5 * is[0] + scale * (camera->cx - 0.5 * was[0]);
  camera->cy = 0.5 * is[1] + scale * (camera->cy - 0.5 * was[1]);
  camera->fx *= scale;
  camera->fy *= scale;
  return 1;
}

conic_status cli_shot_again_take_camera(cli_render_job *job, int *is_taken) {
  const cli_shot_again *again = job->making.again;
  const int *size = job->camera_size;
  *is_taken = again && again->has_camera;
  if (!*is_taken)
    return CONIC_OK;
  job->camera = again->file->shot.camera;
  return !size[0] || resize_camera(again, size[0], size[1], &job->camera) ? CONIC_OK : CONIC_ERROR_ARGUMENT;
}

/* --- what no option says --- */

static void fill_lighting(const cli_shot_again *again, conic_shot *shot) {
  const conic_lighting *was = &again->file->shot.render.lighting;
  conic_lighting *lighting = &shot->render.lighting;
  lighting->is_given = was->is_given;
  if (!gives(again, "light")) {
    lighting->n_lights = was->n_lights;
    memcpy(lighting->lights, was->lights, sizeof lighting->lights);
    memcpy(shot->light.lamps, again->file->shot.light.lamps, sizeof shot->light.lamps);
  }
  if (!gives(again, "sky")) {
    memcpy(lighting->sky, was->sky, sizeof lighting->sky);
    memcpy(lighting->ground, was->ground, sizeof lighting->ground);
  }
  int has_up = was->up[0] != 0.0 || was->up[1] != 0.0 || was->up[2] != 0.0;
  if (again->has_camera && has_up && !gives(again, "up"))
    memcpy(lighting->up, was->up, sizeof lighting->up);
}

static const conic_shot_input *find_recorded(const conic_shot_input *inputs, size_t n, const conic_shot_input *part) {
  for (size_t i = 0; i < n; i++)
    if (inputs[i].role == part->role && strcmp(inputs[i].name, part->name) == 0)
      return &inputs[i];
  return NULL;
}

conic_status cli_shot_again_check(cli_session *session, cli_render_job *job) {
  cli_shot_again *again = job->making.again;
  conic_shot_file now;
  if (!again || again->is_checked)
    return CONIC_OK;
  conic_status status = cli_shot_record(session, job, &now);
  again->is_checked = 1;
  for (size_t i = 0; i < again->file->n_inputs && status == CONIC_OK; i++) {
    const conic_shot_input *was = &again->file->inputs[i];
    const conic_shot_input *is = find_recorded(now.inputs, now.n_inputs, was);
    int is_led_to = was->role == CONIC_SHOT_PART, is_url = conic_layers_is_url(was->name); /* the others were found */
    if ((!is_led_to && !is_url) || (is && is_same_input(is, was)))
      continue;
    if (is)
      tell_changed(again, was->name, was, is);
    else if (!gives(again, "texture") && !gives(again, "as") && !gives(again, "motion"))
      cli_error(CLI_INPUT, "%s: it was not read, and %s was drawn from it", was->name, again->path);
    else
      continue;
    status = CONIC_ERROR_INPUT;
  }
  return status;
}

void cli_shot_again_fill(cli_render_job *job) {
  static const char *const moving[] = {"turntable", "stereo", "camera", NULL};
  const cli_shot_again *again = job->making.again;
  conic_shot *shot = &job->shot;
  if (!again)
    return;
  const conic_shot *was = &again->file->shot;
  if (again->has_camera && !gives_one(again, moving)) {
    shot->way = was->way;
    shot->eye = was->eye;
    if (!gives(again, "near"))
      shot->render.near_z = was->render.near_z;
  }
  if (!job->is_turntable)
    shot->frame = was->frame;
  if (!gives(again, "prefilter") && !(gives(again, "accumulate") && was->n_samples == 0)) /* whose samples are it */
    shot->render.prefilter = was->render.prefilter;
  fill_lighting(again, shot);
}
