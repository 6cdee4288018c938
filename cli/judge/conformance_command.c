/* conic conformance: writes a suite with which any renderer of Gaussian scenes can be judged (docs/reference/
 * conformance.md). */

#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/judge/khr_assets.h"
#include "cli/judge/suite_planes.h"
#include "cli/outputs.h"
#include "core/files/disk.h"
#include "core/files/file.h"

enum { MOST_CASES = 1024, MOST_ASSETS = 128 };

typedef struct suite_case {
  const suite_scene *scene;
  int profile;       /* one of the suite's */
  size_t n_doubtful; /* pixels */
} suite_case;

typedef struct conformance_job {
  cli_build base;
  suite_files *files;
  const char *profile_list;
  unsigned profiles; /* as bits */
  int floats;        /* 0: fast, 1: strict */
  int is_khr;        /* the Khronos pack, whose scenes these are */
  suite_scene assets[MOST_ASSETS];
  const suite_scene *scenes; /* that there are */
  int n_scenes;
  int most_level;
  int n_cases;
  suite_case cases[MOST_CASES];
  struct { /* for each scene of the table */
    size_t n_records;
    int sh_degree;
  } about[128];
} conformance_job;

enum { STAGE_SCENES, STAGE_BOUNDS, STAGE_WRITE };

static const char *const float_names[] = {"fast", "strict", NULL};

static conic_float_model model_of_job(const conformance_job *job) {
  conic_float_model model;
  conic_float_model_init(&model, job->floats ? CONIC_FLOATS_STRICT : CONIC_FLOATS_FAST);
  if (job->is_khr) /* the nodes' matrices are steps, too */
    model.setup_roundoff *= 4.0;
  return model;
}

static void name_case(const suite_case *one, char name[SUITE_PATH_ROOM]) {
  snprintf(name, SUITE_PATH_ROOM, "L%d-%s-%s", one->scene->level, one->scene->name,
           cli_suite_profile_name(one->profile));
}

/* --- the cases --- */

/* The first scene, which is looked at; a suite with all in both formats would be too large. */
static int has_exr(const suite_scene *scene) {
  return scene->asset || scene == cli_suite_scenes || scene->make_splats;
}

static int is_made(const conformance_job *job, const suite_scene *scene) {
  return cli_suite_profiles(scene) & job->profiles && scene->level <= job->most_level;
}

static conic_status write_case_planes(conformance_job *job, const suite_case *one, const suite_planes *planes) {
  suite_files *files = job->files;
  char name[SUITE_PATH_ROOM], path[2 * SUITE_PATH_ROOM], full[4096];
  name_case(one, name);
  conic_status status = CONIC_OK;
  if (has_exr(one->scene)) {
    snprintf(path, sizeof path, "expected/%s.exr", name);
    status = cli_suite_join(files->context, files->folder, path, full, sizeof full);
    if (status == CONIC_OK)
      status = cli_suite_write_exr(files->context, full, planes);
    if (status == CONIC_OK)
      status = cli_suite_add_file(files, path);
  }
  snprintf(path, sizeof path, "expected/%s.npy", name);
  if (status == CONIC_OK)
    status = cli_suite_join(files->context, files->folder, path, full, sizeof full);
  if (status == CONIC_OK)
    status = cli_suite_write_npy(files->context, full, planes);
  return status == CONIC_OK ? cli_suite_add_file(files, path) : status;
}

static conic_status bound_gaussians(conformance_job *job, const conic_gaussians *gaussians, suite_case *one,
                                    suite_planes *planes) {
  conic_context *context = job->files->context;
  const conic_float_model model = model_of_job(job);
  const size_t n_pixels = (size_t)planes->width * (size_t)planes->height;
  const int step = one->scene->step;
  const float *behind = one->scene->background;
  conic_gaussian_options options;
  conic_camera camera;
  conic_gaussian_options_init(&options);
  options.profile = (conic_gaussian_profile)one->profile;
  memcpy(options.background, behind, sizeof options.background);
  cli_suite_camera(one->scene, &camera);
  conic_gaussian_bound *bounds = conic_memory_allocate(context, n_pixels, sizeof *bounds);
  uint32_t *pixels = conic_memory_allocate(context, n_pixels, sizeof *pixels);
  for (size_t i = 0; pixels && i < n_pixels; i++)
    pixels[i] = (uint32_t)(cli_suite_judged_at((int)i / planes->width, step) * camera.width +
                           cli_suite_judged_at((int)i % planes->width, step));
  conic_status status = bounds && pixels ? conic_gaussian_bound_pixels(context, gaussians, &camera, &options, &model,
                                                                       pixels, n_pixels, bounds)
                                         : CONIC_ERROR_MEMORY;
  for (size_t i = 0; status == CONIC_OK && i < n_pixels; i++)
    one->n_doubtful += bounds[i].doubts > 0;
  if (status == CONIC_OK)
    status = cli_suite_take_bounds(context, bounds, behind[0] + behind[1] + behind[2] > 0.0f, planes);
  conic_memory_release_these(context, bounds, pixels);
  return status;
}

static conic_status bound_splats(conformance_job *job, const conic_splats *splats, suite_case *one,
                                 suite_planes *planes) {
  const conic_drawing drawing = {.splats = splats};
  conic_render_options options;
  conic_oracle_asking asking;
  conic_reference reference;
  conic_camera camera;
  conic_render_options_init(&options);
  options.method = CONIC_METHOD_CONIC;
  options.shading = CONIC_SHADE_NONE;
  conic_oracle_asking_init(&asking);
  asking.floats = job->floats ? CONIC_FLOATS_STRICT : CONIC_FLOATS_FAST;
  cli_suite_camera(one->scene, &camera);
  conic_status status =
      conic_oracle_render_asked(job->files->context, &drawing, &camera, &options, &asking, &reference);
  if (status != CONIC_OK)
    return status;
  one->n_doubtful = reference.unstable_pixels;
  status = cli_suite_take_reference(job->files->context, &reference, planes);
  conic_reference_release(job->files->context, &reference);
  return status;
}

static conic_status make_case(conformance_job *job, const suite_content *content, suite_case *one) {
  suite_planes planes = {.width = cli_suite_judged(one->scene->width, one->scene->step),
                         .height = cli_suite_judged(one->scene->height, one->scene->step)};
  double start = cli_seconds();
  conic_status status = one->profile == SUITE_SURFACE ? bound_splats(job, &content->model.points, one, &planes)
                                                      : bound_gaussians(job, &content->gaussians, one, &planes);
  job->base.stages[STAGE_BOUNDS].seconds += cli_seconds() - start;
  start = cli_seconds();
  if (status == CONIC_OK)
    status = write_case_planes(job, one, &planes);
  job->base.stages[STAGE_WRITE].seconds += cli_seconds() - start;
  conic_memory_release(job->files->context, planes.numbers);
  return status;
}

static conic_status make_suite_scene(conformance_job *job, int i_scene) {
  const suite_scene *scene = &job->scenes[i_scene];
  suite_content content;
  double start = cli_seconds();
  conic_status status = cli_suite_write_camera(job->files, scene);
  if (status == CONIC_OK)
    status = cli_suite_write_scene(job->files, scene, &content);
  job->base.stages[STAGE_SCENES].seconds += cli_seconds() - start;
  if (status != CONIC_OK)
    return status;
  job->about[i_scene].n_records = scene->make_splats ? content.model.points.count : content.gaussians.count;
  job->about[i_scene].sh_degree = content.gaussians.sh_degree;
  for (int p = 0; status == CONIC_OK && p < SUITE_PROFILES; p++)
    if (cli_suite_profiles(scene) & job->profiles & 1u << p) {
      suite_case *one = &job->cases[job->n_cases++];
      *one = (suite_case){scene, p, 0};
      status = make_case(job, &content, one);
    }
  cli_suite_release_content(job->files->context, &content);
  return status;
}

/* --- what describes them --- */

static void describe_floats(cli_json *json, const conformance_job *job) {
  const conic_float_model model = model_of_job(job);
  cli_json_object(json, "floats");
  cli_json_text(json, "name", float_names[job->floats]);
  cli_json_figures(json, NULL, {"exp_relative", model.exp_relative}, {"exp_by_argument", model.exp_by_argument},
                   {"setup_roundoff", model.setup_roundoff});
  cli_json_count(json, "form_roundings", (uint64_t)model.n_form_roundings);
  cli_json_close(json);
}

static void describe_words(cli_json *json, const char *key, const char *const *words, int n) {
  cli_json_array(json, key);
  for (int i = 0; i < n; i++)
    cli_json_text(json, NULL, words[i]);
  cli_json_close(json);
}

static void describe_path(cli_json *json, const char *key, const char *folder, const char *name, const char *ending) {
  char path[2 * SUITE_PATH_ROOM];
  snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
  cli_json_text(json, key, path);
}

static void describe_asset_path(cli_json *json, const khr_asset *asset) {
  char path[SUITE_PATH_ROOM];
  cli_khr_path(asset, path);
  cli_json_text(json, "gltf", path);
}

static void describe_scene(cli_json *json, const conformance_job *job, int i_scene) {
  const suite_scene *scene = &job->scenes[i_scene];
  cli_json_object(json, NULL);
  cli_json_text(json, "name", scene->name);
  cli_json_count(json, "level", (uint64_t)scene->level);
  cli_json_text(json, "about", scene->about);
  if (scene->asset)
    cli_json_text(json, "clause", scene->asset->clause);
  cli_json_count(json, "records", job->about[i_scene].n_records);
  cli_json_count(json, "sh_degree", (uint64_t)job->about[i_scene].sh_degree);
  cli_json_object(json, "files");
  if (scene->asset)
    describe_asset_path(json, scene->asset);
  else
    describe_path(json, "ply", "scenes", scene->name, ".ply");
  if (scene->formats & SUITE_SPZ)
    describe_path(json, "spz", "scenes", scene->name, ".spz");
  if (scene->formats & SUITE_GLB)
    describe_path(json, "glb", "scenes", scene->name, ".glb");
  cli_json_close(json);
  cli_json_counts(json, NULL, {"width", (uint64_t)scene->width}, {"height", (uint64_t)scene->height});
  if (scene->step)
    cli_json_count(json, "step", (uint64_t)scene->step);
  cli_json_text(json, "stage", conic_gaussian_stage_name(scene->stage));
  if (scene->make_splats || (scene->asset && scene->asset->flags & KHR_LINEAR))
    cli_json_text(json, "colors", "linear");
  cli_json_object(json, "camera");
  describe_path(json, "conic", "cameras", scene->name, ".json");
  describe_path(json, "colmap", "cameras", scene->name, "");
  describe_path(json, "transforms", "cameras", scene->name, ".transforms.json");
  cli_json_close(json);
  cli_json_array(json, "background");
  for (int c = 0; c < 3; c++)
    cli_json_number(json, NULL, (double)scene->background[c]);
  cli_json_close(json);
  cli_json_close(json);
}

static void describe_cases(cli_json *json, const conformance_job *job) {
  char name[SUITE_PATH_ROOM];
  cli_json_array(json, "cases");
  for (int i = 0; i < job->n_cases; i++) {
    const suite_case *one = &job->cases[i];
    name_case(one, name);
    cli_json_object(json, NULL);
    cli_json_text(json, "name", name);
    cli_json_count(json, "level", (uint64_t)one->scene->level);
    cli_json_texts(json, NULL, {"scene", one->scene->name}, {"profile", cli_suite_profile_name(one->profile)});
    if (has_exr(one->scene))
      describe_path(json, "exr", "expected", name, ".exr");
    describe_path(json, "npy", "expected", name, ".npy");
    cli_json_count(json, "doubtful_pixels", one->n_doubtful);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void describe_levels(cli_json *json, const conformance_job *job) {
  cli_json_array(json, "levels");
  for (int level = 1; level <= (job->is_khr ? KHR_LEVELS : SUITE_LEVELS); level++) {
    uint64_t n = 0;
    for (int i = 0; i < job->n_cases; i++)
      n += job->cases[i].scene->level == level;
    cli_json_object(json, NULL);
    cli_json_count(json, "level", (uint64_t)level);
    cli_json_text(json, "about", job->is_khr ? cli_khr_level_about(level) : cli_suite_level_about(level));
    cli_json_count(json, "cases", n);
    cli_json_close(json);
  }
  cli_json_close(json);
}

/* The assets that no renderer may draw. */
static void describe_refused(cli_json *json) {
  cli_json_array(json, "refused");
  for (int i = 0; i < cli_n_khr_assets; i++) {
    const khr_asset *asset = &cli_khr_assets[i];
    if (asset->level)
      continue;
    cli_json_object(json, NULL);
    cli_json_texts(json, NULL, {"name", asset->name}, {"about", asset->about}, {"clause", asset->clause});
    describe_asset_path(json, asset);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void describe_suite(cli_json *json, const conformance_job *job) {
  cli_json_text(json, "format", "conic-conformance");
  cli_json_count(json, "version", 1);
  cli_json_text(json, "conic", conic_version());
  describe_floats(json, job);
  describe_words(json, "channels", cli_suite_channel_names, SUITE_CHANNELS);
  describe_words(json, "ranges", cli_suite_range_names, SUITE_RANGES);
  describe_levels(json, job);
  cli_json_array(json, "scenes");
  for (int i = 0; i < job->n_scenes; i++)
    if (is_made(job, &job->scenes[i]))
      describe_scene(json, job, i);
  cli_json_close(json);
  describe_cases(json, job);
  if (job->is_khr)
    describe_refused(json);
  cli_json_array(json, "files");
  for (int i = 0; i < job->files->n; i++) {
    cli_json_object(json, NULL);
    cli_json_text(json, "path", job->files->files[i].path);
    cli_json_count(json, "bytes", job->files->files[i].bytes);
    cli_json_text(json, "sha256", job->files->files[i].sha256);
    cli_json_close(json);
  }
  cli_json_close(json);
}

/* Written last, so that a folder with a manifest is a complete suite. */
static conic_status write_suite_manifest(const conformance_job *job) {
  char full[4096];
  cli_json json;
  conic_output *output;
  conic_status status = cli_suite_join(job->files->context, job->files->folder, "manifest.json", full, sizeof full);
  if (status == CONIC_OK)
    status = conic_output_open(job->files->context, full, &output);
  if (status != CONIC_OK)
    return status;
  cli_json_begin(&json, conic_output_stream(output));
  describe_suite(&json, job);
  cli_json_end(&json);
  return conic_output_commit(output);
}

/* A line for each case, for runners that do not read JSON. */
static conic_status write_case_list(const conformance_job *job) {
  char name[SUITE_PATH_ROOM], path[SUITE_PATH_ROOM], line[8 * SUITE_PATH_ROOM];
  size_t n = 0, room = (size_t)job->n_cases * sizeof line + 1;
  char *text = conic_memory_allocate(job->files->context, room, 1);
  if (!text)
    return CONIC_ERROR_MEMORY;
  text[0] = '\0';
  for (int i = 0; i < job->n_cases; i++) {
    const suite_scene *scene = job->cases[i].scene;
    name_case(&job->cases[i], name);
    snprintf(path, sizeof path, "scenes/%s.ply", scene->name);
    if (scene->asset)
      cli_khr_path(scene->asset, path);
    n += (size_t)snprintf(text + n, room - n, "%s\t%s\tcameras/%s.json\t%s\t%.9g,%.9g,%.9g\n", name, path, scene->name,
                          cli_suite_profile_name(job->cases[i].profile), (double)scene->background[0],
                          (double)scene->background[1], (double)scene->background[2]);
  }
  conic_status status = cli_suite_write_text(job->files, "cases.tsv", text);
  conic_memory_release(job->files->context, text);
  return status;
}

/* --- the command --- */

/* Only an earlier suite may be overwritten. */
static int check_suite_folder(const char *folder) {
  char manifest[4096];
  conic_disk_entry found;
  conic_disk_folder entries;
  int is_empty = 1;
  if (!conic_disk_look(folder, &found))
    return CLI_DONE;
  if (!conic_disk_open_folder(folder, &entries))
    return cli_error(CLI_RESOURCE, "%s: cannot write: %s", folder, strerror(errno));
  for (const char *entry; (entry = conic_disk_next_name(&entries));)
    is_empty &= strcmp(entry, ".") == 0 || strcmp(entry, "..") == 0;
  conic_disk_close_folder(&entries);
  snprintf(manifest, sizeof manifest, "%s/manifest.json", folder);
  if (is_empty || conic_disk_look(manifest, &found))
    return CLI_DONE;
  return cli_usage("conformance: %s: the folder is neither empty nor an earlier suite; give another name", folder);
}

/* Removes the old manifest first: without one the folder is no suite until the new one is written. */
static conic_status make_suite_folders(suite_files *files, int is_khr) {
  char full[4096];
  conic_status status = cli_suite_make_folder(files, "");
  if (status == CONIC_OK)
    status = cli_suite_join(files->context, files->folder, "manifest.json", full, sizeof full);
  if (status == CONIC_OK && !conic_disk_remove(full) && errno != ENOENT)
    status = conic_fail(files->context, CONIC_ERROR_IO, "%s: cannot write: %s", full, strerror(errno));
  static const char *const folders[] = {"scenes", "cameras", "expected", "broken"};
  for (int i = 0; status == CONIC_OK && i < (is_khr ? 4 : 3); i++)
    status = cli_suite_make_folder(files, folders[i]);
  return status;
}

static conic_status write_refused(suite_files *files) {
  conic_status status = CONIC_OK;
  for (int i = 0; status == CONIC_OK && i < cli_n_khr_assets; i++) {
    conic_gaussians seen;
    if (cli_khr_assets[i].level)
      continue;
    status = cli_khr_write(files, &cli_khr_assets[i], &seen);
    conic_gaussians_release(files->context, &seen);
  }
  return status;
}

/* The scenes of the pack are the assets that are drawn. */
static void choose_scenes(conformance_job *job) {
  job->scenes = job->is_khr ? job->assets : cli_suite_scenes;
  job->n_scenes = job->is_khr ? 0 : cli_n_suite_scenes;
  for (int i = 0; job->is_khr && i < cli_n_khr_assets && job->n_scenes < MOST_ASSETS; i++)
    if (cli_khr_assets[i].level)
      cli_khr_scene(&cli_khr_assets[i], &job->assets[job->n_scenes++]);
}

static int make_suite(void *cookie) {
  conformance_job *job = cookie;
  job->files = conic_memory_allocate_zeroed(job->base.session->context, 1, sizeof *job->files);
  if (!job->files)
    return CLI_RESOURCE;
  job->files->context = job->base.session->context;
  job->files->folder = job->base.output;
  conic_status status = make_suite_folders(job->files, job->is_khr);
  choose_scenes(job);
  for (int i = 0; status == CONIC_OK && i < job->n_scenes; i++) {
    cli_session_part(job->base.session, "scenes", i + 1, job->n_scenes);
    if (is_made(job, &job->scenes[i]))
      status = make_suite_scene(job, i);
  }
  if (status == CONIC_OK && job->is_khr)
    status = write_refused(job->files);
  if (status == CONIC_OK)
    status = cli_suite_write_text(job->files, "README.md", job->is_khr ? cli_khr_readme : cli_suite_readme);
  if (status == CONIC_OK)
    status = write_case_list(job);
  if (status == CONIC_OK)
    status = write_suite_manifest(job);
  return cli_exit_of(status);
}

static uint64_t count_bytes(const conformance_job *job) {
  uint64_t bytes = 0;
  for (int i = 0; i < job->files->n; i++)
    bytes += job->files->files[i].bytes;
  return bytes;
}

static void tell_suite(const void *cookie) {
  const conformance_job *job = cookie;
  cli_note(job->base.session, "%s: %d cases in %d files of %.1f MB; its README.md says how to use them",
           job->base.output, job->n_cases, job->files->n + 1, 1e-6 * (double)count_bytes(job));
}

static void report_suite(cli_json *json, const void *cookie) {
  const conformance_job *job = cookie;
  cli_json_text(json, "floats", float_names[job->floats]);
  cli_json_counts(json, NULL, {"cases", (uint64_t)job->n_cases}, {"files", (uint64_t)job->files->n + 1},
                  {"bytes", count_bytes(job)});
  describe_levels(json, job);
  cli_build_report_cost(json, &job->base, "cases_per_s", (double)job->n_cases / job->base.total_seconds);
}

static void release_suite(void *cookie) {
  conformance_job *job = cookie;
  conic_memory_release(job->base.session->context, job->files);
}

static int run_conformance(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_suite, tell_suite, report_suite, release_suite};
  conformance_job job = {.most_level = SUITE_LEVELS, .base = {session, .stages = {{"scenes"}, {"bounds"}, {"write"}}}};
  const char *positional[argc];
  int n_positional;
  const cli_option options[] = {
      {"khr", CLI_FLAG, &job.is_khr, NULL, "the pack for KHR_gaussian_splatting: glTF files, valid and broken"},
      {"profile", CLI_TEXT, &job.profile_list, "NAMES", "only these profiles, with commas between [all]",
       .acts.with = "!khr"},
      {"level", CLI_INT, &job.most_level, "N", "only cases up to this level [7]", 1, SUITE_LEVELS},
      {"floats", CLI_CHOICE, &job.floats, "KIND",
       "what renderers may round: fast: as a GPU's fast mathematics; strict: e^x to 2 ulp [fast]",
       .choices = float_names},
  };
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE && n_positional != 1)
    exit_code = cli_usage("conformance: %s; see conic help conformance",
                          n_positional ? "one folder at a time" : "no folder given");
  if (exit_code == CLI_DONE) {
    job.base.output = positional[0];
    job.profiles = cli_suite_find_profiles("conformance", job.profile_list);
    exit_code = job.profiles ? check_suite_folder(job.base.output) : CLI_USAGE;
  }
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  return cli_build_run(&job, &steps, exit_code);
}

const cli_command cli_conformance = {
    .name = "conformance",
    .summary = "writes a suite of cases by which any Gaussian renderer can be judged",
    .usage = "conic conformance OUT/ [--khr | --profile NAME[,NAME]] [--level N] [--floats fast|strict]",
    .run = run_conformance,
    .description = "Writes small scenes, their cameras, and what each pixel may be, into a folder. Draw them with your "
                   "renderer, and let conic judge --suite compare.",
    .examples = {{"write the cases of one profile", "conic conformance suite/ --profile gsplat-1.6"},
                 {"write the pack for Khronos' glTF extension", "conic conformance --khr pack/"}},
};
