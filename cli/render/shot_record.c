#include "cli/render/shot_record.h"

#include "cli/render/frames.h"
#include "cli/scene/background_options.h"
#include "shots/shot_key.h"

void cli_shot_settle(const cli_render_job *job, conic_shot *shot) {
  *shot = job->shot;
  shot->planes &= ~job->unwritten_planes;
  if (shot->n_samples && shot->aperture.diameter > 0.0 && job->accumulating.focus_depth > 0.0) { /* it is found */
    shot->focus_kind = CONIC_FOCUS_DEPTH;
    shot->aperture.focus = job->accumulating.focus_depth;
  }
  if (job->top.is_wanted) /* what is drawn beside it is in no file */
    shot->planes = job->is_aov_given ? job->asked_planes : 1u << CONIC_PLANE_RGBA;
  if (!job->accumulating.motion_path)
    shot->frame = 0.0;
}

static void record_map(const cli_render_job *job, conic_shot_map *map) {
  const cli_top_job *top = &job->top;
  if (!top->is_wanted)
    return;
  map->is_wanted = 1;
  map->epsg = top->epsg;
  map->pixel = top->gsd;
  memcpy(map->minimum, top->box.low, sizeof map->minimum);
  memcpy(map->maximum, top->box.high, sizeof map->maximum);
}

void cli_shot_writing(const cli_render_job *job, conic_shot_writing *writing) {
  int is_display = (job->abilities & CONIC_SOURCE_COMPOSITES) != 0;
  writing->tone = is_display ? CONIC_TONE_SRGB : (conic_tone)job->tone;
  writing->compression = job->writing.compression;
  writing->is_half = job->writing.is_half;
  writing->is_bare = !cli_backdrop_is_studio(job);
  writing->has_legend = job->has_legend;
  writing->has_mattes = job->has_mattes;
  writing->matte_by = job->matte_by;
}

static conic_shot_names names_of(const cli_render_job *job) {
  return (conic_shot_names){.scene = job->inputs,
                            .n_scene = (size_t)job->n_inputs,
                            .texture = job->opening.texture_path,
                            .sky = job->sky_path,
                            .motion = job->accumulating.motion_path};
}

static conic_status find_inputs(cli_session *session, cli_render_job *job) {
  const conic_shot_names names = names_of(job);
  if (job->making.has_inputs)
    return CONIC_OK;
  job->making.has_inputs = 1;
  return conic_shot_inputs_find(session->context, &names, &job->making.inputs);
}

conic_status cli_shot_record(cli_session *session, cli_render_job *job, conic_shot_file *file) {
  conic_shot_file_init(file);
  cli_shot_settle(job, &file->shot);
  file->reading = job->opening;
  record_map(job, &file->map);
  cli_shot_writing(job, &file->writing);
  conic_shot_file_plain(file, job->abilities);
  conic_status status = find_inputs(session, job);
  file->inputs = job->making.inputs.inputs;
  file->n_inputs = job->making.inputs.n;
  return status;
}

/* --- keys --- */

static void add_path(conic_sha256 *sum, const char *path) {
  while (path && path[0] == '.' && path[1] == '/')
    path += 2;
  conic_key_add_text(sum, path ? path : "");
}

/* What the frames become. */
static void add_products(conic_sha256 *sum, const cli_render_job *job) {
  const char *const beside[] = {job->deep_path,  job->overdraw_path, job->clusters_path,
                                job->boxes_path, job->legend_path,   job->making.save_path};
  for (int i = 0; i < job->n_outputs; i++)
    add_path(sum, job->outputs[i]);
  for (size_t i = 0; i < sizeof beside / sizeof *beside; i++)
    add_path(sum, beside[i]);
  add_path(sum, job->writing.format);
  conic_key_add_number(sum, (uint64_t)job->is_overdraw_confetti);
  conic_key_add_number(sum, (uint64_t)(job->boxes_path ? job->box_level : 0));
  conic_key_add_number(sum, (uint64_t)job->making.is_left_out);
}

/* Which frames there are, beside the first; and what ends them early. */
static void add_frames(const cli_render_job *job, conic_sha256 *sum) {
  conic_shot_file file;
  conic_key_add_number(sum, (uint64_t)job->n_frames);
  conic_key_add_number(sum, (uint64_t)job->is_turntable);
  for (size_t i = 0; job->is_every_view && i < job->cameras.count; i++) {
    conic_shot_file_init(&file);
    file.shot.camera = job->cameras.cameras[i];
    conic_key_add_text(sum, job->cameras.names[i]);
    conic_key_add_fields(sum, &file, "camera.");
  }
  conic_key_add_real(sum, job->stereo.distance);
  conic_key_add_real(sum, job->accumulating.seconds);
  conic_key_add_real(sum, job->deadline);
}

conic_status cli_shot_kept_key(cli_session *session, cli_render_job *job, char key[CONIC_SHA256_ROOM]) {
  conic_sha256 sum;
  conic_shot_file file;
  conic_status status = cli_shot_record(session, job, &file);
  conic_sha256_begin(&sum);
  conic_key_add_text(&sum, conic_version());
  conic_key_add_fields(&sum, &file, NULL);
  conic_key_add_fields(&sum, &file, "writing.");
  add_frames(job, &sum);
  conic_key_add_inputs(&sum, &file);
  add_products(&sum, job);
  conic_sha256_end(&sum, key);
  return status;
}

conic_status cli_shot_report(cli_session *session, cli_json *json, cli_render_job *job) {
  conic_shot_file file;
  char key[CONIC_SHOT_KEY_ROOM];
  if (session->host)
    return CONIC_OK;
  conic_status status = cli_shot_record(session, job, &file);
  if (status == CONIC_OK)
    status = conic_shot_file_key(session->context, &file, key);
  if (status == CONIC_OK)
    cli_json_text(json, "shot_key", key);
  return status;
}

/* Whether any file that is written can say how it was made. */
static int is_carried(const cli_session *session, const cli_render_job *job) {
  static const char *const endings[] = {"exr", "png", "tif", "tiff", NULL};
  int n = job->deep_path || job->progressive_path;
  for (int i = 0; i < job->n_outputs; i++)
    n += cli_output_is_one_of(job, job->outputs[i], endings);
  return n > 0 && !job->making.is_left_out && !session->host;
}

conic_status cli_shot_begin_inputs(cli_session *session, cli_render_job *job) {
  const conic_shot_names names = names_of(job);
  int is_wanted = is_carried(session, job) || (session->json_path && !session->host) || job->making.save_path;
  return is_wanted && cli_session_speaks(session)
             ? conic_shot_inputs_begin(session->context, &names, &job->making.inputs)
             : CONIC_OK;
}

static void release_texts(cli_session *session, cli_shot_job *making) {
  conic_shot_text_release(session->context, making->text);
  conic_shot_text_release(session->context, making->shown_text);
  making->text = making->shown_text = NULL;
}

/* A file says what decides itself: so files that are the same say the same. */
conic_status cli_shot_describe(cli_session *session, cli_render_job *job) {
  conic_shot_file file;
  release_texts(session, &job->making);
  if (!is_carried(session, job))
    return CONIC_OK;
  conic_status status = cli_shot_record(session, job, &file);
  const conic_shot_writing writing = file.writing;
  file.writing.tone = CONIC_TONE_SRGB;
  file.writing.is_bare = 0;
  if (status == CONIC_OK)
    status = conic_shot_file_print(session->context, &file, CONIC_SHOT_IN_PICTURE, &job->making.text);
  file.writing = writing;
  file.writing.compression = CONIC_COMPRESSION_ZIP;
  file.writing.is_half = file.writing.has_mattes = 0;
  file.writing.matte_by = NULL;
  if (status == CONIC_OK)
    status = conic_shot_file_print(session->context, &file, CONIC_SHOT_IN_PICTURE, &job->making.shown_text);
  return status;
}

/* OUT.shot.json becomes OUT.0001.shot.json. */
static char *name_shot(const cli_render_job *job, int i_frame) {
  static const char ending[] = ".shot.json";
  const char *path = job->making.save_path;
  size_t n = strlen(path), n_ending = sizeof ending - 1;
  if (n <= n_ending || strcmp(path + n - n_ending, ending) != 0)
    return cli_frame_name(job, path, i_frame);
  char *stem = malloc(n + 1), *name, *whole = NULL;
  if (!stem)
    return NULL;
  snprintf(stem, n + 1, "%.*s.json", (int)(n - n_ending), path);
  name = cli_frame_name(job, stem, i_frame);
  if (name && (whole = realloc(name, strlen(name) + n_ending + 1)))
    memcpy(whole + strlen(whole) - strlen(".json"), ending, sizeof ending);
  else
    free(name);
  free(stem);
  return whole;
}

conic_status cli_shot_save(cli_session *session, cli_render_job *job, int i_frame) {
  conic_shot_file file;
  if (!job->making.save_path)
    return CONIC_OK;
  char *path = name_shot(job, i_frame);
  conic_status status = path ? cli_shot_record(session, job, &file) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_shot_file_write(session->context, &file, path);
  free(path);
  return status;
}

void cli_shot_release(cli_session *session, cli_render_job *job) {
  conic_shot_inputs_release(session->context, &job->making.inputs);
  release_texts(session, &job->making);
}
